//! `poligon bake`: elevation data in, a world out.

use crate::args::BakeArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &BakeArgs, output: Output) -> Result<(), Failure> {
    if !args.features.is_empty() || !args.imagery.is_empty() {
        return Err(Failure::Misuse(
            "this version bakes --dem only; it reads neither --features nor --imagery".to_owned(),
        ));
    }
    let _ = (&args.dem, args.step_m, args.centre, args.size_km, &args.out, output);
    super::not_built_yet("bake")
}
