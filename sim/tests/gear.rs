//! Bodies on wheels: they stand, roll, take off, land, and break with the cause said.

use glam::{DQuat, DVec3};
use sim::aircraft::AircraftState;
use sim::handling::runway::standing_height_m;
use sim::rigid::Model;
use sim::scene::{
    BodyStart, Catalogue, Command, EndReason, EntityView, FuelChange, Happening, Scene, SceneGround, Surroundings,
};
use sim::snapshot::StableId;
use sim::{Condition, Controls, Levers, UtcTime};
use std::path::Path;
use std::sync::Arc;
use terrain::features::cover::Cover;
use terrain::{Grid, Ground, synthetic};

fn trainer() -> Model {
    Model::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/aircraft/trainer.toml")).unwrap()
}

/// A scene with the trainer in a state.
fn with(position_m: DVec3, velocity_mps: DVec3, attitude: DQuat) -> (Scene, StableId) {
    let mut catalogue = Catalogue::new();
    catalogue.add_model("trainer", trainer()).unwrap();
    let far = AircraftState::level(DVec3::new(0.0, 9_000.0, 0.0), 0.0, 150.0);
    let around = Surroundings::default();
    let mut scene = Scene::furnished(far, UtcTime { unix_ns: 0 }, 120, around, Arc::new(catalogue)).unwrap();
    let start = BodyStart {
        model: "trainer".to_owned(),
        position_m,
        velocity_mps,
        attitude,
        rates_radps: DVec3::ZERO,
        fuel: None,
    };
    let id = scene.add_body(&start).unwrap();
    (scene, id)
}

fn north() -> DQuat {
    sim::frame::attitude(sim::frame::Angles::default())
}

fn set(scene: &mut Scene, id: StableId, control: &str, value: f64) {
    scene.order(Command::Control { id, control: control.to_owned(), value }).unwrap();
}

fn body(scene: &Scene) -> EntityView {
    scene.snapshot().bodies[0]
}

fn ended(scene: &Scene) -> Option<EndReason> {
    scene.snapshot().events.iter().find_map(|event| match &event.what {
        Happening::Crash { reason, .. } => Some(*reason),
        _ => None,
    })
}

/// A plane of a slope towards south-east: a tenth, along a diagonal so that nothing is aligned with an axis.
fn slope() -> SceneGround {
    SceneGround::heights(|x_m, z_m| Some(200.0 - 0.08 * x_m - 0.06 * z_m))
}

#[test]
fn with_its_brakes_set_it_rests_on_a_slope_for_ten_minutes_and_after_a_nudge() {
    let ground = slope();
    let up = DVec3::new(0.08, 1.0, 0.06).normalize();
    let tilted = DQuat::from_rotation_arc(DVec3::Y, up) * north();
    let (mut scene, id) = with(DVec3::Y * 200.0 + up * standing_height_m(&trainer()), DVec3::ZERO, tilted.normalize());
    set(&mut scene, id, "parking_brake_norm", 1.0);
    // Burnt fuel moves the centre of gravity, by some 0.2 mm in that time.
    scene.order(Command::Fuel { id, change: FuelChange::Freeze(true) }).unwrap();
    for nudge in [false, true] {
        if nudge {
            // A push at rest: 0.3 m/s in the direction of the slope and up.
            let now = body(&scene);
            scene
                .order(Command::Reposition {
                    id,
                    position_m: now.position_m,
                    velocity_mps: DVec3::new(0.3, 0.2, -0.2),
                    attitude: now.attitude,
                })
                .unwrap();
        }
        for _ in 0..10 * 120 {
            scene.step(&ground);
        }
        let rest = body(&scene);
        let (mut farthest, mut jitter, mut last) = (0.0f64, 0.0f64, rest.position_m);
        for _ in 0..600 * 120 {
            scene.step(&ground);
            let now = body(&scene);
            farthest = farthest.max(now.position_m.distance(rest.position_m));
            jitter = jitter.max(now.position_m.distance(last));
            last = now.position_m;
        }
        assert_eq!(body(&scene).condition, Condition::OnGround, "{:?}", ended(&scene));
        println!("creep {farthest:e} m, jitter {jitter:e} m a step");
        assert!(farthest < 1e-3 && jitter < 1e-4, "nudged {nudge}: creep {farthest} m, jitter {jitter} m a step");
    }
}

#[test]
fn without_brakes_it_rolls_down_the_slope() {
    let ground = slope();
    let (mut scene, _) = with(DVec3::Y * 201.4, DVec3::ZERO, north());
    let from = body(&scene).position_m;
    for _ in 0..20 * 120 {
        scene.step(&ground);
    }
    // Facing up the weaker part of the slope, 0.06: more than the wheels' 0.03.
    assert!(body(&scene).position_m.distance(from) > 5.0, "{:?}", body(&scene));
}

/// Its name, the ground, position, velocity, attitude, and the causes that it may end with; none: whatever comes.
type Case<'a> = (&'a str, &'a SceneGround, DVec3, DVec3, DQuat, &'a [EndReason]);

#[test]
fn hard_landings_end_with_their_cause_and_no_number_that_is_none() {
    let flat = SceneGround::heights(|_, _| Some(0.0));
    let ridge = SceneGround::heights(|x_m, _| Some(40.0 - 1.5 * x_m.abs()));
    let grid = Grid::centred(200.0, 1, 1).unwrap();
    let posts: SceneGround = Ground::new(Arc::new(synthetic::flat(grid, 0.0))).whole().into();
    let wet = vec![1u8; (grid.columns() as usize - 1) * (grid.rows() as usize - 1)];
    let lake = posts.clone().with_cover(Arc::new(Cover::new(&grid, 1, wet).unwrap()));
    let turned = |heading_rad, pitch_rad: f64, roll_rad: f64| {
        sim::frame::attitude(sim::frame::Angles { heading_rad, pitch_rad, roll_rad })
    };
    let dive = 60f64.to_radians();
    let cases: Vec<Case> = vec![
        (
            "60 degrees down",
            &flat,
            DVec3::Y * 60.0,
            DVec3::new(0.0, -70.0 * dive.sin(), -70.0 * dive.cos()),
            turned(0.0, -dive, 0.0),
            &[EndReason::Propeller, EndReason::Hull, EndReason::Gear],
        ),
        ("flat at 8 m/s", &flat, DVec3::Y * 3.0, DVec3::new(0.0, -8.0, -30.0), north(), &[EndReason::Gear]),
        ("on one wheel at 2 m/s", &flat, DVec3::Y * 2.0, DVec3::new(0.0, -1.0, -28.0), turned(0.0, 0.05, 0.15), &[]),
        (
            "inverted",
            &flat,
            DVec3::Y * 8.0,
            DVec3::new(0.0, -4.0, -30.0),
            turned(0.0, 0.0, 3.1),
            &[EndReason::Hull, EndReason::Tail, EndReason::WingTip],
        ),
        (
            "knife edge",
            &flat,
            DVec3::Y * 10.0,
            DVec3::new(0.0, -5.0, -30.0),
            turned(0.0, 0.0, 1.5),
            &[EndReason::WingTip],
        ),
        ("on a ridge", &ridge, DVec3::Y * 42.0, DVec3::new(0.0, -2.0, -28.0), north(), &[]),
        ("across a ridge", &ridge, DVec3::new(-60.0, 20.0, 0.0), DVec3::X * 40.0, turned(1.57, 0.0, 0.0), &[]),
        ("into water", &lake, DVec3::Y * 3.0, DVec3::new(0.0, -1.0, -30.0), north(), &[EndReason::Water]),
        ("over the edge", &posts, DVec3::new(0.0, 1.3, -2_990.0), DVec3::new(0.0, 0.0, -40.0), north(), &[]),
        ("under the ground", &flat, DVec3::Y * -50.0, DVec3::ZERO, north(), &[EndReason::Gear, EndReason::Ground]),
        (
            "on its nose",
            &flat,
            DVec3::Y * 4.0,
            DVec3::new(0.0, -1.0, 0.0),
            turned(0.0, -1.57, 0.0),
            &[EndReason::Propeller],
        ),
    ];
    for (name, ground, at, velocity, attitude, causes) in cases {
        let (mut scene, _) = with(at, velocity, attitude);
        let mut cause = None;
        for _ in 0..20 * 120 {
            scene.step(ground);
            let now = body(&scene);
            assert!(now.position_m.is_finite() && now.velocity_mps.is_finite() && now.attitude.is_finite(), "{name}");
            assert!(now.velocity_mps.length() < 300.0, "{name}: thrown at {} m/s", now.velocity_mps);
            cause = cause.or(ended(&scene));
        }
        println!("{name}: {cause:?}");
        assert!(causes.is_empty() || cause.is_some_and(|cause| causes.contains(&cause)), "{name}: {cause:?}");
    }
}

/// The trainer as the own aircraft, standing at the south end of a runway.
fn piloted() -> Scene {
    let (mut scene, id) = with(DVec3::Y * standing_height_m(&trainer()), DVec3::ZERO, north());
    scene.order(Command::FlyBody { id }).unwrap();
    scene
}

fn circuit_step(scene: &mut Scene, step: u32) {
    let t = f64::from(step) / 120.0;
    let own = scene.aircraft();
    let throttle = if t < 40.0 { 1.0 } else { 0.0 };
    let fast = own.airspeed_mps > 27.0;
    let angles = own.angles();
    let wanted = if fast { if t < 40.0 { 0.12 } else { 0.02 } } else { 0.0 };
    let pitch = (4.0 * (wanted - angles.pitch_rad) - 1.0 * own.rates_radps.y).clamp(-1.0, 1.0);
    let roll = (-2.0 * angles.roll_rad).clamp(-1.0, 1.0);
    let heading = (angles.heading_rad + 1.0).rem_euclid(std::f64::consts::TAU) - 1.0;
    scene.set_controls(Controls { pitch, roll, yaw: (-2.0 * heading).clamp(-1.0, 1.0), throttle });
    let brakes = if t > 45.0 && own.condition == Condition::OnGround { [0.5; 2] } else { [0.0; 2] };
    scene.set_levers(Levers { brakes, flaps: if t > 40.0 { 0.25 } else { 0.0 }, ..Levers::default() });
}

#[test]
fn the_pilot_takes_off_and_the_same_inputs_give_the_same_hash_also_across_a_save() {
    let ground = SceneGround::heights(|_, _| Some(0.0));
    let (mut first, mut second) = (piloted(), piloted());
    let mut highest = 0.0f64;
    for step in 0..60 * 120 {
        circuit_step(&mut first, step);
        first.step(&ground);
        highest = highest.max(first.aircraft().position_m.y);
        if step == 2_000 || step == 120 {
            let catalogue = second.catalogue().clone();
            second = Scene::restore(&second.save(), catalogue).unwrap();
        }
        circuit_step(&mut second, step);
        second.step(&ground);
        assert_eq!(first.snapshot().hash(), second.snapshot().hash(), "step {step}");
    }
    assert_eq!(first.hash(), second.hash());
    assert!(highest > 30.0, "it climbs: {highest} m");
    let shown = first.instruments().unwrap();
    assert!(shown.rpm[0] > 300.0 && shown.fuel_kg[0] < 108.9 && shown.flaps[0] > 9.0, "{shown:?}");
}

#[test]
fn the_autopilot_holds_what_it_is_told() {
    use glam::DVec2;
    use sim::autopilot::Holds;
    let (mut scene, id) = with(DVec3::Y * 1_000.0, DVec3::NEG_Z * 52.0, north());
    set(&mut scene, id, "throttle_norm", 0.7);
    let ground = SceneGround::heights(|_, _| Some(0.0));
    let holds = Holds { altitude_m: Some(1_150.0), heading_rad: Some(1.2), speed_mps: Some(50.0), ..Holds::default() };
    scene.order(Command::Autopilot { id, holds: Some(holds) }).unwrap();
    for _ in 0..180 * 120 {
        scene.step(&ground);
    }
    let now = body(&scene);
    let heading_rad = sim::frame::angles(now.attitude).heading_rad;
    println!("{:.2} m, {:.4} rad, {:.2} m/s", now.position_m.y, heading_rad, now.velocity_mps.length());
    assert!((now.position_m.y - 1_150.0).abs() < 3.0 && (heading_rad - 1.2).abs() < 0.02, "{now:?}");
    assert!((now.velocity_mps.length() - 50.0).abs() < 0.5, "{now:?}");
    // A track eastward, a kilometre aside.
    let aside = DVec2::new(now.position_m.x, now.position_m.z - 1_000.0);
    let track = Holds { heading_rad: None, track: Some((aside, std::f64::consts::FRAC_PI_2)), ..holds };
    scene.order(Command::Autopilot { id, holds: Some(track) }).unwrap();
    for _ in 0..180 * 120 {
        scene.step(&ground);
    }
    let now = body(&scene);
    println!("{:.2} m off the track", now.position_m.z - aside.y);
    assert!((now.position_m.z - aside.y).abs() < 10.0 && (now.position_m.y - 1_150.0).abs() < 3.0, "{now:?}");
    let both = Holds { heading_rad: Some(0.0), ..track };
    assert!(scene.order(Command::Autopilot { id, holds: Some(both) }).is_err());
}

#[test]
fn out_of_fuel_it_windmills_and_the_mixture_cuts_it_off() {
    let (mut scene, id) = with(DVec3::Y * 2_000.0, DVec3::NEG_Z * 45.0, north());
    let ground = SceneGround::heights(|_, _| Some(0.0));
    scene.order(Command::FlyBody { id }).unwrap();
    scene.order(Command::Fuel { id, change: FuelChange::Set(0.0) }).unwrap();
    for _ in 0..10 * 120 {
        scene.set_controls(Controls { pitch: -0.1, throttle: 1.0, ..Controls::default() });
        scene.step(&ground);
    }
    let shown = scene.instruments().unwrap();
    // Driven by the air: turning, but well below the 2,300 that full throttle gives.
    assert!(shown.rpm[0] > 200.0 && shown.rpm[0] < 2_000.0, "{shown:?}");
}

/// The trainer's file with something else in place of a part of it.
fn changed(from: &str, to: &str) -> Result<Model, String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/aircraft/trainer.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains(from), "{from}");
    Model::from_text(&file, &text.replace(from, to)).map_err(|error| error.to_string())
}

#[test]
fn without_its_wheels_it_lands_on_its_belly_and_slides_to_a_stop() {
    let mut bare = trainer();
    bare.contacts.retain(|one| one.rolling.is_none() && one.name != "propeller");
    let mut catalogue = Catalogue::new();
    catalogue.add_model("trainer", bare).unwrap();
    let far = AircraftState::level(DVec3::new(0.0, 9_000.0, 0.0), 0.0, 150.0);
    let around = Surroundings::default();
    let mut scene = Scene::furnished(far, UtcTime { unix_ns: 0 }, 120, around, Arc::new(catalogue)).unwrap();
    let start = BodyStart {
        model: "trainer".to_owned(),
        position_m: DVec3::Y * 0.7,
        velocity_mps: DVec3::new(0.0, -0.5, -28.0),
        attitude: north(),
        rates_radps: DVec3::ZERO,
        fuel: None,
    };
    scene.add_body(&start).unwrap();
    let ground = SceneGround::heights(|_, _| Some(0.0));
    for _ in 0..60 * 120 {
        scene.step(&ground);
        let now = body(&scene);
        assert!(now.position_m.is_finite() && now.position_m.y < 5.0, "{now:?}");
    }
    let now = body(&scene);
    // v2 / (2 x 0.4 x g) is 100 m; the wing carries some of the weight at first.
    assert_eq!(now.condition, Condition::OnGround, "{:?}", ended(&scene));
    assert!(now.velocity_mps.length() < 1e-3 && (-400.0..-60.0).contains(&now.position_m.z), "{now:?}");
}

#[test]
fn what_is_wrong_in_wheels_and_engine_is_named_with_its_key() {
    for (from, to, told) in [
        (
            "steer = { control = \"rudder_norm\"",
            "steer = { control = \"pedal_norm\"",
            "wheel[0].steer: expected a control",
        ),
        ("radius_m = 0.18", "radius_m = 0.0", "wheel[0].radius_m: expected a number within"),
        ("sliding_friction = 0.6", "sliding_friction = 0.9", "wheel[0].sliding_friction"),
        ("part = \"tail\"", "part = \"wheel\"", "expected hull, wing_tip, tail or propeller"),
        ("part = \"tail\"", "part = \"rotor\"", "rotor"),
        ("throttle_control = \"throttle_norm\"", "throttle_control = \"lever\"", "engine.throttle_control"),
        ("[1.4, -0.0720, -0.0600],", "[1.4, -0.0720, 0.0],", "propeller.coefficients: expected a last row"),
        ("capacity_kg = 108.9", "capacity_kg = 1e5", "fuel.capacity_kg"),
        ("warning_rad = 0.215", "warning_rad = 0.5", "stall: expected"),
        ("per_s = 4.5", "per_s = 0.0", "controls.flaps_deg.per_s"),
        ("and_table = \"ground_lift\"", "and_table = \"cushion\"", "found cushion"),
    ] {
        let error = changed(from, to).unwrap_err();
        assert!(error.contains(told), "{to}: {error}");
    }
}

#[test]
fn any_stiffness_of_a_file_stands_at_thirty_steps_a_second() {
    let ground = SceneGround::heights(|_, _| Some(0.0));
    for newtons in ["5e5", "5e7", "9e8"] {
        let model = changed("spring_Npm = 50000.0", &format!("spring_Npm = {newtons}")).unwrap();
        let mut catalogue = Catalogue::new();
        catalogue.add_model("stiff", model).unwrap();
        let far = AircraftState::level(DVec3::new(0.0, 9_000.0, 0.0), 0.0, 150.0);
        let around = Surroundings::default();
        let mut scene = Scene::furnished(far, UtcTime { unix_ns: 0 }, 30, around, Arc::new(catalogue)).unwrap();
        let start = BodyStart {
            model: "stiff".to_owned(),
            position_m: DVec3::Y * 1.3,
            velocity_mps: DVec3::ZERO,
            attitude: north(),
            rates_radps: DVec3::ZERO,
            fuel: None,
        };
        scene.add_body(&start).unwrap();
        for _ in 0..10 * 30 {
            scene.step(&ground);
        }
        let now = body(&scene);
        assert!(now.condition == Condition::OnGround && now.velocity_mps.length() < 0.05, "{newtons}: {now:?}");
    }
}

#[test]
fn a_reset_puts_the_pilot_back_on_the_runway_and_slewing_carries_the_body_along() {
    let ground = SceneGround::heights(|_, _| Some(0.0));
    let mut scene = piloted();
    let first = scene.aircraft().position_m;
    for step in 0..20 * 120 {
        circuit_step(&mut scene, step);
        scene.step(&ground);
    }
    assert!(scene.aircraft().position_m.distance(first) > 100.0);
    scene.command(sim::Command::Slew);
    scene.set_controls(Controls { pitch: -1.0, throttle: 0.9, ..Controls::default() });
    for _ in 0..120 {
        scene.step(&ground);
        assert!(body(&scene).position_m.distance(scene.aircraft().position_m) < 1e-6);
    }
    scene.command(sim::Command::Slew);
    scene.step(&ground);
    assert!(body(&scene).position_m.distance(scene.aircraft().position_m) < 1e-6);
    scene.command(sim::Command::Reset);
    scene.set_controls(Controls { throttle: 0.0, ..Controls::default() });
    for _ in 0..5 * 120 {
        scene.step(&ground);
    }
    let own = scene.aircraft();
    assert!(own.position_m.distance(first) < 10.0 && own.condition == Condition::OnGround, "{own:?}");
}
