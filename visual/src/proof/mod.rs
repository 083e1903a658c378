//! Proofs that need a device: the picture's heights, depth and pops against the ground.
//!
//! They draw through the same [`Renderer`] and [`Terrain`] as every picture, without a window, and read back. Like
//! `terrain::verify` they count and measure; the caller compares with what was promised.

pub mod depth;
pub mod grey;
pub mod heights;

use crate::camera::View;
use crate::capture::{self, Offscreen, Picture};
use crate::frame::{Frame, Scene};
use crate::gpu::{Gpu, GpuError};
use crate::passes::terrain::{Terrain, TerrainLook};
use crate::renderer::{Renderer, Settings};
use crate::sky::HazeGrade;
use glam::DVec3;
use std::sync::Arc;
use terrain::block::window::{BUDGET_BYTES, Settings as WindowSettings, Window};
use terrain::block::{Landscape, Rings};

/// A world ready for pictures of one size, with depth.
pub struct Stage {
    /// The device.
    pub gpu: Gpu,
    /// The ground on the device.
    pub terrain: Terrain,
    renderer: Renderer,
    target: Offscreen,
    scene: Scene,
}

impl Stage {
    /// Prepares a window of `blocks` x `blocks` over a landscape.
    ///
    /// # Errors
    /// [`GpuError::Size`].
    pub fn new(
        gpu: Gpu,
        landscape: Arc<Landscape>,
        rings: Rings,
        blocks: u32,
        size_px: [u32; 2],
        scene: Scene,
    ) -> Result<Self, GpuError> {
        let settings =
            Settings { msaa: 1, render_scale: 1.0, keep_depth: true, sky_in_background: false, haze: HazeGrade::Table };
        let renderer = Renderer::new(&gpu, capture::FORMAT, settings);
        let window = WindowSettings { blocks, rings, budget_bytes: BUDGET_BYTES, wait: true, threads: 2 };
        let window = Window::new(landscape, window, scene.sane().sun_direction);
        let look = TerrainLook { detail: 2, overlay: false, wireframe: false };
        let terrain = Terrain::new(&gpu, renderer.frame_layout(), renderer.scene_format(), window, look);
        let target = Offscreen::new(&gpu, size_px)?;
        let view_range_m = terrain.window().view_range_min_m();
        let scene = Scene { view_range_m, visibility_m: scene.visibility_m.min(view_range_m), ..scene };
        Ok(Self { gpu, terrain, renderer, target, scene })
    }

    /// Size of its pictures, pixels.
    pub fn size_px(&self) -> [u32; 2] {
        self.target.size_px
    }

    /// Moves the window under the eye, until all of it is there, and culls.
    pub fn follow(&mut self, view: &View) {
        let sun: DVec3 = self.scene.sane().sun_direction;
        // A jump within the window's reach is some shifts; each takes some updates.
        let mut before = None;
        for _ in 0..400 {
            self.terrain.follow(&self.gpu, view.eye_m, 0.0, sun);
            let state = (self.terrain.window().origin(), self.terrain.window().counters().upload_bytes_total);
            let rests = before == Some(state) && !self.terrain.window().is_jumping();
            if rests && self.terrain.window().late_blocks() == 0 {
                break;
            }
            before = Some(state);
        }
        self.terrain.prepare(&self.gpu, 0, view);
    }

    /// Draws what was followed.
    ///
    /// # Errors
    /// What the device reports.
    pub fn draw(&mut self, view: &View) -> Result<(), GpuError> {
        let frame = Frame { scene: self.scene, views: vec![*view], hud: Vec::new() };
        let terrain = &self.terrain;
        self.renderer.render(&self.gpu, &frame, &[&self.target.view], |about, layer, pass| {
            if layer == crate::Layer::Solid {
                terrain.draw(about.index, &|_| false, pass);
            }
        })
    }

    /// The picture drawn.
    ///
    /// # Errors
    /// What the device reports.
    pub fn picture(&self) -> Result<Picture, GpuError> {
        self.target.read(&self.gpu)
    }

    /// The depth drawn, row by row from the top: near / distance along the axis, 0 where nothing is.
    ///
    /// # Errors
    /// What the device reports.
    pub fn depth(&self) -> Result<Vec<f32>, GpuError> {
        match self.renderer.depth(0) {
            Some(depth) => capture::read_depth(&self.gpu, depth),
            None => Ok(vec![0.0; (self.target.size_px[0] * self.target.size_px[1]) as usize]),
        }
    }
}
