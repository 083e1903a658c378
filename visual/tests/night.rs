//! Night, looked at pixel by pixel on whatever adapter there is: lit windows, moonlight, points of light on the ground and
//! behind a hill. Without an adapter each test says so.

use glam::{DVec2, DVec3};
use std::sync::Arc;
use terrain::block::ground_map::Climate;
use terrain::block::window::{BUDGET_BYTES, Settings as WindowSettings, Window};
use terrain::block::{Landscape, Rings};
use terrain::features::index::ObjectIndex;
use terrain::features::model::{Airfield, Building, BuildingClass, Features, Origin, Runway, RunwaySurface};
use terrain::frame::{attitude, direction};
use terrain::{Grid, synthetic};
use visual::camera::View;
use visual::capture::{self, Offscreen, Picture};
use visual::passes::lights::{Dark, Lights, Reach};
use visual::passes::objects::Objects;
use visual::passes::terrain::{Terrain, TerrainLook};
use visual::{Frame, Gpu, Layer, Renderer, Scene, Settings};

const SIZE_PX: [u32; 2] = [640, 360];
/// Height of the plain, metres.
const PLAIN_M: f64 = 100.0;

/// A plain on the device with what stands on it, and an eye.
struct Stage {
    gpu: Gpu,
    renderer: Renderer,
    terrain: Terrain,
    objects: Objects,
    lights: Option<Lights>,
    target: Offscreen,
    view: View,
}

/// What is drawn.
#[derive(Clone, Copy, PartialEq)]
struct Drawn {
    ground: bool,
    lights: bool,
}

impl Stage {
    /// Ground that is level but for a ridge `ridge_m` high along z = -1,700 m; an eye that looks north, `down_rad` below level.
    fn new(features: Features, ridge_m: f32, eye_m: DVec3, down_rad: f64, fov_y_rad: f64) -> Option<Self> {
        let gpu = match Gpu::headless() {
            Ok(gpu) => gpu,
            Err(error) => {
                println!("skipped: {error}");
                return None;
            }
        };
        let grid = Grid::centred(100.0, 4, 4).expect("grid");
        let field = Arc::new(synthetic::from_fn(grid, |_, row| {
            PLAIN_M as f32 + if grid.z_m(i64::from(row)) == -1_700.0 { ridge_m } else { 0.0 }
        }));
        let rings = Rings::new(&grid, 12, 1.0);
        let features = Arc::new(features);
        let bare = Landscape::bare(field, rings.limits_m, Climate::new(0.85, 420.0));
        let landscape = Arc::new(Landscape { features: features.clone(), ..bare });
        let area = landscape.ground.whole();
        let index = Arc::new(ObjectIndex::new(features.clone(), &area));
        let renderer = Renderer::new(&gpu, capture::FORMAT, Settings::default());
        let (layout, format) = (renderer.frame_layout().clone(), renderer.scene_format());
        let settings = WindowSettings { blocks: 12, rings, budget_bytes: BUDGET_BYTES, wait: true, threads: 1 };
        let look = TerrainLook { detail: 0, overlay: false, wireframe: false };
        let window = Window::new(landscape.clone(), settings, night(-15.0, None, true).sun_direction);
        let terrain = Terrain::new(&gpu, &layout, format, window, look);
        let ground = terrain.bindings().0.clone();
        let objects = Objects::new(&gpu, &layout, &ground, format, &grid, index, 10_000.0, true);
        let reach = Reach { airfields_m: 12_000.0, towns_m: 12_000.0, wait: true };
        let lights = Lights::new(&gpu, &layout, format, area, features, landscape.cover.clone(), reach);
        let target = Offscreen::new(&gpu, SIZE_PX).expect("target");
        let view = View::fov_y(eye_m, attitude(0.0, -down_rad, 0.0), fov_y_rad, SIZE_PX);
        Some(Self { gpu, renderer, terrain, objects, lights, target, view })
    }

    fn picture(&mut self, scene: Scene, drawn: Drawn) -> Picture {
        let dark = Dark::of(scene.sun_elevation_rad(), scene.visibility_m);
        let eye_m = self.view.eye_m;
        for _ in 0..500 {
            self.terrain.follow(&self.gpu, eye_m, 0.0, scene.sun_direction);
            self.objects.follow(&self.gpu, eye_m, 0.0);
            let window = self.terrain.window();
            if !window.is_jumping() && !window.is_relighting() && window.late_blocks() == 0 && self.objects.late() == 0
            {
                break;
            }
        }
        self.terrain.prepare(&self.gpu, 0, &self.view);
        self.objects.prepare(&self.gpu, 0, &self.view);
        if let Some(lights) = &mut self.lights {
            lights.follow(&self.gpu, eye_m, 0.0, dark);
            lights.prepare(&self.gpu, 0, &self.view);
        }
        let frame = Frame { scene, views: vec![self.view], hud: Vec::new() };
        let (terrain, objects, lights) = (&self.terrain, &self.objects, &self.lights);
        self.renderer
            .render(&self.gpu, &frame, &[&self.target.view], |about, layer, pass| match layer {
                Layer::Solid if drawn.ground => {
                    terrain.draw(about.index, &|_| false, pass);
                    objects.draw(about.index, terrain.bindings().1, pass);
                }
                Layer::Blended if drawn.lights => {
                    if let Some(lights) = lights {
                        lights.draw(about.index, pass);
                    }
                }
                _ => {}
            })
            .expect("rendered");
        self.target.read(&self.gpu).expect("read")
    }

    /// Light that the points of light add to a picture, over all pixels, in display white of green.
    fn added(&mut self, scene: Scene, ground: bool) -> f64 {
        let [with, without] = [true, false].map(|lights| self.picture(scene, Drawn { ground, lights }));
        let green = |picture: &Picture| picture.rgba.chunks_exact(4).map(|p| linear(p[1])).sum::<f64>();
        green(&with) - green(&without)
    }
}

/// Linear light of an 8-bit sRGB value (IEC 61966-2-1).
fn linear(value: u8) -> f64 {
    let v = f64::from(value) / 255.0;
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

fn night(sun_deg: f64, moon: Option<(f64, f64)>, lamps: bool) -> Scene {
    Scene {
        // In the east, so that a moon in the north and one in the south have the same phase.
        sun_direction: direction(std::f64::consts::FRAC_PI_2, sun_deg.to_radians()),
        moon_direction: moon.map(|(azimuth_deg, up_deg)| direction(azimuth_deg.to_radians(), f64::to_radians(up_deg))),
        haze_base_m: PLAIN_M,
        lamps,
        ..Scene::default()
    }
}

/// An apartment house 60 m wide and 25 m high, 120 m north of the middle.
fn house() -> Features {
    let outline = [(-30.0, -130.0), (30.0, -130.0), (30.0, -120.0), (-30.0, -120.0)];
    let outline = outline.map(|(x, z)| DVec2::new(x, z)).to_vec();
    let (class, height_from) = (BuildingClass::Apartments, Origin::Stated);
    Features { buildings: vec![Building { class, outline, height_m: 25.0, height_from }], ..Features::default() }
}

#[test]
fn windows_are_lit_while_the_moon_is_up_and_not_where_lamps_are_left_out() {
    let eye_m = DVec3::new(0.0, PLAIN_M + 12.0, 0.0);
    let Some(mut stage) = Stage::new(house(), 0.0, eye_m, 0.0, 0.6) else { return };
    let solid = Drawn { ground: true, lights: false };
    let warm = |picture: &Picture| {
        picture.rgba.chunks_exact(4).filter(|pixel| pixel[0] > 120 && pixel[0] > pixel[2].saturating_add(40)).count()
    };
    // With a moon or without, the sun is as far down.
    for moon in [Some((180.0, 20.0)), None] {
        let [lit, dark] = [true, false].map(|lamps| warm(&stage.picture(night(-15.0, moon, lamps), solid)));
        // The front is some 320 x 130 pixels; a fifth of it panes, six of ten lit.
        assert!(lit > 1_500, "{moon:?}: {lit} lit pixels");
        assert_eq!(dark, 0, "{moon:?}");
    }
    let [lit, dark] = [true, false].map(|lamps| stage.picture(night(30.0, None, lamps), solid));
    assert_eq!(lit.hash(), dark.hash(), "by day there is no difference");
    // Some have come on half way through dusk: 2.25 degrees under the horizon.
    let [half, all] = [-2.25, -3.0].map(|sun_deg| {
        let [lit, dark] = [true, false].map(|lamps| stage.picture(night(sun_deg, None, lamps), solid));
        lit.rgba.iter().zip(&dark.rgba).filter(|(a, b)| a.abs_diff(**b) > 20).count()
    });
    assert!(half > all / 4 && half < all * 3 / 4, "{half} of {all}");
}

#[test]
fn the_moon_lights_the_walls_that_it_shines_on() {
    let eye_m = DVec3::new(0.0, PLAIN_M + 12.0, 0.0);
    let Some(mut stage) = Stage::new(house(), 0.0, eye_m, 0.0, 0.6) else { return };
    let solid = Drawn { ground: true, lights: false };
    // Before the eye and behind it, as high: the same sky, the southern wall in its light or not.
    let [ahead, behind] = [0.0, 180.0].map(|azimuth_deg| {
        let picture = stage.picture(night(-15.0, Some((azimuth_deg, 25.0)), false), solid);
        // The middle of the front, 60 x 40 pixels.
        let at = |x: u32, y: u32| ((y * SIZE_PX[0] + x) * 4) as usize;
        (0..60 * 40).map(|n| linear(picture.rgba[at(290 + n % 60, 140 + n / 60) + 1])).sum::<f64>()
    });
    assert!(behind > 1.3 * ahead, "{behind} in the moon's light, {ahead} in the wall's own shade");
}

/// A lit grass strip 100 m long across the view, 2,000 m north of the middle.
fn strip() -> Features {
    let ends = [DVec2::new(-50.0, -2_000.0), DVec2::new(50.0, -2_000.0)];
    let runway = Runway {
        ends,
        width_m: 30.0,
        designators: ["09".into(), "27".into()],
        surface: RunwaySurface::Grass,
        lit: true,
        from: Origin::Stated,
    };
    let airfield = Airfield {
        code: "XXXX".into(),
        name: "Made up".into(),
        reference: ends[0],
        level_m: PLAIN_M,
        runways: vec![runway],
        taxiways: Vec::new(),
        aprons: Vec::new(),
    };
    Features { airfields: vec![airfield], ..Features::default() }
}

#[test]
fn level_ground_takes_nothing_of_a_light_and_a_hill_before_it_all() {
    // 5 km off and 150 m up: the look is 0.03 down, and over the ridge, 300 m before the strip, 9 m above the plain.
    let eye_m = DVec3::new(0.0, PLAIN_M + 150.0, 3_000.0);
    let scene = night(-15.0, None, true);
    let Some(mut level) = Stage::new(strip(), 0.0, eye_m, 0.03, 0.6) else { return };
    let (alone, on_ground) = (level.added(scene, false), level.added(scene, true));
    assert!(alone > 0.1, "{alone}");
    // Rounding to 8 bits, differently over each background, takes or adds half a step of a few hundred pixels.
    assert!((on_ground / alone - 1.0).abs() < 0.1, "{on_ground} of {alone}");
    drop(level);
    let Some(mut behind) = Stage::new(strip(), 60.0, eye_m, 0.03, 0.6) else { return };
    let hidden = behind.added(scene, true);
    // What is left is the beacon's halo, which is wider than the crest stands above the beacon.
    assert!(hidden < 0.05 * alone, "{hidden} of {alone} shines through");
}
