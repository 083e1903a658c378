//! `poligon sight`: whether two points see each other.

use crate::args::SightArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &SightArgs, output: Output) -> Result<(), Failure> {
    let _ = (&args.world, args.from, args.to, output);
    super::not_built_yet("sight")
}
