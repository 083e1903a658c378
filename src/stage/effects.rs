//! From what happens in a simulated scene to the particles that show it: tracers, dust, explosions.
//!
//! Events stay in snapshots for half a second, a cloud of dust for longer: what began is remembered by its time, and shown
//! as a function of the scene's time, so a pause holds it and a step back in time takes back what had not begun.

use glam::DVec3;
use sim::Snapshot;
use sim::scene::{EndReason, Event, Happening, SceneGround};
use sim::snapshot::StableId;
use std::collections::BTreeMap;
use visual::particles::{Emitter, EmitterKind};

/// Longest that anything is remembered, scene seconds: an explosion's smoke.
const KEPT_S: f64 = 9.0;
/// Most emitters kept; the youngest are.
const MOST_KEPT: usize = 512;
/// Radius of a tracer's glow, metres.
const TRACER_M: f32 = 0.22;
/// Radius of the dust of a round on the ground, and of the spark of one on a thing, metres.
const DUST_M: f32 = 2.2;
const SPARK_M: f32 = 0.5;
/// Half the width of the water that a round throws up, metres.
const SPLASH_M: f32 = 0.7;
/// Radius of a crash's burst, metres.
const CRASH_M: f32 = 9.0;
/// Radius of the fireball of a kilogram of TNT, metres; it grows with the cube root of the charge (B. Hopkinson 1915). A
/// hot ball of gases of 1.5 to 2 m is common for bare charges of 1 kg (from memory).
const FIREBALL_M: f64 = 1.75;
/// Radius of the smoke and fire of a wreck, metres.
const WRECK_M: f32 = 1.6;

/// See the module.
#[derive(Debug, Default)]
pub struct Effects {
    /// Events taken so far: the number of the next.
    taken: u64,
    kept: Vec<Emitter>,
    /// Since when each wreck burns, scene seconds.
    burning: BTreeMap<StableId, f64>,
}

impl Effects {
    /// What a snapshot shows over its ground.
    pub fn of(&mut self, snapshot: &Snapshot, ground: &SceneGround) -> Vec<Emitter> {
        if snapshot.events_counted < self.taken {
            *self = Self::default();
        }
        for event in snapshot.events.iter().filter(|event| event.number >= self.taken) {
            self.kept.extend(begun(event, ground));
        }
        self.taken = snapshot.events_counted;
        let now_s = snapshot.time_s;
        self.kept.retain(|one| one.born_s <= now_s + 1.0 && one.born_s >= now_s - KEPT_S);
        let over = self.kept.len().saturating_sub(MOST_KEPT);
        self.kept.drain(..over);
        let lit = snapshot.projectiles.iter().filter(|one| one.burning);
        let tracers = lit.map(|shell| Emitter {
            kind: EmitterKind::Tracer,
            born_s: now_s,
            position_m: shell.position_m,
            velocity_mps: shell.velocity_mps,
            size_m: TRACER_M,
        });
        let mut all: Vec<Emitter> = self.kept.iter().copied().chain(tracers).collect();
        self.wrecks(snapshot, &mut all);
        all
    }

    /// Fire and smoke of what was destroyed and burns.
    fn wrecks(&mut self, snapshot: &Snapshot, all: &mut Vec<Emitter>) {
        let now_s = snapshot.time_s;
        let burning = || snapshot.targets.iter().filter(|target| target.burning);
        self.burning.retain(|id, since_s| *since_s <= now_s && burning().any(|target| target.id == *id));
        for target in burning() {
            let born_s = *self.burning.entry(target.id).or_insert(now_s);
            for kind in [EmitterKind::Fire, EmitterKind::Smoke] {
                let position_m = target.position_m;
                all.push(Emitter { kind, born_s, position_m, velocity_mps: DVec3::ZERO, size_m: WRECK_M });
            }
        }
    }
}

fn begun(event: &Event, ground: &SceneGround) -> Option<Emitter> {
    let is_water = |at_m: &DVec3| ground.is_water(at_m.x, at_m.z);
    let (kind, position_m, size_m) = match &event.what {
        Happening::Impact(strike) if strike.target.is_some() || strike.object.is_some() => {
            (EmitterKind::Explosion, strike.point_m, SPARK_M)
        }
        Happening::Impact(strike) if is_water(&strike.point_m) => (EmitterKind::Splash, strike.point_m, SPLASH_M),
        Happening::Impact(strike) => (EmitterKind::Dust, strike.point_m, DUST_M),
        Happening::Burst { point_m, tnt_kg, buried, in_air, .. } => {
            let fireball_m = (FIREBALL_M * tnt_kg.max(0.0).cbrt()) as f32;
            let on_water = !in_air && is_water(point_m);
            // A small burst in the ground is earth thrown up, one in water is water.
            let kind = if on_water {
                EmitterKind::Splash
            } else if *buried && *tnt_kg < 0.5 {
                EmitterKind::Dust
            } else {
                EmitterKind::Explosion
            };
            (kind, *point_m, fireball_m.max(SPARK_M))
        }
        Happening::Crash { point_m, reason: EndReason::Water, .. } => (EmitterKind::Splash, *point_m, CRASH_M),
        Happening::Crash { point_m, .. } => (EmitterKind::Explosion, *point_m, CRASH_M),
        _ => return None,
    };
    Some(Emitter { kind, born_s: event.time_s, position_m, velocity_mps: DVec3::ZERO, size_m })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::UtcTime;
    use sim::aircraft::AircraftState;

    #[test]
    fn a_crash_smokes_longer_than_its_event_is_told_and_a_new_scene_forgets_it() {
        let scene = sim::Scene::new(AircraftState::level(DVec3::Y * 3e3, 0.0, 200.0), UtcTime { unix_ns: 0 });
        let quiet = scene.snapshot();
        let crash = Happening::Crash {
            id: StableId(1),
            reason: EndReason::Ground,
            point_m: DVec3::X,
            normal: DVec3::Y,
            velocity_mps: DVec3::ZERO,
        };
        let mut struck = quiet.clone();
        struck.events = vec![Event { number: 0, time_s: 0.0, what: crash }].into();
        struck.events_counted = 1;
        let (mut effects, ground) = (Effects::default(), SceneGround::void());
        assert!(effects.of(&quiet, &ground).is_empty());
        assert_eq!(effects.of(&struck, &ground).len(), 1);
        assert_eq!(effects.of(&struck, &ground).len(), 1, "an event is taken once");
        let mut later = struck.clone();
        (later.events, later.time_s) = (Vec::new().into(), 5.0);
        assert_eq!(effects.of(&later, &ground)[0].kind, EmitterKind::Explosion);
        later.time_s = 20.0;
        assert!(effects.of(&later, &ground).is_empty());
        assert!(effects.of(&quiet, &ground).is_empty());
    }
}
