//! The proofs that need a device, on a world: heights, depth, and the grey of a pop. None of it without an adapter.

use crate::output;
use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use terrain::block::{Landscape, Rings};
use terrain::verify::pop::Pop;
use terrain::{Area, CELLS};
use visual::camera::View;
use visual::proof::{Stage, depth, grey, heights};
use visual::{Gpu, GpuError, Scene};

/// Pictures whose depth is compared, each from an eye of its own.
const EYES: u64 = 16;

/// Pixels compared in all.
const PIXELS: u64 = 100_000;

/// Switches whose grey is looked at: those that move most, and some spread over the track.
const LARGEST: usize = 8;
const SPREAD: usize = 16;

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
    for (number, pop) in chosen.iter().enumerate() {
        told(0.4 + 0.6 * number as f64 / chosen.len() as f64);
        let view = grey::view_of(&stage, pop.switch.block, pop.eye_m);
        let change = grey::change(&mut stage, &view, pop.switch.block, pop.switch.from, pop.switch.to)?;
        found.grey_switches += u64::from(change.pixels > 0);
        found.grey = found.grey.max(change.mean);
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
        let Some(ground_m) = area.height_m(at.x, at.y) else { continue };
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
