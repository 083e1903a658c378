//! `poligon`: the program. Reads the command line, runs one verb, tells how it ended.
//!
//! stdout carries the verb's report only (see [`output`]); all else goes to stderr. Exit status: 0 done, 1 failed,
//! 2 misuse.
#![forbid(unsafe_code)]

mod ahead;
mod args;
mod bench;
mod failure;
mod flight;
mod fog_base;
mod gpu_proof;
mod ground_edit;
mod hud;
mod models;
mod open_world;
mod output;
mod plot;
mod points;
mod progress;
mod report;
mod scenery;
mod stage;
mod sticks;
mod still;
mod things;
mod trade;
mod values;
mod verbs;
mod views;

use args::{CommandLine, Verb};
use clap::Parser;
use failure::Failure;
use output::Output;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let started = Instant::now();
    let line = match CommandLine::try_parse() {
        Ok(line) => line,
        Err(told) => {
            // Help and version come this way too, for stdout. If neither stream can be written there is no one to tell.
            let _ = told.print();
            return ExitCode::from(if told.use_stderr() { 2 } else { 0 });
        }
    };
    match run(&line, started) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::tell(format_args!("poligon: {failure}"));
            failure.exit_code()
        }
    }
}

fn run(line: &CommandLine, started: Instant) -> Result<(), Failure> {
    let output = if line.json { Output::Json } else { Output::Table };
    match &line.verb {
        Verb::Fly(args) => verbs::fly::run(args, output, started),
        Verb::Bake(args) => verbs::bake::run(args, output),
        Verb::Info(args) => verbs::info::run(args, output),
        Verb::Verify(args) => verbs::verify::run(args, output),
        Verb::Height(args) => verbs::height::run(args, output),
        Verb::Sight(args) => verbs::sight::run(args, output),
        Verb::Simulate(args) => verbs::simulate::run(args, output),
        Verb::Modes(args) => verbs::modes::run(args, output),
        Verb::Shot(args) => verbs::shot::run(args, output),
        Verb::Gallery(args) => verbs::gallery::run(args, output),
        Verb::Input(args) => verbs::input::run(args, output),
        Verb::Bench(args) => verbs::bench::run(args, output),
        Verb::Trade(args) => verbs::trade::run(args, output),
        Verb::Trajectory(args) => verbs::trajectory::run(args, output),
    }
}
