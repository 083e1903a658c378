//! Loose things: what can be knocked over, and debris. They lie on the ground by the physics engine.
//!
//! | file | what |
//! |---|---|
//! | `kind.rs`, `piece.rs` | what there is, and one as it is |
//! | `window.rs` | squares of the ground for the engine |
//! | `engine.rs`, `step.rs` | the engine's step; all of them, with the exact ground's last word |
//! | `burst.rs` | pushes of bursts, parts of what breaks |
//!
//! Vehicles and bodies push them as kinematic bodies of their own shapes and feel nothing of it, nor do targets; shells fly
//! through them. They meet buildings by their middle alone. A vehicle stands and drives by the exact ground
//! ([`crate::scene`]), not by the engine: the engine's vehicle with locked brakes creeps.
//!
//! World frame, SI. Invariants others rely on: things are in the order of their ids, at most [`MOST_LOOSE`]; what comes next
//! depends on the things alone, not on windows or anything else that is kept.

mod burst;
mod engine;
mod kind;
mod piece;
mod step;
mod window;

#[cfg(test)]
mod tests;

pub use burst::push_mps;
pub use kind::LooseKind;
pub use piece::{MOST_MPS, MOST_RADPS, Phase, Piece};
pub use step::Around;
pub use window::{Middle, WINDOW_CELLS, Window, middle_for};

pub(crate) use burst::{Broken, PARTS_OF_AIRCRAFT, parts_of};

use crate::random::Stream;
use crate::scene::SceneGround;
use crate::scene::codec::coded;
use crate::snapshot::StableId;
use glam::{DQuat, DVec3};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::Pose;
use window::Windows;

/// Most loose things of a scene. Where debris would be more, the oldest debris that rests goes first.
pub const MOST_LOOSE: usize = 512;

/// Ids of loose things count from here: no other entity's comes so far, and what lies about changes no other's id, so not
/// the luck of a shot either.
pub const FIRST_ID: u64 = 1 << 60;

/// What happened to loose things so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Times that one was put back on the ground or before a wall that it would have passed.
    pub put_back: u64,
    /// Pieces of debris that went to make room.
    pub forgotten: u64,
    /// Ids given.
    pub named: u64,
}
coded!(Counts { put_back, forgotten, named });

/// Something with a course of its own that pushes, or stands in the way.
#[derive(Debug, Clone)]
pub struct Mover {
    /// Its shape.
    pub shape: SharedShape,
    /// Its reference point.
    pub position_m: DVec3,
    /// Its axes to the world's.
    pub attitude: DQuat,
    /// Velocity.
    pub velocity_mps: DVec3,
    /// Turn about the world's axes.
    pub rates_radps: DVec3,
    /// Of the ball about its reference point.
    pub radius_m: f64,
}

impl Mover {
    /// Speed of its fastest point at most.
    fn speed_mps(&self) -> f64 {
        self.velocity_mps.length() + self.rates_radps.length() * self.radius_m
    }

    /// Whether it comes so near to a thing in a step.
    fn comes_near(&self, piece: &Piece, dt_s: f64, near_m: f64) -> bool {
        let reach_m = piece.kind.radius_m() + self.speed_mps() * dt_s + near_m;
        let far_m = reach_m + self.radius_m;
        if piece.position_m.distance_squared(self.position_m) > far_m * far_m {
            return false;
        }
        // About the thing, so that numbers stay small.
        let pose = Pose::from_parts(self.position_m - piece.position_m, self.attitude);
        self.shape.distance_to_point(&pose, DVec3::ZERO, true) < reach_m
    }
}

/// The loose things of a scene.
#[derive(Debug, Default)]
pub struct Loose {
    pieces: Vec<(StableId, Piece)>,
    /// What happened so far.
    pub counts: Counts,
    windows: Windows,
}

impl Loose {
    /// Those of a saved scene, in the order of their ids.
    pub fn of(pieces: Vec<(StableId, Piece)>, counts: Counts) -> Self {
        Self { pieces, counts, windows: Windows::default() }
    }

    /// All, by id.
    pub fn pieces(&self) -> &[(StableId, Piece)] {
        &self.pieces
    }

    /// Whether any moves.
    pub fn any_moves(&self) -> bool {
        self.pieces.iter().any(|(_, piece)| piece.moves())
    }

    /// The box that holds all, metres; `None` without any.
    pub fn bounds_m(&self) -> Option<(DVec3, DVec3)> {
        let boxes = self.pieces.iter().map(|(_, piece)| {
            let reach = DVec3::splat(piece.kind.radius_m());
            (piece.position_m - reach, piece.position_m + reach)
        });
        boxes.reduce(|(low, high), (a, b)| (low.min(a), high.max(b)))
    }

    /// Adds one; its id must be above all so far. Whether there was room for it.
    pub fn add(&mut self, id: StableId, piece: Piece) -> bool {
        if self.pieces.len() >= MOST_LOOSE {
            let debris = |piece: &Piece| piece.kind.is_debris();
            let resting = self.pieces.iter().position(|(_, piece)| debris(piece) && !piece.moves());
            let Some(oldest) = resting.or_else(|| self.pieces.iter().position(|(_, piece)| debris(piece))) else {
                return false;
            };
            self.pieces.remove(oldest);
            self.counts.forgotten += 1;
        }
        self.pieces.push((id, piece));
        true
    }

    /// Adds one under the next id; `None` if there was no room for it.
    pub fn put(&mut self, piece: Piece) -> Option<StableId> {
        let id = StableId(FIRST_ID + self.counts.named);
        self.add(id, piece).then(|| {
            self.counts.named += 1;
            id
        })
    }

    /// Pushes all that a burst of so many kg of TNT reaches; what is random follows from the keys and each one's id.
    pub fn blow(&mut self, point_m: DVec3, tnt_kg: f64, keys: [u64; 3]) -> bool {
        let [seed, projectile, what] = keys;
        self.pieces.iter_mut().fold(false, |any, (id, piece)| {
            any | burst::blow(piece, point_m, tnt_kg, &mut Stream::new(&[seed, id.0, projectile, what]))
        })
    }
}

/// Stands a thing on the ground as it was put: upright, or flat on a slope. So far above the ground it is let go there.
pub(crate) fn stand(piece: &mut Piece, ground: &SceneGround, over_m: f64) {
    // Its foot as it stands, however it leans: standing anew where nothing changed moves nothing.
    let leans = piece.attitude * DVec3::Y;
    let foot_m = piece.position_m - leans * piece.kind.half_m().y;
    let (x_m, z_m) = (foot_m.x, foot_m.z);
    let Some(ground_m) = ground.height_m(x_m, z_m) else { return };
    let normal = ground.normal(x_m, z_m).filter(|_| !piece.kind.stands_upright() && over_m == 0.0);
    let up = normal.unwrap_or(DVec3::Y);
    // Level first: what stood on one slope may stand on another later.
    let forward = DQuat::from_rotation_arc(leans, DVec3::Y) * (piece.attitude * DVec3::NEG_Z);
    let level = DQuat::from_rotation_y((-forward.x).atan2(-forward.z));
    piece.attitude = (DQuat::from_rotation_arc(DVec3::Y, up) * level).normalize();
    piece.position_m = DVec3::new(x_m, ground_m + over_m, z_m) + up * piece.kind.half_m().y;
    if over_m > 0.0 {
        piece.wake();
    }
}
