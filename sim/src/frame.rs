//! Body, north-east-down and world axes, converted in this one place.
//!
//! World: X east, Y up, Z south (see `terrain::frame`). Body: x forward, y right, z down. View: x right, y up, z
//! backward. An attitude is the unit quaternion that turns body axes into the world's. Headings here are clockwise from
//! *grid* north; turning them to true north is the projection's business.

use glam::{DMat3, DQuat, DVec3};

/// Heading, pitch and roll of an attitude, radians.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Angles {
    /// Clockwise from grid north, in 0..2 pi.
    pub heading_rad: f64,
    /// Nose above the horizon, in -pi/2..pi/2.
    pub pitch_rad: f64,
    /// Right wing down positive, in -pi..pi.
    pub roll_rad: f64,
}

/// North, east, down components of a world vector.
pub fn ned_from_world(world: DVec3) -> DVec3 {
    DVec3::new(-world.z, world.x, -world.y)
}

/// World vector of north, east, down components.
pub fn world_from_ned(ned: DVec3) -> DVec3 {
    DVec3::new(ned.y, -ned.z, -ned.x)
}

/// The rotation that turns north, east, down axes into the world's. Its four parts are halves: it rounds nothing itself.
fn world_from_ned_axes() -> DQuat {
    DQuat::from_xyzw(0.5, 0.5, -0.5, 0.5)
}

/// An attitude to the world's axes, of one to north, east, down.
pub fn world_attitude_from_ned(ned_from_body: DQuat) -> DQuat {
    world_from_ned_axes() * ned_from_body
}

/// An attitude to north, east, down, of one to the world's axes.
pub fn ned_attitude_from_world(world_from_body: DQuat) -> DQuat {
    world_from_ned_axes().conjugate() * world_from_body
}

/// The rotation that turns view axes into body axes.
pub fn body_from_view() -> DQuat {
    DQuat::from_mat3(&DMat3::from_cols(DVec3::Y, DVec3::NEG_Z, DVec3::NEG_X))
}

/// The attitude (body to world) of heading, pitch and roll.
pub fn attitude(angles: Angles) -> DQuat {
    let world_from_view = terrain::frame::attitude(angles.heading_rad, angles.pitch_rad, angles.roll_rad);
    (world_from_view * body_from_view().inverse()).normalize()
}

/// The view attitude (x right, y up, z backward to world) of a body attitude: what a camera in the nose needs.
pub fn view_attitude(world_from_body: DQuat) -> DQuat {
    (world_from_body * body_from_view()).normalize()
}

/// Heading, pitch and roll of an attitude. Straight up or down, where only their sum counts, roll is taken as 0.
pub fn angles(world_from_body: DQuat) -> Angles {
    let forward = ned_from_world(world_from_body * DVec3::X);
    let right = ned_from_world(world_from_body * DVec3::Y);
    let down = ned_from_world(world_from_body * DVec3::Z);
    let level = forward.x.hypot(forward.y);
    let pitch_rad = (-forward.z).atan2(level);
    // Below this the heading of the nose is rounding noise; the right wing still has a heading.
    let (heading, roll_rad) = if level > 1e-9 {
        (forward.y.atan2(forward.x), right.z.atan2(down.z))
    } else {
        ((-right.x).atan2(right.y), 0.0)
    };
    Angles { heading_rad: heading.rem_euclid(std::f64::consts::TAU), pitch_rad, roll_rad }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, TAU};

    #[test]
    fn body_axes_of_level_flight_north() {
        let level = attitude(Angles::default());
        assert!((level * DVec3::X - DVec3::NEG_Z).length() < 1e-15, "nose north");
        assert!((level * DVec3::Y - DVec3::X).length() < 1e-15, "right wing east");
        assert!((level * DVec3::Z - DVec3::NEG_Y).length() < 1e-15, "belly down");
        let climbing = attitude(Angles { pitch_rad: 0.2, ..Angles::default() });
        assert!((climbing * DVec3::X).y > 0.0);
        let banked = attitude(Angles { roll_rad: 0.2, ..Angles::default() });
        assert!((banked * DVec3::Y).y < 0.0, "right wing down");
    }

    #[test]
    fn angles_undo_attitude() {
        // Angles pass through a unit quaternion: a few roundings of 1.1e-16, widened by 1 / cos(pitch) <= 20.
        for heading_rad in [0.0, 1.0, 3.0, 6.0] {
            for pitch_rad in [-1.5, -0.3, 0.0, 1.2] {
                for roll_rad in [-3.0, -0.5, 0.0, 2.0] {
                    let given = Angles { heading_rad, pitch_rad, roll_rad };
                    let back = angles(attitude(given));
                    let turn = (back.heading_rad - heading_rad + 1.0).rem_euclid(TAU) - 1.0;
                    assert!(turn.abs() < 1e-13, "{given:?} {back:?}");
                    assert!((back.pitch_rad - pitch_rad).abs() < 1e-13, "{given:?} {back:?}");
                    assert!((back.roll_rad - roll_rad).abs() < 1e-13, "{given:?} {back:?}");
                }
            }
        }
    }

    #[test]
    fn straight_up_is_finite_and_keeps_the_wings() {
        let up = attitude(Angles { heading_rad: 1.0, pitch_rad: FRAC_PI_2, roll_rad: 0.0 });
        let back = angles(up);
        assert!((back.pitch_rad - FRAC_PI_2).abs() < 1e-7 && back.heading_rad.is_finite());
        let again = attitude(back);
        assert!((again * DVec3::Y - up * DVec3::Y).length() < 1e-7);
    }

    #[test]
    fn ned_and_view_agree_with_the_terrain_frame() {
        assert_eq!(ned_from_world(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(-3.0, 1.0, -2.0));
        assert_eq!(world_from_ned(ned_from_world(DVec3::new(1.0, 2.0, 3.0))), DVec3::new(1.0, 2.0, 3.0));
        for axis in DVec3::AXES {
            assert_eq!(world_attitude_from_ned(DQuat::IDENTITY) * axis, world_from_ned(axis));
            assert_eq!(ned_attitude_from_world(DQuat::IDENTITY) * axis, ned_from_world(axis));
        }
        let given = Angles { heading_rad: 2.0, pitch_rad: 0.3, roll_rad: -0.4 };
        let view = terrain::frame::attitude(2.0, 0.3, -0.4);
        assert!(view_attitude(attitude(given)).dot(view).abs() > 1.0 - 1e-14);
    }
}
