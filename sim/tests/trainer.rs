//! The light trainer of assets/aircraft: its handling, its figures, how it stands.

use sim::handling::{Fixed, level, modes, performance, runway};
use sim::rigid::Model;
use std::path::Path;
use std::sync::Arc;

fn trainer() -> Arc<Model> {
    Arc::new(Model::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/aircraft/trainer.toml")).unwrap())
}

#[test]
fn handling_is_of_level_1() {
    let model = trainer();
    for (altitude_m, speed_mps) in [(0.0, 40.0), (1_524.0, 55.0)] {
        let held = level(&model, altitude_m, Fixed::Speed(speed_mps)).unwrap();
        let found = modes::measure(&held).unwrap();
        println!("{speed_mps} m/s: {found:?}");
        for one in found.judged() {
            println!("  {one:?}");
            assert!(one.passes(), "{one:?}");
        }
    }
}

#[test]
fn it_flies_by_its_handbook() {
    let model = trainer();
    let mut all = performance::figures(&model).unwrap();
    all.extend(runway::figures(&model).unwrap());
    for one in &all {
        println!(
            "{}: {:.3} {} against {:.3}, {:+.1} %",
            one.name,
            one.found,
            one.unit,
            one.handbook,
            100.0 * one.off()
        );
    }
    assert!(all.len() >= 6 && all.iter().all(|one| one.passes()), "{all:#?}");
}

#[test]
fn trimmed_and_hands_off_it_stays_for_a_minute() {
    use sim::integrate::{Motion as _, rk4};
    use sim::rigid::motion::{self, State};
    let model = trainer();
    let mut held = level(&model, 1_500.0, Fixed::Speed(55.0)).unwrap();
    let straight = motion::position(&held.y) + motion::velocity(&held.y) * 60.0;
    let dt_s = 1.0 / 120.0;
    for step in 0..60 * 120 {
        let y = rk4(f64::from(step) * dt_s, &held.y, dt_s, |t, y: &State| held.motion.rate(t, y));
        held.y = motion::normalised(y);
        held.motion.turn_shaft(&y, dt_s);
    }
    let off_m = motion::position(&held.y).distance(straight);
    println!("{off_m} m off after a minute");
    assert!(off_m < 10.0, "{off_m} m");
}
