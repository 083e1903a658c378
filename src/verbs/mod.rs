//! One file a verb. Each reads its arguments, calls the crates, prints one report.
//!
//! A verb prints its report also when the proof in it failed, and then returns the failure: a script sees both.

pub mod bake;
pub mod bench;
pub mod fly;
pub mod gallery;
pub mod height;
pub mod info;
pub mod input;
pub mod modes;
pub mod shot;
pub mod sight;
pub mod simulate;
pub mod trade;
pub mod trajectory;
pub mod verify;
