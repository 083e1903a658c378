//! `poligon trade`: accuracy against cost of every setting.

use crate::args::TradeArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &TradeArgs, output: Output) -> Result<(), Failure> {
    let _ = (args.quick, &args.out, output);
    super::not_built_yet("trade")
}
