//! Integrator, step and precision: the position after a minute of pulsed flight against the time that it takes.
//!
//! The subject is [`super::lin182`], flown by the very code that flies everything else, once in f64 and once in f32.
//! Setting: steps a second. Error: distance from the converged position, metres. Cost: microseconds a simulated second.
//! Where a flight falls apart (the step is too long for its roll mode) there is no point.

use super::lin182::{N, SECONDS, apart_m, fly};
use super::{Effort, best, costs_s};
use crate::failure::Failure;
use crate::report::{Knob, KnobPoint};
use num_traits::Float;
use sim::integrate::Integrator;
use std::hint::black_box;

const STEPS_HZ: [u32; 14] = [2, 3, 5, 8, 12, 20, 30, 60, 120, 240, 480, 1_000, 2_000, 4_000];
const QUICK_HZ: [u32; 9] = [5, 12, 20, 30, 60, 120, 480, 1_000, 4_000];
/// Steps a second of the reference, between those that are measured: fine enough for truncation, coarse enough for
/// rounding, which grows with the number of steps.
const REFERENCE_HZ: u32 = 600;
/// Steps a second of its neighbours, which must agree with it.
const NEIGHBOURS_HZ: [u32; 2] = [500, 720];
/// A minute's flight is four kilometres: what is farther off than that has fallen apart.
const APART_M: f64 = 4_000.0;
/// Steps at least in what is timed at once, so that a clock's tick does not show.
const TIMED_STEPS: u32 = 30_000;

/// A knob for each integrator and precision, and how the reference is known to be converged.
///
/// # Errors
/// None in practice; costs are measured by what may fail.
pub fn knobs(effort: Effort) -> Result<(Vec<Knob>, String), Failure> {
    let reference = fly::<f64>(Integrator::Rk4, REFERENCE_HZ, SECONDS);
    let neighbours = NEIGHBOURS_HZ.map(|steps_hz| apart_m(&fly::<f64>(Integrator::Rk4, steps_hz, SECONDS), &reference));
    let agreed_m = neighbours.into_iter().fold(0.0, f64::max);
    let rows: &[u32] = if effort.quick { &QUICK_HZ } else { &STEPS_HZ };
    let mut curves: Vec<(Integrator, &'static str, Vec<KnobPoint>)> = Vec::new();
    for integrator in [Integrator::Rk4, Integrator::Rk2, Integrator::Ab2, Integrator::SemiEuler] {
        curves.push((integrator, "f64", points::<f64>(integrator, rows, &reference)));
        curves.push((integrator, "f32", points::<f32>(integrator, rows, &reference)));
    }
    let mut works: Vec<Box<dyn FnMut()>> = Vec::new();
    for (integrator, precision, points) in &curves {
        for point in points {
            let (integrator, steps_hz) = (*integrator, point.setting as u32);
            let seconds = timed_s(steps_hz);
            works.push(match *precision {
                "f32" => Box::new(move || {
                    black_box(fly::<f32>(integrator, black_box(steps_hz), seconds));
                }),
                _ => Box::new(move || {
                    black_box(fly::<f64>(integrator, black_box(steps_hz), seconds));
                }),
            });
        }
    }
    let mut costs = costs_s(effort.rounds, &mut works)?.into_iter();
    let knobs = curves.into_iter().map(|(integrator, precision, mut points)| {
        for point in &mut points {
            let seconds = timed_s(point.setting as u32);
            point.cost = costs.next().unwrap_or(f64::NAN) * 1e6 / f64::from(seconds);
        }
        Knob {
            name: format!("integrator {} {precision}", integrator.name()),
            unit: "steps a second".into(),
            error_unit: "m from the converged position after 60 s of pulsed flight".into(),
            cost_unit: "microseconds a simulated second".into(),
            group: Some("integrator".into()),
            best: best(&points),
            points,
        }
    });
    let converged = format!(
        "flight: a light aircraft with linear derivatives, 60 s; reference rk4 f64 at {REFERENCE_HZ} Hz, with which \
         {} and {} Hz agree to {agreed_m:.0e} m: errors below that are noise",
        NEIGHBOURS_HZ[0], NEIGHBOURS_HZ[1]
    );
    Ok((knobs.collect(), converged))
}

/// Seconds of flight that are timed at once; the controls' pulses are over after eleven, and cost nothing.
fn timed_s(steps_hz: u32) -> u32 {
    (TIMED_STEPS / steps_hz).clamp(1, 1_000)
}

/// Errors of one curve, where the flight holds together.
fn points<T: Float>(integrator: Integrator, rows: &[u32], reference: &[f64; N]) -> Vec<KnobPoint> {
    let one = |&steps_hz: &u32| KnobPoint {
        setting: f64::from(steps_hz),
        error: apart_m(&fly::<T>(integrator, steps_hz, SECONDS), reference),
        ..KnobPoint::default()
    };
    rows.iter().map(one).filter(|point| point.error < APART_M).collect()
}
