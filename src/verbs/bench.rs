//! `poligon bench`: speed beside a yardstick in the same run.

use crate::args::BenchArgs;
use crate::bench::{bake, flight, frame, ground, mesh, plants, scene};
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::report;
use crate::values::Subject;
use crate::views::Views;
use std::sync::Arc;
use terrain::Ground;

/// Rounds of baking: each takes half a minute of three bakes.
const BAKES: u32 = 7;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &BenchArgs, output: Output) -> Result<(), Failure> {
    let wanted = |subject| args.subject == subject || args.subject == Subject::All;
    let world = Arc::new(open_world::open(args.world.as_deref())?);
    let mut report = report::Bench::default();
    if wanted(Subject::Ground) {
        tell_subject("ground queries");
        report.results.extend(ground::bench(&world.field, ground::Load::FULL)?);
    }
    if wanted(Subject::Flight) {
        tell_subject("steps of what flies");
        let flown = flight::bench(&Ground::new(world.field.clone()).whole(), flight::Load::FULL)?;
        report.results.extend(flown.results);
        report.skipped.extend(flown.skipped);
    }
    if wanted(Subject::Mesh) {
        tell_subject("building blocks");
        report.results.extend(mesh::bench(&world, mesh::Load::FULL)?);
    }
    if wanted(Subject::Plants) {
        tell_subject("placing plants");
        report.results.extend(plants::bench(&world, plants::Load::FULL)?);
    }
    if wanted(Subject::Frame) {
        tell_subject("frames");
        match visual::Gpu::headless() {
            Ok(_) => report.results.extend(frame::bench(&world, frame::Load::FULL)?),
            Err(reason) => {
                report.skipped.push(report::Skipped { name: "frame".into(), reason: reason.to_string() });
            }
        }
    }
    if wanted(Subject::Scene) {
        tell_subject("what stands on the ground");
        match visual::Gpu::headless() {
            Ok(_) => report.results.extend(scene::bench(&world, &Views::read(None)?, scene::Load::FULL)?),
            Err(reason) => {
                report.skipped.push(report::Skipped { name: "scene".into(), reason: reason.to_string() });
            }
        }
    }
    if wanted(Subject::Bake) {
        tell_subject("baking");
        let baked = bake::bench(BAKES)?;
        report.results.extend(baked.results);
        report.skipped.extend(baked.skipped);
    }
    output.print(&report)
}

fn tell_subject(subject: &str) {
    output::tell(format_args!("poligon: measuring {subject}"));
}
