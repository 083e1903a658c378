//! The Earth under a flight: its shape, its gravity and its rotation, in three depths.
//!
//! | kind | axes of the frame | height | gravity |
//! |---|---|---|---|
//! | flat | north, east, down from the place of origin | above the plane | constant, or with the inverse square of height |
//! | round | Earth-centred, Earth-fixed: x to 0 N 0 E, z to the north pole | above a sphere | inverse square |
//! | ellipsoid | the same | above WGS84 | inverse square with J2 |
//!
//! Metres, seconds, radians. Velocities are those over the rotating Earth. Accelerations of [`Planet::fall_mps2`] are
//! what a body with that velocity falls with: gravitation, centrifugal and Coriolis parts together. A flat frame's
//! gravity is a plumb line's, which holds the centrifugal part already: its rotation adds the Coriolis part alone, and the
//! growth of the centrifugal one with height (0.3 m of a fall of a minute from 10 km) is left out.
//!
//! Invariant others rely on: `position_m` and `place` undo each other to 1e-8 m from -1,000 to 1,000 km.
//!
//! Source: NIMA TR8350.2, WGS 84, 1997 (a, f, GM, omega); NASA/TM-2015-218675, appendix (J2 and its gravitation);
//! B. R. Bowring, Transformation from spatial to geographical coordinates, Survey Review 23, 1976 (two passes).

use glam::{DMat3, DVec3};
use terrain::WGS84;

/// Standard gravity, m/s2 (CGPM 1901).
pub const STANDARD_GRAVITY_MPS2: f64 = 9.806_65;
/// The Earth's gravitational parameter, m3/s2.
pub const EARTH_GM_M3PS2: f64 = 3.986_004_418e14;
/// The Earth's rotation, rad/s.
pub const EARTH_ROTATION_RADPS: f64 = 7.292_115e-5;
/// The Earth's second zonal harmonic, not normalised.
pub const EARTH_J2: f64 = 1.082_629_82e-3;
/// Radius of the sphere with the surface of the ellipsoid, metres.
pub const EARTH_MEAN_RADIUS_M: f64 = 6_371_007.180_9;

/// A place over the Earth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Place {
    /// Geodetic latitude, radians, north positive.
    pub lat_rad: f64,
    /// Longitude, radians, east positive, within -pi..=pi.
    pub lon_rad: f64,
    /// Height above the surface of the model, metres.
    pub altitude_m: f64,
}

/// The shape of the Earth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A plane that touches the sphere of `radius_m` at a place.
    Flat {
        /// Latitude and longitude of the origin.
        origin: Place,
        /// Turns metres into degrees, and g at height 0 into g at a height.
        radius_m: f64,
    },
    /// A sphere.
    Round {
        /// Its radius, metres.
        radius_m: f64,
    },
    /// WGS84.
    Ellipsoid,
}

/// How gravity depends on the place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gravity {
    /// The same everywhere, towards the ground, m/s2.
    Constant(f64),
    /// `g` at height 0, falling with the square of the distance from the centre, m/s2. Flat frames only.
    PlumbInverseSquare(f64),
    /// Gravitation GM / r2, m3/s2.
    InverseSquare(f64),
    /// The same with the second zonal harmonic: GM, J2.
    J2(f64, f64),
}

/// Shape, gravity and rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planet {
    /// Shape.
    pub shape: Shape,
    /// Gravity.
    pub gravity: Gravity,
    /// Rotation about the north pole, rad/s.
    pub rotation_radps: f64,
}

impl Planet {
    /// A plane with standard gravity and no rotation.
    pub fn flat() -> Self {
        Self {
            shape: Shape::Flat { origin: Place::default(), radius_m: EARTH_MEAN_RADIUS_M },
            gravity: Gravity::Constant(STANDARD_GRAVITY_MPS2),
            rotation_radps: 0.0,
        }
    }

    /// WGS84 with J2 and rotation.
    pub fn wgs84() -> Self {
        Self {
            shape: Shape::Ellipsoid,
            gravity: Gravity::J2(EARTH_GM_M3PS2, EARTH_J2),
            rotation_radps: EARTH_ROTATION_RADPS,
        }
    }

    /// The rotation as a vector in the frame's axes, rad/s.
    pub fn rotation(&self) -> DVec3 {
        match self.shape {
            Shape::Flat { origin, .. } => {
                DVec3::new(origin.lat_rad.cos(), 0.0, -origin.lat_rad.sin()) * self.rotation_radps
            }
            Shape::Round { .. } | Shape::Ellipsoid => DVec3::new(0.0, 0.0, self.rotation_radps),
        }
    }

    /// What a body at `position_m` with `velocity_mps` over the Earth falls with, m/s2, in the frame's axes.
    #[inline]
    pub fn fall_mps2(&self, position_m: DVec3, velocity_mps: DVec3) -> DVec3 {
        let coriolis = |rotation: DVec3| -2.0 * rotation.cross(velocity_mps);
        match self.shape {
            Shape::Flat { radius_m, .. } => {
                let down = DVec3::new(0.0, 0.0, self.flat_gravity_mps2(-position_m.z, radius_m));
                if self.rotation_radps == 0.0 { down } else { down + coriolis(self.rotation()) }
            }
            Shape::Round { .. } | Shape::Ellipsoid => {
                let rotation = self.rotation();
                let squared = self.rotation_radps * self.rotation_radps;
                let centrifugal = DVec3::new(position_m.x * squared, position_m.y * squared, 0.0);
                self.gravitation_mps2(position_m) + centrifugal + coriolis(rotation)
            }
        }
    }

    /// A flat frame's gravity at a height: what a plumb line there shows.
    fn flat_gravity_mps2(&self, altitude_m: f64, radius_m: f64) -> f64 {
        let far = (radius_m + altitude_m).max(0.01 * radius_m);
        match self.gravity {
            Gravity::Constant(g) => g,
            Gravity::PlumbInverseSquare(g) => g * (radius_m / far).powi(2),
            Gravity::InverseSquare(gm) | Gravity::J2(gm, _) => gm / (far * far),
        }
    }

    /// Gravitation alone on a round Earth or the ellipsoid, m/s2, in the frame's axes.
    fn gravitation_mps2(&self, r: DVec3) -> DVec3 {
        // Nearer to the centre than this no flight is; the field of a point would tear a body apart there.
        let squared = r.length_squared().max(1e10);
        let distance = squared.sqrt();
        match self.gravity {
            Gravity::Constant(g) | Gravity::PlumbInverseSquare(g) => r * (-g / distance),
            Gravity::InverseSquare(gm) => r * (-gm / (squared * distance)),
            Gravity::J2(gm, j2) => {
                let radius = match self.shape {
                    Shape::Flat { radius_m, .. } | Shape::Round { radius_m } => radius_m,
                    Shape::Ellipsoid => WGS84.a_m,
                };
                let flat = 1.5 * j2 * radius * radius / squared;
                let height = 5.0 * r.z * r.z / squared;
                let (plan, up) = (1.0 + flat * (1.0 - height), 1.0 + flat * (3.0 - height));
                DVec3::new(r.x * plan, r.y * plan, r.z * up) * (-gm / (squared * distance))
            }
        }
    }

    /// Strength of gravity as reported, m/s2: gravitation on a round Earth and the ellipsoid, the plumb line's where flat.
    pub fn gravity_mps2(&self, position_m: DVec3) -> f64 {
        match self.shape {
            Shape::Flat { radius_m, .. } => self.flat_gravity_mps2(-position_m.z, radius_m),
            Shape::Round { .. } | Shape::Ellipsoid => self.gravitation_mps2(position_m).length(),
        }
    }

    /// Height above the surface, metres.
    #[inline]
    pub fn altitude_m(&self, position_m: DVec3) -> f64 {
        match self.shape {
            Shape::Flat { .. } => -position_m.z,
            Shape::Round { radius_m } => position_m.length() - radius_m,
            Shape::Ellipsoid => self.place(position_m).altitude_m,
        }
    }

    /// The place of a position in the frame.
    pub fn place(&self, position_m: DVec3) -> Place {
        match self.shape {
            Shape::Flat { origin, radius_m } => Place {
                lat_rad: origin.lat_rad + position_m.x / radius_m,
                lon_rad: wrapped_rad(origin.lon_rad + position_m.y / (radius_m * origin.lat_rad.cos().max(1e-9))),
                altitude_m: -position_m.z,
            },
            Shape::Round { radius_m } => Place {
                lat_rad: position_m.z.atan2(position_m.x.hypot(position_m.y)),
                lon_rad: position_m.y.atan2(position_m.x),
                altitude_m: position_m.length() - radius_m,
            },
            Shape::Ellipsoid => ellipsoid_place(position_m),
        }
    }

    /// The position of a place in the frame.
    pub fn position_m(&self, place: Place) -> DVec3 {
        let (sin, cos) = place.lat_rad.sin_cos();
        let (sin_lon, cos_lon) = place.lon_rad.sin_cos();
        match self.shape {
            Shape::Flat { origin, radius_m } => DVec3::new(
                (place.lat_rad - origin.lat_rad) * radius_m,
                wrapped_rad(place.lon_rad - origin.lon_rad) * radius_m * origin.lat_rad.cos(),
                -place.altitude_m,
            ),
            Shape::Round { radius_m } => DVec3::new(cos * cos_lon, cos * sin_lon, sin) * (radius_m + place.altitude_m),
            Shape::Ellipsoid => {
                let e2 = WGS84.f * (2.0 - WGS84.f);
                let across = WGS84.a_m / (1.0 - e2 * sin * sin).sqrt();
                let plan = (across + place.altitude_m) * cos;
                DVec3::new(plan * cos_lon, plan * sin_lon, (across * (1.0 - e2) + place.altitude_m) * sin)
            }
        }
    }

    /// The rotation from north, east, down at a place into the frame's axes.
    pub fn frame_from_ned(&self, place: Place) -> DMat3 {
        if matches!(self.shape, Shape::Flat { .. }) {
            return DMat3::IDENTITY;
        }
        let (sin, cos) = place.lat_rad.sin_cos();
        let (sin_lon, cos_lon) = place.lon_rad.sin_cos();
        DMat3::from_cols(
            DVec3::new(-sin * cos_lon, -sin * sin_lon, cos),
            DVec3::new(-sin_lon, cos_lon, 0.0),
            DVec3::new(-cos * cos_lon, -cos * sin_lon, -sin),
        )
    }

    /// How fast north, east, down at the place turn against the frame for a body that moves over the Earth with
    /// `ned_mps`, rad/s, in north, east, down. Nil where the Earth is flat; without its vertical part at the poles.
    pub fn transport_radps(&self, place: Place, ned_mps: DVec3) -> DVec3 {
        let (along, across) = match self.shape {
            Shape::Flat { .. } => return DVec3::ZERO,
            Shape::Round { radius_m } => (radius_m, radius_m),
            Shape::Ellipsoid => {
                let e2 = WGS84.f * (2.0 - WGS84.f);
                let squared = 1.0 - e2 * place.lat_rad.sin().powi(2);
                let across = WGS84.a_m / squared.sqrt();
                (across * (1.0 - e2) / squared, across)
            }
        };
        let east = ned_mps.y / (across + place.altitude_m);
        let (sin, cos) = place.lat_rad.sin_cos();
        let turn = if cos.abs() < 1e-12 { 0.0 } else { -east * sin / cos };
        DVec3::new(east, -ned_mps.x / (along + place.altitude_m), turn)
    }
}

/// An angle within -pi..=pi, left as it is where it already is.
fn wrapped_rad(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if angle.abs() <= PI { angle } else { (angle + PI).rem_euclid(TAU) - PI }
}

/// Two passes of Bowring's formula on the reduced latitude, and the height that is good at the poles too.
fn ellipsoid_place(r: DVec3) -> Place {
    let (a, f) = (WGS84.a_m, WGS84.f);
    let (b, e2) = (a * (1.0 - f), f * (2.0 - f));
    let second = e2 / (1.0 - e2);
    let plan = r.x.hypot(r.y);
    // Tangent of the reduced latitude as a vector (its cosine and sine up to a factor).
    let (mut cos, mut sin) = normalised(plan * b, r.z * a);
    let (mut lat_cos, mut lat_sin) = (1.0, 0.0);
    for _ in 0..2 {
        (lat_cos, lat_sin) = normalised(plan - e2 * a * cos.powi(3), r.z + second * b * sin.powi(3));
        (cos, sin) = normalised(lat_cos, (1.0 - f) * lat_sin);
    }
    let across = a / (1.0 - e2 * lat_sin * lat_sin).sqrt();
    let altitude_m = plan * lat_cos + r.z * lat_sin - a * a / across;
    Place { lat_rad: lat_sin.atan2(lat_cos), lon_rad: r.y.atan2(r.x), altitude_m }
}

fn normalised(x: f64, y: f64) -> (f64, f64) {
    let length = x.hypot(y);
    if length > 0.0 { (x / length, y / length) } else { (1.0, 0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const ELLIPSOID: Planet = Planet {
        shape: Shape::Ellipsoid,
        gravity: Gravity::J2(EARTH_GM_M3PS2, EARTH_J2),
        rotation_radps: EARTH_ROTATION_RADPS,
    };

    #[test]
    fn place_and_position_undo_each_other_from_pole_to_pole() {
        let round = Planet { shape: Shape::Round { radius_m: EARTH_MEAN_RADIUS_M }, ..ELLIPSOID };
        for planet in [ELLIPSOID, round] {
            for lat_rad in [-FRAC_PI_2, -1.2, -0.6, -1e-9, 0.0, 0.3, 0.9, 1.5, FRAC_PI_2 - 1e-7, FRAC_PI_2] {
                for lon_rad in [-PI, -2.0, 0.0, 1.0, PI] {
                    for altitude_m in [-1_000_000.0, -5_000.0, 0.0, 9_144.0, 400_000.0, 1_000_000.0] {
                        let given = planet.position_m(Place { lat_rad, lon_rad, altitude_m });
                        let place = planet.place(given);
                        let back = planet.position_m(place);
                        assert!((back - given).length() < 1e-8, "{lat_rad} {lon_rad} {altitude_m}: {back} {given}");
                        assert!((place.altitude_m - altitude_m).abs() < 1e-8);
                    }
                }
            }
        }
    }

    #[test]
    fn gravity_at_the_equator_is_that_of_the_check_cases() {
        // NASA/TM-2015-218675, case 01: gravitation at 30,000 ft over 0 N 0 E is 32.10653 ft/s2 (five digits).
        let at = ELLIPSOID.position_m(Place { altitude_m: 9_144.0, ..Place::default() });
        assert!((ELLIPSOID.gravity_mps2(at) / 0.3048 - 32.106_53).abs() < 1e-5);
        // WGS84's theoretical gravity at the equator is 9.7803253 m/s2 (TR8350.2, table 3.4), which has more zonal
        // harmonics than J2: 2e-6 relative.
        let sea = ELLIPSOID.position_m(Place::default());
        let plumb = ELLIPSOID.fall_mps2(sea, DVec3::ZERO);
        assert!((plumb.x + 9.780_325_3).abs() < 2e-5 * 9.8, "{plumb}");
    }

    #[test]
    fn coriolis_turns_right_in_the_north_and_lifts_what_flies_east() {
        let flat = Planet {
            shape: Shape::Flat { origin: Place { lat_rad: 0.7, ..Place::default() }, radius_m: 6.4e6 },
            ..Planet::flat()
        };
        let turning = Planet { rotation_radps: EARTH_ROTATION_RADPS, ..flat };
        let extra = |v: DVec3| turning.fall_mps2(DVec3::ZERO, v) - flat.fall_mps2(DVec3::ZERO, v);
        assert!(extra(DVec3::X).y > 0.0, "north goes east");
        assert!(extra(DVec3::Y).z < 0.0 && extra(DVec3::Y).x < 0.0, "east goes up and south");
        assert!(extra(DVec3::Z).y > 0.0, "what falls goes east");
    }

    #[test]
    fn a_flat_frame_falls_as_the_sphere_that_it_touches() {
        let origin = Place { lat_rad: 0.5, ..Place::default() };
        let radius_m = EARTH_MEAN_RADIUS_M;
        let gravity = Gravity::InverseSquare(EARTH_GM_M3PS2);
        let round = Planet { shape: Shape::Round { radius_m }, gravity, rotation_radps: 0.0 };
        let flat = Planet { shape: Shape::Flat { origin, radius_m }, ..round };
        let g = flat.fall_mps2(DVec3::ZERO, DVec3::ZERO).z;
        let plumb = Planet { gravity: Gravity::PlumbInverseSquare(g), ..flat };
        for altitude_m in [0.0, 9_144.0, 80_000.0] {
            let place = Place { altitude_m, ..origin };
            let up = round.fall_mps2(round.position_m(place), DVec3::ZERO);
            let round_down = (round.frame_from_ned(place).transpose() * up).z;
            for flat in [flat, plumb] {
                let flat_down = flat.fall_mps2(DVec3::new(0.0, 0.0, -altitude_m), DVec3::ZERO).z;
                // Numbers near 10: some ten roundings.
                assert!((round_down - flat_down).abs() < 1e-14 * 10.0 * 10.0, "{round_down} {flat_down}");
            }
        }
    }

    #[test]
    fn transport_is_the_turn_of_the_local_axes() {
        for planet in [ELLIPSOID, Planet { shape: Shape::Round { radius_m: 6.4e6 }, ..ELLIPSOID }] {
            let place = Place { lat_rad: 0.8, lon_rad: 2.0, altitude_m: 3_000.0 };
            let ned = DVec3::new(120.0, -80.0, 10.0);
            let here = planet.frame_from_ned(place);
            let dt = 1e-3;
            let moved = planet.place(planet.position_m(place) + here * ned * dt);
            let there = planet.frame_from_ned(moved);
            let turn = glam::DQuat::from_mat3(&(here.transpose() * there)).to_scaled_axis() / dt;
            let ours = planet.transport_radps(place, ned);
            // The difference quotient: one part in 1e-8 of turn, roundings of 1e-16 / dt.
            assert!((turn - ours).length() < 1e-8, "{turn} {ours}");
        }
    }
}
