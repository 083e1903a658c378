//! The light map of a block: what each post has of the sun and of the sky.
//!
//! 32 x 32 RGBA8, one texel a post with an apron: red and green are the east and south parts of the unit normal
//! (0..255 for -1..1), blue how much of the sun's disc is seen, alpha how much of the sky. Made from the world's posts, not
//! the block's, so that a border is as smooth as the middle and shadows cross it.
//!
//! The sun test walks the posts towards the sun, a row or column at a time with the height between two posts taken
//! linearly, keeps the steepest rise met, and compares it with the sun's. It ends where the ray has risen above all
//! ground. The edge of a shadow is softened over [`PENUMBRA_RAD`]: wider than the sun, so that a 200 m post spacing draws
//! a smooth edge instead of steps. All rays of a block are parallel, so a row of texels takes each step together.
//!
//! Invariant others rely on: where a walk ends early shows in no texel, so what lies beyond the reach of a shadow
//! ([`Walk::may_shade`]) does not either.

use super::mesh::TILE;
use crate::field::Field;
use crate::grid::{BlockIndex, PostRect};
use crate::pyramid::Pyramid;
use glam::{DVec2, DVec3};

/// Bytes of a light map.
pub const BYTES: usize = (TILE * TILE * 4) as usize;

/// Over how much angle a shadow's edge goes from dark to light.
pub const PENUMBRA_RAD: f64 = 0.03;

/// Under this elevation the sun lights no ground.
const DARK_ELEVATION_RAD: f64 = -0.02;

/// Longest shadow followed, metres.
const LONGEST_SHADOW_M: f64 = 80_000.0;

/// Steps beyond a block's texels that its share of the sky reads.
const ROOM: usize = 9;

/// The light map of a block for a direction towards the sun (unit, world frame).
pub fn light_map(field: &Field, pyramid: &Pyramid, block: BlockIndex, to_sun: DVec3) -> Box<[u8]> {
    let (first_column, first_row) = (block.first_column(), block.first_row());
    let around = Around::new(field, first_column, first_row);
    let walk = Walk::new(field.grid().step_m, to_sun);
    let highest_m = f64::from(pyramid.all().greatest_m);
    let mut texels = Vec::with_capacity(BYTES);
    let unit = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
    for row in 0..TILE as usize {
        let here: [f64; ROW] = std::array::from_fn(|column| around.post_m(column, row, 0, 0));
        let seen = walk.row_seen(field, first_column, first_row + row as i64, &here, highest_m);
        for column in 0..ROW {
            if here[column].is_nan() {
                texels.extend([128, 128, 255, 255]);
                continue;
            }
            let normal = around.normal(column, row, field.grid().step_m);
            texels.extend([
                unit(normal.x * 0.5 + 0.5),
                unit(normal.z * 0.5 + 0.5),
                unit(seen[column]),
                unit(around.sky_seen(column, row, field.grid().step_m)),
            ]);
        }
    }
    texels.into_boxed_slice()
}

/// Texels of a row.
const ROW: usize = TILE as usize;

/// The posts of a block's texels and those around them.
struct Around(Vec<f32>);

impl Around {
    const SIDE: usize = ROW + 2 * ROOM;

    fn new(field: &Field, first_column: i64, first_row: i64) -> Self {
        let side = Self::SIDE as u32;
        let (column, row) = (first_column - ROOM as i64, first_row - ROOM as i64);
        Self(field.read(PostRect { column, row, columns: side, rows: side }))
    }

    #[inline(always)]
    fn post_m(&self, column: usize, row: usize, east: isize, south: isize) -> f64 {
        let at = (row + ROOM).wrapping_add_signed(south) * Self::SIDE + (column + ROOM).wrapping_add_signed(east);
        f64::from(self.0[at])
    }

    fn normal(&self, column: usize, row: usize, step_m: f64) -> DVec3 {
        let at = |east, south| self.post_m(column, row, east, south);
        normal_from(at(0, 0), [at(-1, 0), at(1, 0)], [at(0, -1), at(0, 1)], step_m)
    }

    /// How much of the sky dome a post sees, 0..=1: from the horizon in eight directions at three distances.
    fn sky_seen(&self, column: usize, row: usize, step_m: f64) -> f64 {
        const DIRECTIONS: [(isize, isize); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        let here = self.post_m(column, row, 0, 0);
        let mut seen = 0.0;
        for (dx, dz) in DIRECTIONS {
            let per_length = if dx * dz == 0 { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 } / step_m;
            let mut horizon = 0.0f64;
            for (reach, share) in [(1, 1.0), (3, 1.0 / 3.0), (9, 1.0 / 9.0)] {
                let rise = self.post_m(column, row, dx * reach, dz * reach) - here;
                // max ignores NaN: void hides nothing.
                horizon = horizon.max(rise * (per_length * share));
            }
            // Cosine-weighted part of the sky above a horizon of this slope.
            seen += 1.0 / (1.0 + horizon * horizon);
        }
        seen / 8.0
    }
}

/// Upward unit normal at a post, from its four neighbours; one-sided beside void and at the world's edge.
pub fn normal(field: &Field, column: i64, row: i64) -> DVec3 {
    let at = |east: i64, south: i64| f64::from(field.post_m(column + east, row + south));
    normal_from(at(0, 0), [at(-1, 0), at(1, 0)], [at(0, -1), at(0, 1)], field.grid().step_m)
}

/// From the height of a post, those west and east, and those north and south of it.
fn normal_from(here: f64, west_east: [f64; 2], north_south: [f64; 2], step_m: f64) -> DVec3 {
    let slope = |[before, after]: [f64; 2]| match (before.is_nan(), after.is_nan()) {
        (false, false) => 0.5 * (after - before),
        (true, false) => after - here,
        (false, true) => here - before,
        (true, true) => 0.0,
    };
    DVec3::new(-slope(west_east), step_m, -slope(north_south)).normalize_or(DVec3::Y)
}

/// How much of the sun's disc a post sees, 0..=1; `highest_m` is no lower than any post.
pub fn sun_seen(field: &Field, column: i64, row: i64, to_sun: DVec3, highest_m: f64) -> f64 {
    let here = [f64::from(field.post_m(column, row)); ROW];
    Walk::new(field.grid().step_m, to_sun).row_seen(field, column, row, &here, highest_m)[0]
}

/// The walk of parallel rays towards the sun, one column or one row a step, whichever the sun is more along.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Walk {
    step_m: f64,
    /// Towards the sun in plan, unit.
    along: DVec2,
    elevation_rad: f64,
    by_column: bool,
    /// Columns or rows a step, 1 or -1.
    ahead: i64,
    /// The other way, posts a step.
    aside: f64,
    /// Plan length of a step, metres.
    stride_m: f64,
    /// Steps of the longest shadow followed.
    most: i64,
    /// The least rise that takes any of the sun away, and the least that takes all: metres a metre.
    clear: f64,
    dark: f64,
    /// Everything, or nothing, is lit and no step is taken.
    even: Option<f64>,
}

impl Walk {
    pub(crate) fn new(step_m: f64, to_sun: DVec3) -> Self {
        let level = to_sun.x.hypot(to_sun.z);
        let elevation_rad = to_sun.y.atan2(level);
        let by_column = to_sun.x.abs() >= to_sun.z.abs();
        let (major, minor) = if by_column { (to_sun.x, to_sun.z) } else { (to_sun.z, to_sun.x) };
        let stride_m = step_m * level / major.abs();
        let tangent = |rad: f64| if rad < std::f64::consts::FRAC_PI_2 { rad.tan() } else { f64::INFINITY };
        let even = if elevation_rad < DARK_ELEVATION_RAD {
            Some(0.0)
        } else if level < 1e-6 {
            Some(1.0)
        } else {
            None
        };
        Self {
            step_m,
            along: DVec2::new(to_sun.x, to_sun.z) / level,
            elevation_rad,
            by_column,
            ahead: major.signum() as i64,
            aside: minor / major.abs(),
            stride_m,
            most: (LONGEST_SHADOW_M / stride_m).ceil() as i64,
            clear: tangent(elevation_rad - 0.5 * PENUMBRA_RAD),
            dark: tangent(elevation_rad + 0.5 * PENUMBRA_RAD),
            even,
        }
    }

    /// How much of the sun's disc is seen by the posts of a row from a column on, of these heights.
    fn row_seen(&self, field: &Field, column: i64, row: i64, here: &[f64; ROW], highest_m: f64) -> [f64; ROW] {
        /// Steps between two looks at whether the rest of the walk can matter.
        const LOOK: i64 = 8;
        if let Some(even) = self.even {
            return [even; ROW];
        }
        let lowest_m = here.iter().copied().fold(f64::INFINITY, f64::min);
        let mut steepest = [f64::NEG_INFINITY; ROW];
        let mut first = [f32::NAN; ROW + 1];
        let mut second = [f32::NAN; ROW];
        for step in 1..=self.most {
            let per_m = 1.0 / (self.stride_m * step as f64);
            if step % LOOK == 1 {
                let least = steepest.iter().zip(here).filter(|(_, h)| !h.is_nan()).map(|(s, _)| *s);
                let least = least.fold(f64::INFINITY, f64::min);
                // Nothing from here on is steeper than this; what is not steeper than `clear` takes nothing away.
                if (highest_m - lowest_m) * per_m < least.max(self.clear) || least >= self.dark {
                    break;
                }
            }
            let across = self.aside * step as f64;
            let (low, ahead) = (across.floor(), self.ahead * step);
            let part = across - low;
            if self.by_column {
                field.read_row(column + ahead, row + low as i64, &mut first[..ROW]);
                field.read_row(column + ahead, row + low as i64 + 1, &mut second);
            } else {
                field.read_row(column + low as i64, row + ahead, &mut first);
                second.copy_from_slice(&first[1..]);
            }
            for at in 0..ROW {
                let (one, two) = (f64::from(first[at]), f64::from(second[at]));
                let height = if part > 0.0 { one * (1.0 - part) + two * part } else { one };
                let rise = (height - here[at]) * per_m;
                // False for void, which hides nothing.
                if rise > steepest[at] {
                    steepest[at] = rise;
                }
            }
        }
        steepest.map(|steepest| {
            let above = self.elevation_rad - steepest.max(-1e3).atan();
            let t = (above / PENUMBRA_RAD + 0.5).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        })
    }

    /// Whether ground at most `rise_m` above a texel can take any sun from it, if it lies within a box of offsets from it,
    /// in posts east and south; never no where it does.
    pub(crate) fn may_shade(&self, [low, high]: [DVec2; 2], rise_m: f32) -> bool {
        if self.even.is_some() {
            return false;
        }
        // Distances in posts at which the ray is within the box; a post of room for the neighbour that a ray lies between.
        let (mut enter, mut leave) = (0.0f64, self.most as f64 * self.stride_m / self.step_m);
        let (low, high) = (low - 1.0, high + 1.0);
        for (direction, low, high) in [(self.along.x, low.x, high.x), (self.along.y, low.y, high.y)] {
            if direction.abs() < 1e-9 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
            } else {
                let (one, other) = (low / direction, high / direction);
                (enter, leave) = (enter.max(one.min(other)), leave.min(one.max(other)));
            }
        }
        // A hair of room for rounding.
        enter <= leave && (enter < 1.0 || f64::from(rise_m) / ((enter - 1e-6) * self.step_m) > self.clear - 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, Ground, synthetic};
    use std::sync::Arc;

    #[test]
    fn shadows_at_posts_agree_with_a_ray_through_the_triangles() {
        let grid = Grid::centred(200.0, 4, 4).unwrap();
        let ground = Ground::new(Arc::new(synthetic::ridges(grid, 11)));
        let (field, area) = (ground.field().clone(), ground.whole());
        let highest = f64::from(ground.pyramid().all().greatest_m);
        let (mut agree, mut all) = (0, 0);
        for (heading, elevation) in
            [(2.0, 0.2), (3.3, 0.45), (4.0, 0.1), (0.7, 0.7), (std::f64::consts::FRAC_PI_2, 0.3)]
        {
            let to_sun = crate::frame::direction(heading, elevation);
            for row in (20..100).step_by(2) {
                for column in (20..100).step_by(2) {
                    let from = DVec3::new(grid.x_m(column), f64::from(field.post_m(column, row)) + 0.05, grid.z_m(row));
                    let lit = area.segment(from, from + to_sun * 60_000.0).is_none();
                    let seen = sun_seen(&field, column, row, to_sun, highest);
                    all += 1;
                    agree += i32::from(lit == (seen >= 0.5));
                }
            }
        }
        // The walk takes the ground between two posts of a row linearly; the triangles bend once more at the diagonal.
        assert!(f64::from(agree) >= 0.99 * f64::from(all), "{agree} of {all}");
    }

    #[test]
    fn flat_ground_is_fully_lit_by_day_and_dark_by_night() {
        let field = synthetic::flat(Grid::centred(200.0, 1, 1).unwrap(), 100.0);
        let pyramid = Pyramid::new(&field);
        let day = light_map(&field, &pyramid, BlockIndex { x: 0, z: 0 }, DVec3::new(0.3, 0.8, 0.1).normalize());
        assert_eq!(day[(5 * TILE as usize + 5) * 4..][..4], [128, 128, 255, 255]);
        let night = light_map(&field, &pyramid, BlockIndex { x: 0, z: 0 }, DVec3::new(0.3, -0.8, 0.1).normalize());
        assert_eq!(night[(5 * TILE as usize + 5) * 4 + 2], 0);
    }
}
