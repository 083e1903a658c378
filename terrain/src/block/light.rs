//! The light map of a block: what each post has of the sun and of the sky.
//!
//! 32 x 32 RGBA8, one texel a post with an apron: red and green are the east and south parts of the unit normal
//! (0..255 for -1..1), blue how much of the sun's disc is seen, alpha how much of the sky. Made from the world's posts, not
//! the block's, so that a border is as smooth as the middle and shadows cross it.
//!
//! The sun test walks the posts towards the sun, a row or column at a time with the height between two posts taken
//! linearly, keeps the steepest angle met, and compares it with the sun's. It ends where the ray has risen above all
//! ground. The edge of a shadow is softened over [`PENUMBRA_RAD`]: wider than the sun, so that a 200 m post spacing draws
//! a smooth edge instead of steps.

use super::mesh::TILE;
use crate::field::Field;
use crate::grid::BlockIndex;
use crate::pyramid::Pyramid;
use glam::DVec3;

/// Bytes of a light map.
pub const BYTES: usize = (TILE * TILE * 4) as usize;

/// Over how much angle a shadow's edge goes from dark to light.
pub const PENUMBRA_RAD: f64 = 0.03;

/// Under this elevation the sun lights no ground.
const DARK_ELEVATION_RAD: f64 = -0.02;

/// Longest shadow followed, metres.
const LONGEST_SHADOW_M: f64 = 80_000.0;

/// The light map of a block for a direction towards the sun (unit, world frame).
pub fn light_map(field: &Field, pyramid: &Pyramid, block: BlockIndex, to_sun: DVec3) -> Box<[u8]> {
    let mut texels = Vec::with_capacity(BYTES);
    let (first_column, first_row) = (block.first_column(), block.first_row());
    let highest_m = f64::from(pyramid.all().greatest_m);
    for row in first_row..first_row + i64::from(TILE) {
        for column in first_column..first_column + i64::from(TILE) {
            let unit = |value: f64| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
            if field.post_m(column, row).is_nan() {
                texels.extend([128, 128, 255, 255]);
                continue;
            }
            let normal = normal(field, column, row);
            texels.extend([
                unit(normal.x * 0.5 + 0.5),
                unit(normal.z * 0.5 + 0.5),
                unit(sun_seen(field, column, row, to_sun, highest_m)),
                unit(sky_seen(field, column, row)),
            ]);
        }
    }
    texels.into_boxed_slice()
}

/// Upward unit normal at a post, from its four neighbours; one-sided beside void and at the world's edge.
pub fn normal(field: &Field, column: i64, row: i64) -> DVec3 {
    let here = f64::from(field.post_m(column, row));
    let slope = |before: f32, after: f32| {
        let (before, after) = (f64::from(before), f64::from(after));
        match (before.is_nan(), after.is_nan()) {
            (false, false) => 0.5 * (after - before),
            (true, false) => after - here,
            (false, true) => here - before,
            (true, true) => 0.0,
        }
    };
    let east = slope(field.post_m(column - 1, row), field.post_m(column + 1, row));
    let south = slope(field.post_m(column, row - 1), field.post_m(column, row + 1));
    DVec3::new(-east, field.grid().step_m, -south).normalize_or(DVec3::Y)
}

/// How much of the sun's disc a post sees, 0..=1.
pub fn sun_seen(field: &Field, column: i64, row: i64, to_sun: DVec3, highest_m: f64) -> f64 {
    let level = to_sun.x.hypot(to_sun.z);
    let elevation = to_sun.y.atan2(level);
    if elevation < DARK_ELEVATION_RAD {
        return 0.0;
    }
    if level < 1e-6 {
        return 1.0;
    }
    let step_m = field.grid().step_m;
    let here = f64::from(field.post_m(column, row));
    // One column or one row a step, whichever the sun is more along.
    let by_column = to_sun.x.abs() >= to_sun.z.abs();
    let (major, minor) = if by_column { (to_sun.x, to_sun.z) } else { (to_sun.z, to_sun.x) };
    let (ahead, aside) = (major.signum() as i64, minor / major.abs());
    let stride_m = step_m * level / major.abs();
    let tangent = elevation.tan();
    // The steepest rise that still matters is where the penumbra begins.
    let clear = (elevation - 0.5 * PENUMBRA_RAD).tan().max(1e-3);
    let mut steepest = f64::NEG_INFINITY;
    let most = (((highest_m - here) / clear).min(LONGEST_SHADOW_M) / stride_m).ceil().max(0.0) as i64;
    for step in 1..=most {
        let across = aside * step as f64;
        let low = across.floor();
        let at = |offset: i64| {
            let (along, beside) = (ahead * step, low as i64 + offset);
            if by_column {
                field.post_m(column + along, row + beside)
            } else {
                field.post_m(column + beside, row + along)
            }
        };
        let part = across - low;
        let height = f64::from(at(0)) * (1.0 - part) + if part > 0.0 { f64::from(at(1)) * part } else { 0.0 };
        if height.is_nan() {
            continue;
        }
        steepest = steepest.max((height - here) / (stride_m * step as f64));
        if steepest > tangent + PENUMBRA_RAD {
            break;
        }
    }
    let above = elevation - steepest.max(-1e3).atan();
    let t = (above / PENUMBRA_RAD + 0.5).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// How much of the sky dome a post sees, 0..=1: from the horizon in eight directions at three distances.
fn sky_seen(field: &Field, column: i64, row: i64) -> f64 {
    const DIRECTIONS: [(i64, i64); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
    let here = f64::from(field.post_m(column, row));
    let step_m = field.grid().step_m;
    let mut seen = 0.0;
    for (dx, dz) in DIRECTIONS {
        let length_m = step_m * ((dx * dx + dz * dz) as f64).sqrt();
        let mut horizon = 0.0f64;
        for reach in [1, 3, 9] {
            let rise = f64::from(field.post_m(column + dx * reach, row + dz * reach)) - here;
            // max ignores NaN: void hides nothing.
            horizon = horizon.max(rise / (length_m * reach as f64));
        }
        // Cosine-weighted part of the sky above a horizon of this slope.
        seen += 1.0 / (1.0 + horizon * horizon);
    }
    seen / 8.0
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
