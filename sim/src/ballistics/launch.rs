//! How a shot leaves: place, velocity, the axes it is described in, and the elevation that a sight's zero asks for.
//!
//! A case gives the velocity either as a speed with azimuth and elevation, or, for what is released, as `[initial]`
//! velocity; then azimuth and elevation are those of that velocity. The elevation of the bore over the horizon is the
//! line of sight's (`look_angle_deg`), plus that of the zero, plus `elevation_deg`.
//!
//! Axes of a shot: x downrange, y up, z to the right, in the plane that touches the Earth at the muzzle, where its origin
//! is. The line of sight passes `sight_height_m` above the muzzle, counted across it. The zero is found in still air at
//! the muzzle's altitude over level ground, without rotation, curvature and spin drift.

use super::motion::{ShellMotion, State, StepError, advance, parts, state};
use super::projectile::Projectile;
use crate::case::{Attitude, Case, Shot, Velocity};
use crate::file::FileError;
use crate::planet::{Gravity, Place, Planet, Shape};
use crate::wind::Wind;
use glam::{DMat3, DQuat, DVec3};

/// Step where a case gives none, seconds. At it the closest rows of reference are met to a tenth of what is allowed; see
/// the tests.
pub const STEP_S: f64 = 0.002;

/// Longest flight to a zero, seconds.
const LONGEST_ZERO_S: f64 = 600.0;
/// Trials of an elevation; the secant's steps settle in about eight.
const TRIALS: usize = 60;

/// The start of a shot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Launch {
    /// Position in the planet's frame.
    pub position_m: DVec3,
    /// Velocity over the Earth in the planet's frame.
    pub velocity_mps: DVec3,
    /// The muzzle.
    pub place: Place,
    /// Columns: downrange, up, right in the planet's frame.
    pub axes: DMat3,
    /// Clockwise from north.
    pub azimuth_rad: f64,
    /// Of the bore over the horizon.
    pub elevation_rad: f64,
    /// Of the line of sight over the horizon.
    pub look_rad: f64,
    /// Of the line of sight over the bore at the muzzle.
    pub sight_height_m: f64,
}

impl Launch {
    /// The launch of a case.
    ///
    /// # Errors
    /// [`FileError`] names a key that contradicts another, or a zero that cannot be reached.
    pub fn of(case: &Case, projectile: &Projectile) -> Result<Self, FileError> {
        let fail = |why: String| FileError::new(&case.file, why);
        let unset = Shot {
            speed_mps: None,
            elevation_rad: 0.0,
            azimuth_rad: 0.0,
            zero_range_m: None,
            sight_height_m: 0.0,
            look_angle_rad: 0.0,
            until: None,
            step_m: None,
            step_s: None,
        };
        let shot = case.shot.as_ref().unwrap_or(&unset);
        let position_m = case.initial.flat_m.unwrap_or_else(|| case.planet.position_m(case.initial.place));
        let place = match case.initial.flat_m {
            Some(_) => case.planet.place(position_m),
            None => case.initial.place,
        };
        let released_ned = released_ned_mps(case);
        let (azimuth_rad, elevation_rad, speed_mps) = match shot.speed_mps {
            Some(_) if released_ned != DVec3::ZERO => {
                return Err(fail("expected one of shot.speed_mps and initial velocity, found both".to_owned()));
            }
            Some(speed_mps) => {
                let zero_rad = match shot.zero_range_m {
                    Some(range_m) => zero_rad(case, projectile, shot, range_m, speed_mps, place.altitude_m)
                        .map_err(|why| fail(format!("shot.zero_range_m: {why}")))?,
                    None => 0.0,
                };
                (shot.azimuth_rad, shot.look_angle_rad + zero_rad + shot.elevation_rad, speed_mps)
            }
            None => {
                let aimed = [
                    ("elevation_deg", shot.elevation_rad != 0.0),
                    ("azimuth_deg", shot.azimuth_rad != 0.0),
                    ("look_angle_deg", shot.look_angle_rad != 0.0),
                    ("zero_range_m", shot.zero_range_m.is_some()),
                ];
                if let Some((key, _)) = aimed.iter().find(|(_, given)| *given) {
                    return Err(fail(format!("shot.{key}: expected shot.speed_mps with it, found none")));
                }
                let level = released_ned.x.hypot(released_ned.y);
                let azimuth = if level > 0.0 { released_ned.y.atan2(released_ned.x) } else { 0.0 };
                // 0 - z and not -z: a level release has no elevation of -0.
                (azimuth, (0.0 - released_ned.z).atan2(level), released_ned.length())
            }
        };
        let frame_from_ned = case.planet.frame_from_ned(place);
        let (sin, cos) = azimuth_rad.sin_cos();
        let axes =
            frame_from_ned * DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::NEG_Z, DVec3::new(-sin, cos, 0.0));
        let velocity_mps = match shot.speed_mps {
            Some(_) => axes * (DVec3::new(elevation_rad.cos(), elevation_rad.sin(), 0.0) * speed_mps),
            None => frame_from_ned * released_ned,
        };
        Ok(Self {
            position_m,
            velocity_mps,
            place,
            axes,
            azimuth_rad,
            elevation_rad,
            look_rad: shot.look_angle_rad,
            sight_height_m: shot.sight_height_m,
        })
    }

    /// Whether it leaves upward. As asked for, not as rounded: over the ellipsoid a level shot may climb by a nanometre.
    pub fn climbs(&self) -> bool {
        self.elevation_rad > 0.0 && self.velocity_mps != DVec3::ZERO
    }

    /// Unit direction of the bore in the planet's frame.
    pub fn bore(&self) -> DVec3 {
        self.axes * DVec3::new(self.elevation_rad.cos(), self.elevation_rad.sin(), 0.0)
    }

    /// Downrange, up, right of a position.
    #[inline]
    pub fn local_m(&self, position_m: DVec3) -> DVec3 {
        self.axes.transpose() * (position_m - self.position_m)
    }
}

/// The velocity of `[initial]` in north, east, down.
fn released_ned_mps(case: &Case) -> DVec3 {
    match (case.initial.velocity, case.initial.attitude) {
        (Velocity::Ned(velocity), _) => velocity,
        (Velocity::Body(velocity), Attitude::Quaternion([w, x, y, z])) => DQuat::from_xyzw(x, y, z, w) * velocity,
        (Velocity::Body(velocity), Attitude::Angles([roll, pitch, yaw])) => {
            DQuat::from_rotation_z(yaw) * (DQuat::from_rotation_y(pitch) * (DQuat::from_rotation_x(roll) * velocity))
        }
    }
}

/// The elevation at which a level shot meets a level line of sight `sight_height_m` above the muzzle at a range.
fn zero_rad(
    case: &Case,
    projectile: &Projectile,
    shot: &Shot,
    range_m: f64,
    speed_mps: f64,
    altitude_m: f64,
) -> Result<f64, String> {
    let at = case.planet.position_m(Place { altitude_m, ..case.initial.place });
    let planet = Planet { gravity: Gravity::Constant(case.planet.gravity_mps2(at)), ..Planet::flat() };
    debug_assert!(matches!(planet.shape, Shape::Flat { .. }));
    let wind = Wind::still();
    let step_s = case.run.dt_s.unwrap_or(STEP_S);
    let height_m = |elevation: f64| {
        let muzzle = DVec3::new(0.0, 0.0, -altitude_m);
        let bore = DVec3::new(elevation.cos(), 0.0, -elevation.sin());
        let mut motion = ShellMotion::new(projectile, planet, &case.atmosphere, &wind, bore);
        height_at_m(case, projectile, &mut motion, state(muzzle, bore * speed_mps), range_m, step_s)
            .map(|height| height.map(|height| height - altitude_m - shot.sight_height_m))
            .map_err(|error| error.to_string())
    };
    let short = || format!("the shot does not get as far as {range_m} m");
    // The straight line to the sight at the range, then secants: height over range is nearly linear in the angle.
    let (mut low, mut high) = ((shot.sight_height_m / range_m).atan(), 0.0);
    let mut low_m = height_m(low)?.ok_or_else(short)?;
    for trial in 0..TRIALS {
        high = if trial == 0 { low - (low_m / range_m).clamp(-0.5, 0.5) } else { high };
        let high_m = height_m(high)?.ok_or_else(short)?;
        // A rounding of the height, which is of the order of the drop.
        if high_m.abs() <= 1e-12 * range_m || high == low {
            return Ok(high);
        }
        if high_m == low_m {
            return if high_m.abs() <= 1e-9 * range_m { Ok(high) } else { Err(short()) };
        }
        let next = high - (high_m * (high - low) / (high_m - low_m)).clamp(-0.3, 0.3);
        (low, low_m) = (high, high_m);
        high = next;
        if high.is_nan() || high.abs() > 1.4 {
            return Err(short());
        }
    }
    if low_m.abs() <= 1e-9 * range_m { Ok(low) } else { Err(short()) }
}

/// Altitude at a distance downrange (north in the plane); `None` if the shot does not get there.
fn height_at_m(
    case: &Case,
    projectile: &Projectile,
    motion: &mut ShellMotion,
    mut y: State,
    range_m: f64,
    step_s: f64,
) -> Result<Option<f64>, StepError> {
    let integrator = case.run.integrator;
    let (mut t_s, mut before) = (0.0, None);
    while t_s < LONGEST_ZERO_S {
        let edge_s = projectile.burn.iter().map(|row| row[0]).find(|row_s| *row_s > t_s).unwrap_or(f64::INFINITY);
        let this_s = step_s.min(edge_s - t_s);
        motion.burn_as_at(&projectile.burn, t_s + 0.5 * this_s);
        let memory = before;
        let (next, _) = advance(integrator, motion, t_s, &y, this_s, &mut before)?;
        if next[0] >= range_m {
            // Newton's steps back onto the range; speed downrange is nearly constant within a step.
            let mut cut_s = this_s * (range_m - y[0]) / (next[0] - y[0]);
            let mut at = y;
            for _ in 0..8 {
                let mut memory = memory;
                at = if cut_s > 0.0 { advance(integrator, motion, t_s, &y, cut_s, &mut memory)?.0 } else { y };
                cut_s += (range_m - at[0]) / at[3];
            }
            return Ok(Some(-parts(&at).0.z));
        }
        if next[3] <= 0.0 || -next[2] < -20_000.0 {
            return Ok(None);
        }
        y = next;
        if this_s < step_s {
            before = None;
        }
        t_s += this_s;
    }
    Ok(None)
}
