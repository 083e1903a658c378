//! `poligon shot`: one picture.

use crate::args::ShotArgs;
use crate::failure::Failure;
use crate::output::Output;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &ShotArgs, output: Output) -> Result<(), Failure> {
    if !args.out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Err(Failure::Misuse(format!("expected a file name that ends in .png, found `{}`", args.out.display())));
    }
    let _ = (&args.world, args.eye, args.look, args.wireframe, &args.view, output);
    super::not_built_yet("shot")
}
