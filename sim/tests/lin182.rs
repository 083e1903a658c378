//! A pulsed flight of the linear Cessna 182 against an independent solution, and what must not change it.
//!
//! `data/lin182_scipy.csv`: the same model integrated by SciPy's DOP853 (relative tolerance 1e-11), whole seconds; feet,
//! degrees. Its floor is 1.5 micrometres.

mod flown;

use flown::{Columns, FT_M, asset, case, fly, fly_to, model, table};
use sim::rigid::simulation::Ending;
use std::path::Path;

fn reference() -> Columns {
    table(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lin182_scipy.csv"))
}

fn flown(replace: &[(&str, &str)], inputs: &str) -> Columns {
    let text = replace.iter().fold(asset("cases/lin182.toml"), |text, (from, to)| text.replace(from, to));
    fly(model("models/lin182.toml"), &case(&text), inputs)
}

/// Greatest distance from the reference at its times, metres.
fn off_m(ours: &Columns, reference: &Columns) -> f64 {
    let mut most = 0.0f64;
    for (i, t) in reference["t_s"].iter().enumerate() {
        let at = ours["t_s"].partition_point(|own| *own < t - 1e-6);
        assert!((ours["t_s"][at] - t).abs() < 1e-6);
        let gap = |own: &str, their: &str| ours[own][at] - reference[their][i] * FT_M;
        let square =
            gap("north_m", "north_ft").powi(2) + gap("east_m", "east_ft").powi(2) + gap("altitude_m", "h_ft").powi(2);
        most = most.max(square.sqrt());
    }
    most
}

#[test]
fn sixty_seconds_at_sixty_hertz_are_within_a_twentieth_of_a_millimetre() {
    let off = off_m(&flown(&[], &asset("inputs/lin182.csv")), &reference());
    println!("lin182, rk4 at 60 Hz: {off:.2e} m");
    assert!(off < 5e-5, "{off} m");
}

#[test]
fn edges_off_the_grid_cost_nothing() {
    // Steps of 1/61 s: no edge but that at 0 lies on the grid.
    let odd = [("dt_s = 0.016666666666666666", "dt_s = 0.01639344262295082")];
    let off = off_m(&flown(&odd, &asset("inputs/lin182.csv")), &reference());
    println!("lin182, rk4 at 61 Hz, all edges off the grid: {off:.2e} m");
    assert!(off < 5e-5, "{off} m");
}

#[test]
fn two_edges_within_a_step_and_one_exactly_on_it_are_all_taken() {
    // A pulse of 4 ms that begins and ends inside one step of 1/60 s, and one whose edges are steps of the grid.
    let pulse = |from: f64, to: f64| format!("t_s,elevator_rad\n0,0.035\n{from},0.075\n{to},0.035\n");
    for (from, to) in [(2.001, 2.005), (2.0, 2.0 + 1.0 / 60.0)] {
        let short = [("seconds = 60.0", "seconds = 5.0")];
        let fine = [("seconds = 60.0", "seconds = 5.0"), ("dt_s = 0.016666666666666666", "dt_s = 0.0005")];
        let (coarse, fine) = (flown(&short, &pulse(from, to)), flown(&fine, &pulse(from, to)));
        let still = flown(&short, "t_s,elevator_rad\n0,0.035\n");
        let end = |columns: &Columns| *columns["altitude_m"].last().unwrap();
        let (moved, gap) = ((end(&fine) - end(&still)).abs(), (end(&coarse) - end(&fine)).abs());
        assert!(moved > 1e-3, "the pulse is felt: {moved}");
        // Fourth order at 60 Hz is 1e-6 m after a minute of larger pulses than these.
        assert!(gap < 1e-6, "{gap} of {moved}");
    }
}

#[test]
fn the_spacing_of_rows_changes_nothing_and_rows_between_steps_lie_on_the_flight() {
    let inputs = asset("inputs/lin182.csv");
    let (each, odd) = (flown(&[], &inputs), flown(&[("output_dt_s = 0.1", "output_dt_s = 0.07")], &inputs));
    for name in ["north_m", "east_m", "altitude_m", "qw", "r_degps"] {
        assert_eq!(each[name].last().unwrap().to_bits(), odd[name].last().unwrap().to_bits(), "{name}");
    }
    // Rows at 0.07, 0.14 .. against the same times of a flight whose steps end there.
    let steps = [("output_dt_s = 0.1", "output_dt_s = 0.07"), ("dt_s = 0.016666666666666666", "dt_s = 0.014")];
    let on_steps = flown(&steps, &inputs);
    for (i, t) in odd["t_s"].iter().enumerate().take(800) {
        let gap = (odd["altitude_m"][i] - on_steps["altitude_m"][i]).abs();
        // Both are within the fourth-order error of 2e-6 m of the flight.
        assert!((on_steps["t_s"][i] - t).abs() < 1e-9 && gap < 5e-6, "{t} s: {gap} m");
    }
}

#[test]
fn other_integrators_have_their_own_order_of_error() {
    let inputs = asset("inputs/lin182.csv");
    let reference = reference();
    let off = |name: &str, dt_s: f64| {
        let text = format!("integrator = \"{name}\"\ndt_s = {dt_s:?}");
        off_m(&flown(&[("dt_s = 0.016666666666666666", &text)], &inputs), &reference)
    };
    for (name, order) in [("rk2", 2.0), ("ab2", 2.0), ("semi_euler", 1.0)] {
        let (coarse, fine) = (off(name, 1.0 / 100.0), off(name, 1.0 / 200.0));
        let found = (coarse / fine).log2();
        println!("lin182, {name}: {coarse:.2e} m at 100 Hz, {fine:.2e} m at 200 Hz, order {found:.2}");
        // Whole seconds lie on both grids; the edges restart ab2, whose history would else break its order.
        assert!((found - order).abs() < 0.1, "{name}: order {found}");
    }
}

#[test]
fn a_stop_is_found_within_its_step() {
    let text = asset("cases/lin182.toml").replace("[run]", "[run]\nstop = [\"altitude_m<1500\"]");
    let text = text
        .replace("seconds = 60.0", "seconds = 600.0")
        .replace("attitude_deg = [0.0, 0.0, 0.0]", "attitude_deg = [0.0, -20.0, 0.0]");
    let (columns, ending) = fly_to(model("models/lin182.toml"), &case(&text), "");
    assert_eq!(ending, Ending::Stop("altitude_m<1500".to_owned()));
    let end = columns["altitude_m"].last().unwrap();
    // The time is found to f64 rounding; 80 m/s times 2^-52 of a minute, and roundings of 1500 m.
    assert!(*end < 1_500.0 && *end > 1_500.0 - 1e-9, "{end}");
    assert!(columns["t_s"].windows(2).all(|pair| pair[0] < pair[1]));
}
