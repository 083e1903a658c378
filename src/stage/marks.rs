//! From what happens in a simulated scene to what stays of it on the ground: marks, and craters that the posts can show.
//!
//! A mark is drawn only ([`terrain::block::overlay::decal`]). A crater of a step's radius or more is an edit of the ground: the
//! simulation makes it between two steps ([`sim::run::edited`]), the picture makes the same one here, in the same order, so both
//! have the same posts and the same version. An event is taken once. A scene that is earlier than what was taken is another one:
//! its marks go, the ground keeps its craters.

use crate::output;
use crate::scenery::Scenery;
use glam::{DVec2, DVec3};
use sim::scene::{Event, Happening};
use sim::snapshot::StableId;
use sim::weapons::Damage;
use sim::{Snapshot, scene};
use terrain::block::overlay::Kind;
use terrain::block::overlay::decal::Decal;
use terrain::edit::{Crater, Edit};
use visual::passes::decals::MOST_DECALS;

/// Radius of the earth that a round without a charge throws up, metres.
const ROUND_M: f64 = 0.3;
/// Radius of the ground that a crash burns, and a wreck, metres.
const CRASH_M: f64 = 7.0;
const WRECK_M: f64 = 3.5;
/// Steeper normals than this are of walls: nothing is draped there.
const LEAST_UP: f64 = 0.2;

/// See the module.
#[derive(Debug, Clone, Default)]
pub struct Marks {
    /// Events taken so far: the number of the next.
    taken: u64,
    /// Marks and edits so far, for a device that is made anew.
    decals: Vec<Decal>,
    edits: Vec<Edit>,
}

impl Marks {
    /// Leaves what events tell of, up to a snapshot, on the ground of a scenery.
    pub fn leave(&mut self, events: &[Event], snapshot: &Snapshot, scenery: &mut Scenery) {
        if snapshot.events_counted < self.taken {
            (self.taken, self.decals) = (0, Vec::new());
            scenery.things.clear_decals();
        }
        let from = self.taken;
        let new = || events.iter().filter(|event| event.number >= from);
        let Some(last) = new().map(|event| event.number).max() else { return };
        self.taken = last + 1;
        let ground = scenery.scene_ground();
        let is_land = |of: &Decal| !ground.is_water(of.centre_m.x, of.centre_m.y);
        let mut decals: Vec<Decal> = new().filter_map(|event| decal(event, snapshot)).filter(is_land).collect();
        let craters: Vec<Crater> = new().filter_map(crater).collect();
        // What threw up a crater leaves no mark of its strike beside it.
        let bowls = craters.iter().map(|crater| (crater.centre_m, crater.radius_m));
        let small = decals.iter().filter(|of| of.radius_m > ROUND_M).map(|of| (of.centre_m, of.radius_m));
        let bowls: Vec<(DVec2, f64)> = bowls.chain(small).collect();
        decals.retain(|of| {
            of.radius_m > ROUND_M || bowls.iter().all(|(centre_m, radius_m)| centre_m.distance(of.centre_m) > *radius_m)
        });
        for crater in craters {
            self.edits.push(Edit::Crater(crater));
            edit(scenery, &self.edits[self.edits.len() - 1..]);
        }
        if !decals.is_empty() {
            let over = (self.decals.len() + decals.len()).saturating_sub(MOST_DECALS);
            self.decals.drain(..over.min(self.decals.len()));
            self.decals.extend_from_slice(&decals);
            scenery.things.add_decals(decals);
        }
    }

    /// Leaves all of it on another scenery of the same world.
    pub fn again(&self, scenery: &mut Scenery) {
        self.edits.chunks(1).for_each(|one| edit(scenery, one));
        scenery.things.add_decals(self.decals.clone());
    }
}

/// Makes an edit; the simulation told or refused the same one.
fn edit(scenery: &mut Scenery, edits: &[Edit]) {
    if let Err(why) = scenery.edit_ground(edits) {
        output::tell(format_args!("poligon: no crater: {why}"));
    }
}

/// The crater of an event that the posts can show.
fn crater(event: &Event) -> Option<Crater> {
    sim::run::crater(event)
}

fn plan(at_m: DVec3) -> DVec2 {
    DVec2::new(at_m.x, at_m.z)
}

/// The mark that an event leaves.
fn decal(event: &Event, snapshot: &Snapshot) -> Option<Decal> {
    let mark = |at_m: DVec3, radius_m: f64, kind: Kind| Some(Decal { centre_m: plan(at_m), radius_m, kind });
    match &event.what {
        Happening::Crater { centre_m, radius_m, changes_posts: false, .. } => mark(*centre_m, *radius_m, Kind::Crater),
        Happening::Impact(strike) if is_ground(strike) => mark(strike.point_m, ROUND_M, Kind::Crater),
        Happening::Crash { point_m, normal, reason, .. }
            if *reason != scene::EndReason::Water && normal.y > LEAST_UP =>
        {
            mark(*point_m, CRASH_M, Kind::Scorch)
        }
        Happening::Damage { id, state: Damage::Destroyed, .. } => {
            let wreck = burning(snapshot, *id)?;
            mark(wreck, WRECK_M, Kind::Scorch)
        }
        _ => None,
    }
}

fn is_ground(strike: &scene::Strike) -> bool {
    strike.target.is_none() && strike.object.is_none() && strike.normal.y > LEAST_UP
}

fn burning(snapshot: &Snapshot, id: StableId) -> Option<DVec3> {
    snapshot.targets.iter().find(|target| target.id == id && target.burning).map(|target| target.position_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenery::Look;
    use crate::values::Quality;
    use sim::scene::{Catalogue, Command, SceneGround, Surroundings};
    use sim::weapons::{Aim, Weapon, builtin};
    use sim::{Scene, UtcTime};
    use std::path::Path;
    use std::sync::Arc;
    use visual::capture;

    /// A charge of this mass leaves a crater of some 400 m in plan: two steps of the tiny world.
    const HUGE_KG: f64 = 1e9;

    fn catalogue() -> Arc<Catalogue> {
        let mut all = Catalogue::new();
        builtin::add_all(&mut all).unwrap();
        let text = include_str!("../../assets/weapons/mk82.toml");
        let huge = text.replace("tnt_kg = 95.0", &format!("tnt_kg = {HUGE_KG:e}"));
        assert_ne!(text, huge);
        all.add_weapon("huge", Weapon::from_text(Path::new("huge.toml"), &huge).unwrap()).unwrap();
        Arc::new(all)
    }

    /// Drops a bomb and lets its marks be left; steps until the ground is another, or all are down.
    fn drop(weapon: &str, rounds: u32, scenery: &mut Scenery) -> (Scene, SceneGround, Marks) {
        let start = sim::aircraft::AircraftState::level(DVec3::new(0.0, 3_000.0, 1_000.0), 0.0, 150.0);
        let date = UtcTime::parse("2026-06-21T06:00:00Z").unwrap();
        let mut scene = Scene::furnished(start, date, 120, Surroundings::default(), catalogue()).unwrap();
        let (own, weapon) = (scene.own_id(), weapon.to_owned());
        let aim = Aim::Nearest;
        for command in [
            Command::Load { owner: own, weapon: weapon.clone(), rounds, at_m: DVec3::Z },
            Command::Arm { owner: own, master: true, weapon: Some(weapon.clone()), fuze: None },
            Command::Release { owner: own, weapon, rounds, together: 1, interval_s: 0.5, aim },
        ] {
            scene.order(command).unwrap();
        }
        let (mut ground, mut marks) = (scenery.scene_ground(), Marks::default());
        for _ in 0..120 * 60 {
            let snapshot = sim::advance(&mut scene, &mut ground);
            marks.leave(&snapshot.events, &snapshot, scenery);
        }
        (scene, ground, marks)
    }

    #[test]
    fn bombs_leave_marks_and_a_huge_one_another_ground_that_the_next_step_meets() {
        let Ok(gpu) = visual::Gpu::headless() else {
            println!("skipped: no adapter");
            return;
        };
        let world = Arc::new(crate::bench::tests::tiny_world());
        let look = Look { size_px: [64, 64], ..Look::preset(Quality::Standard) };
        let mut scenery = Scenery::new(gpu, capture::FORMAT, world, look);
        let before = scenery.scene_ground();
        let (scene, _, marks) = drop("mk82", 3, &mut scenery);
        assert_eq!((marks.edits.len(), scenery.things.decals()), (0, 3), "three small craters");
        assert_eq!(scene.snapshot().ground_version, 0);

        let (scene, after, marks) = drop("huge", 1, &mut scenery);
        assert_eq!((marks.edits.len(), after.version(), scene.snapshot().ground_version), (1, 1, 1));
        // The picture has the very ground that the simulation made for itself; so has one on a device made anew.
        let mut anew = Scenery::new(scenery.gpu.clone(), capture::FORMAT, scenery.world.clone(), look);
        marks.again(&mut anew);
        for shown in [&scenery, &anew] {
            let area = shown.scene_ground();
            assert_eq!(area.version(), 1);
            for z_m in (-3_000..3_000).step_by(170).map(f64::from) {
                assert_eq!(area.height_m(30.0, z_m), after.height_m(30.0, z_m), "{z_m}");
            }
        }
        let changes_m = (-3_000..3_000).step_by(50).map(f64::from).map(|z_m| {
            let height = |ground: &SceneGround| ground.height_m(0.0, z_m).unwrap_or(0.0);
            height(&after) - height(&before)
        });
        let deepest_m = changes_m.fold(0.0, f64::min);
        assert!(deepest_m < -50.0, "a crater: {deepest_m}");
        assert_eq!(scenery.things.decals(), 3, "a crater of the posts is no mark");
        // Another scene takes the marks of the one before away.
        let start = sim::aircraft::AircraftState::level(DVec3::Y * 3_000.0, 0.0, 150.0);
        let fresh = Scene::new(start, UtcTime { unix_ns: 0 }).snapshot();
        Marks { taken: 5, ..marks }.leave(&fresh.events, &fresh, &mut scenery);
        assert_eq!(scenery.things.decals(), 0);
    }
}
