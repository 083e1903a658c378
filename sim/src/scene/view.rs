//! What a snapshot tells of a scene: its entities in lists by id, as cheap to copy as a pointer.
//!
//! World frame. A list is made when the first snapshot after a change asks for it and shared by all that follow; one of
//! a kind that the scene has none of is the shared empty list.

use super::body::Body;
use super::event::Event;
use super::shell::Shell;
use super::target::TargetState;
use super::{Freeze, Roster, Scene};
use crate::air_data::AirData;
use crate::aircraft::{AircraftState, Condition};
use crate::snapshot::{Flags, Mode, Snapshot, StableId, turned};
use crate::weapons::Damage;
use glam::{DQuat, DVec3};
use std::cell::OnceCell;
use std::sync::Arc;

/// What an entity is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum EntityKind {
    /// A rigid body.
    Body,
    /// A shell, a bomb, a rocket.
    Projectile,
    /// A target.
    Target,
    /// What lies about: something that can be knocked over, or debris.
    Loose,
}

/// An entity as others see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EntityView {
    /// Its name in the scene.
    pub id: StableId,
    /// What it is.
    pub kind: EntityKind,
    /// Place of its model, projectile or shape in the catalogue; of a loose thing in [`crate::loose::LooseKind::ALL`].
    pub of: u32,
    /// Position, metres.
    pub position_m: DVec3,
    /// Its axes to the world's: body axes; of a projectile with X along its velocity; of a target those of its shape.
    pub attitude: DQuat,
    /// Velocity over the ground, m/s.
    pub velocity_mps: DVec3,
    /// Whether it flies; a target is on the ground.
    pub condition: Condition,
    /// Hits taken so far.
    pub hits: u32,
    /// What is left of a target.
    pub damage: Damage,
    /// Whether it shows a light: a destroyed target that burns, a motor, a tracer.
    pub burning: bool,
    /// Whether gear that retracts is down; of what has none, true.
    pub gear_down: bool,
    /// Counts jumps, across which nothing may be interpolated.
    pub jumps: u32,
}

/// Lists made so far of the scene as it is.
#[derive(Debug, Default)]
pub(super) struct Views {
    pub bodies: OnceCell<Arc<[EntityView]>>,
    pub shells: OnceCell<Arc<[EntityView]>>,
    pub targets: OnceCell<Arc<[EntityView]>>,
    pub loose: OnceCell<Arc<[EntityView]>>,
}

impl EntityView {
    /// Part of the way from one view of an entity to a later one; the later one where it jumped between.
    pub(crate) fn interpolate(a: &Self, b: &Self, t: f64) -> Self {
        if a.jumps != b.jumps {
            return *b;
        }
        Self {
            position_m: a.position_m.lerp(b.position_m, t),
            velocity_mps: a.velocity_mps.lerp(b.velocity_mps, t),
            attitude: turned(a.attitude, b.attitude, t),
            ..*b
        }
    }

    /// Its numbers, for a hash.
    pub(crate) fn words(&self) -> [u64; 13] {
        let (p, q, v) = (self.position_m, self.attitude, self.velocity_mps);
        let rest = u64::from(self.of) | (self.kind as u64) << 32 | (self.condition as u64) << 40;
        let rest = rest | (self.damage as u64) << 48 | u64::from(self.burning) << 56;
        let counts = u64::from(self.hits) | u64::from(self.jumps) << 32;
        let f = f64::to_bits;
        [self.id.0, rest, counts, f(p.x), f(p.y), f(p.z), f(q.x), f(q.y), f(q.z), f(q.w), f(v.x), f(v.y), f(v.z)]
    }
}

/// Two lists by id as one, at part of the way between them. What is in one of them only is shown as it is there.
pub(crate) fn interpolated(a: &Arc<[EntityView]>, b: &Arc<[EntityView]>, t: f64) -> Arc<[EntityView]> {
    if Arc::ptr_eq(a, b) || (a.is_empty() && b.is_empty()) {
        return b.clone();
    }
    let mut all = Vec::with_capacity(b.len());
    let (mut left, mut right) = (a.iter().peekable(), b.iter().peekable());
    loop {
        match (left.peek(), right.peek()) {
            (Some(one), Some(other)) if one.id == other.id => {
                all.push(EntityView::interpolate(one, other, t));
                left.next();
                right.next();
            }
            (Some(one), Some(other)) if one.id < other.id => {
                all.push(**one);
                left.next();
            }
            (_, Some(other)) => {
                all.push(**other);
                right.next();
            }
            (Some(one), None) => {
                all.push(**one);
                left.next();
            }
            (None, None) => return all.into(),
        }
    }
}

impl Scene {
    /// The scene as it stands.
    pub fn snapshot(&self) -> Snapshot {
        let aircraft = self.aircraft();
        let track_ended = self.mode == Mode::Track && self.track.as_ref().is_some_and(|t| self.track_m >= t.length_m());
        Snapshot {
            ground_version: self.ground_version.unwrap_or(0),
            step: self.clock.step(),
            time_s: self.clock.time_s(),
            date: self.clock.date(),
            aircraft_id: self.own_id,
            aircraft,
            height_above_ground_m: self.height_above_ground_m,
            controls: self.controls,
            levers: self.levers,
            flown: self.flown,
            flags: Flags {
                paused: self.clock.paused(),
                frozen: self.freeze != Freeze::None,
                mode: self.mode,
                crashed: aircraft.condition == Condition::Crashed,
                track_ended,
            },
            rate: self.clock.rate(),
            slowed_s: self.clock.slowed_s(),
            track_m: self.track_m,
            jumps: self.jumps,
            bodies: self.listed(&self.views.bodies, &self.bodies, Self::body_view),
            projectiles: self.listed(&self.views.shells, &self.shells, Self::shell_view),
            targets: self.listed(&self.views.targets, &self.targets, Self::target_view),
            loose: self.loose_views(),
            weapons: self.page.clone(),
            events: self.recent_events(),
            events_counted: self.log.counted,
            events_chain: self.log.chain,
            instruments: self.instruments(),
            air_data: self.air_data(&aircraft),
        }
    }

    fn air_data(&self, aircraft: &AircraftState) -> AirData {
        let altitude_m = aircraft.position_m.y;
        let air = self.surroundings.atmosphere.at(altitude_m);
        AirData::of(&air, aircraft.airspeed_mps, self.levers.altimeter_pa, altitude_m)
    }

    /// Events since the scene began.
    pub fn events_counted(&self) -> u64 {
        self.log.counted
    }

    /// Events from a number on, of those that are still kept.
    pub fn events_from(&self, number: u64) -> impl Iterator<Item = &Event> {
        self.log.recent.iter().filter(move |event| event.number >= number)
    }

    fn recent_events(&self) -> Arc<[Event]> {
        if self.log.recent.is_empty() { Arc::default() } else { self.log.recent.as_slice().into() }
    }

    fn listed<C: hecs::Component>(
        &self,
        made: &OnceCell<Arc<[EntityView]>>,
        roster: &Roster,
        view: impl Fn(&Self, StableId, &C) -> EntityView,
    ) -> Arc<[EntityView]> {
        if roster.is_empty() {
            return Arc::default();
        }
        let make = || {
            let all = self.ecs.view::<&C>();
            roster.iter().filter_map(|(id, entity)| Some(view(self, *id, all.get(*entity)?))).collect()
        };
        made.get_or_init(make).clone()
    }

    fn body_view(&self, id: StableId, body: &Body) -> EntityView {
        let at = body.carriage(&self.surroundings.planet());
        EntityView {
            id,
            kind: EntityKind::Body,
            of: body.model,
            position_m: at.position_m,
            attitude: at.attitude,
            velocity_mps: at.velocity_mps,
            condition: body.condition(),
            hits: 0,
            damage: Damage::Intact,
            burning: false,
            gear_down: body.is_gear_down(&self.catalogue.models[body.model as usize].thing),
            jumps: body.jumps,
        }
    }

    fn shell_view(&self, id: StableId, shell: &Shell) -> EntityView {
        let velocity_mps = shell.velocity_mps();
        EntityView {
            id,
            kind: EntityKind::Projectile,
            of: shell.kind,
            position_m: shell.position_m(),
            attitude: velocity_mps
                .try_normalize()
                .map_or(DQuat::IDENTITY, |way| DQuat::from_rotation_arc(DVec3::X, way)),
            velocity_mps,
            condition: Condition::Flying,
            hits: 0,
            damage: Damage::Intact,
            burning: shell.load.is_some_and(|load| {
                let weapon = &self.catalogue.weapons[load.weapon as usize].thing;
                weapon.is_tracer(shell.round) || weapon.burns_at(shell.age_s)
            }),
            gear_down: true,
            jumps: shell.jumps,
        }
    }

    fn target_view(&self, id: StableId, target: &TargetState) -> EntityView {
        EntityView {
            id,
            kind: EntityKind::Target,
            of: target.shape,
            position_m: target.position_m,
            attitude: target.attitude,
            velocity_mps: target.velocity_mps,
            condition: Condition::OnGround,
            hits: target.hits,
            damage: target.state(),
            burning: target.state() == Damage::Destroyed
                && target.kind.is_some_and(|kind| self.catalogue.kinds[kind as usize].thing.burns),
            gear_down: true,
            jumps: target.jumps,
        }
    }
}
