//! What the physics of flight costs and how wrong it is: integrators, steps and precisions, depths of gravity, tiers of
//! ballistics.
//!
//! Errors are exact properties of the models, the same on every machine; costs are measured in rounds in which all
//! values of a knob take turns. A knob with several curves is several knobs of one `group`.

mod ballistics;
mod gravity;
mod lin182;
mod shots;
mod steps;

use crate::bench::statistics::{interleave, median};
use crate::failure::Failure;
use crate::report::{KnobPoint, Trade};
use std::time::Instant;

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Fewer steps.
    pub quick: bool,
    /// Rounds of each cost.
    pub rounds: u32,
}

impl Effort {
    /// Half a minute.
    pub const FULL: Self = Self { quick: false, rounds: 9 };
    /// Some seconds.
    pub const QUICK: Self = Self { quick: true, rounds: 5 };
}

/// Measures every knob of flight; `tell` hears what is being done.
///
/// # Errors
/// [`Failure::Failed`] if a model that is built in cannot be flown.
pub fn measure(effort: Effort, tell: &mut dyn FnMut(&str)) -> Result<Trade, Failure> {
    tell("integrators, steps and precisions");
    let (mut knobs, converged) = steps::knobs(effort)?;
    tell("depths of gravity");
    knobs.extend(gravity::knobs(effort)?);
    tell("tiers of ballistics");
    knobs.extend(ballistics::knobs(effort)?);
    knobs.extend(shots::knobs(effort)?);
    let conditions = format!("{converged}; costs are medians of {} rounds in turns, one core", effort.rounds);
    Ok(Trade { knobs, conditions })
}

/// Medians of what pieces of work cost, in seconds each; they take turns.
fn costs_s(rounds: u32, works: &mut [Box<dyn FnMut() + '_>]) -> Result<Vec<f64>, Failure> {
    let mut timed: Vec<_> = works
        .iter_mut()
        .map(|work| {
            move || {
                let start = Instant::now();
                work();
                Ok::<_, Failure>(start.elapsed().as_secs_f64())
            }
        })
        .collect();
    let mut subjects: Vec<&mut dyn FnMut() -> Result<f64, Failure>> =
        timed.iter_mut().map(|work| work as &mut dyn FnMut() -> Result<f64, Failure>).collect();
    Ok(interleave(1, rounds, &mut subjects)?.iter().map(|values| median(values)).collect())
}

/// The setting with the least error.
fn best(points: &[KnobPoint]) -> Option<f64> {
    points.iter().min_by(|a, b| a.error.total_cmp(&b.error)).map(|point| point.setting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Knob;

    #[test]
    fn every_knob_runs_from_coarse_to_fine_with_errors_that_are_numbers() {
        let trade = measure(Effort { quick: true, rounds: 1 }, &mut |_| ()).unwrap();
        let mut names: Vec<&str> = trade.knobs.iter().map(|knob| knob.name.as_str()).collect();
        assert!(names.contains(&"integrator rk4 f32") && names.contains(&"gravity drop"), "{names:?}");
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        for knob in &trade.knobs {
            assert!(knob.points.len() >= 2 && !knob.unit.is_empty() && !knob.cost_unit.is_empty(), "{}", knob.name);
            assert!(knob.points.iter().all(|point| point.error.is_finite() && point.cost > 0.0), "{knob:?}");
            let rising = knob.points.windows(2).all(|pair| pair[1].setting > pair[0].setting);
            let falling = knob.points.windows(2).all(|pair| pair[1].setting < pair[0].setting);
            assert!(rising || falling, "{}", knob.name);
        }
        let knob = |name: &str| trade.knobs.iter().find(|knob| knob.name == name).unwrap();
        let ends = |knob: &Knob| {
            let error = |point: Option<&KnobPoint>| point.map_or(f64::NAN, |point| point.error);
            let least = knob.points.iter().map(|point| point.error).fold(f64::INFINITY, f64::min);
            (error(knob.points.first()), least, error(knob.points.last()))
        };
        // Single precision has a best step; beyond it rounding grows with the number of steps.
        for name in ["integrator rk4 f32", "integrator rk2 f32"] {
            let (coarsest, least, finest) = ends(knob(name));
            assert!(finest > 10.0 * least && coarsest > 2.0 * least, "{name}: {coarsest} {least} {finest}");
            let (best, points) = (knob(name).best.unwrap(), &knob(name).points);
            assert!(points[0].setting < best && best < points[points.len() - 1].setting, "{name}: {best}");
        }
        let (coarsest, least, finest) = ends(knob("integrator rk4 f64"));
        assert!(least < 1e-6 && finest < 1e-6 && coarsest > 1e-3, "{coarsest} {least} {finest}");
    }
}
