//! `poligon height`: height, normal and surface of the ground at the points of a CSV file.

use crate::args::HeightArgs;
use crate::failure::Failure;
use crate::output::Output;
use crate::points::{self, Points};
use std::path::Path;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &HeightArgs, output: Output) -> Result<(), Failure> {
    let points = read(&args.points)?;
    let _ = (&args.world, points, output);
    super::not_built_yet("height")
}

fn read(path: &Path) -> Result<Points, Failure> {
    let bytes =
        std::fs::read(path).map_err(|error| Failure::while_doing(format!("reading {}", path.display()), error))?;
    points::parse(&bytes).map_err(|error| Failure::while_doing(path.display(), error))
}
