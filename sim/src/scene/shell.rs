//! Projectiles in a scene: a point each, swept every step against the exact ground and the targets near it.
//!
//! A state is that of [`crate::ballistics::motion`] in north, east, down from the world's origin. A step is cut where a
//! motor's burn has a row. The owner is never struck by its own round.
//!
//! Invariants others rely on: a projectile leaves the scene by an impact or an ending that is told, never in silence;
//! which one does not depend on the order of targets.

use super::arms::Load;
use super::body::ALTITUDES_M;
use super::catalogue::Named;
use super::codec::coded;
use super::event::{EndReason, Strike};
use super::ground::SceneGround;
use super::gun::Shot;
use super::surroundings::Surroundings;
use super::target_grid::TargetGrid;
use crate::aircraft::FARTHEST_M;
use crate::ballistics::motion::{ShellMotion, State, StepError, advance, parts, state};
use crate::ballistics::path::StepPath;
use crate::ballistics::projectile::Projectile;
use crate::ballistics::targets::{Pose, Target, TargetImpact, target_impact};
use crate::frame::{ned_from_world, world_from_ned};
use crate::integrate::Integrator;
use crate::snapshot::{StableId, turned};
use crate::weapons::Trigger;
use glam::DVec3;
use std::sync::Arc;

/// A projectile in flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shell {
    /// Its place in the catalogue.
    pub kind: u32,
    pub owner: StableId,
    pub round: u64,
    pub age_s: f64,
    pub state: State,
    bore: DVec3,
    /// The weapon that it is, with its fuze and aim.
    pub load: Option<Load>,
    pub jumps: u32,
}
coded!(Shell { kind, owner, round, age_s, state, bore, load, jumps });

/// How a step ended for a projectile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fate {
    Flies,
    /// What it struck, and at which fraction of the scene's step.
    Struck(Strike, f64),
    /// Where its fuze burst it above the ground, and at which fraction of the scene's step.
    Burst(DVec3, f64),
    Lost(EndReason),
}

/// What projectiles fly through and may strike during one step.
pub(super) struct Range<'a> {
    ground: &'a SceneGround,
    targets: &'a [Target],
    grid: &'a TargetGrid,
    surroundings: &'a Surroundings,
    motions: Vec<(ShellMotion<'a>, &'a Projectile)>,
    dt_s: f64,
}

impl<'a> Range<'a> {
    pub fn new(
        projectiles: &'a [Named<Arc<Projectile>>],
        surroundings: &'a Surroundings,
        ground: &'a SceneGround,
        targets: &'a [Target],
        grid: &'a TargetGrid,
        dt_s: f64,
    ) -> Self {
        let one = |projectile: &'a Projectile| {
            let (air, wind) = (&surroundings.atmosphere, &surroundings.wind);
            (ShellMotion::new(projectile, surroundings.planet(), air, wind, DVec3::X), projectile)
        };
        // Once a step and kind, not a shell.
        let motions = projectiles.iter().map(|named| one(&named.thing)).collect();
        Self { ground, targets, grid, surroundings, motions, dt_s }
    }

    /// Flies a projectile from a fraction of the step to its end.
    pub fn fly(&self, id: StableId, shell: &mut Shell, from: f64) -> Fate {
        let step_s = (1.0 - from) * self.dt_s;
        if step_s <= 0.0 {
            return Fate::Flies;
        }
        let start = shell.state;
        let next = match self.advanced(shell, step_s) {
            Ok(next) => next,
            Err(StepError::Stiff { .. }) => return Fate::Lost(EndReason::Stiff),
            Err(StepError::NotFinite { .. }) => return Fate::Lost(EndReason::NotFinite),
        };
        let ((from_r, from_v), (to_r, to_v)) = (parts(&start), parts(&next));
        let path = StepPath {
            from_m: world_from_ned(from_r),
            from_mps: world_from_ned(from_v),
            to_m: world_from_ned(to_r),
            to_mps: world_from_ned(to_v),
            step_s,
        };
        let struck = self.struck(id, shell, &path, from);
        if let Some((point_m, fraction)) = self.burst_above(shell, &path)
            && struck.is_none_or(|(_, strikes)| fraction <= strikes)
        {
            return Fate::Burst(point_m, from + (1.0 - from) * fraction);
        }
        if let Some((strike, fraction)) = struck {
            return Fate::Struck(strike, from + (1.0 - from) * fraction);
        }
        let altitude = -to_r.z;
        if to_r.x.abs().max(to_r.y.abs()) > FARTHEST_M || altitude < ALTITUDES_M.0 || altitude > ALTITUDES_M.1 {
            return Fate::Lost(EndReason::LeftWorld);
        }
        shell.state = next;
        shell.age_s += step_s;
        Fate::Flies
    }

    fn advanced(&self, shell: &Shell, step_s: f64) -> Result<State, StepError> {
        let (shared, projectile) = &self.motions[shell.kind as usize];
        if projectile.burn.is_empty() {
            return advance(Integrator::Rk4, shared, shell.age_s, &shell.state, step_s, &mut None)
                .map(|(next, _)| next);
        }
        let (air, wind) = (&self.surroundings.atmosphere, &self.surroundings.wind);
        let mut motion = ShellMotion::new(projectile, self.surroundings.planet(), air, wind, shell.bore);
        let (mut y, mut t_s, end_s) = (shell.state, shell.age_s, shell.age_s + step_s);
        while t_s < end_s {
            let row = projectile.burn.partition_point(|row| row[0] <= t_s);
            let to_s = projectile.burn.get(row).map_or(end_s, |row| row[0].min(end_s));
            motion.burn_as_at(&projectile.burn, 0.5 * (t_s + to_s));
            (y, _) = advance(Integrator::Rk4, &motion, t_s, &y, to_s - t_s, &mut None)?;
            t_s = to_s;
        }
        Ok(y)
    }

    /// Where a height fuze bursts it on the path, and at which fraction: where the path, lowered by the fuze's height, meets
    /// the ground, from where it is armed on.
    fn burst_above(&self, shell: &Shell, path: &StepPath) -> Option<(DVec3, f64)> {
        let fuze = shell.load?.fuze;
        let Trigger::Height(height_m) = fuze.trigger else { return None };
        let armed = ((fuze.arming_s - shell.age_s) / path.step_s).max(0.0);
        if armed >= 1.0 {
            return None;
        }
        let rest = if armed > 0.0 { path.split(armed)[1] } else { *path };
        let down = DVec3::Y * height_m;
        let lowered = StepPath { from_m: rest.from_m - down, to_m: rest.to_m - down, ..rest };
        let touch = self.ground.touch(&lowered)?;
        Some((touch.point_m + down, armed + (1.0 - armed) * touch.fraction))
    }

    /// What the path strikes first, and at which fraction of it; at the same instant the target, of several the one
    /// with the lowest id.
    fn struck(&self, id: StableId, shell: &Shell, path: &StepPath, from: f64) -> Option<(Strike, f64)> {
        let mut first: Option<TargetImpact> = None;
        self.grid.near(path, |index| {
            let target = &self.targets[index];
            let impact = if from == 0.0 {
                target_impact(path, std::slice::from_ref(target), Some(shell.owner))
            } else {
                // A round that left during the step meets a target that has moved on meanwhile.
                let at = Pose {
                    position_m: target.from.position_m.lerp(target.to.position_m, from),
                    attitude: turned(target.from.attitude, target.to.attitude, from),
                };
                target_impact(path, &[Target { from: at, ..target.clone() }], Some(shell.owner))
            };
            if let Some(impact) = impact
                && first.is_none_or(|first| (impact.fraction, impact.id) < (first.fraction, first.id))
            {
                first = Some(impact);
            }
        });
        let of = Strike {
            projectile: id,
            kind: shell.kind,
            owner: shell.owner,
            round: shell.round,
            target: None,
            object: None,
            point_m: DVec3::ZERO,
            point_in_target_m: DVec3::ZERO,
            normal: DVec3::ZERO,
            velocity_mps: DVec3::ZERO,
        };
        if let Some(touch) = self.ground.touch_all(path)
            && first.is_none_or(|first| touch.fraction < first.fraction)
        {
            let (point_m, normal, velocity_mps) = (touch.point_m, touch.normal, touch.velocity_mps);
            let strike =
                Strike { object: touch.object, point_m, point_in_target_m: point_m, normal, velocity_mps, ..of };
            return Some((strike, touch.fraction));
        }
        first.map(|impact| {
            let TargetImpact { id, fraction, point_m, point_in_target_m, normal, velocity_mps, .. } = impact;
            (Strike { target: Some(id), point_m, point_in_target_m, normal, velocity_mps, ..of }, fraction)
        })
    }
}

impl Shell {
    pub fn new(kind: u32, owner: StableId, round: u64, shot: &Shot, load: Option<Load>) -> Self {
        let state = state(ned_from_world(shot.position_m), ned_from_world(shot.velocity_mps));
        Self { kind, owner, round, age_s: 0.0, state, bore: ned_from_world(shot.bore), load, jumps: 0 }
    }

    pub fn position_m(&self) -> DVec3 {
        world_from_ned(parts(&self.state).0)
    }

    pub fn velocity_mps(&self) -> DVec3 {
        world_from_ned(parts(&self.state).1)
    }

    /// Puts it elsewhere at a velocity; its age and round stay.
    pub fn relocate(&mut self, position_m: DVec3, velocity_mps: DVec3) {
        self.state = state(ned_from_world(position_m), ned_from_world(velocity_mps));
        self.jumps = self.jumps.wrapping_add(1);
    }
}
