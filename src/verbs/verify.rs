//! `poligon verify`: cracks, the near picture against the ground, the far error and the pop, proven on a world.

use crate::args::VerifyArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &VerifyArgs, output: Output) -> Result<(), Failure> {
    let _ = (&args.world, output);
    super::not_built_yet("verify")
}
