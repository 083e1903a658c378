//! The values of one knob side by side: each a scenery, all at the same cameras, in turns.

use super::Effort;
use super::surface::{Spread, add_errors_px};
use crate::bench::cameras::Camera;
use crate::bench::statistics::median;
use crate::failure::Failure;
use crate::scenery::{Look, Scenery};
use glam::DVec3;
use std::sync::Arc;
use terrain::store::World;
use visual::capture::{self, Offscreen, Picture};
use visual::proof::grey::luma;
use visual::{Gpu, GpuError};

/// One value of a knob on stage.
pub struct Actor {
    scenery: Scenery,
    target: Offscreen,
    /// For each camera the times of its rounds.
    times_ms: Vec<Vec<f64>>,
    triangles: Vec<f64>,
    surface_px: Spread,
    pictures: Vec<Picture>,
}

/// What was seen of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Mean over the cameras of the median time of a frame.
    pub ms: f64,
    /// Mean triangles of a frame.
    pub triangles: u64,
    /// Root mean square of the surface's error on screen, pixels of the reference view.
    pub surface_rms_px: f64,
    /// The largest.
    pub surface_max_px: f64,
    /// Memory on the device for terrain.
    pub gpu_bytes: u64,
}

impl Actor {
    /// Puts a look on stage, on a device of its own.
    ///
    /// # Errors
    /// [`Failure::Failed`] where there is no adapter.
    pub fn new(world: &Arc<World>, look: Look) -> Result<Self, Failure> {
        let gpu = Gpu::headless().map_err(drawing)?;
        let scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), look);
        let target = Offscreen::new(&scenery.gpu, look.size_px).map_err(drawing)?;
        Ok(Self {
            scenery,
            target,
            times_ms: Vec::new(),
            triangles: Vec::new(),
            surface_px: Spread::default(),
            pictures: Vec::new(),
        })
    }

    /// Goes to a camera, takes its picture, measures its surface.
    fn look_from(&mut self, camera: &Camera, to_sun: DVec3) -> Result<(), Failure> {
        camera.settle(&mut self.scenery, to_sun, &self.target)?;
        self.pictures.push(self.target.read(&self.scenery.gpu).map_err(drawing)?);
        let terrain = &self.scenery.terrain;
        self.triangles.push(terrain.counts().triangles as f64);
        add_errors_px(terrain.window().landscape(), terrain.draws(0), camera.eye_m, &mut self.surface_px);
        Ok(())
    }

    /// What was seen.
    pub fn seen(&self) -> Seen {
        Seen {
            ms: self.times_ms.iter().map(|rounds| median(rounds)).sum::<f64>() / self.times_ms.len() as f64,
            triangles: (self.triangles.iter().sum::<f64>() / self.triangles.len() as f64) as u64,
            surface_rms_px: self.surface_px.rms(),
            surface_max_px: self.surface_px.largest,
            gpu_bytes: self.scenery.terrain.gpu_bytes() as u64,
        }
    }

    /// Root mean square difference of its pictures from another's, grey levels of 255.
    pub fn grey_rms_from(&self, reference: &[Picture]) -> f64 {
        let mut spread = Spread::default();
        for (ours, theirs) in self.pictures.iter().zip(reference) {
            for (a, b) in ours.rgba.chunks_exact(4).zip(theirs.rgba.chunks_exact(4)) {
                spread.add(luma(a) - luma(b));
            }
        }
        spread.rms()
    }

    /// Its pictures, a camera each.
    pub fn into_pictures(self) -> Vec<Picture> {
        self.pictures
    }
}

/// Lets all actors take turns at every camera.
///
/// # Errors
/// What a device reports.
pub fn play(actors: &mut [Actor], cameras: &[Camera], to_sun: DVec3, effort: &Effort) -> Result<(), Failure> {
    for camera in cameras {
        for actor in actors.iter_mut() {
            actor.look_from(camera, to_sun)?;
        }
        actors.iter_mut().for_each(|actor| actor.times_ms.push(Vec::new()));
        for _ in 0..effort.rounds {
            for actor in actors.iter_mut() {
                let ms = camera.frame_ms(&mut actor.scenery, to_sun, &actor.target)?;
                actor.times_ms.last_mut().into_iter().for_each(|rounds| rounds.push(ms));
            }
        }
    }
    Ok(())
}

fn drawing(error: GpuError) -> Failure {
    Failure::while_doing("measuring a setting", error)
}
