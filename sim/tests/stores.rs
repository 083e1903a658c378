//! Stores on a rigid body: what they weigh, where, and how they drag, beside an obvious twin; a lopsided load; jettison.

mod firing_range;

use firing_range::{SEED, arm, load, release, run, scores};
use glam::{DMat3, DVec3};
use sim::aircraft::AircraftState;
use sim::rigid::{Model, builtin};
use sim::scene::{BodyStart, Catalogue, Command, EntityView, FuelChange, Happening, Scene, SceneGround, Surroundings};
use sim::snapshot::StableId;
use sim::weapons::{Aim, Outcome};
use sim::{UtcTime, input};
use std::path::Path;
use std::sync::Arc;

const STORES: [(&str, u32, DVec3); 3] = [
    ("mk82", 3, DVec3::new(0.2, -2.5, 0.9)),
    ("mk82", 1, DVec3::new(-0.3, 3.0, 0.7)),
    ("hydra70", 19, DVec3::new(0.6, 1.4, 1.1)),
];

/// The jet with stores built in: mass, centre of gravity, inertia and drag are written into its file.
fn with_stores_built_in() -> String {
    let text = builtin::ALL.iter().find(|(name, _)| *name == "jet").unwrap().1;
    let bare = Model::from_text(Path::new("jet.toml"), text).unwrap();
    let points = STORES.map(|(name, rounds, at_m)| {
        let weapon = sim::weapons::builtin::weapon(name).unwrap();
        (weapon.carried_kg * f64::from(rounds), at_m, weapon.carried_drag_area_m2 * f64::from(rounds))
    });
    let mass_kg = bare.mass_kg + points.iter().map(|point| point.0).sum::<f64>();
    let moment = points.iter().map(|point| point.1 * point.0).sum::<DVec3>();
    let cg_m = (bare.cg_m * bare.mass_kg + moment) / mass_kg;
    let stores_m = moment / points.iter().map(|point| point.0).sum::<f64>();
    // Each mass moved to the common centre of gravity, one after the other.
    let moved = |kg: f64, arm: DVec3| {
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        (DMat3::IDENTITY * arm.length_squared() - outer) * kg
    };
    let inertia = points.iter().fold(bare.inertia_kgm2 + moved(bare.mass_kg, bare.cg_m - cg_m), |sum, point| {
        sum + moved(point.0, point.1 - cg_m)
    });
    let rows: Vec<String> = (0..3).map(|row| format!("{:?}", inertia.row(row).to_array())).collect();
    let body = format!(
        "[body]\nmass_kg = {mass_kg:?}\ncg_m = {:?}\ninertia_kgm2 = [{}]\nnever_exceed_mps = 411.6\n",
        cg_m.to_array(),
        rows.join(", ")
    );
    let (begins, ends) = (text.find("[body]").unwrap(), text.find("[reference]").unwrap());
    let half_m2 = 0.5 * points.iter().map(|point| point.2).sum::<f64>();
    let drag: String = [("ahead_mps", [1, 0, 0]), ("right_mps", [0, 1, 0]), ("down_mps", [0, 0, 1])]
        .map(|(along, axes)| {
            let force = axes.map(|axis| f64::from(axis) * -half_m2);
            let at = stores_m.to_array();
            format!("[[thrust]]\nforce_N = {force:?}\nat_m = {at:?}\ntimes = [\"density_kgpm3\", \"tas_mps\", \"{along}\"]\n")
        })
        .concat();
    format!("{}{body}\n{}\n{drag}", &text[..begins], &text[ends..])
}

fn catalogue() -> Arc<Catalogue> {
    let mut all = Catalogue::new();
    all.add_model("jet", builtin::named("jet").unwrap().unwrap()).unwrap();
    all.add_model("twin", Model::from_text(Path::new("twin.toml"), &with_stores_built_in()).unwrap()).unwrap();
    sim::weapons::builtin::add_all(&mut all).unwrap();
    Arc::new(all)
}

fn scene() -> Scene {
    let mut around = Surroundings::over(0.74).unwrap();
    around.seed = SEED;
    let start = AircraftState::level(DVec3::new(0.0, 3_000.0, 0.0), 0.0, 200.0);
    Scene::furnished(start, UtcTime::parse("2026-06-21T06:00:00Z").unwrap(), 120, around, catalogue()).unwrap()
}

fn start(model: &str, position_m: DVec3) -> BodyStart {
    BodyStart {
        model: model.to_owned(),
        position_m,
        velocity_mps: DVec3::NEG_Z * 200.0,
        attitude: sim::frame::attitude(sim::frame::Angles { pitch_rad: 0.05, ..Default::default() }),
        rates_radps: DVec3::new(0.3, 0.1, -0.1),
        fuel: None,
    }
}

fn body(scene: &Scene, id: StableId) -> EntityView {
    *scene.snapshot().bodies.iter().find(|body| body.id == id).unwrap()
}

#[test]
fn a_loaded_body_flies_as_one_with_its_stores_built_in() {
    let ground = SceneGround::void();
    let mut scene = scene();
    let loaded = scene.add_body(&start("jet", DVec3::new(0.0, 3_000.0, 0.0))).unwrap();
    for (weapon, rounds, at_m) in STORES {
        scene.order(load(loaded, weapon, rounds, at_m)).unwrap();
    }
    // The centre of gravity went to the stores as they were hung.
    let at = body(&scene, loaded);
    let twin = BodyStart { velocity_mps: at.velocity_mps, ..start("twin", at.position_m) };
    let twin = scene.add_body(&twin).unwrap();
    for id in [loaded, twin] {
        // What is burnt lessens the mass that the stores' inertia is counted with; the twin's is written down.
        scene.order(Command::Fuel { id, change: FuelChange::Freeze(true) }).unwrap();
        for (control, value) in [("throttle_norm", 0.6), ("elevator_norm", 0.1), ("aileron_norm", 0.05)] {
            scene.order(Command::Control { id, control: control.to_owned(), value }).unwrap();
        }
    }
    // Both equations are the same in other words: a rounding of 1e-16 of 200 m/s a step, which an unsteady flight of
    // 1,200 steps lets grow by some hundred.
    const APART: f64 = 1e-8;
    for step in 0..1_200 {
        scene.step(&ground);
        let [a, b] = [body(&scene, loaded), body(&scene, twin)];
        let apart = a.position_m.distance(b.position_m).max(a.velocity_mps.distance(b.velocity_mps));
        assert!(apart < APART && a.attitude.angle_between(b.attitude) < 1e-7, "step {step}: {apart}");
    }
}

/// A jet as the own aircraft, with stores, trimmed.
fn own(stores: &[(&str, u32, DVec3)]) -> (Scene, StableId) {
    let mut scene = scene();
    let level = BodyStart { rates_radps: DVec3::ZERO, ..start("jet", DVec3::new(0.0, 3_000.0, 0.0)) };
    let id = scene.add_body(&level).unwrap();
    let owner = scene.own_id();
    scene.set_levers(input::Levers { gear: 0.0, ..Default::default() });
    scene.order(Command::FlyBody { id }).unwrap();
    let before = scene.hash();
    assert!(scene.order(Command::FlyBody { id: StableId(999) }).is_err());
    assert_eq!((scene.flown(), scene.hash()), (Some(id), before), "what is refused changes nothing");
    for (weapon, rounds, at_m) in stores {
        scene.order(load(owner, weapon, *rounds, *at_m)).unwrap();
    }
    scene.trim_flown().unwrap();
    (scene, owner)
}

fn roll_radps(scene: &Scene) -> f64 {
    scene.aircraft().rates_radps.x
}

#[test]
fn a_lopsided_load_rolls_it_until_it_is_let_go() {
    let ground = SceneGround::void();
    let one = DVec3::new(0.0, 3.0, 0.8);
    let (mut even, _) = own(&[("mk82", 1, one), ("mk82", 1, one * DVec3::new(1.0, -1.0, 1.0))]);
    run(&mut even, &ground, 120);
    assert!(roll_radps(&even).abs() < 1e-4, "{}", roll_radps(&even));
    let (mut scene, owner) = own(&[("mk82", 1, one)]);
    run(&mut scene, &ground, 120);
    // 241 kg at 3 m are 7.1 kN m: over 13,000 kg m2 and a roll mode of 0.3 s some 0.15 rad/s, right wing down.
    let heavy = roll_radps(&scene);
    assert!((0.08..0.25).contains(&heavy), "{heavy}");
    scene.order(arm(owner, "mk82", None)).unwrap();
    let before = scene.aircraft();
    scene.order(release(owner, "mk82", 1, 1, 0.0, Aim::Nearest)).unwrap();
    scene.step(&ground);
    let after = scene.aircraft();
    // What it is made of stays where it is; its centre of gravity goes back by 241/9,540 of 3 m, to the left: 0.076 m.
    let went = after.position_m - before.position_m - 0.5 * (before.velocity_mps + after.velocity_mps) / 120.0;
    let left = before.attitude * DVec3::NEG_Y;
    assert!((went.dot(left) - 0.076).abs() < 0.005, "{went}");
    run(&mut scene, &ground, 240);
    // Seven time constants of the roll mode; banked, it turns with what is left of the spiral.
    assert!(roll_radps(&scene).abs() < 0.02, "{}", roll_radps(&scene));
}

#[test]
fn what_is_jettisoned_falls_unarmed_whatever_the_master_arm() {
    let ground = SceneGround::from(
        terrain::Ground::new(Arc::new(terrain::synthetic::flat(
            terrain::Grid::centred(200.0, 40, 40).unwrap(),
            2_500.0,
        )))
        .whole(),
    );
    let (mut scene, owner) = own(&[
        ("gsh23", 200, DVec3::new(4.0, 0.0, 0.5)),
        ("mk82", 2, DVec3::new(0.0, 2.0, 0.8)),
        ("mk82", 2, DVec3::new(0.0, -2.0, 0.8)),
        ("hydra70", 19, DVec3::new(0.0, 3.0, 0.8)),
    ]);
    let full_kg = scene.stores_load(owner).mass_kg;
    let saved = scene.save();
    scene.command(input::Command::Jettison);
    let (_, events) = run(&mut scene, &ground, 120 * 15);
    let left = ["gsh23", "mk82", "hydra70"].map(|weapon| scene.rounds_left(owner, weapon));
    assert_eq!(left, [200, 0, 0]);
    assert!((full_kg - scene.stores_load(owner).mass_kg - 4.0 * 241.0 - 19.0 * 10.4).abs() < 1e-9);
    let scores = scores(&events);
    assert!(scores.len() == 4 && scores.iter().all(|score| score.outcome == Outcome::Dud), "{scores:?}");
    assert!(!events.iter().any(|event| matches!(event.what, Happening::Burst { .. })));
    // The same of a save, to the bit.
    let mut again = Scene::restore(&saved, catalogue()).unwrap();
    again.command(input::Command::Jettison);
    run(&mut again, &ground, 120 * 15);
    assert_eq!(again.snapshot().hash(), scene.snapshot().hash());
    // One weapon alone, of an owner that has none of it left: nothing is to be done.
    scene.order(Command::Jettison { owner, weapon: Some("mk82".to_owned()) }).unwrap();
    let refused = scene.order(Command::Jettison { owner, weapon: Some("anvil".to_owned()) }).unwrap_err();
    assert!(refused.to_string().contains("anvil"), "{refused}");
    let nobody = StableId(77);
    assert!(scene.order(Command::Jettison { owner: nobody, weapon: None }).is_err());
}
