//! Steps of what flies: a rigid body, a shell, and a shell's swept step against the ground.
//!
//! The rigid body is a light aircraft from a file: flat Earth with Coriolis and gravity by height, standard air, tables of
//! lift, drag and thrust, rk4 at 120 Hz. Its yardstick is JSBSim's own light aircraft at the same rate, which also
//! has an engine's inside, fuel, gear and a control system, and takes one evaluation a step where ours takes four. A shell's
//! yardstick is JSBSim's bomb, and a point mass written out here. All take turns in every round.
//!
//! Scenes of many entities stand in [`entities`], what lies about in [`loose`].

mod entities;
mod jsbsim;
mod loose;
mod shell;
mod swept;

use super::OWN;
use super::statistics::{Against, Better, ROUNDS, WARM_UPS, alone, beside};
use crate::failure::Failure;
use crate::report::{BenchResult, Skipped};
use jsbsim::Jsbsim;
use sim::case::Case;
use sim::integrate::Motion as _;
use sim::rigid::{Inputs, Model, Simulation};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;
use terrain::Area;

const LIGHT: &str = include_str!("light.toml");
const CASE: &str = "[frame]\nkind = 'flat'\ngravity = 'inverse_square'\nlatitude_deg = 42\nrotation_radps = 7.292115e-5\n\
    [initial]\naltitude_m = 914\nvelocity_body_mps = [51.4, 0, 1.3]\n\
    [run]\nseconds = 60\ndt_s = 0.008333333333333333\n";

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Steps of ours in a round.
    pub steps: u32,
    /// Steps of JSBSim in a round.
    pub yardstick_steps: u32,
    /// Rounds that count.
    pub rounds: u32,
    /// Steps of a scene of ten thousand in a round.
    pub scene_steps: u32,
    /// Whether to ask JSBSim.
    pub ask: bool,
}

impl Load {
    /// What the program measures with.
    pub const FULL: Self = Self { steps: 50_000, yardstick_steps: 5_000, rounds: ROUNDS, scene_steps: 4, ask: true };
}

/// Results, and what could not be compared.
pub struct Flown {
    /// Ours, beside JSBSim where it is there.
    pub results: Vec<BenchResult>,
    /// What is missing.
    pub skipped: Vec<Skipped>,
}

/// What each round tells, nanoseconds.
#[derive(Default)]
struct Times {
    step: Vec<f64>,
    rates: Vec<f64>,
    air: Vec<f64>,
    loads: Vec<f64>,
    jsbsim: Vec<f64>,
    shell: Vec<f64>,
    plain: Vec<f64>,
    bomb: Vec<f64>,
    swept: Vec<f64>,
    segment: Vec<f64>,
}

/// Measures on a world's ground.
///
/// # Errors
/// [`Failure::Failed`] if a built-in model cannot be flown, or JSBSim ends in mid-run.
pub fn bench(area: &Area, load: Load) -> Result<Flown, Failure> {
    let flight = light()?;
    let shell = shell::Shell::new()?;
    let paths = swept::paths(area);
    let yardstick = if load.ask { Jsbsim::start() } else { Err("not asked for".to_owned()) };
    let mut yardstick = yardstick.map_err(|reason| Skipped { name: "flight beside JSBSim".into(), reason });
    let mut times = Times::default();
    let mut scenes = entities::Scenes::new(area)?;
    let mut lying = loose::Lying::new(area)?;
    for round in 0..WARM_UPS + load.rounds {
        if round == WARM_UPS {
            times = Times::default();
            scenes.forget();
            lying.forget();
            yardstick.iter_mut().for_each(|jsbsim| jsbsim.nothing_ns.clear());
        }
        if let Ok(jsbsim) = &mut yardstick {
            times.jsbsim.push(jsbsim.step_ns("c172x", load.yardstick_steps)?);
            times.bomb.push(jsbsim.step_ns("mk82", load.yardstick_steps)?);
        }
        let mut flown = flight.clone();
        times.step.push(each_ns(load.steps, || flown.step()));
        times.rates.push(4.0 * each_ns(load.steps, || flight.motion.rate(0.0, black_box(flight.state()))));
        let air = &flight.motion.atmosphere;
        times.air.push(4.0 * each_ns(load.steps, || air.at(black_box(914.0))));
        let sample = flight.motion.sample(flight.state(), false);
        let cg_m = flight.motion.cg_m;
        let (mut memory, mut slots) = (flight.motion.model.memory(), sample.slots);
        times.loads.push(
            4.0 * each_ns(load.steps, || {
                flight.motion.model.loads(black_box(&mut slots), sample.through_air, 1_500.0, 1.0, cg_m, &mut memory)
            }),
        );
        times.shell.push(shell.step_ns(load.steps)?);
        times.plain.push(shell::plain_step_ns(load.steps));
        let (swept_ns, segment_ns) = swept::each_ns(area, &paths);
        times.swept.push(swept_ns);
        times.segment.push(segment_ns);
        scenes.round(load.scene_steps);
        lying.round(load.scene_steps);
    }
    let mut told = told(&times, yardstick);
    told.results.extend(scenes.results());
    told.results.extend(lying.results());
    Ok(told)
}

fn told(times: &Times, yardstick: Result<Jsbsim, Skipped>) -> Flown {
    let ns = "ns";
    let light_note = "rk4 at 120 Hz: four evaluations of air, tables, coefficients and gravity a step; one core";
    let shell_note = "rk4, G7 with a smooth curve, air by height, flat; one core";
    let (mut results, mut skipped) = (Vec::new(), Vec::new());
    match yardstick {
        Ok(jsbsim) => {
            let nothing = super::statistics::median(&jsbsim.nothing_ns);
            let name = "JSBSim c172x at 120 Hz, its loop in Python";
            let against = Against { name, version: &jsbsim.version, values: &times.jsbsim };
            let note = format!(
                "{light_note}; the yardstick's aircraft evaluates once a step, and has an engine's inside, fuel, gear and \
                 a control system too; a call from Python that does nothing takes {nothing:.0} ns of its time"
            );
            results.push(beside("rigid body, step", ns, Better::Less, &times.step, against, note));
            let name = "JSBSim mk82 at 120 Hz, its loop in Python";
            let against = Against { name, version: &jsbsim.version, values: &times.bomb };
            results.push(beside(
                "shell, step, against JSBSim's bomb",
                ns,
                Better::Less,
                &times.shell,
                against,
                shell_note,
            ));
        }
        Err(reason) => {
            results.push(alone("rigid body, step", ns, &times.step, light_note));
            skipped.push(reason);
        }
    }
    results.push(alone("rigid body, four rates", ns, &times.rates, "the step without its sums: its floor"));
    results.push(alone("rigid body, four times the loads", ns, &times.loads, "tables, terms, forces and moments"));
    results.push(alone("rigid body, four times the air", ns, &times.air, "one power each"));
    let name = "point mass written out, constant Cd and density, rk4";
    let against = Against { name, version: OWN, values: &times.plain };
    results.push(beside("shell, step", ns, Better::Less, &times.shell, against, shell_note));
    let against = Against { name: "the segment alone", version: OWN, values: &times.segment };
    let note = "steps of 1/120 s at 760 m/s over mountains, from well above to close to the ground";
    results.push(beside("shell, swept impact of a step", ns, Better::Less, &times.swept, against, note));
    Flown { results, skipped }
}

/// The light aircraft in level flight.
fn light() -> Result<Simulation, Failure> {
    let failed = |error: sim::file::FileError| Failure::while_doing("reading a built-in aircraft", error);
    let model = Model::from_text(Path::new("light.toml"), LIGHT).map_err(failed)?;
    let case = Case::from_text(Path::new("light.case"), CASE).map_err(failed)?;
    Simulation::new(model, &case, Inputs::default(), None).map_err(failed)
}

/// Nanoseconds of a piece of work, over many.
fn each_ns<T>(count: u32, mut work: impl FnMut() -> T) -> f64 {
    let start = Instant::now();
    for _ in 0..count {
        black_box(work());
    }
    start.elapsed().as_secs_f64() * 1e9 / f64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use terrain::{Grid, Ground, synthetic};

    #[test]
    fn the_aircraft_stays_in_the_air_for_as_long_as_it_is_timed() {
        let mut flight = light().unwrap();
        let (mut low_m, mut high_m) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..Load::FULL.steps {
            flight.step();
            let height_m = -flight.state()[2];
            (low_m, high_m) = (low_m.min(height_m), high_m.max(height_m));
        }
        println!("{} s of flight between {low_m:.0} and {high_m:.0} m", flight.t_s());
        assert!(low_m > 100.0 && high_m < 8_000.0, "{low_m} {high_m}");
        assert_eq!(flight.most_pieces, 1, "a step must be one step");
    }

    #[test]
    fn every_result_has_a_name_of_its_own() {
        let area = Ground::new(Arc::new(synthetic::ridges(Grid::centred(200.0, 4, 4).unwrap(), 5))).whole();
        let flown =
            bench(&area, Load { steps: 50, yardstick_steps: 5, rounds: 2, scene_steps: 1, ask: false }).unwrap();
        assert!(flown.skipped.len() == 1 && flown.results.len() >= 6);
        for (at, result) in flown.results.iter().enumerate() {
            assert!(result.ours > 0.0 && result.rounds == 2, "{result:?}");
            assert!(flown.results[..at].iter().all(|other| other.name != result.name));
        }
    }
}
