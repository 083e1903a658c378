//! The world's frame, in one place.
//!
//! Right-handed: X east, Y up, Z south, metres, f64. The origin is the world's centre at mean sea level. East and south
//! are those of the world's map grid; a person's headings are from *true* north, which the grid's convergence turns.
//! Angles inside are radians, headings clockwise from north seen from above.

use glam::{DQuat, DVec3};

/// Unit vector of a heading (clockwise from grid north) and an elevation above the horizon, radians.
pub fn direction(grid_heading_rad: f64, elevation_rad: f64) -> DVec3 {
    let (sin_heading, cos_heading) = grid_heading_rad.sin_cos();
    let (sin_elevation, cos_elevation) = elevation_rad.sin_cos();
    DVec3::new(cos_elevation * sin_heading, sin_elevation, -cos_elevation * cos_heading)
}

/// Heading (clockwise from grid north, in 0..2 pi) and elevation of a direction, radians. Heading 0 straight up or down.
pub fn heading_elevation(direction: DVec3) -> (f64, f64) {
    let level = direction.x.hypot(direction.z);
    let heading = if level > 0.0 { direction.x.atan2(-direction.z) } else { 0.0 };
    (heading.rem_euclid(std::f64::consts::TAU), direction.y.atan2(level))
}

/// The attitude that looks along a heading and elevation with a roll (right wing down positive), radians.
///
/// It turns view axes (x right, y up, z backward) into the world's.
pub fn attitude(grid_heading_rad: f64, elevation_rad: f64, roll_rad: f64) -> DQuat {
    DQuat::from_rotation_y(-grid_heading_rad)
        * DQuat::from_rotation_x(elevation_rad)
        * DQuat::from_rotation_z(-roll_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn north_is_minus_z_and_east_is_x() {
        assert!((direction(0.0, 0.0) - DVec3::NEG_Z).length() < 1e-15);
        assert!((direction(FRAC_PI_2, 0.0) - DVec3::X).length() < 1e-15);
        assert!((direction(1.0, FRAC_PI_2) - DVec3::Y).length() < 1e-15);
    }

    #[test]
    fn attitude_looks_along_its_direction() {
        for (heading, elevation) in [(0.3, 0.2), (4.0, -1.2), (6.1, 1.5)] {
            let looks = attitude(heading, elevation, 0.7) * DVec3::NEG_Z;
            assert!((looks - direction(heading, elevation)).length() < 1e-14);
            let (h, e) = heading_elevation(looks);
            assert!((h - heading).abs() < 1e-13 && (e - elevation).abs() < 1e-13);
        }
        // Right wing down: the right axis points below the horizon.
        assert!((attitude(0.0, 0.0, 0.5) * DVec3::X).y < 0.0);
    }
}
