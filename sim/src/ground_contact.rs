//! The ground for rigid bodies: a window of posts as the physics engine's height field, with our diagonal.
//!
//! Loose things lie on it ([`crate::loose`]); it is also the yardstick of the ground benchmark. Aircraft, vehicles, shells
//! and sights use the ground itself: the engine's ray loses hits that lie on cell lines.
//!
//! The engine's field is centred on its origin and `scale` is its *full* extent; its array is column-major with rows
//! along z and columns along x, so posts need no flip, only this one copy. Its cells are cut, unless told otherwise,
//! from (x0, z1) to (x1, z0): south-west to north-east, as ours. Facts checked in parry3d-f64 0.31.1, heightfield3.rs.
//!
//! Invariant: each triangle of the window has the very heights of the posts (f32 widened to f64), or is removed because
//! a post of it is void.

use rapier3d::parry::math::Vector;
use rapier3d::parry::shape::{HeightField, HeightFieldCellStatus, HeightFieldFlags};
use rapier3d::parry::utils::Array2;
use std::fmt;

/// Why there is no height field.
#[derive(Debug, Clone, PartialEq)]
pub enum WindowError {
    /// Fewer than 2 x 2 posts, or not as many as columns times rows.
    Posts {
        /// Columns asked for.
        columns: u32,
        /// Rows asked for.
        rows: u32,
        /// Posts given.
        found: usize,
    },
    /// The step is not finite and positive.
    Step(f64),
    /// No post is finite: there is no ground.
    Void,
    /// A post is infinite.
    Infinite {
        /// Its column.
        column: u32,
        /// Its row.
        row: u32,
    },
}

impl fmt::Display for WindowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Posts { columns, rows, found } => {
                write!(f, "expected at least 2 x 2 posts, {columns} x {rows} of them, found {found}")
            }
            Self::Step(step_m) => write!(f, "expected a post step above 0 m, found {step_m}"),
            Self::Void => write!(f, "expected at least one post with a height, found only void"),
            Self::Infinite { column, row } => {
                write!(f, "the post at column {column}, row {row} must be finite or NaN for void, found an infinity")
            }
        }
    }
}

impl std::error::Error for WindowError {}

/// The engine's field of `columns` x `rows` posts, row by row from the north-west; NaN is void.
///
/// It is centred: put its collider at the middle of the window, at height 0.
///
/// # Errors
/// [`WindowError`] says what is wrong with the posts.
pub fn height_field(posts_m: &[f32], columns: u32, rows: u32, step_m: f64) -> Result<HeightField, WindowError> {
    let (width, depth) = (columns as usize, rows as usize);
    if width < 2 || depth < 2 || width.checked_mul(depth) != Some(posts_m.len()) {
        return Err(WindowError::Posts { columns, rows, found: posts_m.len() });
    }
    if !step_m.is_finite() || step_m <= 0.0 {
        return Err(WindowError::Step(step_m));
    }
    if let Some(at) = posts_m.iter().position(|h| h.is_infinite()) {
        return Err(WindowError::Infinite { column: (at % width) as u32, row: (at / width) as u32 });
    }
    let lowest = posts_m.iter().copied().filter(|h| !h.is_nan()).reduce(f32::min).ok_or(WindowError::Void)?;
    // A void post needs some number, or the field's box is NaN; its triangles are removed below.
    let height = |row: usize, column: usize| {
        let post = posts_m[row * width + column];
        f64::from(if post.is_nan() { lowest } else { post })
    };
    let extent = Vector::new((width - 1) as f64 * step_m, 1.0, (depth - 1) as f64 * step_m);
    let heights = Array2::from_fn(depth, width, height);
    let mut field = HeightField::with_flags(heights, extent, HeightFieldFlags::FIX_INTERNAL_EDGES);
    let void = |row: usize, column: usize| posts_m[row * width + column].is_nan();
    for row in 0..depth - 1 {
        for column in 0..width - 1 {
            let shared = void(row + 1, column) || void(row, column + 1);
            let mut status = HeightFieldCellStatus::default();
            status.set(HeightFieldCellStatus::LEFT_TRIANGLE_REMOVED, shared || void(row, column));
            status.set(HeightFieldCellStatus::RIGHT_TRIANGLE_REMOVED, shared || void(row + 1, column + 1));
            if !status.is_empty() {
                field.set_cell_status(row, column, status);
            }
        }
    }
    Ok(field)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use terrain::{Field, Grid};

    const SEED: u64 = 20_261_122;

    #[test]
    fn every_triangle_is_ours_to_the_bit() {
        // Not square, so that a swapped axis shows; a seventh of the posts void.
        let grid = Grid::centred(200.0, 2, 3).unwrap();
        let mut random = StdRng::seed_from_u64(SEED);
        let mut post = || if random.random_bool(0.14) { f32::NAN } else { random.random_range(-430.0f32..8_850.0) };
        let posts: Vec<f32> = (0..grid.posts()).map(|_| post()).collect();
        let ours = Field::new(grid, posts.clone()).unwrap();
        let engine = height_field(&posts, grid.columns(), grid.rows(), grid.step_m).unwrap();
        let mut present = 0;
        for row in 0..grid.rows() - 1 {
            for column in 0..grid.columns() - 1 {
                let (north_west, south_east) = engine.triangles_at(row as usize, column as usize);
                for (theirs, ours) in [north_west, south_east].into_iter().zip(ours.cell_triangles(column, row)) {
                    assert_eq!(theirs.is_some(), ours.is_some(), "column {column}, row {row}");
                    let (Some(theirs), Some(ours)) = (theirs, ours) else { continue };
                    present += 1;
                    for (a, b) in [theirs.a, theirs.b, theirs.c].into_iter().zip(ours.corners) {
                        assert_eq!(a.y.to_bits(), b.y.to_bits(), "column {column}, row {row}");
                        // The engine scales a fraction of the extent: two roundings of at most 9 km, 2^-52 each.
                        assert!((a.x - b.x).abs() < 4e-12 && (a.z - b.z).abs() < 4e-12, "{a:?} {b:?}");
                    }
                }
            }
        }
        assert!(present > 3_000, "{present}");
    }

    #[test]
    fn windows_that_are_none_are_refused() {
        assert!(matches!(height_field(&[0.0; 2], 1, 2, 1.0), Err(WindowError::Posts { .. })));
        assert!(matches!(height_field(&[0.0; 5], 2, 2, 1.0), Err(WindowError::Posts { found: 5, .. })));
        assert!(matches!(height_field(&[], u32::MAX, u32::MAX, 1.0), Err(WindowError::Posts { .. })));
        assert!(matches!(height_field(&[0.0; 4], 2, 2, f64::NAN), Err(WindowError::Step(_))));
        assert_eq!(height_field(&[f32::NAN; 4], 2, 2, 1.0).unwrap_err(), WindowError::Void);
        let infinite = height_field(&[0.0, 0.0, f32::INFINITY, 0.0], 2, 2, 1.0).unwrap_err();
        assert_eq!(infinite, WindowError::Infinite { column: 0, row: 1 });
    }
}
