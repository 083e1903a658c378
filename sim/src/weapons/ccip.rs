//! Where a weapon would strike if it were released now (CCIP: continuously computed impact point).
//!
//! World frame, metres, seconds. The prediction flies the scene's own equations ([`ShellMotion`], [`advance`]) against the
//! scene's own ground, in longer steps; turbulence and spread are no part of it. A step asks the ground once, with the
//! step's chord lowered by twice the bend of its path; only where that meets something the path is swept exactly. So a
//! path that ends under ground is never missed; one that grazes a ridge within that bend may be.
//!
//! Cost: at most [`MOST_STEPS`] steps of flight, and as many questions to the ground. `cargo run --release -p poligon-sim
//! --example weapons` prints error and cost by length of step; those of [`Settings::of`] were chosen from it.
//!
//! Safe escape: the owner is taken to fly straight on. `least_fall_m` is the height over the point of impact from which
//! the same release would just arm and burst farther than `safe_m` from the owner.

use super::Fuze;
use super::weapon::{Weapon, WeaponKind};
use crate::aircraft::FARTHEST_M;
use crate::ballistics::motion::{ShellMotion, State, StepError, advance, parts, state};
use crate::ballistics::path::StepPath;
use crate::ballistics::projectile::Projectile;
use crate::frame::{ned_from_world, world_from_ned};
use crate::integrate::Integrator;
use crate::scene::{ALTITUDES_M, SceneGround, Surroundings};
use glam::DVec3;
use serde::Serialize;

/// Most steps of a prediction.
pub const MOST_STEPS: u32 = 160;
/// Length of a step while a motor burns, over that of the others: there the speed changes most.
const BURN_SHARE: f64 = 0.25;
/// Range at which a gun's pipper is shown, metres.
pub const SIGHT_RANGE_M: f64 = 800.0;
/// Longest that a too low release is followed under the ground, seconds.
const MOST_BEYOND_S: f64 = 20.0;

/// How a projectile leaves: world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leaving {
    /// Where, metres.
    pub position_m: DVec3,
    /// Velocity over the ground, m/s.
    pub velocity_mps: DVec3,
    /// Unit direction of thrust at rest.
    pub bore: DVec3,
    /// Where its owner is, metres.
    pub owner_m: DVec3,
    /// The owner's velocity, m/s.
    pub owner_mps: DVec3,
}

/// How a prediction is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Length of a step, seconds; a quarter of it while a motor burns.
    pub step_s: f64,
    /// Longest flight, seconds.
    pub most_s: f64,
    /// Most steps.
    pub most_steps: u32,
    /// The fuze, as set.
    pub fuze: Fuze,
    /// Distance at which the owner is safe from the burst, metres; 0 asks for none.
    pub safe_m: f64,
    /// Range of a pipper, metres.
    pub range_m: Option<f64>,
}

/// Where it will be at a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pipper {
    /// The point, metres.
    pub point_m: DVec3,
    /// When, seconds after release.
    pub time_s: f64,
}

/// A prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solution {
    /// The point of impact.
    pub point_m: DVec3,
    /// Upward normal of the ground there; outward of a thing.
    pub normal: DVec3,
    /// Velocity there, m/s.
    pub velocity_mps: DVec3,
    /// Seconds from release.
    pub time_s: f64,
    /// From the release to the point, metres.
    pub slant_m: f64,
    /// Whether the fuze is armed by then.
    pub armed: bool,
    /// From the burst to the owner, if it flies straight on, metres.
    pub separation_m: f64,
    /// Whether that is far enough.
    pub safe: bool,
    /// Least height over the point of impact for a release that arms and is safe; `None` if there is none within
    /// the time that is looked at.
    pub least_fall_m: Option<f64>,
    /// The point at the range that was asked for, if it gets there.
    pub pipper: Option<Pipper>,
    /// Steps of flight that it took.
    pub steps: u32,
}

/// Why there is no prediction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoSolution {
    /// It strikes nothing within so many seconds.
    NothingWithin(f64),
    /// It leaves the bounds of any world: there is no ground under it.
    LeavesWorld,
    /// It cannot be flown in these steps.
    Stiff,
    /// No weapon is selected, or none of it is left.
    NoWeapon,
}

impl std::fmt::Display for NoSolution {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NothingWithin(most_s) => write!(f, "no impact within {most_s} s"),
            Self::LeavesWorld => f.write_str("no ground under the path"),
            Self::Stiff => f.write_str("drag is too stiff"),
            Self::NoWeapon => f.write_str("no weapon is ready"),
        }
    }
}

impl Solution {
    /// What the crew must be warned of: a release now would be a dud, or too near to its own burst.
    pub fn warning(&self) -> Option<&'static str> {
        if !self.armed {
            Some("TOO LOW TO ARM")
        } else if !self.safe {
            Some("TOO NEAR THE BURST")
        } else {
            None
        }
    }
}

impl Settings {
    /// Those for a weapon with its fuze as set.
    pub fn of(weapon: &Weapon, fuze: Fuze) -> Self {
        let (step_s, most_s, range_m) = match weapon.kind {
            WeaponKind::Bomb => (1.0, 150.0, None),
            WeaponKind::Rocket => (0.4, 40.0, None),
            WeaponKind::Gun => (0.2, 20.0, Some(SIGHT_RANGE_M)),
        };
        let most_steps = MOST_STEPS;
        Self { step_s, most_s, most_steps, fuze, safe_m: weapon.warhead.map_or(0.0, |warhead| warhead.safe_m), range_m }
    }
}

/// Predicts where a projectile strikes.
///
/// # Errors
/// [`NoSolution`] says why there is no point.
pub fn predict(
    projectile: &Projectile,
    around: &Surroundings,
    ground: &SceneGround,
    leaving: &Leaving,
    settings: &Settings,
) -> Result<Solution, NoSolution> {
    let bore = ned_from_world(leaving.bore);
    let mut motion = ShellMotion::new(projectile, around.planet(), &around.atmosphere, &around.wind, bore);
    let mut y = state(ned_from_world(leaving.position_m), ned_from_world(leaving.velocity_mps));
    let (mut t_s, mut steps) = (0.0, 0);
    let (mut found, mut least_fall_m, mut pipper): (Option<Solution>, _, _) = (None, None, None);
    loop {
        let end_s = found.as_ref().map_or(settings.most_s, |found| found.time_s + MOST_BEYOND_S);
        if t_s >= end_s || steps >= settings.most_steps {
            break;
        }
        let row_s = projectile.burn.iter().map(|row| row[0]).find(|row_s| *row_s > t_s).unwrap_or(f64::INFINITY);
        let step_s = if row_s.is_finite() { BURN_SHARE * settings.step_s } else { settings.step_s };
        let to_s = (t_s + step_s).min(row_s).min(end_s);
        motion.burn_as_at(&projectile.burn, 0.5 * (t_s + to_s));
        let next = match advance(Integrator::Rk4, &motion, t_s, &y, to_s - t_s, &mut None) {
            Ok((next, _)) => next,
            Err(_) if found.is_some() => break,
            Err(StepError::Stiff { .. } | StepError::NotFinite { .. }) => return Err(NoSolution::Stiff),
        };
        steps += 1;
        let path = path(&y, &next, to_s - t_s);
        if pipper.is_none()
            && let Some(range_m) = settings.range_m
            && path.to_m.distance(leaving.position_m) >= range_m
        {
            let share = first_true(|share| path.position_m(share).distance(leaving.position_m) >= range_m);
            pipper = Some(Pipper { point_m: path.position_m(share), time_s: t_s + share * path.step_s });
        }
        if least_fall_m.is_none() {
            let safe = |share: f64| {
                let (at_m, at_s) = (path.position_m(share), t_s + share * path.step_s);
                settings.fuze.is_armed(at_s) && separation_m(leaving, at_m, at_s) >= settings.safe_m
            };
            if safe(1.0) {
                let share = if safe(0.0) { 0.0 } else { first_true(safe) };
                least_fall_m = Some(leaving.position_m.y - path.position_m(share).y);
            }
        }
        if found.is_none()
            && ground.may_touch(&path)
            && let Some(touch) = ground.touch_all(&path)
        {
            let time_s = t_s + touch.fraction * path.step_s;
            let separation_m = separation_m(leaving, touch.point_m, time_s);
            found = Some(Solution {
                point_m: touch.point_m,
                normal: touch.normal,
                velocity_mps: touch.velocity_mps,
                time_s,
                slant_m: touch.point_m.distance(leaving.position_m),
                armed: settings.fuze.is_armed(time_s),
                separation_m,
                safe: separation_m >= settings.safe_m,
                least_fall_m: None,
                pipper: None,
                steps,
            });
        }
        if found.is_some() && least_fall_m.is_some() {
            break;
        }
        let outside = path.to_m.x.abs().max(path.to_m.z.abs()) > FARTHEST_M
            || path.to_m.y < ALTITUDES_M.0
            || path.to_m.y > ALTITUDES_M.1;
        if outside {
            if found.is_some() {
                break;
            }
            return Err(NoSolution::LeavesWorld);
        }
        (y, t_s) = (next, to_s);
    }
    let found = found.ok_or(NoSolution::NothingWithin(t_s))?;
    Ok(Solution { least_fall_m, pipper, steps, ..found })
}

fn path(from: &State, to: &State, step_s: f64) -> StepPath {
    let ((from_r, from_v), (to_r, to_v)) = (parts(from), parts(to));
    StepPath {
        from_m: world_from_ned(from_r),
        from_mps: world_from_ned(from_v),
        to_m: world_from_ned(to_r),
        to_mps: world_from_ned(to_v),
        step_s,
    }
}

fn separation_m(leaving: &Leaving, at_m: DVec3, at_s: f64) -> f64 {
    at_m.distance(leaving.owner_m + leaving.owner_mps * at_s)
}

/// The fraction from which on something is so, which is not at 0 and is at 1; to 2^-20 of a step.
fn first_true(is: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if is(middle) { high = middle } else { low = middle }
    }
    high
}
