//! One file a verb. Each reads its arguments, calls the crates, prints one report.
//!
//! A verb prints its report also when the proof in it failed, and then returns the failure: a script sees both.

pub mod bake;
pub mod bench;
pub mod fly;
pub mod height;
pub mod info;
pub mod shot;
pub mod sight;
pub mod trade;
pub mod verify;

use crate::failure::Failure;

/// What a verb answers while its part of the program does not exist.
fn not_built_yet<T>(verb: &str) -> Result<T, Failure> {
    Err(Failure::Failed(format!("`{verb}` is not built yet in this version")))
}
