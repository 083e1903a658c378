//! What projectiles of weapons do where they end: bursts, damage, craters, scores.
//!
//! World frame, metres, seconds. What ends within a step is taken in the order of its time, of its id at the same instant;
//! targets stand where they are at that time, between the poses of the step. Every hurt target is named by an event, and
//! every weapon but a gun's round by a score.
//!
//! Invariants others rely on: the point of a burst and of a score is the impact's own, to the bit, but for a burst of a delay
//! fuze in the ground, which is farther along the line that it struck on; what is random
//! depends on the seed, the target and the projectile alone, so not on the order of anything.

use super::arms::Load;
use super::body::Body;
use super::codec::coded;
use super::event::{EndReason, Happening, Strike};
use super::ground::GroundTouch;
use super::shell::Shell;
use super::target::TargetState;
use super::{Refused, Scene, SceneGround, found, place};
use crate::ballistics::projectile::Projectile;
use crate::ballistics::targets::{Pose, Target};
use crate::random::Stream;
use crate::snapshot::{StableId, turned};
use crate::weapons::armour::DAMAGED_FROM;
use crate::weapons::crater::{changes_posts, crater, vented};
use crate::weapons::penetration;
use crate::weapons::score::{Aim, Outcome, Score, miss};
use crate::weapons::{Armour, Damage, Trigger, Warhead, WeaponKind};
use glam::DVec3;
use terrain::features::index::ObjectId;

/// A stream's key beside seed, target and projectile: no turbulence and no round has it.
const KEY_DAMAGE: u64 = u64::MAX - 1;

/// A projectile of a weapon whose flight ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ended {
    /// When, scene time.
    pub time_s: f64,
    pub id: StableId,
    pub owner: StableId,
    pub round: u64,
    pub load: Load,
    /// Since its release.
    pub age_s: f64,
    pub point_m: DVec3,
    /// Its velocity there against what it struck, m/s, and the outward normal of that.
    velocity_mps: DVec3,
    normal: DVec3,
    /// Where it bursts, if its delay runs in the ground.
    burst_m: DVec3,
    /// The target that it struck, and where in it.
    pub target: Option<(StableId, DVec3)>,
    pub object: Option<ObjectId>,
    /// Whether it burst above the ground.
    pub in_air: bool,
    /// Whether it struck before and its delay is over.
    pub rested: bool,
    /// Targets that it destroyed as a solid shot.
    kills: u32,
    /// The target that it is scored against, and its miss, taken at the impact.
    scored: Option<StableId>,
    miss: Option<(f64, u32)>,
}
coded!(Ended {
    time_s,
    id,
    owner,
    round,
    load,
    age_s,
    point_m,
    velocity_mps,
    normal,
    burst_m,
    target,
    object,
    in_air,
    rested,
    kills,
    scored,
    miss
});

impl Ended {
    /// One that burst in the air.
    pub fn in_air(id: StableId, shell: &Shell, load: Load, point_m: DVec3, time_s: f64, age_s: f64) -> Self {
        Self {
            time_s,
            id,
            owner: shell.owner,
            round: shell.round,
            load,
            age_s,
            point_m,
            velocity_mps: DVec3::ZERO,
            normal: DVec3::ZERO,
            burst_m: point_m,
            target: None,
            object: None,
            in_air: true,
            rested: false,
            kills: 0,
            scored: None,
            miss: None,
        }
    }

    /// One that struck.
    pub fn of_strike(strike: &Strike, shell: &Shell, load: Load, time_s: f64, age_s: f64) -> Self {
        let target = strike.target.map(|id| (id, strike.point_in_target_m));
        let of = Self::in_air(strike.projectile, shell, load, strike.point_m, time_s, age_s);
        let (velocity_mps, normal) = (strike.velocity_mps, strike.normal);
        Self { target, object: strike.object, in_air: false, velocity_mps, normal, ..of }
    }

    /// Where it is in the ground after a time; where it struck, if it struck something else or too flat to go in.
    fn goes_to(&self, projectile: &Projectile, after_s: f64, ground: &SceneGround) -> DVec3 {
        let speed_mps = self.velocity_mps.length();
        let on_ground = self.target.is_none() && self.object.is_none();
        let (Some(diameter_m), true) = (projectile.diameter_m, on_ground && speed_mps > 0.0) else {
            return self.point_m;
        };
        let along = self.velocity_mps / speed_mps;
        if !penetration::goes_in(-along.dot(self.normal)) {
            return self.point_m;
        }
        let softness = penetration::softness(ground.cover_at(self.point_m.x, self.point_m.z));
        let way_m = penetration::way_m(projectile.mass_kg, diameter_m, speed_mps, softness);
        self.point_m + along * penetration::gone_m(way_m, speed_mps, after_s)
    }

    /// What a restored one must be.
    pub fn check(&self, weapons: usize) -> Result<(), Refused> {
        if self.load.weapon as usize >= weapons || !self.rested || self.kills > 1_000_000 {
            return Err(Refused::new("resting: expected a weapon of the catalogue that struck"));
        }
        place("resting.burst_m", self.burst_m)?;
        place("resting.point_m", self.point_m).map(|_| ())
    }
}

/// Where a target is at a time of the step that began at `from_s`.
fn pose_at(target: &Target, fraction: f64) -> Pose {
    Pose {
        position_m: target.from.position_m.lerp(target.to.position_m, fraction),
        attitude: turned(target.from.attitude, target.to.attitude, fraction),
    }
}

/// What bursts did so far.
#[derive(Debug, Clone, Copy, Default)]
struct Done {
    hurt: bool,
    kills: u32,
}

impl Scene {
    /// Does what projectiles do that ended in this step, and those whose delay ends in it.
    pub(super) fn take_effect(&mut self, mut ended: Vec<Ended>, ground: &SceneGround, from_s: f64, dt_s: f64) {
        loop {
            let due = |one: &Ended| one.time_s < from_s + dt_s;
            ended.extend(self.resting.iter().filter(|one| due(one)));
            self.resting.retain(|one| !due(one));
            if ended.is_empty() {
                return;
            }
            ended.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.id.cmp(&b.id)));
            for one in std::mem::take(&mut ended) {
                let fraction = ((one.time_s - from_s) / dt_s).clamp(0.0, 1.0);
                self.end_weapon(one, ground, fraction);
            }
        }
    }

    fn end_weapon(&mut self, mut one: Ended, ground: &SceneGround, fraction: f64) {
        let catalogue = self.catalogue.clone();
        let weapon = &catalogue.weapons[one.load.weapon as usize].thing;
        let mut done = Done { hurt: one.target.is_some(), kills: one.kills };
        if !one.rested && weapon.kind != WeaponKind::Gun {
            self.measure(&mut one, fraction);
        }
        if let Some((target, _)) = one.target.filter(|_| !one.rested) {
            let armour = self.armour_of(target);
            if let Some(hits) = armour.and_then(|armour| weapon.hits_to_kill.of(armour)) {
                done.kills += u32::from(self.hurt(target, 1.0 / hits, &one) == Some(Damage::Destroyed));
            }
        }
        let armed = one.rested || one.in_air || one.load.fuze.is_armed(one.age_s);
        let Some(warhead) = weapon.warhead else { return self.score(&one, weapon.kind, done, false) };
        if !armed {
            return self.score(&one, weapon.kind, done, true);
        }
        if let Trigger::Delay(delay_s) = one.load.fuze.trigger
            && !one.rested
        {
            (one.rested, one.kills) = (true, done.kills);
            one.burst_m = one.goes_to(&weapon.projectile, delay_s, ground);
            one.time_s += delay_s;
            self.resting.push(one);
            return;
        }
        let mut point_m = one.burst_m;
        if let Some((target, in_target_m)) = one.target.filter(|_| one.rested)
            && let Some(index) = self.index_of(target)
        {
            // It went along with what it struck.
            let pose = pose_at(&self.swept[index], fraction);
            point_m = pose.position_m + pose.attitude * in_target_m;
        }
        self.burst(&one, point_m, &warhead, ground, fraction, &mut done);
        self.score(&one, weapon.kind, done, false);
    }

    fn burst(
        &mut self,
        one: &Ended,
        point_m: DVec3,
        warhead: &Warhead,
        ground: &SceneGround,
        fraction: f64,
        done: &mut Done,
    ) {
        let on_ground = !one.in_air && one.target.is_none() && one.object.is_none();
        let buried = on_ground && one.burst_m != one.point_m;
        let burst = Happening::Burst {
            projectile: one.id,
            weapon: one.load.weapon,
            owner: one.owner,
            round: one.round,
            point_m,
            tnt_kg: warhead.tnt_kg,
            buried,
            in_air: one.in_air,
        };
        self.log.add(one.time_s, burst);
        let under_m = ground.height_m(point_m.x, point_m.z);
        let over_m = under_m.map(|under_m| point_m.y - under_m);
        // On the ground to the bit, or in it.
        let height_m = if on_ground { over_m.map(|over_m| if buried { over_m.min(0.0) } else { 0.0 }) } else { over_m };
        // Water closes over it again.
        if let Some(crater) = height_m.and_then(|height_m| crater(warhead.tnt_kg, height_m))
            && !ground.is_water(point_m.x, point_m.z)
        {
            let happening = Happening::Crater {
                centre_m: if on_ground && !buried {
                    point_m
                } else {
                    DVec3 { y: under_m.unwrap_or(point_m.y), ..point_m }
                },
                radius_m: crater.radius_m,
                depth_m: crater.depth_m,
                changes_posts: ground.step_m().is_some_and(|step_m| changes_posts(crater.radius_m, step_m)),
            };
            self.log.add(one.time_s, happening);
        }
        let vented = height_m.map_or(1.0, |height_m| vented(warhead.tnt_kg, height_m));
        if vented <= 0.0 {
            return;
        }
        // Radii go with the cube root of a charge.
        self.blow_loose(one.id, point_m, warhead.tnt_kg * vented.powi(3));
        self.hurt_bodies(one, point_m, warhead, vented);
        if self.swept.is_empty() {
            return;
        }
        let reach_m = warhead.reach_m();
        let mut near = Vec::new();
        self.grid.around(point_m.x, point_m.z, reach_m, |index| near.push(index));
        near.sort_unstable();
        near.dedup();
        for index in near {
            let swept = &self.swept[index];
            let pose = pose_at(swept, fraction);
            let from_m = pose.attitude.conjugate() * (point_m - pose.position_m);
            if from_m.length() - swept.shape.radius_m() > reach_m {
                continue;
            }
            let (id, distance_m) = (swept.id, swept.shape.distance_m(from_m).max(0.0) / vented);
            let Some(armour) = self.armour_of(id) else { continue };
            let chance = Stream::new(&[self.surroundings.seed, id.0, one.id.0, KEY_DAMAGE]).uniform();
            let amount = if chance < warhead.kills(distance_m, armour) {
                1.0
            } else if chance < warhead.hurts(distance_m, armour) {
                DAMAGED_FROM
            } else {
                continue;
            };
            done.hurt = true;
            done.kills += u32::from(self.hurt(id, amount, one) == Some(Damage::Destroyed));
        }
    }

    /// Wrecks flying and standing bodies beside a burst, by the same curve as targets; every one counts as light, its centre of
    /// gravity as all of it. The own aircraft of point mass is no body.
    fn hurt_bodies(&mut self, one: &Ended, point_m: DVec3, warhead: &Warhead, vented: f64) {
        let mut crashed = Vec::new();
        for &(id, entity) in &self.bodies {
            let Ok(mut body) = self.ecs.get::<&mut Body>(entity) else { continue };
            let at = body.carriage(&self.surroundings.planet());
            let away_m = at.position_m - point_m;
            if body.ended.is_some() || away_m.length() > warhead.reach_m() {
                continue;
            }
            let chance = Stream::new(&[self.surroundings.seed, id.0, one.id.0, KEY_DAMAGE]).uniform();
            if chance >= warhead.kills(away_m.length() / vented, Armour::Light) {
                continue;
            }
            let touch = GroundTouch {
                fraction: 0.0,
                point_m: at.position_m,
                normal: DVec3::ZERO,
                velocity_mps: at.velocity_mps,
                object: None,
            };
            body.wreck(EndReason::Blast, touch);
            let (normal, velocity_mps) = (touch.normal, touch.velocity_mps);
            let crash = Happening::Crash { id, reason: EndReason::Blast, point_m: touch.point_m, normal, velocity_mps };
            self.log.add(one.time_s, crash);
            crashed.push((id, touch));
        }
        if !crashed.is_empty() {
            self.views.bodies.take();
        }
        for (id, touch) in crashed {
            // What comes off goes on as it went: there is no ground that would turn it.
            let level = touch.velocity_mps.try_normalize().map_or(DVec3::Y, |way| way.any_orthonormal_vector());
            self.strew(id, &GroundTouch { normal: level, ..touch });
        }
    }

    fn armour_of(&self, target: StableId) -> Option<Armour> {
        let target = self.ecs.get::<&TargetState>(found(&self.targets, target)?).ok()?;
        target.kind.map(|kind| self.catalogue.kinds[kind as usize].thing.armour)
    }

    /// Hurts a target, tells it, and lets its column react; the new state if that changed.
    fn hurt(&mut self, id: StableId, amount: f64, by: &Ended) -> Option<Damage> {
        let (state, column) = {
            let entity = found(&self.targets, id)?;
            let mut target = self.ecs.get::<&mut TargetState>(entity).ok()?;
            (target.hurt(amount), target.column)
        };
        self.views.targets.take();
        if let Some(state) = state {
            self.log.add(by.time_s, Happening::Damage { id, state, owner: by.owner, round: by.round });
            if state == Damage::Destroyed {
                self.shatter(id, by);
            }
        }
        if let Some(column) = column {
            for (at, (_, entity)) in self.targets.iter().enumerate() {
                if let Ok(mut other) = self.ecs.get::<&mut TargetState>(*entity)
                    && other.column.is_some_and(|of| of.number == column.number)
                {
                    other.react(at as u64);
                }
            }
        }
        state
    }

    /// Measures its miss at the impact. A gun's rounds are too many to measure each; they are only counted.
    fn measure(&self, one: &mut Ended, fraction: f64) {
        let aim = match one.load.aim {
            Aim::Place(at_m) => Some((None, at_m)),
            Aim::Target(id) => {
                self.index_of(id).map(|index| (Some(id), pose_at(&self.swept[index], fraction).position_m))
            }
            Aim::Nearest => self.nearest(one.point_m, fraction),
        };
        if let Some((target, aim_m)) = aim {
            (one.scored, one.miss) = (target, Some(miss(one.point_m, aim_m, one.load.way)));
        }
    }

    fn score(&mut self, one: &Ended, kind: WeaponKind, done: Done, dud: bool) {
        let outcome = match done {
            Done { kills: 1.., .. } => Outcome::Kill,
            _ if dud => Outcome::Dud,
            Done { hurt: true, .. } => Outcome::Hit,
            _ => Outcome::Miss,
        };
        let score = Score {
            weapon: one.load.weapon,
            projectile: one.id,
            owner: one.owner,
            round: one.round,
            target: one.scored,
            point_m: one.point_m,
            miss_m: one.miss.map(|(miss_m, _)| miss_m),
            clock: one.miss.map(|(_, clock)| clock),
            outcome,
            kills: done.kills,
        };
        if kind != WeaponKind::Gun {
            self.log.add(one.time_s, Happening::Score(score));
        }
        self.tallies.entry((one.owner, one.load.weapon)).or_default().add(&score);
    }

    fn index_of(&self, id: StableId) -> Option<usize> {
        self.targets.binary_search_by_key(&id, |(id, _)| *id).ok()
    }

    /// The target nearest in plan, of several the first.
    fn nearest(&self, point_m: DVec3, fraction: f64) -> Option<(Option<StableId>, DVec3)> {
        let mut best: Option<(f64, StableId, DVec3)> = None;
        for target in &self.swept {
            let at_m = pose_at(target, fraction).position_m;
            let distance_m = (at_m.x - point_m.x).hypot(at_m.z - point_m.z);
            if best.is_none_or(|(least_m, ..)| distance_m < least_m) {
                best = Some((distance_m, target.id, at_m));
            }
        }
        best.map(|(_, id, at_m)| (Some(id), at_m))
    }
}
