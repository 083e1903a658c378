//! Writes pictures of what stands on the ground and of particles, by day and by night, over a made-up town.
//!
//! `cargo run -p poligon-visual --example standing -- FOLDER [NAME..]`

use glam::{DQuat, DVec2, DVec3};
use std::error::Error;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;
use terrain::block::ground_map::Climate;
use terrain::block::window::{BUDGET_BYTES, Settings as WindowSettings, Window};
use terrain::block::{Landscape, Rings};
use terrain::features::index::ObjectIndex;
use terrain::features::lakes::Lakes;
use terrain::features::model::{
    Airfield, Building, BuildingClass, Features, Mast, MastClass, Origin, Placed, PlacedClass, PowerLine, Runway,
    RunwaySurface,
};
use terrain::features::placing;
use terrain::frame::{attitude, direction};
use terrain::{Grid, synthetic};
use visual::camera::View;
use visual::capture::{self, Offscreen};
use visual::models::things::MODELS;
use visual::particles::{Emitter, EmitterKind};
use visual::passes::objects::{ObjectInstance, Objects};
use visual::passes::particles::Particles;
use visual::passes::terrain::{Terrain, TerrainLook};
use visual::{Frame, Gpu, Layer, Renderer, Scene, Settings};

const SIZE_PX: [u32; 2] = [1280, 720];

/// A town of houses and blocks on hills, an airfield on the level south of it.
fn features() -> Features {
    let mut features = Features::default();
    let mut seed = 5_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / f64::from(1_u32 << 31)
    };
    for row in -26..26_i32 {
        for column in -30..30_i32 {
            let (x, z) = (f64::from(column) * 24.0, f64::from(row) * 26.0 - 900.0);
            let centre = (x / 700.0).hypot((z + 900.0) / 700.0);
            if row % 5 == 0 || column % 6 == 0 || random() < 0.15 + 0.5 * centre {
                continue;
            }
            let turn = DVec2::from_angle(0.25 + 0.15 * (random() - 0.5));
            let middle = DVec2::from_angle(0.25).rotate(DVec2::new(x, z + 900.0)) + DVec2::new(0.0, -900.0);
            let half = DVec2::new(5.0 + 4.0 * random(), 4.0 + 2.5 * random());
            let mut corners = vec![(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            if random() < 0.25 {
                corners = vec![(-1.0, -1.0), (1.0, -1.0), (1.0, 0.1), (0.1, 0.1), (0.1, 1.0), (-1.0, 1.0)];
            }
            let (class, height_m, grow) = match (centre, random()) {
                (c, r) if c < 0.35 && r < 0.8 => (BuildingClass::Apartments, 12.0 + 18.0 * random(), 1.25),
                (c, _) if c < 0.35 => (BuildingClass::Commercial, 10.0 + 20.0 * random(), 1.3),
                (_, r) if r < 0.04 => (BuildingClass::Church, 12.0, 1.2),
                (_, r) if r < 0.12 => (BuildingClass::Barn, 5.0, 1.2),
                (_, r) if r < 0.2 => (BuildingClass::Industrial, 7.0, 1.3),
                _ => (BuildingClass::House, 5.0 + 2.0 * random(), 1.0),
            };
            let outline = corners.iter().map(|(u, v)| middle + turn.rotate(DVec2::new(*u, *v) * half * grow)).collect();
            let height_m = height_m as f32;
            features.buildings.push(Building { class, outline, height_m, height_from: Origin::Assumed });
        }
    }
    let at = |x: f64, z: f64| DVec2::new(x, z);
    features.airfields.push(Airfield {
        code: "XXXX".into(),
        name: "Made up".into(),
        reference: at(0.0, 1_200.0),
        level_m: 420.0,
        runways: vec![Runway {
            ends: [at(-1_000.0, 1_250.0), at(1_000.0, 1_250.0)],
            width_m: 45.0,
            designators: ["09".into(), "27".into()],
            surface: RunwaySurface::Asphalt,
            lit: true,
            from: Origin::Stated,
        }],
        taxiways: Vec::new(),
        aprons: Vec::new(),
    });
    for (number, class) in
        [MastClass::Mast, MastClass::Tower, MastClass::Chimney, MastClass::WindTurbine].iter().enumerate()
    {
        let height_m = [60.0, 50.0, 80.0, 100.0][number];
        features.masts.push(Mast { class: *class, at: at(-500.0 + 250.0 * number as f64, 300.0), height_m });
    }
    features
        .power_lines
        .push(PowerLine { line: (-4..5).map(|n| at(f64::from(n) * 250.0, 550.0)).collect(), height_m: 35.0 });
    for (number, class) in
        [PlacedClass::Tank, PlacedClass::Truck, PlacedClass::Ship, PlacedClass::Boat].iter().enumerate()
    {
        features.placed.push(Placed {
            class: *class,
            at: at(600.0 + 40.0 * number as f64, 300.0),
            grid_heading_rad: 0.6,
        });
    }
    features
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "standing-pictures".into()));
    let wanted: Vec<String> = arguments.collect();
    let gpu = Gpu::headless()?;
    let grid = Grid::centred(100.0, 4, 4)?;
    let field = Arc::new(synthetic::from_fn(grid, |column, row| {
        let (x, z) = (grid.x_m(i64::from(column)), grid.z_m(i64::from(row)));
        let hill = 60.0 * (x / 900.0).sin() * ((z + 500.0) / 1_100.0).cos() + 180.0 * (-(z + 3_000.0) / 900.0).tanh();
        let level = ((z - 500.0) / 300.0).clamp(0.0, 1.0);
        (420.0 + (1.0 - level) * hill.max(-30.0)) as f32
    }));
    let mut features = features();
    let things = placing::placed(&features, &Lakes::default(), &field);
    features.placed.extend(things);
    let features = Arc::new(features);
    let rings = Rings::new(&grid, 12, 1.0);
    let bare = Landscape::bare(field, rings.limits_m, Climate::new(0.85, 420.0));
    let landscape = Arc::new(Landscape { features: features.clone(), ..bare });
    let area = landscape.ground.whole();
    let start = Instant::now();
    let index = Arc::new(ObjectIndex::new(features, &area));
    println!("{} things indexed in {:.1} ms", index.len(), start.elapsed().as_secs_f64() * 1e3);

    let mut renderer = Renderer::new(&gpu, capture::FORMAT, Settings { msaa: 4, ..Settings::default() });
    let settings = WindowSettings { blocks: 12, rings, budget_bytes: BUDGET_BYTES, wait: true, threads: 1 };
    let look = TerrainLook { detail: 2, overlay: false, wireframe: false };
    let (layout, format) = (renderer.frame_layout().clone(), renderer.scene_format());
    let sun = |deg: f64| direction(3.6, deg.to_radians());
    let mut terrain = Terrain::new(&gpu, &layout, format, Window::new(landscape, settings, sun(35.0)), look);
    let ground_layout = terrain.bindings().0.clone();
    let mut objects = Objects::new(&gpu, &layout, &ground_layout, format, &grid, index, 10_000.0, true);
    let mut particles = Particles::new(&layout, format);

    let on = |x: f64, z: f64, up_m: f64| DVec3::new(x, area.height_m(x, z).unwrap_or(0.0) + up_m, z);
    // Every shape in a row, in motion.
    let row: Vec<ObjectInstance> = MODELS
        .iter()
        .enumerate()
        .map(|(number, class)| ObjectInstance {
            class: *class,
            position_m: on(-700.0 + 70.0 * number as f64, 2_000.0, 0.0),
            attitude: DQuat::from_rotation_y(0.7),
            scale: if class.placed().is_some() { 1.0 } else { 30.0 },
            shade: 1.0,
        })
        .collect();
    objects.set_dynamic(&row);
    let born = |kind, x: f64, up_m, size_m, born_s| Emitter {
        kind,
        born_s,
        position_m: on(x, 1_600.0, up_m),
        velocity_mps: DVec3::new(3.0, 0.0, 1.0),
        size_m,
    };
    let emitters = [
        born(EmitterKind::Explosion, -60.0, 0.0, 8.0, 9.75),
        born(EmitterKind::Explosion, -25.0, 0.0, 8.0, 7.5),
        born(EmitterKind::Dust, 5.0, 0.0, 5.0, 9.2),
        born(EmitterKind::Smoke, 30.0, 1.0, 4.0, -30.0),
        born(EmitterKind::Fire, 30.0, 0.0, 3.0, -30.0),
        Emitter { velocity_mps: DVec3::X, ..born(EmitterKind::MuzzleFlash, 55.0, 3.0, 1.2, 9.97) },
        Emitter { velocity_mps: DVec3::new(700.0, 60.0, -100.0), ..born(EmitterKind::Tracer, 60.0, 8.0, 0.08, 9.97) },
        Emitter { velocity_mps: DVec3::new(-700.0, 20.0, -30.0), ..born(EmitterKind::Tracer, 40.0, 12.0, 0.08, 9.96) },
    ];
    let time_s = 10.0;
    let cases = [
        ("town_300", on(-100.0, 100.0, 150.0), 0.05, -0.13, 35.0),
        ("town_near", on(-60.0, -420.0, 25.0), 0.1, -0.1, 35.0),
        ("town_low_sun", on(600.0, -100.0, 120.0), -0.9, -0.12, 8.0),
        ("town_dusk", on(-100.0, 100.0, 150.0), 0.05, -0.13, -4.0),
        ("town_night", on(-100.0, 100.0, 150.0), 0.05, -0.13, -12.0),
        ("airfield", on(-150.0, 1_210.0, 45.0), 0.3, -0.22, 35.0),
        ("models_a", on(-460.0, 2_090.0, 28.0), 0.0, -0.2, 35.0),
        ("models_b", on(60.0, 2_090.0, 28.0), 0.0, -0.2, 35.0),
        ("masts", on(-100.0, 760.0, 40.0), 0.0, -0.05, 35.0),
        ("particles", on(0.0, 1_710.0, 12.0), 0.0, -0.02, 35.0),
        ("particles_night", on(0.0, 1_710.0, 12.0), 0.0, -0.02, -12.0),
    ];
    let target = Offscreen::new(&gpu, SIZE_PX)?;
    for (name, eye_m, heading_rad, up_rad, sun_deg) in cases {
        if !wanted.is_empty() && !wanted.iter().any(|one| one == name) {
            continue;
        }
        let to_sun = sun(sun_deg);
        let view = View::fov_y(eye_m, attitude(heading_rad, up_rad, 0.0), 1.0, SIZE_PX);
        terrain.follow(&gpu, eye_m, 0.0, to_sun);
        terrain.prepare(&gpu, 0, &view);
        let start = Instant::now();
        objects.follow(&gpu, eye_m, 0.0);
        let followed_ms = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        objects.prepare(&gpu, 0, &view);
        let prepared_ms = start.elapsed().as_secs_f64() * 1e3;
        particles.set(emitters);
        particles.prepare(&gpu, 0, &view, time_s);
        let scene = Scene { sun_direction: to_sun, time_s, haze_base_m: 400.0, ..Scene::default() };
        let frame = Frame { scene, views: vec![view], hud: Vec::new() };
        for _ in 0..2 {
            renderer.render(&gpu, &frame, &[&target.view], |about, layer, pass| match layer {
                Layer::Solid => {
                    terrain.draw(about.index, &|_| false, pass);
                    objects.draw(about.index, terrain.bindings().1, pass);
                }
                Layer::Blended => particles.draw(about.index, pass),
            })?;
        }
        target.read(&gpu)?.write_png(&folder.join(format!("{name}.png")))?;
        let (counts, sprites) = (objects.counts(), particles.count(0));
        println!("{name:16} follow {followed_ms:.1} ms, prepare {prepared_ms:.2} ms, {counts:?}, {sprites} sprites");
    }
    Ok(())
}
