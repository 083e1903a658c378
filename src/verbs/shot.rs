//! `poligon shot`: one picture.

use crate::args::ShotArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::Output;
use crate::scenery::{self, Look, Scenery};
use crate::still::{self, Standpoint};
use std::sync::Arc;
use visual::capture::{self, Offscreen};

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &ShotArgs, output: Output) -> Result<(), Failure> {
    if !args.out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        return Err(Failure::Misuse(format!("expected a file name that ends in .png, found `{}`", args.out.display())));
    }
    let world = Arc::new(open_world::open(args.world.as_deref())?);
    let gpu = visual::Gpu::headless().map_err(|error| Failure::while_doing("taking a picture", error))?;
    let mut look = Look::of(&args.view, gpu.report.kind, true);
    look.ground.wireframe = args.wireframe;
    let mut scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), look);
    scenery.use_models_of(args.world.as_deref())?;
    scenery.make_craters(&args.craters)?;
    let eye_m = scenery::position(&world, &scenery.area, args.eye)?;
    let at = Standpoint {
        eye_m,
        attitude: still::attitude(&world, eye_m, args.look.azimuth_deg, args.look.elevation_deg),
        heavens: scenery.heavens(args.view.time.unwrap_or_else(|| scenery::default_moment(&world)))?,
    };
    let target =
        Offscreen::new(&scenery.gpu, look.size_px).map_err(|error| Failure::while_doing("taking a picture", error))?;
    let picture = still::take(&mut scenery, &at, &target)?;
    output.print(&still::write(&scenery, &picture, &args.out)?)
}
