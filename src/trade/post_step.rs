//! The distance between posts against the data they come from.
//!
//! The world is baked anew from the source at each step. Its error is the difference between its ground and the source
//! at every one of the source's own samples, off lakes (which the bake levels on purpose) and their shores. So that a
//! frame shows the same ground at any step, the window is the smallest that guarantees [`RANGE_M`].

use super::surface::Spread;
use crate::failure::Failure;
use glam::DVec2;
use terrain::Ground;
use terrain::bake::{self, BakeRequest, Input, open};
use terrain::block::window::MAX_BLOCKS;
use terrain::store::World;

/// Guaranteed range of every window, and the visibility drawn, metres.
pub const RANGE_M: f64 = 30_000.0;

/// Shores are left out this far from their line, in posts: the bake tapers the ground there.
const SHORE_POSTS: f64 = 4.0;

/// The request at another step.
pub fn at_step(request: &BakeRequest, step_m: f64) -> BakeRequest {
    BakeRequest { step_m, ..request.clone() }
}

/// Blocks along the smallest window that guarantees [`RANGE_M`]; `None` if there is none so large.
pub fn window(world: &World) -> Option<u32> {
    let blocks = 2 * ((RANGE_M / world.field.grid().block_m() - 1e-9).ceil() as u32 + 1);
    (blocks <= MAX_BLOCKS).then_some(blocks.max(4))
}

/// Differences between a world's ground and the samples of its first source, metres.
///
/// # Errors
/// [`Failure::Failed`] if the source cannot be read.
pub fn source_errors_m(world: &World, request: &BakeRequest) -> Result<Spread, Failure> {
    let raster = match request.sources.first() {
        Some((Input::Embedded(bytes), _)) => open::read(bytes.content, bytes.name, None),
        Some((Input::File(path), _)) => open::open(path),
        None => return Err(Failure::Failed("expected a source to compare with, found none".into())),
    }
    .map_err(|error| Failure::while_doing("reading the source", error))?;
    let area = Ground::new(world.field.clone()).whole();
    let shore_m = SHORE_POSTS * world.field.grid().step_m;
    let grid = world.field.grid();
    let (low, high) = (DVec2::new(grid.west_m, grid.north_m), DVec2::new(grid.east_m(), grid.south_m()));
    let water = world.lakes.near(low, high, shore_m);
    let mut spread = Spread::default();
    for j in 0..raster.rows {
        for i in 0..raster.columns {
            let at = world.projection.to_world(raster.place(DVec2::new(i as f64 + 0.5, j as f64 + 0.5)));
            let Some(ground_m) = area.height_m(at.x, at.y) else { continue };
            if water.signed_distance_m(at) < shore_m {
                continue;
            }
            spread.add(ground_m - f64::from(raster.sample_m(i, j)));
        }
    }
    Ok(spread)
}

/// Bakes a request; the world and the seconds it took.
///
/// # Errors
/// [`Failure::Failed`] as the bake.
pub fn baked(request: &BakeRequest) -> Result<(World, f64), Failure> {
    let start = std::time::Instant::now();
    let world = bake::bake(request, &mut |_, _| ()).map_err(|error| Failure::while_doing("baking", error))?;
    Ok((world, start.elapsed().as_secs_f64()))
}
