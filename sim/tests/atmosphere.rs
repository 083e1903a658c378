//! The standard atmosphere against three independent readings of it, -1 to 30 km.
//!
//! `data/us76_icao.csv`: temperature, pressure, density and speed of sound by the packages ambiance 1.3.1, fluids 1.3.1 and
//! ussa1976 0.3.4, which agree with each other to 4.5e-6 in pressure.

mod flown;

use flown::table;
use sim::atmosphere::{AirSample, Atmosphere};
use std::path::Path;

#[test]
fn the_table_is_met_to_a_hundred_thousandth() {
    let rows = table(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/us76_icao.csv"));
    let air = Atmosphere::standard();
    let quantities = |air: &AirSample| {
        [("T_K", air.temperature_k), ("p_Pa", air.pressure_pa), ("rho", air.density_kgpm3), ("c", air.sound_mps)]
    };
    let mut compared = 0;
    for (i, height_m) in rows["h_geometric_m"].iter().enumerate() {
        let ours = air.at(*height_m);
        for package in ["ambiance", "fluids", "ussa1976"] {
            for (name, ours) in quantities(&ours) {
                // The third package has no row below sea level.
                let theirs = rows[&format!("{package}_{name}")][i];
                if theirs.is_finite() {
                    compared += 1;
                    assert!((ours / theirs - 1.0).abs() < 1e-5, "{package} {name} at {height_m} m: {ours} {theirs}");
                }
            }
        }
    }
    assert!(compared >= 300, "{compared}");
}
