//! A world on one device, ready for pictures: window of blocks, renderer, sun. Used by every verb that draws.
//!
//! What a picture shows is decided here once, from flags and presets, so a window, a headless flight, a shot and a proof
//! of the same view are the same picture.

use crate::args::ViewArgs;
use crate::failure::Failure;
use crate::fog_base;
use crate::open_world;
use crate::output;
use crate::things::Things;
use crate::values::{Overlay, Quality, Without};
use glam::{DQuat, DVec2, DVec3};
use sim::UtcTime;
use std::sync::{Arc, Once};
use terrain::block::rings::NEAR_RADIUS_M;
use terrain::block::window::{BUDGET_BYTES, Settings as WindowSettings, Window};
use terrain::block::{Landscape, Rings};
use terrain::features::index::ObjectIndex;
use terrain::store::World;
use terrain::{Area, Geodetic};
use visual::camera::View;
use visual::gpu::AdapterKind;
use visual::passes::lights::Dark;
use visual::passes::lines::Stroke;
use visual::passes::terrain::{Terrain, TerrainLook};
use visual::sky::HazeGrade;
use visual::{Frame, Gpu, Renderer, Scene};

/// A fog's base moves in steps of this, metres.
const FOG_BASE_STEP_M: f64 = 5.0;

/// What of a world is drawn beside its ground. What a world does not have costs nothing whatever stands here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Content {
    /// Roads, running water, runways: what is draped on the ground.
    pub overlays: bool,
    /// Buildings and placed things.
    pub objects: bool,
    /// Share of the plants that are drawn, 0 to 1.
    pub plants: f32,
    /// How far from the eye overlays, objects and plants are drawn at most, metres; not beyond the near zone.
    pub reach_m: f64,
    /// Light points and lit windows.
    pub lights: bool,
}

impl Content {
    /// All of it.
    pub const ALL: Self = Self { overlays: true, objects: true, plants: 1.0, reach_m: NEAR_RADIUS_M, lights: true };
}

/// What shines in the sky: unit vectors, world frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heavens {
    /// Towards the sun.
    pub to_sun: DVec3,
    /// Towards the moon, where it is known.
    pub to_moon: Option<DVec3>,
}

impl From<DVec3> for Heavens {
    /// A sun without a moon.
    fn from(to_sun: DVec3) -> Self {
        Self { to_sun, to_moon: None }
    }
}

/// Everything that decides a picture but the eye and the time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Size, pixels.
    pub size_px: [u32; 2],
    /// Vertical field of view, radians.
    pub fov_y_rad: f64,
    /// How far one sees, metres, as asked for.
    pub visibility_m: Option<f64>,
    /// Blocks along a side of the window.
    pub window: u32,
    /// Largest error on screen, pixels of the reference view.
    pub limit_px: f64,
    /// The near radius asked for, metres; the window's own choice if none.
    pub near_radius_m: Option<f64>,
    /// Every block at level 0.
    pub all_level_0: bool,
    /// Samples a pixel.
    pub msaa: u32,
    /// Pixels drawn for one shown, along a side.
    pub render_scale: f32,
    /// How the ground is drawn.
    pub ground: TerrainLook,
    /// What else is drawn.
    pub content: Content,
    /// Wait for every block and every sky table.
    pub wait: bool,
    /// How light scattered on the way from the ground is found.
    pub haze: HazeGrade,
    /// Keep depth for reading back.
    pub keep_depth: bool,
}

impl Look {
    /// From flags; what is not given comes from the preset, and that from the adapter.
    pub fn of(args: &ViewArgs, adapter: AdapterKind, wait: bool) -> Self {
        let preset = Self::preset(args.quality.unwrap_or(match adapter {
            AdapterKind::Hardware => Quality::Fine,
            AdapterKind::Software => Quality::Standard,
        }));
        Self {
            size_px: [args.size.width_px, args.size.height_px],
            fov_y_rad: args.fov_y_deg.to_radians(),
            visibility_m: args.visibility_m,
            window: args.window.unwrap_or(preset.window),
            all_level_0: args.all_level_0,
            msaa: args.msaa.unwrap_or(preset.msaa),
            render_scale: args.render_scale.map_or(preset.render_scale, |scale| scale as f32),
            ground: TerrainLook { overlay: args.overlay == Some(Overlay::Blocks), ..preset.ground },
            content: Content {
                overlays: preset.content.overlays && !args.without.contains(&Without::Overlays),
                objects: preset.content.objects && !args.without.contains(&Without::Objects),
                lights: preset.content.lights && !args.without.contains(&Without::Lights),
                plants: match args.plants {
                    _ if args.without.contains(&Without::Plants) => 0.0,
                    Some(share) => share as f32,
                    None => preset.content.plants,
                },
                reach_m: preset.content.reach_m,
            },
            wait,
            ..preset
        }
    }

    /// A preset alone: 1280 x 720 pixels, 60 degrees, waiting for every block.
    pub fn preset(quality: Quality) -> Self {
        let (window, msaa, render_scale, detail, plants, reach_m, haze) = match quality {
            Quality::Fine => (24, 4, 1.0, 2, 1.0, NEAR_RADIUS_M, HazeGrade::Table),
            Quality::Standard => (24, 1, 1.0, 2, 1.0, NEAR_RADIUS_M, HazeGrade::Table),
            Quality::Software => (12, 1, 0.67, 0, 0.25, 4_000.0, HazeGrade::Horizon),
        };
        Self {
            size_px: [1280, 720],
            fov_y_rad: 60f64.to_radians(),
            visibility_m: None,
            window,
            limit_px: 1.0,
            near_radius_m: None,
            all_level_0: false,
            msaa,
            render_scale,
            ground: TerrainLook { detail, overlay: false, wireframe: false },
            content: Content { plants, reach_m, ..Content::ALL },
            wait: true,
            haze,
            keep_depth: false,
        }
    }

    /// The rings that this look has in a world.
    pub fn rings(&self, world: &World) -> Rings {
        if self.all_level_0 {
            return Rings::all_level_0();
        }
        match self.near_radius_m {
            Some(near_m) => Rings::with_near_radius(near_m, self.limit_px),
            None => Rings::new(world.field.grid(), self.window, self.limit_px),
        }
    }
}

/// See the module.
pub struct Scenery {
    /// The device.
    pub gpu: Gpu,
    /// The world.
    pub world: Arc<World>,
    /// Its ground, the newest version.
    pub area: Area,
    /// What blocks and tiles are made from, the newest version.
    pub landscape: Arc<Landscape>,
    /// What pictures look like.
    pub look: Look,
    /// The ground on the device.
    pub terrain: Terrain,
    /// What stands on it.
    pub things: Things,
    /// All that stands on the ground; what shells meet too, drawn or not.
    pub standing: Arc<ObjectIndex>,
    renderer: Renderer,
}

impl Scenery {
    /// Prepares a world for pictures into targets of a colour format.
    pub fn new(gpu: Gpu, format: visual::TextureFormat, world: Arc<World>, look: Look) -> Self {
        tell_of_missing_edges(&gpu, look.ground);
        let rings = look.rings(&world);
        let landscape = open_world::landscape(&world, &rings);
        let area = landscape.ground.whole();
        let settings = WindowSettings {
            blocks: look.window,
            rings,
            budget_bytes: BUDGET_BYTES,
            wait: look.wait,
            threads: std::thread::available_parallelism().map_or(1, |cores| cores.get().saturating_sub(1).clamp(1, 4)),
        };
        let renderer = Renderer::new(
            &gpu,
            format,
            visual::Settings {
                msaa: look.msaa,
                render_scale: look.render_scale,
                keep_depth: look.keep_depth,
                sky_in_background: !look.wait,
                haze: look.haze,
            },
        );
        let near_m = settings.rings.radii_m[0];
        let window = Window::new(landscape.clone(), settings, DVec3::Y);
        let terrain = Terrain::new(&gpu, renderer.frame_layout(), renderer.scene_format(), window, look.ground);
        let standing = Arc::new(ObjectIndex::new(world.features.clone(), &area));
        let latitude_rad = world.projection.centre().lat_rad;
        let things = Things::new(&gpu, &renderer, &terrain, &landscape, &standing, latitude_rad, near_m, &look);
        Self { gpu, world, area, landscape, look, terrain, things, standing, renderer }
    }

    /// Visibility drawn: as asked, clamped to what the window guarantees, metres.
    pub fn visibility_m(&self) -> f64 {
        let most_m = self.terrain.window().view_range_min_m();
        self.look.visibility_m.map_or(most_m, |asked_m| asked_m.min(most_m))
    }

    /// Height that the visibility holds at, above sea level, metres: the world's lowest ground; of a fog, which fills
    /// every valley by itself, the lowest ground about the eye.
    fn haze_base_m(&self, eye_m: DVec3) -> f64 {
        let world_m = self.world.info.statistics.min_m.max(0.0);
        let fog = visual::sky::fog_share(self.visibility_m());
        if fog == 0.0 {
            return world_m;
        }
        let near_m = fog_base::near_m(&self.area, DVec2::new(eye_m.x, eye_m.z)).unwrap_or(world_m);
        // In steps, since new air is made for each.
        ((world_m + fog * (near_m.max(0.0) - world_m)) / FOG_BASE_STEP_M).round() * FOG_BASE_STEP_M
    }

    /// Depth of the last picture, if it was kept.
    pub fn depth(&self) -> Option<&visual::Texture> {
        self.renderer.depth(0)
    }

    /// Sun and moon at a moment over the world's centre.
    ///
    /// # Errors
    /// [`Failure::Failed`] where the sun's position is not known.
    pub fn heavens(&self, at: UtcTime) -> Result<Heavens, Failure> {
        heavens(&self.world, at)
    }

    /// Changes how the ground is drawn.
    pub fn set_ground_look(&mut self, ground: TerrainLook) {
        tell_of_missing_edges(&self.gpu, ground);
        self.look.ground = ground;
        self.terrain.set_look(&self.gpu, self.renderer.frame_layout(), ground);
    }

    /// The view of an eye that looks along an attitude (view axes to world).
    pub fn view(&self, eye_m: DVec3, attitude: DQuat, size_px: [u32; 2]) -> View {
        View::fov_y(eye_m, attitude, self.look.fov_y_rad, size_px)
    }

    /// Streams, culls: all that the render thread does for the ground before it draws.
    pub fn follow(&mut self, view: &View, speed_mps: f64, heavens: impl Into<Heavens>) {
        let Heavens { to_sun, .. } = heavens.into();
        self.terrain.follow(&self.gpu, view.eye_m, speed_mps, to_sun);
        self.terrain.prepare(&self.gpu, 0, view);
        let dark = Dark::of(to_sun.y.clamp(-1.0, 1.0).asin(), self.visibility_m());
        self.things.follow(&self.gpu, &self.terrain, view, speed_mps, dark);
    }

    /// Blocks and tiles within their reach that were not there when last followed.
    pub fn late(&self) -> u64 {
        self.terrain.window().late_blocks() + self.things.late()
    }

    /// Bytes on the device for what the scene holds.
    pub fn gpu_bytes(&self) -> usize {
        self.terrain.gpu_bytes() + self.things.gpu_bytes()
    }

    /// Whether all that the eye's place asks for is there.
    pub fn is_settled(&self) -> bool {
        let window = self.terrain.window();
        !window.is_jumping() && !window.is_relighting() && !window.is_changing() && self.late() == 0
    }

    /// Takes the shapes that a world's folder has of its own.
    ///
    /// # Errors
    /// [`Failure::Failed`] for a file that is no shape.
    pub fn use_models_of(&mut self, world: Option<&std::path::Path>) -> Result<(), Failure> {
        self.things.use_models_of(&self.gpu, world)
    }

    /// The ground and what stands on it, as shells and bodies meet it.
    pub fn scene_ground(&self) -> sim::SceneGround {
        sim::SceneGround::from(self.area.clone())
            .with_objects(self.standing.clone())
            .with_cover(self.world.cover.clone())
    }

    /// Draws what was last followed, with strokes over it.
    ///
    /// # Errors
    /// What the device reports.
    pub fn draw(
        &mut self,
        view: &View,
        heavens: impl Into<Heavens>,
        time_s: f64,
        hud: Vec<Stroke>,
        target: &visual::TextureView,
    ) -> Result<(), visual::GpuError> {
        let Heavens { to_sun, to_moon } = heavens.into();
        let scene = Scene {
            sun_direction: to_sun,
            moon_direction: to_moon,
            visibility_m: self.visibility_m(),
            haze_base_m: self.haze_base_m(view.eye_m),
            view_range_m: self.terrain.window().view_range_min_m(),
            exposure: 1.0,
            lamps: self.look.content.lights,
            time_s,
        };
        let frame = Frame { scene, views: vec![*view], hud };
        self.things.prepare_particles(&self.gpu, 0, view, time_s);
        let (terrain, things) = (&self.terrain, &self.things);
        self.renderer.render(&self.gpu, &frame, &[target], |about, layer, pass| {
            things.draw(about.index, layer, terrain, pass);
        })
    }
}

/// Says once a run that a wireframe is asked of an adapter that draws none.
fn tell_of_missing_edges(gpu: &Gpu, ground: TerrainLook) {
    static TOLD: Once = Once::new();
    if ground.wireframe && !gpu.draws_edges() {
        TOLD.call_once(|| {
            output::tell(format_args!(
                "poligon: no wireframe: adapter \"{}\" cannot draw edges alone (POLYGON_MODE_LINE)",
                gpu.report.name
            ));
        });
    }
}

/// Sun and moon at a moment over a world's centre.
///
/// # Errors
/// [`Failure::Failed`] where the sun's position is not known.
pub fn heavens(world: &World, at: UtcTime) -> Result<Heavens, Failure> {
    let centre = world.projection.centre();
    let moon = visual::moon::position(at.unix_s(), centre.lat_deg(), centre.lon_deg()).ok();
    // At the centre grid north is true north.
    let to_moon = moon.map(|moon| terrain::frame::direction(moon.true_azimuth_rad, moon.elevation_rad));
    Ok(Heavens { to_sun: to_sun(world, at)?, to_moon })
}

/// Towards the sun at a moment over a world's centre, world frame.
///
/// # Errors
/// [`Failure::Failed`] where the position is not known.
pub fn to_sun(world: &World, at: UtcTime) -> Result<DVec3, Failure> {
    let centre = world.projection.centre();
    let sun = visual::sun::position(at.unix_s(), centre.lat_deg(), centre.lon_deg())
        .map_err(|error| Failure::while_doing("placing the sun", error))?;
    // At the centre grid north is true north.
    Ok(terrain::frame::direction(sun.true_azimuth_rad, sun.elevation_rad))
}

/// World position of a place a person named.
///
/// # Errors
/// [`Failure::Failed`] for a height above ground where there is none.
pub fn position(world: &World, area: &Area, place: crate::values::Place) -> Result<DVec3, Failure> {
    use crate::values::Altitude;
    let DVec2 { x, y: z } = world.projection.to_world(Geodetic::from_degrees(place.lat_deg, place.lon_deg));
    let height_m = match place.altitude {
        Altitude::SeaLevelM(height_m) => height_m,
        Altitude::GroundM(above_m) => {
            above_m
                + area.height_m(x, z).ok_or_else(|| {
                    Failure::Failed(format!(
                        "a height above ground needs ground: this world has none at {}, {}",
                        place.lat_deg, place.lon_deg
                    ))
                })?
        }
    };
    Ok(DVec3::new(x, height_m, z))
}

/// Grid heading of a true one at a world position, radians.
pub fn grid_heading_rad(world: &World, at: DVec3, true_heading_rad: f64) -> f64 {
    true_heading_rad - convergence_rad(world, at)
}

/// True heading of a grid one at a world position, radians.
pub fn true_heading_rad(world: &World, at: DVec3, grid_heading_rad: f64) -> f64 {
    grid_heading_rad + convergence_rad(world, at)
}

fn convergence_rad(world: &World, at: DVec3) -> f64 {
    let place = world.projection.to_geodetic(DVec2::new(at.x, at.z));
    let turn = world.projection.grid_convergence_rad(place);
    if turn.is_finite() { turn } else { 0.0 }
}

/// The moment a picture shows where none was asked for: mid-morning at the world's centre in summer.
pub fn default_moment(world: &World) -> UtcTime {
    // 2026-06-21T09:00Z, moved to nine o'clock local solar time.
    let nine = UtcTime { unix_ns: 1_782_032_400_000_000_000 };
    nine.plus_s(-world.projection.centre().lon_deg() / 360.0 * 86_400.0)
}
