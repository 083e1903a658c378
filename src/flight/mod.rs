//! The main job: a flight, flown on a track or by a pilot, drawn, measured and reported.
//!
//! [`plan`] says what is flown; [`headless`] flies it waiting for every block, [`paced`] never waiting, [`window`] with a
//! pilot. All three draw through [`crate::stage`] and [`crate::scenery`] and write down each frame in a
//! [`record::Record`], which becomes the report.

pub mod headless;
pub mod holes;
pub mod paced;
pub mod pictures;
pub mod plan;
pub mod record;
pub mod window;

use crate::failure::Failure;
use crate::output;
use crate::report;
use std::path::{Path, PathBuf};
use visual::GpuError;

/// A device's error as a verb's.
pub fn device_failed(error: GpuError) -> Failure {
    Failure::while_doing("drawing", error)
}

/// Writes a report as JSON beside its place and renames it into it, so that a reader finds a whole report or none.
///
/// # Errors
/// [`Failure::Failed`] if it cannot be written.
pub fn write_report(path: &Path, report: &report::Fly) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::while_doing(format_args!("writing {}", path.display()), error);
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let beside = PathBuf::from(beside);
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    std::fs::write(&beside, format!("{:#}\n", output::to_value(report)?)).map_err(failed)?;
    std::fs::rename(&beside, path).map_err(failed)
}
