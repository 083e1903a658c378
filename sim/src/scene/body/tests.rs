//! Bodies at rest, and bodies that run away.

use super::*;
use crate::scene::{Freeze, SceneGround, Surroundings};
use std::path::Path;
use std::sync::Arc;

fn rig(text: &str) -> Rig {
    let body = "[body]\nmass_kg = 10.0\ninertia_kgm2 = [[1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, 2.0]]\n";
    let reference = "[reference]\narea_m2 = 1.0\nspan_m = 1.0\nchord_m = 1.0\n";
    let model = Model::from_text(Path::new("body.toml"), &format!("{body}{reference}{text}")).unwrap();
    Rig::new(&Arc::new(model), &Surroundings::default().weightless())
}

fn body(rig: &mut Rig, velocity_mps: DVec3, rates_radps: DVec3) -> Body {
    let start = BodyStart {
        model: String::new(),
        position_m: DVec3::Y * 1_000.0,
        velocity_mps,
        attitude: DQuat::IDENTITY,
        rates_radps,
        fuel: None,
    };
    Body::new(&start, 0, rig, &[1], &Surroundings::default().weightless()).unwrap()
}

#[test]
fn a_million_steps_at_rest_or_of_decay_leave_no_denormal_number() {
    let damps = |to: &str, hat: &str| format!("[[aero.term]]\nto = \"{to}\"\nvalue = -9.0\ntimes = [\"{hat}\"]\n");
    let damped = [("Cl", "p_hat"), ("Cm", "q_hat"), ("Cn", "r_hat")].map(|(to, hat)| damps(to, hat)).concat();
    let (ground, dt_s) = (SceneGround::void(), 1.0 / 120.0);
    let spinning = DVec3::new(1.0, 0.5, 0.2);
    for (steps, velocity_mps, rates) in [(1_000_000, DVec3::ZERO, DVec3::ZERO), (200_000, DVec3::X * 5.0, spinning)] {
        let mut rig = rig(&damped);
        let mut body = body(&mut rig, velocity_mps, rates);
        let mut subnormal = 0;
        for _ in 0..steps {
            assert_eq!(body.step(&mut rig, &ground, Freeze::None, dt_s), Outcome::Flies);
            subnormal += body.state.iter().filter(|number| number.is_subnormal()).count();
        }
        assert_eq!(subnormal, 0);
        assert_eq!(motion::rates(&body.state), DVec3::ZERO, "what decays is at rest in the end");
    }
}

#[test]
fn numbers_that_run_away_end_a_flight_at_its_last_good_state() {
    let growing = "[[aero.term]]\nto = \"CX\"\nvalue = 1e200\n";
    let mut rig = rig(growing);
    let mut body = body(&mut rig, DVec3::NEG_Z * 50.0, DVec3::ZERO);
    let outcome = (0..100).map(|_| body.step(&mut rig, &SceneGround::void(), Freeze::None, 0.01));
    let ended = outcome.into_iter().find(|outcome| *outcome != Outcome::Flies);
    assert!(matches!(ended, Some(Outcome::Ended(..))), "{ended:?}");
    assert!(body.state.iter().all(|number| number.is_finite()));
}

#[test]
fn a_restored_body_without_its_slow_controls_is_refused() {
    let model = Arc::new(crate::rigid::builtin::named("jet").unwrap().unwrap());
    let around = Surroundings::default();
    let mut rig = Rig::new(&model, &around);
    let start = BodyStart {
        model: String::new(),
        position_m: DVec3::Y * 3_000.0,
        velocity_mps: DVec3::NEG_Z * 200.0,
        attitude: DQuat::IDENTITY,
        rates_radps: DVec3::ZERO,
        fuel: None,
    };
    let mut body = Body::new(&start, 0, &mut rig, &[1], &around).unwrap();
    body.check(&model).unwrap();
    body.moved.clear();
    assert!(body.check(&model).unwrap_err().to_string().contains("body.moved"));
}
