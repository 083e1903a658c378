//! `poligon shot`: one picture.

use crate::args::ShotArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::Output;
use crate::report;
use crate::scenery::{self, Look, Scenery};
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
    let eye_m = scenery::position(&world, &scenery.area, args.eye)?;
    let heading_rad = scenery::grid_heading_rad(&world, eye_m, args.look.azimuth_deg.to_radians());
    let attitude = terrain::frame::attitude(heading_rad, args.look.elevation_deg.to_radians(), 0.0);
    let heavens = scenery.heavens(args.view.time.unwrap_or_else(|| scenery::default_moment(&world)))?;

    let failed = |error: visual::GpuError| Failure::while_doing("taking a picture", error);
    let target = Offscreen::new(&scenery.gpu, look.size_px).map_err(failed)?;
    let view = scenery.view(eye_m, attitude, look.size_px);
    scenery.follow(&view, 0.0, heavens);
    scenery.draw(&view, heavens, 0.0, Vec::new(), &target.view).map_err(failed)?;
    let picture = target.read(&scenery.gpu).map_err(failed)?;
    picture.write_png(&args.out).map_err(|error| Failure::Failed(error.to_string()))?;

    let counts = scenery.terrain.counts();
    output.print(&report::Shot {
        out: args.out.display().to_string(),
        size: format!("{}x{}", look.size_px[0], look.size_px[1]),
        image_hash: report::hash(picture.hash()),
        visibility_m: scenery.visibility_m(),
        triangles_drawn: counts.triangles,
        triangles_all_level0: counts.triangles_all_level0,
        late_blocks: scenery.terrain.window().late_blocks(),
    })
}
