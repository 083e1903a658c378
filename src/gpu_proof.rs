//! The proofs that need a device, on a world: heights, depth, and the grey of a pop. None of it without an adapter.

use crate::output;
use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use terrain::block::{Landscape, Rings};
use terrain::verify::pop::Pop;
use terrain::{Area, CELLS, Field};
use visual::camera::View;
use visual::proof::{Stage, depth, grey, heights};
use visual::{Gpu, GpuError, Scene};

/// Pictures whose depth is compared, each from an eye of its own.
const EYES: u64 = 16;

/// Pixels compared in all.
pub const PIXELS: u64 = 100_000;

/// Switches whose grey is looked at: those that move most, and some spread over the track.
const LARGEST: usize = 8;
const SPREAD: usize = 16;

/// Surface pixels from which on a block shows as a patch: 16 x 16, not quite a degree. Of a block behind a crest a sliver
/// may show in which every pixel is next to an outline; its mean is told apart.
const PATCH_PIXELS: u64 = 256;

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Found {
    /// Posts on the device.
    pub heights: heights::Heights,
    /// Depth in pictures.
    pub depths: depth::Depths,
    /// Largest mean change of grey over a block's surface, of 255.
    pub grey: f64,
    /// The same with outlines.
    pub grey_any: f64,
    /// Largest change of a single pixel, of 255.
    pub grey_worst_pixel: f64,
    /// Switches that were seen.
    pub grey_switches: u64,
    /// Switches looked at: they move a surface of which a post is in sight.
    pub switches_in_sight: u64,
}

/// A device, or `None`, having said why.
pub fn device() -> Option<Gpu> {
    match Gpu::headless() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            output::tell(format_args!("poligon: the picture is not verified: {error}"));
            None
        }
    }
}

/// Pixels that a proof must have compared to count as one: all where the world has at least a block's worth of ground.
/// Less may show in too few pixels, so there one will do; over void alone there is nothing to compare.
pub fn pixels_due(field: &Field) -> u64 {
    let grid = field.grid();
    let (columns, rows) = (i64::from(grid.columns()) - 1, i64::from(grid.rows()) - 1);
    let sound = |column, row| !field.post_m(column, row).is_nan();
    let triangles = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).map(|(column, row)| {
        // Cut from south-west to north-east.
        let cut = sound(column, row + 1) && sound(column + 1, row);
        usize::from(cut && sound(column, row)) + usize::from(cut && sound(column + 1, row + 1))
    });
    let block = 2 * (CELLS * CELLS) as usize;
    let mut found = 0;
    for some in triangles {
        found += some;
        if found >= block {
            return PIXELS;
        }
    }
    found.min(1) as u64
}

/// What the proofs are made on.
pub struct Subject {
    /// The ground.
    pub landscape: Arc<Landscape>,
    /// Rings of the window.
    pub rings: Rings,
    /// Blocks along the window.
    pub blocks: u32,
    /// Light and air.
    pub scene: Scene,
}

/// All proofs; `told` hears the share done.
///
/// # Errors
/// What the device reports.
pub fn prove(gpu: &Gpu, subject: &Subject, pops: &[Pop], told: &dyn Fn(f64)) -> Result<Found, GpuError> {
    let mut found = Found::default();
    near(gpu, subject, &mut found, told)?;
    let mut stage = stage(gpu, subject, [1080, 1080])?;
    let chosen = chosen(&subject.landscape.ground.whole(), pops);
    found.switches_in_sight = chosen.len() as u64;
    for (number, pop) in chosen.iter().enumerate() {
        told(0.4 + 0.6 * number as f64 / chosen.len() as f64);
        let view = grey::view_of(&stage, pop.switch.block, pop.eye_m);
        let change = grey::change(&mut stage, &view, pop.switch.block, pop.switch.from, pop.switch.to)?;
        found.grey_switches += u64::from(change.pixels > 0);
        if change.pixels >= PATCH_PIXELS {
            found.grey = found.grey.max(change.mean);
        }
        found.grey_any = found.grey_any.max(change.mean_any);
        found.grey_worst_pixel = found.grey_worst_pixel.max(change.worst);
    }
    Ok(found)
}

fn stage(gpu: &Gpu, subject: &Subject, size_px: [u32; 2]) -> Result<Stage, GpuError> {
    Stage::new(gpu.clone(), subject.landscape.clone(), subject.rings, subject.blocks, size_px, subject.scene)
}

/// Heights and depth from random eyes: low and high, looking anywhere from a little up to straight down.
fn near(gpu: &Gpu, subject: &Subject, found: &mut Found, told: &dyn Fn(f64)) -> Result<(), GpuError> {
    let mut stage = stage(gpu, subject, [960, 720])?;
    let area = subject.landscape.ground.whole();
    let grid = *area.grid();
    let size_px = stage.size_px();
    let mut rng = StdRng::seed_from_u64(2);
    // A world of void or a narrow one may have eyes that see too little.
    for eye in 0..4 * EYES {
        let wanted = (PIXELS * (eye + 1) / EYES).min(PIXELS);
        if found.depths.pixels_checked >= PIXELS {
            break;
        }
        told(0.4 * found.depths.pixels_checked as f64 / PIXELS as f64);
        let at =
            DVec2::new(rng.random_range(grid.west_m..grid.east_m()), rng.random_range(grid.north_m..grid.south_m()));
        let Some((at, ground_m)) = ground_after(&area, at) else { break };
        // 2 m to 6 km, evenly by ratio.
        let above_m = 2.0 * 3_000f64.powf(rng.random_range(0.0..1.0));
        let elevation_rad = if eye % EYES == 0 { -std::f64::consts::FRAC_PI_2 } else { rng.random_range(-1.3..0.1) };
        let attitude = terrain::frame::attitude(
            rng.random_range(0.0..std::f64::consts::TAU),
            elevation_rad,
            rng.random_range(-0.5..0.5),
        );
        let view = View::fov_y(DVec3::new(at.x, ground_m + above_m, at.y), attitude, 60f64.to_radians(), size_px);
        stage.follow(&view);
        stage.draw(&view)?;
        if eye % 4 == 0 {
            let heights = heights::compare(&stage, &view)?;
            found.heights.vertices_checked += heights.vertices_checked;
            found.heights.height_mismatches += heights.height_mismatches;
            found.heights.position_mismatches += heights.position_mismatches;
        }
        let drawn = stage.depth()?;
        let pixels = (0..400_000).map(|_| size_px.map(|edge| rng.random_range(0..edge)));
        let left = wanted.saturating_sub(found.depths.pixels_checked);
        let depths = depth::compare(&area, &view, &drawn, subject.rings.radii_m[0], left, pixels);
        found.depths = found.depths.and(depths);
    }
    Ok(())
}

/// The first place with ground from here on, east along its row of cells and then through the rows, and its height;
/// `None` where there is none in the world.
fn ground_after(area: &Area, at: DVec2) -> Option<(DVec2, f64)> {
    let grid = area.grid();
    let here = std::iter::once(at);
    let (columns, rows) = (u64::from(grid.columns()) - 1, u64::from(grid.rows()) - 1);
    let first = ((at.y - grid.north_m) / grid.step_m) as u64 * columns + ((at.x - grid.west_m) / grid.step_m) as u64;
    let cells = (first..first + columns * rows).map(|cell| (cell % columns, cell / columns % rows));
    // A place in each triangle of a cell: north-west and south-east of the cut.
    let inside = cells.flat_map(|(column, row)| {
        [0.25, 0.75].map(|share| {
            DVec2::new(grid.west_m, grid.north_m) + (DVec2::new(column as f64, row as f64) + share) * grid.step_m
        })
    });
    here.chain(inside).find_map(|at| Some((at, area.height_m(at.x, at.y)?)))
}

/// Which switches to look at, in the order of the track: of blocks that the eye sees.
fn chosen(area: &Area, pops: &[Pop]) -> Vec<Pop> {
    // One that moves nothing shows nothing.
    let moving: Vec<usize> = (0..pops.len()).filter(|at| pops[*at].move_m > 0.0).collect();
    let mut by_px = moving.clone();
    by_px.sort_by(|a, b| pops[*b].px.total_cmp(&pops[*a].px));
    let mut all: Vec<usize> = by_px.into_iter().filter(|at| is_seen(area, &pops[*at])).take(LARGEST).collect();
    // From each part of the track the first that is seen.
    for part in moving.chunks(moving.len().div_ceil(SPREAD).max(1)) {
        all.extend(part.iter().find(|at| is_seen(area, &pops[**at])));
    }
    all.sort_unstable();
    all.dedup();
    all.into_iter().map(|at| pops[at]).collect()
}

/// Whether any of some posts of a switching block is in sight, a little above the ground.
fn is_seen(area: &Area, pop: &Pop) -> bool {
    let (field, grid) = (area.field(), area.grid());
    let block = pop.switch.block;
    (0..=CELLS).step_by(3).any(|row| {
        (0..=CELLS).step_by(3).any(|column| {
            let (column, row) = (block.first_column() + i64::from(column), block.first_row() + i64::from(row));
            let height_m = f64::from(field.post_m(column, row)) + 1.0;
            let post = DVec3::new(grid.x_m(column), height_m, grid.z_m(row));
            height_m.is_finite() && area.segment(pop.eye_m, post).is_none()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::{Grid, Ground, synthetic};

    #[test]
    fn a_proof_is_owed_by_what_ground_there_is() {
        let grid = Grid::centred(200.0, 3, 2).unwrap();
        let field = |sound: &dyn Fn(u32, u32) -> bool| {
            synthetic::from_fn(grid, |column, row| if sound(column, row) { 7.0 } else { f32::NAN })
        };
        for (name, field, due) in [
            ("ground", field(&|_, _| true), PIXELS),
            ("a block", field(&|c, r| c <= 30 && r <= 30), PIXELS),
            ("a cell less", field(&|c, r| c <= 30 && r <= 30 && (c, r) != (0, 0)), 1),
            // The south-east triangle of one cell, seen from the world's other end.
            ("a triangle", field(&|c, r| [(40, 21), (41, 20), (41, 21)].contains(&(c, r))), 1),
            ("posts alone", field(&|c, r| c % 2 == 0 && r % 2 == 0), 0),
            ("void", field(&|_, _| false), 0),
        ] {
            assert_eq!(pixels_due(&field), due, "{name}");
            let area = Ground::new(Arc::new(field)).whole();
            let from = DVec2::new(grid.east_m() - 1.0, grid.south_m() - 1.0);
            let found = ground_after(&area, from);
            assert_eq!(found.map(|(_, height_m)| height_m), (due > 0).then_some(7.0), "{name}: {found:?}");
        }
    }
}
