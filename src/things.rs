//! All that stands and lies on the ground of a scenery: what is draped on it, plants, forests, buildings and other
//! things; the smoke and fire over it; the lights on it.
//!
//! Each kind is there only if the world has something of it and the look shows it: no pass, no thread, no byte else.

use crate::failure::Failure;
use crate::scenery::Look;
use glam::{DVec2, DVec3};
use std::path::Path;
use std::sync::Arc;
use terrain::block::Landscape;
use terrain::block::overlay::decal::Decal;
use terrain::block::rings::NEAR_RADIUS_M;
use terrain::edit::Changed;
use terrain::features::index::ObjectIndex;
use vegetation::place::Nursery;
use visual::camera::View;
use visual::models::Mesh;
use visual::models::things::Model;
use visual::particles::Emitter;
use visual::passes::canopy::{CanopyCounts, CanopyPass};
use visual::passes::decals::DecalPass;
use visual::passes::lights::{Dark, Lights, Reach};
use visual::passes::objects::{ObjectCounts, ObjectInstance, Objects};
use visual::passes::overlay::{OverlayPass, OverlaySettings};
use visual::passes::particles::Particles;
use visual::passes::plants::{PlantCounts, Plants};
use visual::passes::terrain::Terrain;
use visual::{Gpu, Layer, RenderPass, Renderer};

/// Farthest a town's lamps are drawn, metres.
const TOWNS_REACH_M: f64 = 45_000.0;

/// See the module.
pub struct Things {
    overlay: Option<OverlayPass>,
    decals: DecalPass,
    plants: Option<Plants>,
    canopy: Option<CanopyPass>,
    objects: Option<Objects>,
    /// Shapes that replaced generated ones.
    own_models: Vec<(Model, Mesh)>,
    particles: Particles,
    lights: Option<Lights>,
    latitude_rad: f64,
}

impl Things {
    /// Prepares what a look shows of a landscape; `near_m` is the near zone's radius.
    pub fn new(
        gpu: &Gpu,
        renderer: &Renderer,
        terrain: &Terrain,
        landscape: &Arc<Landscape>,
        standing: &Arc<ObjectIndex>,
        latitude_rad: f64,
        near_m: f64,
        look: &Look,
    ) -> Self {
        let (frame, ground, format) = (renderer.frame_layout(), terrain.bindings().0, renderer.scene_format());
        let near_m = near_m.min(NEAR_RADIUS_M).min(look.content.reach_m);
        let overlay = look.content.overlays.then(|| {
            let settings = OverlaySettings { reach_m: near_m, detail: look.ground.detail, wait: look.wait };
            OverlayPass::new(gpu, frame, ground, format, landscape.clone(), settings)
        });
        let share = look.content.plants.min(1.0);
        let nursery = (share > 0.0).then(|| Arc::new(Nursery::new(landscape.clone(), latitude_rad)));
        let plants =
            nursery.as_ref().and_then(|n| Plants::new(gpu, frame, ground, format, n, share, near_m, look.wait));
        let canopy = nursery.as_ref().and_then(|n| CanopyPass::new(gpu, frame, ground, format, n, near_m, look.wait));
        let grid = landscape.ground.field().grid();
        // Also where nothing stands: what a scene moves is drawn by the same pass, and an empty one does no work.
        let objects = look
            .content
            .objects
            .then(|| Objects::new(gpu, frame, ground, format, grid, standing.clone(), near_m, look.wait));
        let particles = Particles::new(frame, format);
        let decals = DecalPass::new(frame, ground, format, landscape.ground.field().clone());
        let lights = look.content.lights.then(|| {
            let reach_m = f64::from(look.window.saturating_sub(2)) * 0.5 * grid.block_m();
            let reach = Reach { airfields_m: reach_m, towns_m: reach_m.min(TOWNS_REACH_M), wait: look.wait };
            let (area, features, cover) =
                (landscape.ground.whole(), landscape.features.clone(), landscape.cover.clone());
            Lights::new(gpu, frame, format, area, features, cover, reach)
        });
        let overlay = overlay.flatten();
        let lights = lights.flatten();
        Self { overlay, decals, plants, canopy, objects, own_models: Vec::new(), particles, lights, latitude_rad }
    }

    /// Takes over a new version of the ground: what stands where it changed is placed anew. `moved` are the middles in plan of
    /// the things that `standing` has at other heights.
    pub fn set_landscape(
        &mut self,
        landscape: &Arc<Landscape>,
        standing: &Arc<ObjectIndex>,
        moved: &[DVec2],
        changed: &Changed,
    ) {
        if let Some(overlay) = &mut self.overlay {
            overlay.set_landscape(landscape.clone(), changed);
        }
        self.decals.set_field(landscape.ground.field().clone());
        if self.plants.is_some() || self.canopy.is_some() {
            let nursery = Arc::new(Nursery::new(landscape.clone(), self.latitude_rad));
            if let Some(plants) = &mut self.plants {
                plants.set_nursery(&nursery, changed);
            }
            if let Some(canopy) = &mut self.canopy {
                canopy.set_nursery(&nursery, changed);
            }
        }
        if let Some(objects) = &mut self.objects {
            objects.set_index(standing.clone(), moved);
        }
        if let Some(lights) = &mut self.lights {
            lights.set_area(&landscape.ground.whole(), changed);
        }
    }

    /// Streams around the eye and culls for a view. The terrain must have followed already.
    pub fn follow(&mut self, gpu: &Gpu, terrain: &Terrain, view: &View, speed_mps: f64, dark: Dark) {
        let eye_m: DVec3 = view.eye_m;
        if let Some(overlay) = &mut self.overlay {
            overlay.follow(gpu, eye_m, speed_mps);
            overlay.prepare(0, view, terrain);
        }
        self.decals.prepare(gpu, 0, terrain);
        if let Some(plants) = &mut self.plants {
            plants.follow(eye_m, speed_mps);
            plants.prepare(gpu, 0, view);
        }
        if let Some(canopy) = &mut self.canopy {
            canopy.follow(gpu, eye_m, speed_mps);
            canopy.prepare(gpu, 0, view);
        }
        if let Some(objects) = &mut self.objects {
            objects.follow(gpu, eye_m, speed_mps);
            objects.prepare(gpu, 0, view);
        }
        if let Some(lights) = &mut self.lights {
            lights.follow(gpu, eye_m, speed_mps, dark);
            lights.prepare(gpu, 0, view);
        }
    }

    /// Places the particles of a view at a time of the scene, seconds.
    pub fn prepare_particles(&mut self, gpu: &Gpu, view_index: usize, view: &View, time_s: f64) {
        self.particles.prepare(gpu, view_index, view, time_s);
    }

    /// Records a layer of a followed view; `ground` draws the blocks.
    pub fn draw(&self, view_index: usize, layer: Layer, terrain: &Terrain, pass: &mut RenderPass<'_>) {
        match layer {
            Layer::Solid => {
                // What stands up hides ground behind it, which then costs no pixels.
                if let Some(objects) = &self.objects {
                    objects.draw(view_index, terrain.bindings().1, pass);
                }
                if let Some(plants) = &self.plants {
                    plants.draw(view_index, terrain.bindings().1, pass);
                }
                if let Some(canopy) = &self.canopy {
                    canopy.draw(view_index, terrain.bindings().1, pass);
                }
                let draped = |block| self.overlay.as_ref().is_some_and(|overlay| overlay.has_water(block));
                terrain.draw(view_index, &draped, pass);
                if let Some(overlay) = &self.overlay {
                    overlay.draw(view_index, terrain, pass);
                }
                self.decals.draw(view_index, terrain, pass);
            }
            Layer::Blended => {
                if let Some(lights) = &self.lights {
                    lights.draw(view_index, pass);
                }
                self.particles.draw(view_index, pass);
            }
        }
    }

    /// What stands in the view last followed: single plants, and the closed forest.
    pub fn plants_drawn(&self) -> (PlantCounts, CanopyCounts) {
        let plants = self.plants.as_ref().map_or_else(PlantCounts::default, Plants::counts);
        (plants, self.canopy.as_ref().map_or_else(CanopyCounts::default, CanopyPass::counts))
    }

    /// What stood on the ground of the last picture.
    pub fn object_counts(&self) -> ObjectCounts {
        self.objects.as_ref().map_or_else(ObjectCounts::default, Objects::counts)
    }

    /// What a scene moves, for the next pictures.
    pub fn set_moving(&mut self, shapes: &[ObjectInstance]) {
        if let Some(objects) = &mut self.objects {
            objects.set_dynamic(shapes);
        }
    }

    /// What tracers, smoke and fire the next pictures show.
    pub fn set_particles(&mut self, emitters: Vec<Emitter>) {
        self.particles.set(emitters);
    }

    /// Marks that events left on the ground, drawn from the next followed view on.
    pub fn add_decals(&mut self, decals: Vec<Decal>) {
        self.decals.add(decals);
    }

    /// Marks that there are.
    #[cfg(test)]
    pub fn decals(&self) -> usize {
        self.decals.count()
    }

    /// Takes all marks away.
    pub fn clear_decals(&mut self) {
        self.decals.clear();
    }

    /// Takes the shapes that a world's folder has of its own.
    ///
    /// # Errors
    /// [`Failure::Failed`] for a file that is no shape.
    pub fn use_models_of(&mut self, gpu: &Gpu, world: Option<&Path>) -> Result<(), Failure> {
        if self.objects.is_some() {
            self.use_models(gpu, crate::models::own(world)?);
        }
        Ok(())
    }

    /// Takes shapes in the place of generated ones.
    pub fn use_models(&mut self, gpu: &Gpu, own: Vec<(Model, Mesh)>) {
        if let Some(objects) = &mut self.objects
            && !own.is_empty()
        {
            objects.set_models(gpu, &own);
            self.own_models = own;
        }
    }

    /// Shapes that replaced generated ones.
    pub fn own_models(&self) -> &[(Model, Mesh)] {
        &self.own_models
    }

    /// Longest time that placing the plants of a tile took, milliseconds; 0 without plants.
    pub fn plants_placed_ms_max(&self) -> f64 {
        self.plants.as_ref().map_or(0.0, Plants::placed_ms_max)
    }

    /// Tiles within their reach that were not there when last followed.
    pub fn late(&self) -> u64 {
        let overlay = self.overlay.as_ref().map_or(0, OverlayPass::late);
        let plants = self.plants.as_ref().map_or(0, Plants::late);
        let objects = self.objects.as_ref().map_or(0, Objects::late);
        (overlay + plants + objects) as u64
    }

    /// Bytes on the device.
    pub fn gpu_bytes(&self) -> usize {
        self.overlay.as_ref().map_or(0, OverlayPass::gpu_bytes)
            + self.plants.as_ref().map_or(0, Plants::gpu_bytes)
            + self.canopy.as_ref().map_or(0, CanopyPass::gpu_bytes)
            + self.objects.as_ref().map_or(0, Objects::gpu_bytes)
            + self.lights.as_ref().map_or(0, Lights::gpu_bytes)
            + self.particles.gpu_bytes()
            + self.decals.gpu_bytes()
    }
}
