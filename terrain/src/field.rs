//! Heights on a grid, and the surface between them: the ground.
//!
//! Frame: see [`crate::frame`]; heights in metres above mean sea level. Every cell is cut from its south-west to its
//! north-east corner into two triangles. Picture, physics, queries and meshes all rely on that one diagonal.
//!
//! A post without data is *void* and stored as NaN; a triangle with a void corner is void too: nothing is there.
//! Invariant: a post is finite or NaN, never infinite, and |height| <= [`MAX_HEIGHT_M`].
//!
//! A field never changes; an event makes a new version of it ([`Field::edited`]) that shares what did not change.

use crate::edit::{Changed, Edit, EditError};
use crate::grid::{Grid, PostRect};
use crate::paged::Paged;
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::fmt;

/// Largest height taken: more than any place on Earth with a 10,000 m test step on top.
pub const MAX_HEIGHT_M: f32 = 100_000.0;

/// Posts and their heights.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    grid: Grid,
    heights_m: Paged<f32>,
    version: u32,
}

/// A post's place: column and row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Corner {
    /// Column.
    pub column: u32,
    /// Row.
    pub row: u32,
}

/// One triangle of the ground, its corners in world metres, counter-clockwise seen from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Corners.
    pub corners: [DVec3; 3],
}

/// Why a field cannot be made.
#[derive(Debug, Clone, PartialEq)]
pub enum FieldError {
    /// The number of heights is not the grid's number of posts.
    Count {
        /// Posts of the grid.
        expected: usize,
        /// Heights given.
        found: usize,
    },
    /// A height is infinite or beyond [`MAX_HEIGHT_M`].
    Height {
        /// Column of the post.
        column: u32,
        /// Row of the post.
        row: u32,
        /// What was found there.
        height_m: f32,
    },
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count { expected, found } => write!(f, "expected {expected} heights, found {found}"),
            Self::Height { column, row, height_m } => write!(
                f,
                "the height at column {column}, row {row} must be within +-{MAX_HEIGHT_M} m or NaN for no data, found {height_m}"
            ),
        }
    }
}

impl std::error::Error for FieldError {}

impl Field {
    /// A field from heights row by row, north first, each row from the west. NaN is void.
    ///
    /// # Errors
    /// [`FieldError`] if the count is not the grid's, or a height is infinite or beyond [`MAX_HEIGHT_M`].
    pub fn new(grid: Grid, heights_m: Vec<f32>) -> Result<Self, FieldError> {
        if heights_m.len() != grid.posts() {
            return Err(FieldError::Count { expected: grid.posts(), found: heights_m.len() });
        }
        if let Some(at) = heights_m.iter().position(|h| h.abs() > MAX_HEIGHT_M) {
            let columns = grid.columns() as usize;
            let (column, row) = ((at % columns) as u32, (at / columns) as u32);
            return Err(FieldError::Height { column, row, height_m: heights_m[at] });
        }
        Ok(Self { grid, heights_m: Paged::new(heights_m), version: 0 })
    }

    /// The next version of the field: the edits made, one after the other, and what they changed. Cost: a copy of the
    /// pages changed and of a table of a thousandth of the field.
    ///
    /// # Errors
    /// [`EditError`] says which edit cannot be made; none is then.
    pub fn edited(&self, edits: &[Edit]) -> Result<(Self, Changed), EditError> {
        let posts = crate::edit::posts(self, edits)?;
        let changed = Changed::new(self, &posts);
        let columns = self.grid.columns() as usize;
        let changes =
            posts.iter().map(|(corner, height_m)| (corner.row as usize * columns + corner.column as usize, *height_m));
        let heights_m = self.heights_m.with(changes);
        Ok((Self { grid: self.grid, heights_m, version: self.version + 1 }, changed))
    }

    /// Counts the edits that made it, from 0.
    pub fn version(&self) -> u32 {
        self.version
    }

    /// Size of the posts in bytes.
    pub fn bytes(&self) -> usize {
        self.heights_m.bytes()
    }

    /// Where the posts lie.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// All heights row by row; NaN is void. A copy if the field was edited.
    pub fn heights_m(&self) -> Cow<'_, [f32]> {
        self.heights_m.all()
    }

    /// Heights of a cell's posts: north-west, north-east, south-west, south-east. The cell must be one of the grid's.
    #[inline(always)]
    pub(crate) fn cell_m(&self, column: usize, row: usize) -> [f32; 4] {
        let wide = self.grid.columns() as usize;
        let at = row * wide + column;
        let places = [at, at + 1, at + wide, at + wide + 1];
        match self.heights_m.whole() {
            Some(heights) => places.map(|at| heights[at]),
            None => places.map(|at| self.heights_m.get(at)),
        }
    }

    /// Height of a post in metres; NaN if void or outside the grid.
    pub fn post_m(&self, column: i64, row: i64) -> f32 {
        if (0..i64::from(self.grid.columns())).contains(&column) && (0..i64::from(self.grid.rows())).contains(&row) {
            self.heights_m.get(row as usize * self.grid.columns() as usize + column as usize)
        } else {
            f32::NAN
        }
    }

    /// Position of a post in the world.
    pub fn position_m(&self, corner: Corner) -> DVec3 {
        let (column, row) = (i64::from(corner.column), i64::from(corner.row));
        DVec3::new(self.grid.x_m(column), f64::from(self.post_m(column, row)), self.grid.z_m(row))
    }

    /// The heights of a rectangle, row by row; NaN outside the grid.
    pub fn read(&self, rect: PostRect) -> Vec<f32> {
        let wide = rect.columns as usize;
        let mut heights = vec![f32::NAN; wide * rect.rows as usize];
        for (row, line) in (rect.row..).zip(heights.chunks_exact_mut(wide.max(1))) {
            self.read_row(rect.column, row, line);
        }
        heights
    }

    /// Heights along a row from a column on; NaN outside the grid.
    #[inline]
    pub(crate) fn read_row(&self, column: i64, row: i64, into: &mut [f32]) {
        let columns = i64::from(self.grid.columns());
        let inside = (0..i64::from(self.grid.rows())).contains(&row);
        let first = column.clamp(0, columns);
        let last = (column + into.len() as i64).clamp(first, columns);
        if !inside || first == last {
            return into.fill(f32::NAN);
        }
        let (before, length) = ((first - column) as usize, (last - first) as usize);
        into[..before].fill(f32::NAN);
        into[before + length..].fill(f32::NAN);
        self.heights_m.read((row * columns + first) as usize, &mut into[before..before + length]);
    }

    /// The two triangles of a cell, the north-western one first; a void one is `None`.
    pub fn cell_triangles(&self, column: u32, row: u32) -> [Option<Triangle>; 2] {
        let at = |dc: u32, dr: u32| self.position_m(Corner { column: column + dc, row: row + dr });
        let (nw, ne, sw, se) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        [[nw, sw, ne], [sw, se, ne]]
            .map(|corners| corners.iter().all(|c| c.y.is_finite()).then_some(Triangle { corners }))
    }
}

impl Triangle {
    /// Upward unit normal.
    pub fn normal(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize()
    }

    /// Height of the triangle's plane over a plan point (x, z), metres.
    pub fn plane_height_m(&self, at: DVec2) -> f64 {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a);
        a.y - (normal.x * (at.x - a.x) + normal.z * (at.y - a.z)) / normal.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_face_up_and_share_the_south_west_to_north_east_diagonal() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let field = Field::new(grid, (0..grid.posts()).map(|i| (i % 7) as f32).collect()).unwrap();
        let [north_west, south_east] = field.cell_triangles(3, 4).map(Option::unwrap);
        assert!(north_west.normal().y > 0.0 && south_east.normal().y > 0.0);
        let sw = field.position_m(Corner { column: 3, row: 5 });
        let ne = field.position_m(Corner { column: 4, row: 4 });
        for triangle in [north_west, south_east] {
            assert!(triangle.corners.contains(&sw) && triangle.corners.contains(&ne));
        }
    }

    #[test]
    fn a_rectangle_is_its_posts_one_by_one_also_beyond_the_edge() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let field = Field::new(grid, (0..grid.posts()).map(|i| i as f32).collect()).unwrap();
        for (column, row) in [(0, 0), (-3, -2), (25, 28), (200, 5), (-200, 5), (5, -90)] {
            let rect = PostRect { column, row, columns: 9, rows: 7 };
            for (at, height) in field.read(rect).into_iter().enumerate() {
                let slow = field.post_m(column + at as i64 % 9, row + at as i64 / 9);
                assert_eq!(height.to_bits(), slow.to_bits(), "{rect:?} at {at}");
            }
        }
    }

    #[test]
    fn infinite_heights_are_refused_and_void_is_kept() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let mut heights = vec![0.0; grid.posts()];
        heights[grid.columns() as usize + 2] = f32::NAN;
        let field = Field::new(grid, heights.clone()).unwrap();
        assert!(field.post_m(2, 1).is_nan());
        // Post (2, 1) is the north-west corner of cell (2, 1): only the south-eastern triangle is left.
        assert!(matches!(field.cell_triangles(2, 1), [None, Some(_)]));
        heights[grid.columns() as usize + 9] = f32::INFINITY;
        assert!(matches!(Field::new(grid, heights), Err(FieldError::Height { column: 9, row: 1, .. })));
        assert!(matches!(Field::new(grid, vec![0.0; 3]), Err(FieldError::Count { found: 3, .. })));
    }
}
