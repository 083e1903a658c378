//! What one entity of a scene costs a step, among a hundred and among ten thousand.
//!
//! Rigid bodies, shells in the air, and as many of each as of driving targets, spread over 30 km of a world's ground. The
//! yardstick of the many is the cost of one among the few: what is flat has a ratio of 1.

use super::{LIGHT, OWN};
use crate::bench::statistics::{Against, Better, beside};
use crate::failure::Failure;
use crate::report::BenchResult;
use glam::{DQuat, DVec2, DVec3};
use sim::UtcTime;
use sim::aircraft::AircraftState;
use sim::ballistics::projectile::Projectile;
use sim::ballistics::shape::Shape;
use sim::rigid::Model;
use sim::scene::{BodyStart, Catalogue, Command, Muzzle, Scene, SceneGround, Surroundings, TargetStart};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use terrain::Area;

/// How many of a kind.
const FEW: usize = 100;
const MANY: usize = 10_000;
/// Side of the square that they are spread over, metres.
pub(super) const SIDE_M: f64 = 30_000.0;
pub(super) const HZ: u32 = 120;

/// Which kinds are in a scene.
#[derive(Clone, Copy)]
pub(super) struct Kinds {
    pub bodies: bool,
    pub shells: bool,
    pub targets: bool,
}

const SCENES: [(&str, Kinds); 3] = [
    ("entity, rigid body", Kinds { bodies: true, shells: false, targets: false }),
    ("entity, shell", Kinds { bodies: false, shells: true, targets: false }),
    ("entity, shell with a driving target", Kinds { bodies: false, shells: true, targets: true }),
];

/// Scenes of few and of many.
pub struct Scenes {
    ground: SceneGround,
    pairs: Vec<[Scene; 2]>,
    ns: Vec<[Vec<f64>; 2]>,
}

impl Scenes {
    /// Scenes over a world's ground.
    ///
    /// # Errors
    /// [`Failure::Failed`] if a built-in scene cannot be made.
    pub fn new(area: &Area) -> Result<Self, Failure> {
        let catalogue = catalogue()?;
        let ground: SceneGround = area.clone().into();
        let mut pairs = Vec::new();
        for (_, kinds) in SCENES {
            pairs.push([scene(&ground, &catalogue, kinds, FEW)?, scene(&ground, &catalogue, kinds, MANY)?]);
        }
        Ok(Self { ground, ns: pairs.iter().map(|_| Default::default()).collect(), pairs })
    }

    /// One round: steps of few and of many, in turns.
    pub fn round(&mut self, steps_of_many: u32) {
        for (pair, ns) in self.pairs.iter_mut().zip(&mut self.ns) {
            for (scene, (ns, (count, steps))) in
                pair.iter_mut().zip(ns.iter_mut().zip([(FEW, 10 * steps_of_many), (MANY, steps_of_many)]))
            {
                let start = Instant::now();
                (0..steps).for_each(|_| scene.step(&self.ground));
                ns.push(start.elapsed().as_secs_f64() * 1e9 / (f64::from(steps) * count as f64));
            }
        }
    }

    /// Forgets the rounds so far.
    pub fn forget(&mut self) {
        self.ns.iter_mut().flatten().for_each(Vec::clear);
    }

    /// What the rounds told.
    pub fn results(&self) -> impl Iterator<Item = BenchResult> + '_ {
        SCENES.iter().zip(&self.ns).map(|((name, _), [few, many])| {
            let against = Against { name: "the same among 100", version: OWN, values: few };
            beside(name, "ns", Better::Less, many, against, "a step of 10,000 over the ground, one core; flat is 1")
        })
    }
}

pub(super) fn failed(error: impl std::fmt::Display) -> Failure {
    Failure::while_doing("making a built-in scene", error)
}

pub(super) fn catalogue() -> Result<Arc<Catalogue>, Failure> {
    let mut all = Catalogue::new();
    all.add_model("light", Model::from_text(Path::new("light.toml"), LIGHT).map_err(failed)?).map_err(failed)?;
    let shell = "mass_kg = 0.36\ndiameter_m = 0.03\ndrag = \"G1\"\nform_factor = 1.0";
    let shell = Projectile::from_text(Path::new("shell.toml"), shell).map_err(failed)?;
    all.add_projectile("shell", shell).map_err(failed)?;
    all.add_shape("tank", Shape::block(DVec3::new(1.7, 1.2, 3.5)).map_err(failed)?).map_err(failed)?;
    Ok(Arc::new(all))
}

/// A scene of `count` of each kind.
pub(super) fn scene(
    ground: &SceneGround,
    catalogue: &Arc<Catalogue>,
    kinds: Kinds,
    count: usize,
) -> Result<Scene, Failure> {
    let start = AircraftState::level(DVec3::new(0.0, 9_000.0, 0.0), 0.3, 180.0);
    let date = UtcTime::new(2026, 6, 21, 6, 0, 0).ok_or_else(|| failed("a date"))?;
    let around = Surroundings::over(0.74).map_err(failed)?;
    let mut scene = Scene::furnished(start, date, HZ, around, catalogue.clone()).map_err(failed)?;
    let across = (count as f64).sqrt().ceil();
    let place = |i: usize| {
        let (column, row) = (i as f64 % across, (i as f64 / across).floor());
        DVec2::new(column / across - 0.5, row / across - 0.5) * SIDE_M
    };
    let height_m = |at: DVec2| ground.height_m(at.x, at.y).unwrap_or(0.0);
    for i in 0..count {
        let at = place(i);
        if kinds.bodies {
            scene
                .add_body(&BodyStart {
                    model: "light".to_owned(),
                    position_m: DVec3::new(at.x, height_m(at) + 1_500.0, at.y),
                    velocity_mps: DVec3::NEG_Z * 51.4,
                    attitude: sim::frame::attitude(sim::frame::Angles::default()),
                    rates_radps: DVec3::ZERO,
                    fuel: None,
                })
                .map_err(failed)?;
        }
        if kinds.targets {
            let route_m = vec![at + DVec2::new(25.0, 0.0), at + DVec2::new(25.0, 25.0)];
            let target = TargetStart { route_m, speed_mps: 5.0, loops: true, ..TargetStart::standing("tank", at) };
            scene.add_target(&target).map_err(failed)?;
        }
    }
    if kinds.shells {
        let owner = scene.own_id();
        for _ in 0..count {
            let (projectile, muzzle) = ("shell".to_owned(), Muzzle::ahead(850.0));
            scene.order(Command::Fire { owner, projectile, muzzle, rounds: 1, per_minute: 0.0 }).map_err(failed)?;
        }
        scene.step(ground);
        let shells = scene.snapshot().projectiles.clone();
        if shells.len() != count {
            return Err(failed(format_args!("expected {count} shells in the air, found {}", shells.len())));
        }
        for (i, shell) in shells.iter().enumerate() {
            let at = place(i);
            scene
                .order(Command::Reposition {
                    id: shell.id,
                    position_m: DVec3::new(at.x, height_m(at) + 300.0, at.y),
                    velocity_mps: DVec3::new(300.0, 400.0, 300.0),
                    attitude: DQuat::IDENTITY,
                })
                .map_err(failed)?;
        }
    }
    Ok(scene)
}
