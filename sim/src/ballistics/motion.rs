//! How a projectile moves: a point with drag and thrust over a planet, and a step that stays stable under any drag.
//!
//! State: position (3) and velocity over the Earth (3) in the planet's frame ([`crate::planet`]), metres, seconds.
//! `v' = fall(r, v) - k rho Cd(|u| / c) |u| u + thrust`, with the velocity u through the air, so a shell that drifts with
//! the wind feels no drag. Thrust is along the velocity over the Earth; at rest along the bore.
//!
//! Invariants others rely on: [`advance`] gives finite numbers or an error; a step is cut into equal pieces where
//! `|lambda| h` of drag would exceed half of the integrator's limit, so drag never throws a body back. Components of the
//! velocity below [`REST_MPS`] become 0: what only decays would end in denormal numbers, which are slow.
//!
//! Source: R. L. McCoy, Modern Exterior Ballistics, 1999, chapter 8 (point mass); J. Hairer, G. Wanner, Solving Ordinary
//! Differential Equations II, 1996, section IV.2 (stability).

use super::projectile::Projectile;
use crate::atmosphere::Atmosphere;
use crate::integrate::{self, Before, Integrator, Motion};
use crate::planet::{Planet, Shape};
use crate::wind::Wind;
use glam::DVec3;
use std::fmt;

/// Position and velocity.
pub type State = [f64; 6];

/// A component of velocity below this is rest, m/s: 30 digits below what is ever printed, 270 above a denormal.
pub const REST_MPS: f64 = 1e-30;
/// The part of the integrator's limit of damping that a piece of a step uses.
const SHARE_OF_LIMIT: f64 = 0.5;
/// Shortest piece of a step, seconds.
const SHORTEST_S: f64 = 1e-9;
/// Below this height the air is that at this height (see [`crate::atmosphere`]): the densest of all.
const DENSEST_M: f64 = -5_000.0;

/// A projectile in flight over a planet.
#[derive(Debug, Clone)]
pub struct ShellMotion<'a> {
    planet: Planet,
    atmosphere: &'a Atmosphere,
    wind: &'a Wind,
    /// Curve, and deceleration over density, coefficient and square of speed.
    drag: Option<&'a super::projectile::Drag>,
    windy: bool,
    flat: bool,
    mass_kg: f64,
    bore: DVec3,
    thrust: Thrust,
    /// `|lambda|` over speed in the densest air is at most this, 1/m.
    stiffest_pm: f64,
}

/// Thrust as a straight line in time, N; one piece of a burn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Thrust {
    from_s: f64,
    from_n: f64,
    slope_nps: f64,
}

/// Why a step cannot be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepError {
    /// Drag is so stiff that a piece of a step would be shorter than a nanosecond.
    Stiff {
        /// The piece that it would take, seconds.
        needed_s: f64,
        /// Time since the shot, seconds.
        t_s: f64,
    },
    /// A number is no longer finite.
    NotFinite {
        /// Time since the shot, seconds.
        t_s: f64,
    },
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stiff { needed_s, t_s } => write!(
                f,
                "drag is too stiff at {t_s} s: it needs steps of {needed_s:e} s, the shortest are {SHORTEST_S:e} s"
            ),
            Self::NotFinite { t_s } => write!(f, "the state is not finite after {t_s} s"),
        }
    }
}

impl std::error::Error for StepError {}

impl<'a> ShellMotion<'a> {
    /// The motion of a projectile; `bore` is the unit direction of thrust at rest, in the planet's frame.
    pub fn new(
        projectile: &'a Projectile,
        planet: Planet,
        atmosphere: &'a Atmosphere,
        wind: &'a Wind,
        bore: DVec3,
    ) -> Self {
        let drag = projectile.drag.as_ref().filter(|_| *atmosphere != Atmosphere::None);
        let densest = atmosphere.at(DENSEST_M).density_kgpm3;
        Self {
            planet,
            atmosphere,
            wind,
            drag,
            windy: !wind.is_still(),
            flat: matches!(planet.shape, Shape::Flat { .. }),
            mass_kg: projectile.mass_kg,
            bore,
            thrust: Thrust::default(),
            stiffest_pm: drag.map_or(0.0, |drag| drag.drag_m2pkg * densest * drag.curve.steepest()),
        }
    }

    /// Takes the thrust that burns at a time; to be called for the middle of each step, which no row of the burn may cut.
    pub fn burn_as_at(&mut self, burn: &[[f64; 2]], t_s: f64) {
        let after = burn.partition_point(|row| row[0] <= t_s);
        self.thrust = match (after.checked_sub(1).map(|i| burn[i]), burn.get(after)) {
            (Some([from_s, from_n]), Some([to_s, to_n])) => {
                Thrust { from_s, from_n, slope_nps: (to_n - from_n) / (to_s - from_s) }
            }
            _ => Thrust::default(),
        };
    }

    /// Velocity of the air at a position, in the frame's axes.
    pub fn wind_mps(&self, position_m: DVec3) -> DVec3 {
        if !self.windy {
            return DVec3::ZERO;
        }
        if self.flat {
            return self.wind.ned_mps(-position_m.z);
        }
        let place = self.planet.place(position_m);
        self.planet.frame_from_ned(place) * self.wind.ned_mps(place.altitude_m)
    }

    /// Mach number of a state; 0 where there is no air.
    pub fn mach(&self, y: &State) -> f64 {
        let (position, velocity) = parts(y);
        let sound_mps = self.atmosphere.at(self.planet.altitude_m(position)).sound_mps;
        if sound_mps > 0.0 { (velocity - self.wind_mps(position)).length() / sound_mps } else { 0.0 }
    }

    fn acceleration_mps2(&self, t_s: f64, y: &State) -> DVec3 {
        let (position, velocity) = parts(y);
        let mut acceleration = self.planet.fall_mps2(position, velocity);
        if let Some(drag) = self.drag {
            let (altitude_m, through) = if self.windy && !self.flat {
                let place = self.planet.place(position);
                let wind = self.planet.frame_from_ned(place) * self.wind.ned_mps(place.altitude_m);
                (place.altitude_m, velocity - wind)
            } else {
                let altitude_m = self.planet.altitude_m(position);
                (altitude_m, if self.windy { velocity - self.wind.ned_mps(altitude_m) } else { velocity })
            };
            let air = self.atmosphere.at(altitude_m);
            let speed = through.length();
            let cd = drag.curve.cd(speed / air.sound_mps);
            acceleration -= through * (drag.drag_m2pkg * air.density_kgpm3 * cd * speed);
        }
        if self.thrust != Thrust::default() {
            let thrust_n = self.thrust.from_n + self.thrust.slope_nps * (t_s - self.thrust.from_s);
            acceleration += velocity.try_normalize().unwrap_or(self.bore) * (thrust_n / self.mass_kg);
        }
        acceleration
    }

    /// A bound of the rate with which drag pulls a disturbed velocity back, within a step, 1/s.
    fn lambda_ps(&self, y: &State, step_s: f64) -> f64 {
        let (position, velocity) = parts(y);
        let Some(drag) = self.drag else { return 0.0 };
        let speed = (velocity - self.wind_mps(position)).length();
        // The air gets denser on the way down; a step does not fall farther than its own speed takes it, and g.
        let depth_m = (velocity.length() + 5.0 * step_s) * step_s;
        let air = self.atmosphere.at(self.planet.altitude_m(position) - depth_m);
        drag.drag_m2pkg * air.density_kgpm3 * drag.curve.steepest() * speed
    }

    /// Pieces into which a step must be cut.
    fn pieces(&self, integrator: Integrator, t_s: f64, y: &State, step_s: f64) -> Result<f64, StepError> {
        let limit = SHARE_OF_LIMIT * integrator.damping_limit();
        let (_, velocity) = parts(y);
        // Almost every step ends here, without a look at the air.
        let most_mps = velocity.length() + if self.windy { self.wind_mps(parts(y).0).length() } else { 0.0 };
        if self.stiffest_pm * most_mps * step_s <= limit {
            return Ok(1.0);
        }
        let lambda = self.lambda_ps(y, step_s);
        let needed_s = limit / lambda;
        if step_s > needed_s && needed_s < SHORTEST_S {
            return Err(StepError::Stiff { needed_s, t_s });
        }
        Ok((step_s / needed_s).ceil().max(1.0))
    }
}

impl Motion<f64, 6> for ShellMotion<'_> {
    #[inline]
    fn rate(&self, t_s: f64, y: &State) -> State {
        let a = self.acceleration_mps2(t_s, y);
        [y[3], y[4], y[5], a.x, a.y, a.z]
    }

    #[inline]
    fn drift(&self, y: &State) -> State {
        [y[3], y[4], y[5], 0.0, 0.0, 0.0]
    }
}

/// Position and velocity of a state.
#[inline]
pub fn parts(y: &State) -> (DVec3, DVec3) {
    (DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]))
}

/// The state of a position and a velocity.
pub fn state(position_m: DVec3, velocity_mps: DVec3) -> State {
    let (r, v) = (position_m, velocity_mps);
    [r.x, r.y, r.z, v.x, v.y, v.z]
}

/// The state a step later: one step of the integrator, or as many pieces as drag needs. Also says how many.
///
/// # Errors
/// [`StepError`] if drag is too stiff for any step, or a number is no longer finite.
pub fn advance(
    integrator: Integrator,
    motion: &ShellMotion,
    t_s: f64,
    y: &State,
    step_s: f64,
    before: &mut Before<f64, 6>,
) -> Result<(State, u64), StepError> {
    let (mut y, mut at_s, end_s, mut taken) = (*y, t_s, t_s + step_s, 0);
    let mut left_s = step_s;
    while left_s > 0.0 {
        let pieces = motion.pieces(integrator, at_s, &y, left_s)?;
        // The first of so many pieces: the next ones are counted anew, as drag falls with the speed.
        let piece_s = if pieces > 1.0 { left_s / pieces } else { left_s };
        y = integrate::step(integrator, motion, at_s, &y, piece_s, before);
        taken += 1;
        at_s += piece_s;
        left_s = if pieces > 1.0 { end_s - at_s } else { 0.0 };
        for component in &mut y[3..] {
            if component.abs() < REST_MPS {
                *component = 0.0;
            }
        }
        if !y.iter().all(|number| number.is_finite()) {
            return Err(StepError::NotFinite { t_s: at_s });
        }
    }
    Ok((y, taken))
}

#[cfg(test)]
mod tests;
