//! A proving ground for tests of scenes: hills, a stable little aircraft, shells, a rocket, targets, guns.

// Each test binary uses a part of it.
#![allow(dead_code)]

use glam::{DQuat, DVec2, DVec3};
use sim::aircraft::AircraftState;
use sim::ballistics::projectile::Projectile;
use sim::ballistics::shape::Shape;
use sim::rigid::Model;
use sim::scene::{
    BodyStart, Catalogue, Command, Failure, Fuel, FuelChange, Muzzle, Scene, SceneGround, Stamped, Surroundings,
    TargetStart,
};
use sim::snapshot::StableId;
use sim::{Controls, UtcTime};
use std::path::Path;
use std::sync::Arc;
use terrain::{Grid, Ground, synthetic};

/// Seed of the scenario.
pub const SEED: u64 = 20_261_124;

/// A light aircraft in a few derivatives: stable, damped, with a throttle and two surfaces.
pub const LIGHT: &str = r#"
[body]
mass_kg = 1000.0
inertia_kgm2 = [[1300.0, 0.0, 0.0], [0.0, 1800.0, 0.0], [0.0, 0.0, 2700.0]]
[reference]
area_m2 = 16.0
span_m = 11.0
chord_m = 1.5
[controls]
aileron_norm = { min = -1.0, max = 1.0 }
elevator_norm = { min = -1.0, max = 1.0 }
throttle_norm = { min = 0.0, max = 1.0, initial = 0.6 }
[[aero.term]]
to = "CD"
value = 0.03
[[aero.term]]
to = "CL"
value = 0.3
[[aero.term]]
to = "CL"
value = 5.0
times = ["alpha_rad"]
[[aero.term]]
to = "CY"
value = -0.4
times = ["beta_rad"]
[[aero.term]]
to = "Cm"
value = -0.9
times = ["alpha_rad"]
[[aero.term]]
to = "Cm"
value = -12.0
times = ["q_hat"]
[[aero.term]]
to = "Cm"
value = -0.3
times = ["elevator_norm"]
[[aero.term]]
to = "Cl"
value = -0.45
times = ["p_hat"]
[[aero.term]]
to = "Cl"
value = 0.08
times = ["aileron_norm"]
[[aero.term]]
to = "Cn"
value = 0.07
times = ["beta_rad"]
[[aero.term]]
to = "Cn"
value = -0.12
times = ["r_hat"]
[[thrust]]
force_N = [3000.0, 0.0, 0.0]
times = ["throttle_norm"]
"#;

pub fn catalogue() -> Arc<Catalogue> {
    let mut all = Catalogue::new();
    all.add_model("light", Model::from_text(Path::new("light.toml"), LIGHT).unwrap()).unwrap();
    let projectile = |text: &str| Projectile::from_text(Path::new("p.toml"), text).unwrap();
    let shell = "mass_kg = 0.36\ndiameter_m = 0.03\ndrag = \"G1\"\nform_factor = 1.0";
    all.add_projectile("shell", projectile(shell)).unwrap();
    let rocket = "mass_kg = 10.0\ndiameter_m = 0.07\ndrag = \"G1\"\nform_factor = 1.0\nburn = [[0.05, 0.0], [0.06, 4000.0], [0.9, 4000.0], [0.91, 0.0]]";
    all.add_projectile("rocket", projectile(rocket)).unwrap();
    all.add_shape("tank", Shape::block(DVec3::new(1.7, 1.2, 3.5)).unwrap()).unwrap();
    all.add_shape("ball", Shape::sphere(3.0).unwrap()).unwrap();
    Arc::new(all)
}

/// Mountains of 12 x 12 km.
pub fn mountains() -> SceneGround {
    let field = synthetic::ridges(Grid::centred(200.0, 2, 2).unwrap(), 7);
    Ground::new(Arc::new(field)).whole().into()
}

/// A level plain at sea level, 12 x 12 km.
pub fn plain() -> SceneGround {
    Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 2, 2).unwrap(), 0.0))).whole().into()
}

pub fn surroundings() -> Surroundings {
    let mut around = Surroundings::over(0.74).unwrap();
    (around.turbulence_mps, around.seed) = (1.5, SEED);
    around
}

/// A scene with the own aircraft alone, 120 steps a second.
pub fn empty(around: Surroundings) -> Scene {
    let start = AircraftState::level(DVec3::new(0.0, 6_000.0, 0.0), 0.3, 180.0);
    Scene::furnished(start, UtcTime::parse("2026-06-21T06:00:00Z").unwrap(), 120, around, catalogue()).unwrap()
}

/// Level flight north at 60 m/s.
pub fn light(position_m: DVec3) -> BodyStart {
    BodyStart {
        model: "light".to_owned(),
        position_m,
        velocity_mps: DVec3::NEG_Z * 60.0,
        attitude: sim::frame::attitude(sim::frame::Angles::default()),
        rates_radps: DVec3::ZERO,
        fuel: Some(Fuel { fuel_kg: 100.0, flow_kgps: 0.05 }),
    }
}

pub fn fire(owner: StableId, projectile: &str, muzzle: Muzzle, rounds: u32, per_minute: f64) -> Command {
    Command::Fire { owner, projectile: projectile.to_owned(), muzzle, rounds, per_minute }
}

/// A gun with spread, ahead and a little down.
pub fn gun() -> Muzzle {
    Muzzle {
        offset_m: DVec3::new(3.0, 0.5, 0.2),
        direction: DVec3::new(1.0, 0.0, 0.15),
        sigma_rad: 0.003,
        speed_sigma_mps: 4.0,
        ..Muzzle::ahead(850.0)
    }
}

/// A busy scene: three bodies, targets that stand and drive, and everything that can be ordered, still to come.
pub fn busy() -> Scene {
    let mut scene = empty(surroundings());
    for x_m in [-900.0, 0.0, 900.0] {
        scene.add_body(&light(DVec3::new(x_m, 5_600.0, 100.0))).unwrap();
    }
    for i in 0..6 {
        let at = DVec2::new(-1_500.0 + 500.0 * f64::from(i), -900.0);
        let route_m =
            if i % 2 == 0 { vec![at + DVec2::new(40.0, 0.0), at + DVec2::new(40.0, 60.0)] } else { Vec::new() };
        let start = TargetStart { route_m, speed_mps: 12.0, loops: i == 4, ..TargetStart::standing("tank", at) };
        scene.add_target(&start).unwrap();
    }
    let (own, first, second, tank) = (scene.own_id(), StableId(2), StableId(3), StableId(5));
    let up = Muzzle { direction: DVec3::new(0.0, 1.0, -1.0), ..gun() };
    let name = "jam".to_owned();
    let orders = [
        (0, fire(own, "shell", gun(), 400, 3_000.0)),
        (0, fire(tank, "shell", up, 200, 600.0)),
        (3, Command::Controls(Controls { pitch: 0.2, roll: 0.3, yaw: 0.0, throttle: 0.7 })),
        (10, Command::Control { id: first, control: "aileron_norm".to_owned(), value: 0.1 }),
        (20, fire(first, "rocket", Muzzle::ahead(30.0), 4, 300.0)),
        (
            40,
            Command::Fail { id: first, name, failure: Failure::ControlStuck("aileron_norm".to_owned()), in_steps: 25 },
        ),
        (45, Command::Wind(vec![(0.0, DVec3::new(3.0, -8.0, 0.0)), (9_000.0, DVec3::new(20.0, 5.0, 0.0))])),
        (60, Command::Fail { id: second, name: "hole".to_owned(), failure: Failure::FuelLeak(30.0), in_steps: 0 }),
        (70, Command::Control { id: first, control: "aileron_norm".to_owned(), value: -0.2 }),
        (90, Command::Turbulence(4.0)),
        (100, Command::Fuel { id: StableId(4), change: FuelChange::Consume(20.0) }),
        (140, Command::Clear { id: first, name: "jam".to_owned() }),
        (
            150,
            Command::Reposition {
                id: StableId(4),
                position_m: DVec3::new(800.0, 6_000.0, 0.0),
                velocity_mps: DVec3::X * 70.0,
                attitude: sim::frame::attitude(sim::frame::Angles { heading_rad: 1.5, ..Default::default() }),
            },
        ),
        (200, Command::CeaseFire { owner: tank }),
        (
            210,
            Command::Reposition {
                id: StableId(6),
                position_m: DVec3::new(0.0, 3_000.0, 0.0),
                velocity_mps: DVec3::ZERO,
                attitude: DQuat::IDENTITY,
            },
        ),
    ];
    for (step, command) in orders {
        scene.schedule(Stamped { step, command }).unwrap();
    }
    scene
}
