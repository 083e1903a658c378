//! What lies about in a scene: who pushes it, and what becomes debris.
//!
//! Targets and rigid bodies push loose things and stand in their way; the own aircraft does where it is a body. A target's
//! shape is what shells strike, a body's its contacts: a ball about each wheel, a rod from its middle to each part. What is
//! destroyed or crashes leaves debris. World frame, SI.
//!
//! Invariant others rely on: without a loose thing a step costs one look at an empty list; debris depends on the seed, the
//! thing that broke and the projectile, or for a crash the step, alone.

use super::body::Body;
use super::effects::Ended;
use super::event::Happening;
use super::target::TargetState;
use super::view::{EntityKind, EntityView};
use super::{Freeze, GroundTouch, Refused, Scene, SceneGround, attitude, found, place};
use crate::aircraft::Condition;
use crate::ballistics::shape::Shape;
use crate::ballistics::targets::{Pose, Target};
use crate::loose::{Around, Broken, LooseKind, MOST_LOOSE, Mover, PARTS_OF_AIRCRAFT, Phase, Piece, parts_of};
use crate::random::Stream;
use crate::rigid::Model;
use crate::rigid::gear::Part;
use crate::snapshot::StableId;
use crate::weapons::Damage;
use crate::weapons::target_kind::StandOn;
use glam::{DQuat, DVec2, DVec3};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::Pose as EnginePose;
use std::sync::Arc;

/// Keys of streams beside seed, thing and projectile: no turbulence, round or damage has them.
const KEY_BLAST: u64 = u64::MAX - 2;
const KEY_DEBRIS: u64 = u64::MAX - 3;
/// Radius of the rods that stand for a body's wings, nose and tail, metres.
const ROD_M: f64 = 0.3;
/// Highest that something may be put over the ground, metres.
const MOST_OVER_M: f64 = 1_000.0;

/// A loose thing to be put somewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LooseStart {
    /// What it is.
    pub kind: LooseKind,
    /// Plan position (x, z), metres.
    pub plan_m: DVec2,
    /// Height of its foot over the ground, metres: at 0 it stands until something strikes it, above that it is let go.
    pub over_ground_m: f64,
    /// Which way it faces; it stands upright, or flat on a slope.
    pub attitude: DQuat,
}

impl Scene {
    /// Puts a loose thing somewhere.
    ///
    /// # Errors
    /// [`Refused`] if a number is none or there are too many.
    pub fn add_loose(&mut self, start: &LooseStart) -> Result<StableId, Refused> {
        let over_m = start.over_ground_m;
        if !(0.0..=MOST_OVER_M).contains(&over_m) {
            return Err(Refused::new(format_args!("loose.over_ground_m: expected 0..={MOST_OVER_M}, found {over_m}")));
        }
        let piece = Piece {
            kind: start.kind,
            position_m: place("loose.plan_m", DVec3::new(start.plan_m.x, over_m, start.plan_m.y))?,
            attitude: attitude("loose.attitude", start.attitude)?,
            velocity_mps: DVec3::ZERO,
            rates_radps: DVec3::ZERO,
            phase: Phase::Put(over_m),
        };
        let full = || Refused::new(format_args!("loose: expected at most {MOST_LOOSE} things, found one more"));
        let id = self.loose.put(piece).ok_or_else(full)?;
        self.unsettled = true;
        self.views.loose.take();
        Ok(id)
    }

    /// The number of loose things, and how many of them move.
    pub fn loose_counts(&self) -> [usize; 2] {
        let pieces = self.loose.pieces();
        [pieces.len(), pieces.iter().filter(|(_, piece)| piece.moves()).count()]
    }

    pub(super) fn settle_loose(&mut self, ground: &SceneGround) {
        if !self.loose.pieces().is_empty() {
            self.loose.ground_changed(ground);
            self.views.loose.take();
        }
    }

    pub(super) fn step_loose(&mut self, ground: &SceneGround, from_s: f64, dt_s: f64) {
        let Some((low, high)) = self.loose.bounds_m() else { return };
        let any_moves = self.loose.any_moves();
        let movers = self.movers(low, high, any_moves, dt_s);
        if !any_moves && movers.is_empty() {
            return;
        }
        let gravity_mps2 = self.surroundings.planet().gravity_mps2(DVec3::ZERO);
        let gone = self.loose.step(&Around { ground, movers: &movers, gravity_mps2, dt_s });
        for (id, reason) in gone {
            self.log.add(from_s + dt_s, Happening::Lost { id, reason });
        }
        if any_moves || self.loose.any_moves() {
            self.views.loose.take();
        }
    }

    /// Targets and bodies near a box; those that stand still count only where something there moves.
    fn movers(&self, low: DVec3, high: DVec3, and_standing: bool, dt_s: f64) -> Vec<Mover> {
        let near = |at_m: DVec3, radius_m: f64, way_m: f64| {
            let reach = DVec3::splat(radius_m + way_m + 1.0);
            (at_m + reach).cmpge(low).all() && (at_m - reach).cmple(high).all()
        };
        let mut movers = Vec::new();
        for target in &self.swept {
            let moves = target.from != target.to;
            let (from, radius_m) = (target.from.position_m, target.shape.radius_m());
            if (moves || and_standing) && near(from, radius_m, from.distance(target.to.position_m)) {
                movers.push(mover_of(target, dt_s));
            }
        }
        let planet = self.surroundings.planet();
        let bodies = self.ecs.view::<&Body>();
        for body in self.bodies.iter().filter_map(|(_, entity)| bodies.get(*entity)) {
            let at = body.carriage(&planet);
            let moves = body.ended.is_none() && at.velocity_mps != DVec3::ZERO && self.freeze == Freeze::None;
            let model = &self.catalogue.models[body.model as usize].thing;
            let radius_m = reach_m(model);
            if (moves || and_standing) && near(at.position_m, radius_m, at.velocity_mps.length() * dt_s) {
                let still = |rate: DVec3| if moves { rate } else { DVec3::ZERO };
                movers.push(Mover {
                    shape: rods(model),
                    position_m: at.position_m,
                    attitude: at.attitude,
                    velocity_mps: still(at.velocity_mps),
                    rates_radps: still(at.attitude * at.rates_radps),
                    radius_m,
                });
            }
        }
        movers
    }

    /// Lets a burst push what lies about.
    pub(super) fn blow_loose(&mut self, projectile: StableId, point_m: DVec3, tnt_kg: f64) {
        if self.loose.blow(point_m, tnt_kg, [self.surroundings.seed, projectile.0, KEY_BLAST]) {
            self.views.loose.take();
        }
    }

    /// Debris of a target that was destroyed.
    pub(super) fn shatter(&mut self, id: StableId, by: &Ended) {
        let catalogue = self.catalogue.clone();
        let Some((kind, broken)) = found(&self.targets, id).and_then(|entity| {
            let target = self.ecs.get::<&TargetState>(entity).ok()?;
            let kind = &catalogue.kinds[target.kind? as usize].thing;
            Some((kind, (target.pose(), target.velocity_mps)))
        }) else {
            return;
        };
        let tnt_kg = catalogue.weapons[by.load.weapon as usize].thing.warhead.map_or(0.0, |warhead| warhead.tnt_kg);
        let (pose, velocity_mps) = broken;
        let parts = parts_of(kind.armour, kind.stand.on == StandOn::Wheels);
        let broken = Broken { shape: &kind.shape, pose, velocity_mps, parts, point_m: by.point_m, tnt_kg };
        let stream = Stream::new(&[self.surroundings.seed, id.0, by.id.0, KEY_DEBRIS]);
        self.throw(&broken, stream);
    }

    /// Debris of a body that met the ground. It slides on with a part of its speed.
    pub(super) fn strew(&mut self, id: StableId, touch: &GroundTouch) {
        let Some(entity) = found(&self.bodies, id).filter(|_| touch.normal != DVec3::ZERO) else { return };
        let Some((pose, radius_m)) = self.ecs.get::<&Body>(entity).ok().map(|body| {
            let at = body.carriage(&self.surroundings.planet());
            let radius_m = reach_m(&self.catalogue.models[body.model as usize].thing);
            (Pose { position_m: at.position_m, attitude: at.attitude }, radius_m)
        }) else {
            return;
        };
        let Ok(shape) = Shape::sphere(0.4 * radius_m) else { return };
        let along = touch.velocity_mps - touch.normal * touch.velocity_mps.dot(touch.normal);
        let (parts, point_m) = (PARTS_OF_AIRCRAFT, touch.point_m);
        let broken = Broken { shape: &shape, pose, velocity_mps: along * 0.5, parts, point_m, tnt_kg: 0.0 };
        self.throw(&broken, Stream::new(&[self.surroundings.seed, id.0, self.clock.step(), KEY_DEBRIS]));
    }

    fn throw(&mut self, broken: &Broken<'_>, mut stream: Stream) {
        for piece in broken.pieces(&mut stream) {
            // Near the bounds of any world there is no place for it, and what was put there is never taken away for it.
            if piece.is_sound() && place("debris", piece.position_m).is_ok() {
                self.loose.put(piece);
            }
        }
        self.views.loose.take();
    }

    pub(super) fn loose_views(&self) -> Arc<[EntityView]> {
        if self.loose.pieces().is_empty() {
            return Arc::default();
        }
        let view = |(id, piece): &(StableId, Piece)| EntityView {
            id: *id,
            kind: EntityKind::Loose,
            of: piece.kind.number(),
            position_m: piece.position_m,
            attitude: piece.attitude,
            velocity_mps: piece.velocity_mps,
            condition: if piece.moves() { Condition::Flying } else { Condition::OnGround },
            hits: 0,
            damage: Damage::Intact,
            burning: false,
            gear_down: true,
            jumps: 0,
        };
        self.views.loose.get_or_init(|| self.loose.pieces().iter().map(view).collect()).clone()
    }
}

fn mover_of(target: &Target, dt_s: f64) -> Mover {
    let (from, to) = (target.from, target.to);
    let turn = to.attitude * from.attitude.conjugate();
    let turn = if turn.w < 0.0 { -turn } else { turn };
    Mover {
        shape: target.shape.collider(),
        position_m: from.position_m,
        attitude: from.attitude,
        velocity_mps: (to.position_m - from.position_m) / dt_s,
        rates_radps: turn.to_scaled_axis() / dt_s,
        radius_m: target.shape.radius_m(),
    }
}

/// Radius of the ball about a body's middle that holds its rods.
fn reach_m(model: &Model) -> f64 {
    let contacts = model.contacts.iter();
    contacts.map(|one| (one.at_m - model.cg_m).length() + one.radius_m.max(ROD_M)).fold(2.0 * ROD_M, f64::max)
}

/// A body's wheels and parts in its body axes, from its centre of gravity.
fn rods(model: &Model) -> SharedShape {
    let mut shapes = vec![(EnginePose::identity(), SharedShape::ball(2.0 * ROD_M))];
    for one in &model.contacts {
        let at_m = one.at_m - model.cg_m;
        shapes.push(match one.part {
            Part::Wheel => (EnginePose::from_translation(at_m), SharedShape::ball(one.radius_m.max(0.05))),
            // A wing is level with its tip.
            Part::WingTip => {
                let root = DVec3::new(at_m.x, 0.0, at_m.z);
                (EnginePose::identity(), SharedShape::capsule(root, at_m, ROD_M))
            }
            _ => (EnginePose::identity(), SharedShape::capsule(DVec3::ZERO, at_m, ROD_M)),
        });
    }
    SharedShape::compound(shapes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::loose::stand;

    #[test]
    fn a_thing_that_is_put_stands_on_its_foot() {
        let ground = SceneGround::heights(|x_m, _| Some(0.1 * x_m));
        let mut piece = Piece {
            kind: LooseKind::Barrel,
            position_m: DVec3::new(10.0, 0.0, 3.0),
            attitude: DQuat::from_rotation_y(1.0),
            velocity_mps: DVec3::ZERO,
            rates_radps: DVec3::ZERO,
            phase: Phase::Put(0.0),
        };
        stand(&mut piece, &ground, 0.0);
        let normal = DVec3::new(-0.1, 1.0, 0.0).normalize();
        let foot = piece.position_m - normal * LooseKind::Barrel.half_m().y;
        // The slope is taken by differences over a metre of numbers below 2: some roundings of 2^-52.
        assert!(foot.distance(DVec3::new(10.0, 1.0, 3.0)) < 1e-12, "{foot}");
        assert!((piece.attitude * DVec3::Y).distance(normal) < 1e-12);
        // Stood anew a hundred times, as when a world is furnished: it creeps by roundings alone, and keeps its heading.
        let before = piece;
        for _ in 0..100 {
            stand(&mut piece, &ground, 0.0);
        }
        assert!(piece.position_m.distance(before.position_m) < 1e-11, "{}", piece.position_m);
        assert!(piece.attitude.dot(before.attitude).abs() > 1.0 - 1e-12);
        piece.kind = LooseKind::Pole;
        stand(&mut piece, &ground, 0.0);
        assert!((piece.attitude * DVec3::Y).distance(DVec3::Y) < 1e-12);
    }
}
