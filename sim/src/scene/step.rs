//! One fixed step of a scene.
//!
//! In this order: commands that are due; the own aircraft; bodies, targets, loose things and shells, each by id; the rounds that leave
//! during the step, which fly what is left of it; then what those weapons do that ended in it. Owners are where they are at the moment that a round leaves; targets
//! move during the step while shells are swept past them.
//!
//! Invariant others rely on: the cost of an entity does not depend on how many others there are, and no entity costs an
//! allocation a step; only what strikes, fires or fails may, and the page of an own aircraft that carries weapons.

use super::body::parts::struck;
use super::body::{Body, Outcome};
use super::effects::Ended;
use super::event::{EndReason, Happening};
use super::gun::Carriage;
use super::shell::{Fate, Range, Shell};
use super::target::TargetState;
use super::{Freeze, Scene, SceneGround, found};
use crate::autopilot::Sight;
use crate::ballistics::targets::Pose;
use crate::snapshot::{Mode, StableId};
use glam::{DVec2, DVec3};

/// A round that hit: the target, the owner and the owner's round.
type Hit = (StableId, StableId, u64);

impl Scene {
    /// Takes one step. Pausing is the caller's: a clock that is paused gives no steps to take.
    ///
    /// The ground may be another version than in the step before: all that this step meets is the new one, and the snapshot
    /// after it names it.
    pub fn step(&mut self, ground: &SceneGround) {
        let version = ground.version();
        if self.ground_version.replace(version).is_some_and(|before| before != version) {
            self.ground_changed();
        }
        self.settle(ground);
        self.obey();
        let (dt_s, from_s, date) = (self.clock.step_s(), self.clock.time_s(), self.clock.date());
        self.clock.tick();
        if !self.log.recent.is_empty() {
            self.log.forget(from_s);
        }
        if self.freeze == Freeze::Total {
            self.clock.set_date(date);
            self.bursts.iter_mut().for_each(|burst| burst.wait(dt_s));
            self.resting.iter_mut().for_each(|one| one.time_s += dt_s);
            self.look_down(ground);
            return;
        }
        let before: Vec<Option<Carriage>> = self.bursts.iter().map(|burst| self.carriage(burst.owner)).collect();
        if self.freeze != Freeze::Flight {
            match self.piloted() {
                Some(body) => {
                    self.command_flown(body);
                    self.lay_sights(ground);
                    self.step_bodies(ground, from_s, dt_s);
                    self.follow_flown(body, dt_s);
                }
                None => {
                    self.step_own(ground.height_at(), dt_s);
                    self.seat_flown();
                    self.lay_sights(ground);
                    self.step_bodies(ground, from_s, dt_s);
                }
            }
        }
        self.step_targets(ground, dt_s);
        self.step_loose(ground, from_s, dt_s);
        self.step_shells(ground, &before, from_s, dt_s);
        self.look_down(ground);
    }

    /// Says that the ground is another than before: what stands on it takes its height anew before the next step.
    pub fn ground_changed(&mut self) {
        self.unsettled = true;
    }

    /// Puts targets on the ground that were not yet.
    pub(super) fn settle(&mut self, ground: &SceneGround) {
        if !std::mem::take(&mut self.unsettled) {
            return;
        }
        for (_, entity) in &self.targets {
            if let Ok(mut target) = self.ecs.get::<&mut TargetState>(*entity) {
                target.settle(ground);
            }
        }
        self.views.targets.take();
        self.settle_loose(ground);
    }

    /// The pose of whoever may fire: the own aircraft, a body that flies, a target.
    pub(super) fn carriage(&self, id: StableId) -> Option<Carriage> {
        if id == self.own_id {
            let own = self.aircraft();
            return Some(Carriage {
                position_m: own.position_m,
                attitude: own.attitude,
                velocity_mps: own.velocity_mps,
                rates_radps: own.rates_radps,
            });
        }
        if let Some(entity) = found(&self.bodies, id) {
            let body = self.ecs.get::<&Body>(entity).ok()?;
            return body.ended.is_none().then(|| body.carriage(&self.surroundings.planet()));
        }
        let target = self.ecs.get::<&TargetState>(found(&self.targets, id)?).ok()?;
        Some(Carriage {
            position_m: target.position_m,
            attitude: target.attitude,
            velocity_mps: target.velocity_mps,
            rates_radps: DVec3::ZERO,
        })
    }

    /// Shows each autopilot that holds an attack where its weapon would strike, and where its target is.
    fn lay_sights(&mut self, ground: &SceneGround) {
        for place in 0..self.bodies.len() {
            let (id, entity) = self.bodies[place];
            let held = self.ecs.get::<&Body>(entity).ok().and_then(|body| body.autopilot?.holds.attack);
            let Some(target) = held else { continue };
            let owner = if self.flown == Some(id) { self.own_id } else { id };
            let sight = self.sight(owner, target, ground);
            if let Ok(mut body) = self.ecs.get::<&mut Body>(entity) {
                body.sight = sight;
            }
        }
    }

    /// An owner's aim at a target; without a place where its weapon would strike, that of its bore.
    fn sight(&self, owner: StableId, target: StableId, ground: &SceneGround) -> Option<Sight> {
        let target_m = self.ecs.get::<&TargetState>(found(&self.targets, target)?).ok()?.position_m;
        let own = self.carriage(owner)?;
        let bore = own.attitude * DVec3::X;
        let along_bore = own.position_m + bore * own.position_m.distance(target_m);
        let strikes_m = self.ccip(owner, ground).map_or(along_bore, |solution| solution.point_m);
        Some(Sight { strikes_m, target_m })
    }

    fn step_bodies(&mut self, ground: &SceneGround, from_s: f64, dt_s: f64) {
        if self.bodies.is_empty() {
            return;
        }
        self.views.bodies.take();
        let carried = self.flown.filter(|_| self.mode != Mode::Pilot);
        let (step, freeze, log) = (self.clock.step() - 1, self.freeze, &mut self.log);
        let mut crashed = Vec::new();
        let mut all = self.ecs.view_mut::<&mut Body>();
        for &(id, entity) in &self.bodies {
            // A body that is carried along with the own aircraft does not fly by itself.
            if carried == Some(id) {
                continue;
            }
            let Some(body) = all.get_mut(entity).filter(|body| body.ended.is_none()) else { continue };
            if !body.failures.is_empty() {
                body.set_in(step, |name| log.add(from_s, Happening::Failure { id, name: name.to_owned() }));
            }
            let (from, rig) = (body.state, &mut self.rigs[body.model as usize]);
            let mut outcome = body.step(rig, ground, freeze, dt_s);
            if outcome == Outcome::Flies {
                let motion = &rig.motion;
                let about = (&self.swept[..], &self.grid);
                let touch = struck(body, &motion.model, motion.cg_m, &from, dt_s, ground, about);
                outcome = touch.map_or(outcome, |touch| body.wreck(EndReason::Struck, touch));
            }
            match outcome {
                Outcome::Flies => {}
                Outcome::OutOfFuel => log.add(from_s + dt_s, Happening::OutOfFuel { id }),
                Outcome::Ended(reason, touch) => {
                    let (point_m, normal, velocity_mps) = (touch.point_m, touch.normal, touch.velocity_mps);
                    let crash = Happening::Crash { id, reason, point_m, normal, velocity_mps };
                    log.add(from_s + touch.fraction * dt_s, crash);
                    crashed.push((id, touch));
                }
            }
        }
        for (id, touch) in crashed {
            self.strew(id, &touch);
        }
    }

    fn step_targets(&mut self, ground: &SceneGround, dt_s: f64) {
        if self.targets.is_empty() {
            return;
        }
        let mut moved = std::mem::take(&mut self.swept_anew);
        let mut all = self.ecs.view_mut::<&mut TargetState>();
        for (&(_, entity), swept) in self.targets.iter().zip(&mut self.swept) {
            let Some(target) = all.get_mut(entity) else { continue };
            // What moved in the step before, or was put elsewhere since, must not be swept along that way again.
            let now = target.pose();
            moved |= swept.from != now || swept.to != now;
            (swept.from, swept.to) = (now, now);
            if target.is_restless() {
                target.step(ground, dt_s);
                swept.to = target.pose();
                if target.turns_at_once() {
                    // The new attitude holds for the whole step.
                    swept.from = Pose { position_m: now.position_m, ..swept.to };
                }
                moved = true;
            }
        }
        if moved {
            self.views.targets.take();
            self.grid.rebuild(&self.swept);
        }
    }

    fn step_shells(&mut self, ground: &SceneGround, before: &[Option<Carriage>], from_s: f64, dt_s: f64) {
        if self.shells.is_empty() && self.bursts.is_empty() && self.resting.is_empty() {
            return;
        }
        self.views.shells.take();
        let after: Vec<Option<Carriage>> = self.bursts.iter().map(|burst| self.carriage(burst.owner)).collect();
        let projectiles = &self.catalogue.projectiles;
        let range = Range::new(projectiles, &self.surroundings, ground, &self.swept, &self.grid, dt_s);
        let (mut hits, mut gone, mut new): (Vec<Hit>, Vec<hecs::Entity>, Vec<(StableId, Shell)>) = Default::default();
        let mut ended: Vec<Ended> = Vec::new();
        let (log, tallies) = (&mut self.log, &mut self.tallies);
        // Whether it still flies.
        let mut fly = |id: StableId, shell: &mut Shell, from: f64| match range.fly(id, shell, from) {
            Fate::Flies => true,
            Fate::Struck(strike, fraction) => {
                if let Some(target) = strike.target {
                    hits.push((target, strike.owner, strike.round));
                }
                let (time_s, age_s) = (from_s + fraction * dt_s, shell.age_s + (fraction - from) * dt_s);
                log.add(time_s, Happening::Impact(strike));
                if let Some(load) = shell.load {
                    ended.push(Ended::of_strike(&strike, shell, load, time_s, age_s));
                }
                false
            }
            Fate::Burst(point_m, fraction) => {
                let (time_s, age_s) = (from_s + fraction * dt_s, shell.age_s + (fraction - from) * dt_s);
                if let Some(load) = shell.load {
                    ended.push(Ended::in_air(id, shell, load, point_m, time_s, age_s));
                }
                false
            }
            Fate::Lost(reason) => {
                log.add(from_s + dt_s, Happening::Lost { id, reason });
                if let Some(load) = shell.load {
                    tallies.entry((shell.owner, load.weapon)).or_default().lost += 1;
                }
                false
            }
        };
        let mut all = self.ecs.view_mut::<&mut Shell>();
        self.shells.retain(|&(id, entity)| {
            let flies = all.get_mut(entity).is_some_and(|shell| fly(id, shell, 0.0));
            if !flies {
                gone.push(entity);
            }
            flies
        });
        let (until_s, seed) = (from_s + dt_s, self.surroundings.seed);
        let mut released: Vec<(StableId, u32)> = Vec::new();
        for ((burst, before), after) in self.bursts.iter_mut().zip(before).zip(&after) {
            let (Some(before), Some(after)) = (before, after) else {
                burst.end();
                continue;
            };
            while let Some(due_s) = burst.next_before(until_s) {
                let fraction = ((due_s - from_s) / dt_s).clamp(0.0, 1.0);
                let mut load = burst.load;
                if let Some(load) = &mut load {
                    let Some(at_m) = self.arms.get_mut(&burst.owner).and_then(|arms| arms.take(load.weapon)) else {
                        burst.end();
                        break;
                    };
                    burst.muzzle.offset_m = at_m;
                    let way = before.velocity_mps.lerp(after.velocity_mps, fraction);
                    load.way = DVec2::new(way.x, way.z);
                    released.push((burst.owner, load.weapon));
                }
                let round = self.fired.entry(burst.owner).or_insert(0);
                let shot = burst.shot(seed, *round, before, after, fraction);
                let (id, mut shell) =
                    (StableId(self.next_id), Shell::new(burst.projectile, burst.owner, *round, &shot, load));
                *round += 1;
                self.next_id += 1;
                if fly(id, &mut shell, fraction) {
                    new.push((id, shell));
                }
            }
        }
        self.bursts.retain(|burst| !burst.is_over());
        for entity in gone {
            // Listed, so there.
            let _ = self.ecs.despawn(entity);
        }
        for (id, shell) in new {
            let entity = self.ecs.spawn((id, shell));
            self.shells.push((id, entity));
        }
        for (target, owner, round) in hits {
            let entity = found(&self.targets, target);
            if let Some(mut target) = entity.and_then(|entity| self.ecs.get::<&mut TargetState>(entity).ok()) {
                target.hits = target.hits.saturating_add(1);
                target.last_round = Some((owner, round));
                self.views.targets.take();
            }
        }
        for &(owner, weapon) in &released {
            self.tallies.entry((owner, weapon)).or_default().released += 1;
        }
        released.dedup_by_key(|(owner, _)| *owner);
        for (owner, _) in released {
            self.weigh(owner);
        }
        self.take_effect(ended, ground, from_s, dt_s);
    }
}
