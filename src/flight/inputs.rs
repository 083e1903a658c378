//! A pilot's inputs from and to a file.

use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::output;
use sim::Scene;
use sim::input::recording;
use std::{fs, io};

/// Largest file read, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// Prepares a scene: what is to be played is scheduled, what is to be kept is recorded.
///
/// # Errors
/// [`Failure::Failed`] names the file and the line.
pub fn prepare(args: &FlyArgs, scene: &mut Scene) -> Result<(), Failure> {
    if args.record.is_some() {
        scene.start_record();
    }
    let Some(file) = &args.inputs else { return Ok(()) };
    let failed = |why: &dyn std::fmt::Display| Failure::Failed(format!("{}: {why}", file.display()));
    let long = |bytes: u64| io::Error::other(format!("expected at most {MOST_BYTES} bytes, found {bytes}"));
    let text = fs::metadata(file)
        .and_then(|about| if about.len() > MOST_BYTES { Err(long(about.len())) } else { Ok(()) })
        .and_then(|()| fs::read_to_string(file))
        .map_err(|error| failed(&error))?;
    for stamped in recording::parse(&text, scene.clock.step_hz()).map_err(|error| failed(&error))? {
        scene.schedule(stamped).map_err(|error| failed(&error))?;
    }
    Ok(())
}

/// Writes what was recorded.
///
/// # Errors
/// [`Failure::Failed`] if it cannot be written.
pub fn keep(args: &FlyArgs, scene: &Scene) -> Result<(), Failure> {
    let Some(file) = &args.record else { return Ok(()) };
    output::write_whole(file, recording::written(scene.record(), scene.clock.step_hz()).as_bytes())
}
