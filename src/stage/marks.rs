//! From what happens in a simulated scene to what stays of it on the ground: marks, and craters that the posts can show.
//!
//! A mark is drawn only ([`terrain::block::overlay::decal`]); a crater of a step's radius or more is an edit of the ground, which
//! physics meets from the next step on. An event is taken once. A scene that is earlier than what was taken is another one:
//! its marks go, the ground keeps its craters.

use crate::output;
use crate::scenery::Scenery;
use glam::{DVec2, DVec3};
use sim::scene::{Event, Happening, SceneGround};
use sim::snapshot::StableId;
use sim::weapons::Damage;
use sim::{Snapshot, scene};
use terrain::block::overlay::Kind;
use terrain::block::overlay::decal::Decal;
use terrain::edit::{Crater, Edit};

/// Radius of the earth that a round without a charge throws up, metres.
const ROUND_M: f64 = 0.3;
/// Radius of the ground that a crash burns, and a wreck, metres.
const CRASH_M: f64 = 7.0;
const WRECK_M: f64 = 3.5;
/// Steeper normals than this are of walls: nothing is draped there.
const LEAST_UP: f64 = 0.2;

/// See the module.
#[derive(Debug, Clone, Copy, Default)]
pub struct Marks {
    /// Events taken so far: the number of the next.
    taken: u64,
}

impl Marks {
    /// Leaves what a snapshot tells of on the ground of a scenery; the new ground if it is another.
    pub fn leave(&mut self, snapshot: &Snapshot, scenery: &mut Scenery) -> Option<SceneGround> {
        if snapshot.events_counted == self.taken {
            return None;
        }
        if snapshot.events_counted < self.taken {
            *self = Self::default();
            scenery.things.clear_decals();
        }
        let new = || snapshot.events.iter().filter(|event| event.number >= self.taken);
        let ground = scenery.scene_ground();
        let is_land = |of: &Decal| !ground.is_water(of.centre_m.x, of.centre_m.y);
        let decals: Vec<Decal> = new().filter_map(|event| decal(event, snapshot)).filter(is_land).collect();
        let edits: Vec<Edit> = new().filter_map(crater).map(Edit::Crater).collect();
        self.taken = snapshot.events_counted;
        if !decals.is_empty() {
            scenery.things.add_decals(decals);
        }
        if edits.is_empty() {
            return None;
        }
        match scenery.edit_ground(&edits) {
            Ok(changed) if changed.is_empty() => None,
            Ok(_) => Some(scenery.scene_ground()),
            Err(why) => {
                output::tell(format_args!("poligon: no crater: {why}"));
                None
            }
        }
    }
}

/// The crater of an event that the posts can show.
fn crater(event: &Event) -> Option<Crater> {
    match event.what {
        Happening::Crater { centre_m, radius_m, depth_m, changes_posts: true } => {
            Some(Crater { centre_m: plan(centre_m), radius_m, depth_m })
        }
        _ => None,
    }
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
