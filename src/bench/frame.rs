//! Whole frames: the presets beside everything at level 0, in turns over places on the scenic track.
//!
//! All sceneries are alive at once, each with a device of its own, and draw the same places one after the other. A
//! round is the mean over all places, so that it is the track and not one view that is compared. For context: the same
//! frame without ground (sky only), and one that is only cleared, which no frame can beat.

use super::OWN;
use super::cameras::{self, Camera};
use super::statistics::{Against, Better, ROUNDS, alone, beside};
use crate::failure::Failure;
use crate::report::BenchResult;
use crate::scenery::{self, Look, Scenery};
use crate::values::Quality;
use std::sync::Arc;
use std::time::Instant;
use terrain::store::World;
use visual::capture::{self, Offscreen};
use visual::{Frame, Gpu, GpuError, Renderer, Scene};

/// How much is measured.
#[derive(Debug, Clone, Copy)]
pub struct Load {
    /// Picture size, pixels.
    pub size_px: [u32; 2],
    /// Places on the track.
    pub places: u32,
    /// Rounds at each place.
    pub rounds: u32,
}

impl Load {
    /// What the program measures with.
    pub const FULL: Self = Self { size_px: [1280, 720], places: 8, rounds: ROUNDS };
}

/// Measures frames over a world.
///
/// # Errors
/// [`GpuError`] as a [`Failure`], also where there is no adapter.
pub fn bench(world: &Arc<World>, load: Load) -> Result<Vec<BenchResult>, Failure> {
    let failed = |error: GpuError| Failure::while_doing("measuring frames", error);
    // Mountains and the plains before them: the track from the southern shore to the Tekes basin.
    let shares: Vec<f64> = (0..load.places).map(|i| 0.12 + 0.5 * f64::from(i) / f64::from(load.places)).collect();
    let cameras = cameras::along_track(world, &shares)?;
    let to_sun = scenery::to_sun(world, scenery::default_moment(world))?;
    let mut sceneries = Vec::new();
    let mut targets = Vec::new();
    for (quality, all_level_0) in [(Quality::Standard, false), (Quality::Standard, true), (Quality::Software, false)] {
        let gpu = Gpu::headless().map_err(failed)?;
        let look = Look { size_px: load.size_px, all_level_0, ..Look::preset(quality) };
        let scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), look);
        targets.push(Offscreen::new(&scenery.gpu, load.size_px).map_err(failed)?);
        sceneries.push(scenery);
    }
    let mut bare = Bare::new(load.size_px).map_err(failed)?;

    // A sum over places for each round.
    let mut times_ms = vec![vec![0.0; load.rounds as usize]; sceneries.len() + 2];
    let share = 1.0 / cameras.len() as f64;
    let mut triangles = vec![Vec::new(); sceneries.len()];
    for camera in &cameras {
        for ((scenery, target), triangles) in sceneries.iter_mut().zip(&targets).zip(&mut triangles) {
            camera.settle(scenery, to_sun, target)?;
            triangles.push(scenery.terrain.counts().triangles as f64 * 1e-3);
        }
        bare.sky_ms(camera, to_sun).map_err(failed)?;
        for round in 0..load.rounds as usize {
            for ((scenery, target), times_ms) in sceneries.iter_mut().zip(&targets).zip(&mut times_ms) {
                times_ms[round] += share * camera.frame_ms(scenery, to_sun, target)?;
            }
            times_ms[3][round] += share * bare.sky_ms(camera, to_sun).map_err(failed)?;
            times_ms[4][round] += share * bare.clear_ms().map_err(failed)?;
        }
    }

    let adapter = &sceneries[0].gpu.report;
    let [width, height] = load.size_px;
    let note = format!("{width}x{height}, mean over {} places, {} ({})", cameras.len(), adapter.name, adapter.kind);
    let [standard, all, software, sky, clear] = times_ms.as_slice() else { return Ok(Vec::new()) };
    let against = |name, values| Against { name, version: OWN, values };
    let (less, ms) = (Better::Less, "ms");
    Ok(vec![
        beside("frame, standard", ms, less, standard, against("all at level 0", all), note.as_str()),
        beside("frame, software", ms, less, software, against("frame, standard", standard), note.as_str()),
        beside("frame, standard, against the floor", ms, less, standard, against("clear only", clear), note.as_str()),
        alone("frame without ground", ms, sky, "sky only"),
        beside(
            "triangles a frame, standard",
            "thousands",
            less,
            &triangles[0],
            against("all at level 0", &triangles[1]),
            "a round is a place",
        ),
        alone("triangles a frame, software", "thousands", &triangles[2], "a round is a place"),
    ])
}

/// A renderer without ground.
struct Bare {
    gpu: Gpu,
    renderer: Renderer,
    target: Offscreen,
}

impl Bare {
    fn new(size_px: [u32; 2]) -> Result<Self, GpuError> {
        let gpu = Gpu::headless()?;
        let renderer = Renderer::new(&gpu, capture::FORMAT, visual::Settings::default());
        let target = Offscreen::new(&gpu, size_px)?;
        Ok(Self { gpu, renderer, target })
    }

    fn sky_ms(&mut self, camera: &Camera, to_sun: glam::DVec3) -> Result<f64, GpuError> {
        let start = Instant::now();
        let view = visual::camera::View::fov_y(camera.eye_m, camera.attitude, 60f64.to_radians(), self.target.size_px);
        let scene = Scene { sun_direction: to_sun, ..Scene::default() };
        let frame = Frame { scene, views: vec![view], hud: Vec::new() };
        self.renderer.render(&self.gpu, &frame, &[&self.target.view], |_, _, _| ())?;
        self.gpu.wait()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }

    fn clear_ms(&self) -> Result<f64, GpuError> {
        let start = Instant::now();
        self.target.clear(&self.gpu);
        self.gpu.wait()?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_frame_has_a_time_and_a_yardstick() {
        if let Err(reason) = Gpu::headless() {
            println!("skipped: {reason}");
            return;
        }
        let world = Arc::new(crate::bench::tests::tiny_world());
        let results = bench(&world, Load { size_px: [64, 36], places: 2, rounds: 2 }).unwrap();
        assert_eq!(results.len(), 6);
        assert!(results.iter().all(|result| result.ours > 0.0 && result.rounds == 2), "{results:?}");
        let triangles = results.iter().find(|result| result.name == "triangles a frame, standard").unwrap();
        assert!(triangles.ratio.unwrap() >= 1.0, "levels draw no more than level 0");
    }
}
