//! `poligon info`: what a world is.

use crate::args::InfoArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &InfoArgs, output: Output) -> Result<(), Failure> {
    let _ = (&args.world, output);
    super::not_built_yet("info")
}
