//! The main job: a flight, flown on a track or by a pilot, drawn, measured and reported.
//!
//! [`plan`] says what is flown; [`headless`] flies it waiting for every block, [`paced`] never waiting, [`window`] with a
//! pilot. All three draw through [`crate::stage`] and [`crate::scenery`] and write down each frame in a
//! [`record::Record`], which becomes the report.

pub mod headless;
pub mod holes;
pub mod inputs;
pub mod paced;
pub mod pictures;
pub mod plan;
pub mod record;
mod trace;
pub mod window;

use crate::failure::Failure;
use crate::output;
use crate::report;
use std::path::Path;
use visual::GpuError;

/// A device's error as a verb's.
pub fn device_failed(error: GpuError) -> Failure {
    Failure::while_doing("drawing", error)
}

/// Writes a report as JSON.
///
/// # Errors
/// [`Failure::Failed`] if it cannot be written.
pub fn write_report(path: &Path, report: &report::Fly) -> Result<(), Failure> {
    output::write_whole(path, format!("{:#}\n", output::to_value(report)?).as_bytes())
}
