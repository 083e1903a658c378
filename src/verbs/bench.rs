//! `poligon bench`: speed beside a yardstick in the same run.

use crate::args::BenchArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &BenchArgs, output: Output) -> Result<(), Failure> {
    let _ = (args.subject, output);
    super::not_built_yet("bench")
}
