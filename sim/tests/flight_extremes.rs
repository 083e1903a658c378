//! Flights where models and integrators break elsewhere: no air speed, every attitude to the air, poles, stiff drag, long
//! runs, hostile files. Nothing may panic, hang or give a number that is none.

mod flown;

use flown::{Columns, asset, case, fly, fly_to, model};
use glam::DVec3;
use sim::case::Case;
use sim::rigid::motion::{self, RigidMotion};
use sim::rigid::simulation::Ending;
use sim::rigid::{Inputs, Model, Simulation};
use std::path::Path;
use std::sync::Arc;

const FEATHER: &str = "[body]\nmass_kg = 0.01\ninertia_kgm2 = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 1e-4]]\n\
                       [reference]\narea_m2 = 1.0\n[[aero.term]]\nto = \"CD\"\nvalue = 1.0\n";

fn feather() -> Model {
    Model::from_text(Path::new("feather.toml"), FEATHER).unwrap()
}

fn text(frame: &str, initial: &str, seconds: f64, dt_s: f64) -> String {
    format!(
        "[frame]\n{frame}\n[initial]\n{initial}\n[run]\nseconds = {seconds:?}\ndt_s = {dt_s:?}\noutput_dt_s = 1.0\n"
    )
}

fn all_finite(columns: &Columns) -> bool {
    columns.values().flatten().all(|value| value.is_finite())
}

fn last(columns: &Columns, name: &str) -> f64 {
    *columns[name].last().unwrap()
}

#[test]
fn every_direction_of_the_air_and_none_can_be_flown() {
    let mut velocities = vec!["[0, 0, 0]".to_owned(), "[1e-300, 0, 0]".into(), "[1e-12, -1e-12, 1e-12]".into()];
    for alpha_deg in (-180..=180).step_by(30) {
        for beta_deg in [-90, -45, 0, 60, 90] {
            let (a, b) = (f64::from(alpha_deg).to_radians(), f64::from(beta_deg).to_radians());
            let v = DVec3::new(a.cos() * b.cos(), b.sin(), a.sin() * b.cos()) * 70.0;
            velocities.push(format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z));
        }
    }
    for velocity in velocities {
        for attitude in ["[0, 0, 0]", "[0, 90, 0]", "[180, -90, 30]"] {
            let initial = format!("altitude_m = 6000\nattitude_deg = {attitude}\nvelocity_body_mps = {velocity}");
            let columns = fly(model("models/lin182.toml"), &case(&text("", &initial, 10.0, 1.0 / 120.0)), "");
            assert!(all_finite(&columns), "{velocity} {attitude}");
        }
    }
}

#[test]
fn a_tail_slide_falls_back_and_comes_out_nose_down() {
    let initial = "altitude_m = 6000\nattitude_deg = [0, 90, 0]\nvelocity_body_mps = [15, 0, 0]";
    let columns = fly(model("models/lin182.toml"), &case(&text("", initial, 30.0, 1.0 / 120.0)), "");
    assert!(all_finite(&columns));
    // Backward through the air on the way; speed and forward flight come back.
    assert!(columns["u_mps"].iter().any(|u| *u < -1.0), "{:?}", columns["u_mps"]);
    assert!(last(&columns, "u_mps") > 20.0);
}

#[test]
fn air_that_moves_with_the_body_does_nothing_to_it() {
    let still = text("", "altitude_m = 6000", 5.0, 0.01);
    let moving = text("", "altitude_m = 6000\nvelocity_ned_mps = [12, -7, 0]", 5.0, 0.01)
        + "[[wind]]\nnorth_mps = 12.0\neast_mps = -7.0\n";
    let (still, moving) = (fly(feather(), &case(&still), ""), fly(feather(), &case(&moving), ""));
    for (i, t) in still["t_s"].iter().enumerate() {
        // Positions of tens of metres and heights of 6,000, a thousand steps of roundings.
        assert!((moving["north_m"][i] - 12.0 * t).abs() < 1e-9 && (moving["east_m"][i] + 7.0 * t).abs() < 1e-9);
        assert!((moving["altitude_m"][i] - still["altitude_m"][i]).abs() < 1e-8);
    }
    assert_eq!(moving["tas_mps"][0], 0.0);
}

#[test]
fn a_hover_in_wind_stands_over_the_ground() {
    // Thrust up to the gram, attitude level, air moving past: only drag moves the body, downwind.
    let hover = FEATHER.to_owned() + "[[thrust]]\nforce_N = [0.0, 0.0, -0.0980665]\n";
    let hover = Model::from_text(Path::new("hover.toml"), &hover).unwrap();
    let wind = text("", "altitude_m = 100", 30.0, 0.01) + "[[wind]]\nnorth_mps = 3.0\n";
    let columns = fly(hover, &case(&wind), "");
    assert!((last(&columns, "altitude_m") - 100.0).abs() < 1e-9);
    assert!((last(&columns, "vn_mps") - 3.0).abs() < 0.1 && last(&columns, "tas_mps") < 0.1);
}

#[test]
fn loops_pass_straight_up_and_straight_down() {
    // A body that pitches at 30 degrees a second in vacuum: twelve seconds a turn, through +-90 degrees each time.
    let vacuum =
        text("", "altitude_m = 6000\nrates_degps = [0, 30, 0]", 60.0, 0.01) + "[atmosphere]\nmodel = \"none\"\n";
    let columns = fly(feather(), &case(&vacuum), "");
    assert!(all_finite(&columns));
    for (t, pitch) in columns["t_s"].iter().zip(&columns["pitch_deg"]) {
        let expected = (30.0 * t).to_radians().sin().asin().to_degrees();
        // asin near 90 degrees: the square root of f64's rounding, in degrees.
        assert!((pitch - expected).abs() < 2e-6, "{t}: {pitch} {expected}");
    }
    let energy = columns["p_degps"].iter().chain(&columns["r_degps"]).fold(0.0f64, |most, rate| most.max(rate.abs()));
    assert!(energy < 1e-12);
}

#[test]
fn poles_and_the_date_line_are_places_like_others() {
    for (lat, lon, north, east) in [
        (90.0, 0.0, 200.0, 0.0),
        (-90.0, 45.0, 0.0, 300.0),
        (89.999, 179.9999, 900.0, 10.0),
        (0.0, 179.999, 0.0, 800.0),
    ] {
        let initial = format!(
            "lat_deg = {lat:?}\nlon_deg = {lon:?}\naltitude_m = 20000\nvelocity_ned_mps = [{north:?}, {east:?}, 0]"
        );
        for frame in ["kind = \"ellipsoid\"", "kind = \"round\""] {
            let columns = fly(model("models/sphere.toml"), &case(&text(frame, &initial, 20.0, 0.01)), "");
            assert!(all_finite(&columns), "{lat} {lon} {frame}");
            assert!(columns["lat_deg"].iter().all(|lat| lat.abs() <= 90.0));
            assert!(columns["lon_deg"].iter().all(|lon| lon.abs() <= 180.0));
        }
    }
    let over = text(
        "kind = \"ellipsoid\"",
        "lat_deg = 0\nlon_deg = 179.999\naltitude_m = 20000\nvelocity_ned_mps = [0, 800, 0]",
        20.0,
        0.01,
    );
    let columns = fly(model("models/sphere.toml"), &case(&over), "");
    assert!(columns["lon_deg"][0] > 0.0 && last(&columns, "lon_deg") < 0.0, "crossed the date line");
}

#[test]
fn stiff_drag_is_cut_into_pieces_or_refused() {
    for (integrator, dt_s) in [("rk4", 0.1), ("rk4", 0.001), ("rk2", 0.1), ("semi_euler", 0.1), ("ab2", 1.0 / 120.0)] {
        let initial = "altitude_m = 9000\nvelocity_ned_mps = [100, 0, 0]";
        let text = text("", initial, 60.0, dt_s).replace("[run]", &format!("[run]\nintegrator = \"{integrator}\""));
        let columns = fly(feather(), &case(&text), "");
        assert!(all_finite(&columns), "{integrator}");
        // Never thrown back, and at the end at its terminal speed sqrt(2 m g / (rho S)).
        assert!(columns["vn_mps"].iter().all(|v| *v >= -1e-9), "{integrator}");
        let terminal = (2.0 * 0.01 * 9.806_65 / last(&columns, "density_kgpm3")).sqrt();
        // Air thickens on the way down by 1e-4 a metre, so the speed lags by some 1e-5 of itself; 0.1 % tells a bounce.
        assert!((last(&columns, "vd_mps") / terminal - 1.0).abs() < 1e-3, "{integrator}: {}", last(&columns, "vd_mps"));
    }
    let text = text("", "altitude_m = 0\nvelocity_ned_mps = [50000, 0, 0]", 1.0, 0.1);
    let error = Simulation::new(feather(), &case(&text), Inputs::default(), None).unwrap_err().to_string();
    assert!(error.contains("run.dt_s") && error.contains("found 0.1 s"), "{error}");
}

#[test]
fn steps_from_a_millisecond_to_a_tenth_of_a_second_give_the_same_flight() {
    let end = |dt_s: f64| {
        let text = asset("cases/lin182.toml").replace("dt_s = 0.016666666666666666", &format!("dt_s = {dt_s:?}"));
        let columns = fly(model("models/lin182.toml"), &case(&text), &asset("inputs/lin182.csv"));
        DVec3::new(last(&columns, "north_m"), last(&columns, "east_m"), last(&columns, "altitude_m"))
    };
    let fine = end(0.001);
    for dt_s in [0.002, 0.01, 0.05, 0.1] {
        let gap = (end(dt_s) - fine).length();
        println!("lin182, rk4: {gap:.2e} m apart at {dt_s} s from 1 ms");
        // lambda h is 1.3 at 0.1 s: still decaying; errors there are some centimetres.
        assert!(gap < 0.5, "{dt_s}: {gap}");
    }
}

#[test]
fn an_hour_keeps_the_quaternion_and_a_body_at_rest_has_no_denormals() {
    let text = text("kind = \"ellipsoid\"", "altitude_m = 1e6\nrates_degps = [40, 10, -25]", 3_600.0, 0.05);
    let text = text + "[atmosphere]\nmodel = \"none\"\n";
    let mut flight = Simulation::new(model("models/brick.toml"), &case(&text), Inputs::default(), None).unwrap();
    for _ in 0..72_000 {
        flight.step();
    }
    let y = flight.state();
    let length = (y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6]).sqrt();
    assert!((length - 1.0).abs() < 1e-12, "{length}");

    // Drag takes a body that drifts to rest; with no gravity nothing keeps it moving. What decays exponentially would
    // reach denormal numbers after some 40,000 of these steps.
    let rest = case(
        "[frame]\ngravity = \"constant\"\ng_mps2 = 0\n[initial]\naltitude_m = 10\nvelocity_ned_mps = [1, 2, 3]\n\
                     rates_degps = [1, 2, 3]\n[run]\nseconds = 1\ndt_s = 0.01\n",
    );
    let linear = FEATHER.replace("value = 1.0", "value = 1.0\ntimes = [\"slow_norm\"]")
        + "[controls]\nslow_norm = { min = 0, max = 1, initial = 1 }\n";
    let mut motion = RigidMotion::new(
        Arc::new(Model::from_text(Path::new("m.toml"), &linear).unwrap()),
        rest.planet,
        rest.atmosphere.clone(),
        rest.wind.clone(),
    );
    motion.gust_mps = DVec3::ZERO;
    let mut y = sim::rigid::start::state(&rest.planet, &rest.initial);
    for _ in 0..1_000_000 {
        // A tenth off a step: the decay of a stiff damper.
        for component in &mut y[8..] {
            *component *= 0.9;
        }
        y = motion::normalised(y);
    }
    assert!(y.iter().all(|x| *x == 0.0 || x.is_normal()), "{y:?}");
    assert!(motion::velocity(&y) == DVec3::ZERO && motion::rates(&y) == DVec3::ZERO);
}

#[test]
fn a_table_that_refuses_what_is_outside_ends_the_flight_and_keeps_what_was_good() {
    let bounded = FEATHER.replace("value = 1.0", "table = \"drag\"")
        + "[table.drag]\naxes = [\"altitude_m\"]\nbreakpoints = [[8990, 10000]]\nvalues = [1, 1]\noutside = \"error\"\n";
    let bounded = || Model::from_text(Path::new("m.toml"), &bounded).unwrap();
    let (columns, ending) = fly_to(bounded(), &case(&text("", "altitude_m = 9000", 60.0, 0.01)), "");
    let Ending::Failed(why) = ending else { panic!("{ending:?}") };
    assert!(why.contains("table.drag: expected altitude_m within 8990 and 10000"), "{why}");
    assert!(all_finite(&columns) && last(&columns, "altitude_m") < 8_990.0 && columns["t_s"].len() > 10);
    let low = Simulation::new(bounded(), &case(&text("", "altitude_m = 10", 1.0, 0.01)), Inputs::default(), None);
    assert!(low.unwrap_err().to_string().contains("table.drag"));
}

#[test]
fn bodies_that_cannot_be_are_refused_with_the_key() {
    let body = |inertia: &str| format!("[body]\nmass_kg = 1\ninertia_kgm2 = {inertia}\n");
    let fine = body("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]");
    let table = |breakpoints: &str, values: &str| {
        format!(
            "{fine}[reference]\narea_m2 = 1\n[[aero.term]]\nto = \"CD\"\ntable = \"t\"\n[table.t]\naxes = [\"mach\"]\nbreakpoints = {breakpoints}\nvalues = {values}\n"
        )
    };
    for (text, told) in [
        (String::new(), "body: expected mass_kg"),
        (body("[[0, 0, 0], [0, 0, 0], [0, 0, 0]]"), "body.inertia_kgm2: expected positive"),
        (body("[[1, 2, 0], [2, 1, 0], [0, 0, 1]]"), "body.inertia_kgm2: expected positive"),
        (body("[[-1, 0, 0], [0, 1, 0], [0, 0, 1]]"), "body.inertia_kgm2: expected positive"),
        (body("[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]"), "body.inertia_kgm2: expected a symmetric"),
        (body("[[1, 0, 0], [0, 1, 0], [0, 0, 2.1]]"), "body.inertia_kgm2: expected no principal moment above"),
        (body("[[1, 0, 0], [0, 1, 0], [0, 0, nan]]"), "body.inertia_kgm2[2][2]: expected a finite number"),
        (fine.replace("mass_kg = 1", "mass_kg = 0"), "body.mass_kg"),
        (fine.replace("mass_kg = 1", "mass_kg = inf"), "body.mass_kg: expected a finite number"),
        (fine.clone() + "colour = 3\n", "colour"),
        (fine.clone() + "[[aero.term]]\nto = \"CD\"\nvalue = 1\n", "reference.area_m2"),
        (fine.clone() + "[reference]\narea_m2 = 1\n[[aero.term]]\nto = \"Cl\"\nvalue = 1\n", "reference.span_m"),
        (
            fine.clone() + "[reference]\narea_m2 = 1\n[[aero.term]]\nto = \"CQ\"\nvalue = 1\n",
            "aero.term[0].to: expected one of CD",
        ),
        (
            fine.clone() + "[reference]\narea_m2 = 1\n[[aero.term]]\nto = \"CD\"\n",
            "aero.term[0]: expected a value or a table",
        ),
        (
            fine.clone() + "[reference]\narea_m2 = 1\n[[aero.term]]\nto = \"CD\"\nvalue = 1\ntimes = [\"alfa_rad\"]\n",
            "found alfa_rad, expected one of alpha_rad",
        ),
        (
            fine.clone() + "[reference]\narea_m2 = 1\n[[aero.term]]\nto = \"CD\"\ntable = \"none\"\n",
            "aero.term[0].table",
        ),
        (fine.clone() + "[controls]\nstick = { min = 0, max = 1 }\n", "controls.stick"),
        (fine.clone() + "[controls]\nstick_norm = { min = 1, max = 0 }\n", "controls.stick_norm"),
        (fine.clone() + "[[daveml]]\nfile = \"no such.dml\"\n", "no such.dml"),
        (table("[[1, 1]]", "[1, 1]"), "table.t"),
        (table("[[0, 1]]", "[1]"), "table.t"),
        (table("[[0, 1], [0, 1]]", "[1, 1, 1, 1]"), "table.t.breakpoints: expected one list an axis, 1, found 2"),
    ] {
        let error = Model::from_text(Path::new("m.toml"), &text).unwrap_err().to_string();
        assert!(error.contains(told), "{text}\n{error}");
    }
    // A flat plate and the sum exactly at its bound are bodies.
    assert!(Model::from_text(Path::new("m.toml"), &body("[[1, 0, 0], [0, 1, 0], [0, 0, 2]]")).is_ok());
}

#[test]
fn trim_says_what_is_left_when_nothing_holds() {
    let text = asset("cases/lin182.toml") + "\n[trim]\nvary = [\"elevator_rad\"]\n";
    let error =
        Simulation::new(model("models/lin182.toml"), &case(&text), Inputs::default(), None).unwrap_err().to_string();
    assert!(error.contains("trim") && error.contains("forward_mps2") && error.contains("elevator_rad"), "{error}");
    let unknown = text.replace("elevator_rad", "elevator_deg");
    let error =
        Simulation::new(model("models/lin182.toml"), &case(&unknown), Inputs::default(), None).unwrap_err().to_string();
    assert!(error.contains("found elevator_deg"), "{error}");
    // With speed, elevator and pitch free the constant thrust of the model is met.
    let free = text.replace("vary = [\"elevator_rad\"]", "vary = [\"elevator_rad\", \"speed_mps\", \"pitch_deg\"]");
    let free = free.replace("velocity_body_mps = [", "velocity_ned_mps = [");
    let free: Case = case(&free.replace("seconds = 60.0", "seconds = 300.0"));
    let columns = fly(model("models/lin182.toml"), &free, "");
    // Trimmed to 1e-9 m/s2: the phugoid's slow growth of that in five minutes stays below a millimetre a second.
    assert!((last(&columns, "altitude_m") - columns["altitude_m"][0]).abs() < 1e-3, "{}", last(&columns, "altitude_m"));
}

#[test]
fn a_fast_spin_is_cut_into_pieces_and_keeps_its_angle() {
    // Pure roll: the angle is known. rk4 errs by (angle of a piece / 2)^4 / 120 of it: 2e-6 at a quarter radian.
    for (spin_degps, dt_s) in [(360.0, 0.1), (1_800.0, 0.1), (3_600.0, 1.0 / 60.0), (7_200.0, 1.0 / 120.0)] {
        let initial = format!("altitude_m = 5000\nrates_degps = [{spin_degps:?}, 0, 0]");
        let text = text("g_mps2 = 0", &initial, 60.0, dt_s) + "[atmosphere]\nmodel = \"none\"\n";
        let columns = fly(feather(), &case(&text), "");
        let turned = spin_degps * 60.0;
        let off = (last(&columns, "roll_deg") - turned + 180.0).rem_euclid(360.0) - 180.0;
        assert!(off.abs() < 3e-6 * turned, "{spin_degps} deg/s, {dt_s} s: {off} deg off");
    }
}

#[test]
fn a_mode_that_is_not_of_the_air_is_held_at_rest_too() {
    // A rate damper of 400/s in the thrust: unstable at steps of 10 ms unless cut.
    let damper = "[body]\nmass_kg = 1\ninertia_kgm2 = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n[reference]\narea_m2 = 1\nchord_m = 1\n\
                  [[thrust]]\nforce_N = [0, 0, 400]\nat_m = [1, 0, 0]\ntimes = [\"q_radps\"]\n\
                  [[thrust]]\nforce_N = [0, 0, -400]\ntimes = [\"q_radps\"]\n";
    for speed in [0, 1, 50] {
        let initial = format!("altitude_m = 5000\nvelocity_ned_mps = [{speed}, 0, 0]\nrates_degps = [0, 20, 0]");
        let model = Model::from_text(Path::new("m.toml"), damper).unwrap();
        let columns = fly(model, &case(&text("g_mps2 = 0", &initial, 2.0, 0.01)), "");
        assert!(
            all_finite(&columns) && last(&columns, "q_degps").abs() < 1e-12,
            "{speed}: {}",
            last(&columns, "q_degps")
        );
    }
}

#[test]
fn a_state_that_runs_away_is_said_and_the_last_good_one_kept() {
    // Negative drag through a table of two axes, which meets NaN on its way.
    let mad = FEATHER.replace("value = 1.0", "value = -2.0")
        + "[[aero.term]]\nto = \"CD\"\ntable = \"t\"\n[table.t]\naxes = [\"mach\", \"alpha_rad\"]\nbreakpoints = [[0, 1], [0, 1]]\n\
           values = [0, 0, 0, 0]\ninterpolation = \"pchip\"\n";
    let mad = Model::from_text(Path::new("m.toml"), &mad).unwrap();
    let initial = "altitude_m = 1000\nvelocity_ned_mps = [1, 0, 0]";
    let (columns, ending) = fly_to(mad, &case(&text("", initial, 600.0, 0.1)), "");
    assert!(matches!(ending, Ending::Failed(_)), "{ending:?}");
    assert!(all_finite(&columns) && last(&columns, "tas_mps") < 1e7);
}

#[test]
fn an_input_row_that_changes_nothing_changes_nothing() {
    let calm = asset("cases/lin182.toml");
    for text in [calm.clone(), calm + "\n[turbulence]\nkind = \"dryden\"\nsigma_mps = 2.0\nseed = 3\n"] {
        let none = fly(model("models/lin182.toml"), &case(&text), "");
        let rows = "t_s,elevator_rad\n0.001,\n0.5,\n1.2345,\n7.7,\n";
        let same = fly(model("models/lin182.toml"), &case(&text), rows);
        // The step that a row splits is two steps: the error of fourth order of those changes, nanometres.
        let gap = (last(&none, "altitude_m") - last(&same, "altitude_m")).abs();
        assert!(gap < 1e-6, "{gap}");
    }
}

#[test]
fn a_stop_that_holds_at_the_start_is_told_in_the_only_row() {
    let text = text("", "altitude_m = 10", 5.0, 0.01).replace("[run]", "[run]\nstop = [\"altitude_m<20\"]");
    let (columns, ending) = fly_to(feather(), &case(&text), "");
    assert_eq!((columns["t_s"].len(), ending), (1, Ending::Stop("altitude_m<20".to_owned())));
    let passing = text.replace("altitude_m<20", "altitude_m=5");
    let (columns, ending) = fly_to(feather(), &case(&passing.replace("seconds = 5.0", "seconds = 60.0")), "");
    assert_eq!(ending, Ending::Stop("altitude_m=5".to_owned()));
    assert!((last(&columns, "altitude_m") - 5.0).abs() < 1e-9);
}

#[test]
fn the_angle_of_attack_that_trim_finds_is_the_one_that_is_flown() {
    let rc = || model("models/rc_trainer.toml");
    for (ned, wind) in [
        ([15.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([14.0, 0.0, 0.3], [-3.0, 1.5, 0.5]),
        ([15.0, 2.0, 0.0], [2.0, 0.0, -0.5]),
    ] {
        let [north, east, up] = wind;
        let text = format!(
            "[initial]\naltitude_m = 200\nvelocity_ned_mps = {ned:?}\nrates_frame = \"local\"\n\
             [[wind]]\nnorth_mps = {north:?}\neast_mps = {east:?}\nup_mps = {up:?}\n\
             [trim]\nvary = [\"elevator_trim_deg\", \"throttle_norm\", \"alpha_deg\"]\n[run]\nseconds = 1\ndt_s = 0.01\n"
        );
        let flight = Simulation::new(rc(), &case(&text), Inputs::default(), None).unwrap();
        let found = &flight.trimmed.as_ref().unwrap().values[2];
        let flown = flight.row()[sim::rigid::column::COLUMNS.iter().position(|name| *name == "alpha_deg").unwrap()];
        // Both are angles of a hundredth of a radian, by two ways of a dozen roundings.
        assert!(found.0 == "alpha_deg" && (found.1 - flown).abs() < 1e-11, "{found:?} {flown}");
    }
}
