//! What loose things cost a step: fifty that move, and two hundred that rest.
//!
//! The fifty's yardstick is the same engine with the same things on the same window, its world kept from step to step: how
//! much it costs to make the world anew each step. That of those that rest is the same scene without them.

use super::OWN;
use super::entities::{self, HZ, Kinds};
use crate::bench::statistics::{Against, Better, beside};
use crate::failure::Failure;
use crate::report::BenchResult;
use glam::{DQuat, DVec2, DVec3};
use rapier3d::parry::shape::SharedShape;
use rapier3d::prelude::{ColliderBuilder, PhysicsWorld, RigidBodyBuilder};
use sim::loose::{Around, Loose, LooseKind, Phase, Piece, Window, middle_for};
use sim::scene::{LooseStart, Scene, SceneGround};
use sim::snapshot::StableId;
use std::time::Instant;
use terrain::Area;

/// Things that move, for how many steps after they were thrown, and how fast.
const MOVING: u32 = 50;
const STEPS: u32 = 40;
const THROWN_MPS: f64 = 4.0;
/// Things that rest, and lorries that drive among them.
const RESTING: u32 = 200;
const LORRIES: usize = 20;
const ASIDE_M: DVec2 = DVec2::splat(150.0);
const GRAVITY_MPS2: f64 = 9.81;

/// What the rounds told so far, nanoseconds a step.
pub struct Lying {
    ground: SceneGround,
    thrown: Vec<Piece>,
    window: Window,
    scenes: [Scene; 2],
    ns: [[Vec<f64>; 2]; 2],
}

impl Lying {
    /// On a world's ground.
    ///
    /// # Errors
    /// [`Failure::Failed`] if a built-in scene cannot be made.
    pub fn new(area: &Area) -> Result<Self, Failure> {
        let ground: SceneGround = area.clone().into();
        let lorries = Kinds { bodies: false, shells: false, targets: true };
        let mut without = entities::scene(&ground, &entities::catalogue()?, lorries, LORRIES)?;
        let mut with = entities::scene(&ground, &entities::catalogue()?, lorries, LORRIES)?;
        for number in 0..RESTING {
            let (column, row) = (f64::from(number % 20), f64::from(number / 20));
            // Beside the lorries' ways, not on them.
            let plan_m = DVec2::new(column / 20.0 - 0.5, row / 10.0 - 0.5) * entities::SIDE_M + ASIDE_M;
            let kind = LooseKind::ALL[number as usize % 4];
            let start = LooseStart { kind, plan_m, over_ground_m: 0.0, attitude: DQuat::IDENTITY };
            with.add_loose(&start).map_err(entities::failed)?;
        }
        // The first step puts all on the ground.
        with.step(&ground);
        without.step(&ground);
        let [there, moving] = with.loose_counts();
        if (there, moving) != (RESTING as usize, 0) {
            return Err(entities::failed(format_args!(
                "expected {RESTING} things at rest, found {there}, {moving} moving"
            )));
        }
        let thrown = thrown(&ground);
        let window = Window::new(&ground, middle_for(&ground, 0.0, 0.0));
        Ok(Self { thrown, window, scenes: [with, without], ground, ns: Default::default() })
    }

    /// One round.
    pub fn round(&mut self, steps: u32) {
        let [moving, resting] = &mut self.ns;
        moving[0].push(ours_ns(&self.thrown, &self.ground));
        moving[1].push(kept_ns(&self.thrown, &self.window));
        for (scene, ns) in self.scenes.iter_mut().zip(resting) {
            let start = Instant::now();
            (0..10 * steps).for_each(|_| scene.step(&self.ground));
            ns.push(start.elapsed().as_secs_f64() * 1e9 / f64::from(10 * steps));
        }
    }

    /// Forgets the rounds so far.
    pub fn forget(&mut self) {
        self.ns = Default::default();
    }

    /// What the rounds told.
    pub fn results(&self) -> [BenchResult; 2] {
        let [moving, resting] = &self.ns;
        let kept = Against { name: "rapier3d, its world kept", version: "0.36.1", values: &moving[1] };
        let without = Against { name: "the same scene without them", version: OWN, values: &resting[1] };
        [
            beside(
                "loose, 50 that move, step",
                "ns",
                Better::Less,
                &moving[0],
                kept,
                "thrown at 4 m/s, a third of a second; ours makes the engine's world anew each step and sweeps each path",
            ),
            beside(
                "loose, 200 at rest, step",
                "ns",
                Better::Less,
                &resting[0],
                without,
                "a whole step of a scene with 20 driving lorries among them",
            ),
        ]
    }
}

/// Things close above the ground about the origin, each on its way.
fn thrown(ground: &SceneGround) -> Vec<Piece> {
    (0..MOVING)
        .map(|number| {
            let (x_m, z_m) = (f64::from(number % 10) * 1.6, f64::from(number / 10) * 1.6);
            let angle = f64::from(number);
            Piece {
                kind: LooseKind::ALL[number as usize % 9],
                position_m: DVec3::new(x_m, ground.height_m(x_m, z_m).unwrap_or(0.0) + 1.6, z_m),
                attitude: DQuat::from_rotation_x(angle),
                velocity_mps: DVec3::new(angle.cos(), -0.5, angle.sin()) * THROWN_MPS,
                rates_radps: DVec3::ZERO,
                phase: Phase::Moves(0.0),
            }
        })
        .collect()
}

fn ours_ns(thrown: &[Piece], ground: &SceneGround) -> f64 {
    let mut loose = Loose::default();
    for (number, piece) in thrown.iter().enumerate() {
        loose.add(StableId(number as u64), *piece);
    }
    let around = Around { ground, movers: &[], gravity_mps2: GRAVITY_MPS2, dt_s: 1.0 / f64::from(HZ) };
    let start = Instant::now();
    (0..STEPS).for_each(|_| drop(loose.step(&around)));
    start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS)
}

fn kept_ns(thrown: &[Piece], window: &Window) -> f64 {
    let mut world = PhysicsWorld::new();
    world.gravity = DVec3::Y * -GRAVITY_MPS2;
    world.integration_parameters.dt = 1.0 / f64::from(HZ);
    if let Some(field) = &window.field {
        world.insert_collider(ColliderBuilder::new(SharedShape(field.clone())), None);
    }
    let origin_m = DVec3::new(window.middle_m.x, 0.0, window.middle_m.y);
    for piece in thrown {
        let pose = rapier3d::prelude::Pose::from_parts(piece.position_m - origin_m, piece.attitude);
        let body = RigidBodyBuilder::dynamic().pose(pose).linvel(piece.velocity_mps);
        world.insert(body, ColliderBuilder::new(piece.kind.collider()).mass(piece.kind.mass_kg()));
    }
    let start = Instant::now();
    (0..STEPS).for_each(|_| world.step());
    start.elapsed().as_secs_f64() * 1e9 / f64::from(STEPS)
}
