//! Events that change the ground of the embedded world: every block of a window is what it would be had the ground been so
//! from the start, and no border has a T-junction.

use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::collections::HashMap;
use std::sync::Arc;
use terrain::bake::default_world;
use terrain::block::ground_map::Climate;
use terrain::block::payload::{Mesh, Payload};
use terrain::block::window::{BUDGET_BYTES, Level, Settings, Upload, Window};
use terrain::block::{Landscape, Rings, mesh};
use terrain::edit::{Crater, Edit};
use terrain::features::by_block::StripsByBlock;
use terrain::verify::cracks::Sheet;
use terrain::verify::flight::Piece;
use terrain::{Field, Grid, Ground, RingMasks};

#[test]
fn random_craters_of_the_embedded_world_are_as_if_they_had_always_been_there() {
    let world = default_world(&mut |_, _| ()).expect("the embedded world").world;
    let grid = *world.field.grid();
    let rings = Rings::new(&grid, 12, 1.0);
    let over = |field: Arc<Field>| Landscape {
        masks: RingMasks::new(&field, rings.limits_m),
        ground: Ground::new(field),
        lakes: Arc::new(world.lakes.clone()),
        strips: Arc::new(StripsByBlock::new(&grid, &world.features)),
        features: world.features.clone(),
        cover: world.cover.clone(),
        imagery: world.imagery.clone(),
        climate: Climate::of(world.projection.centre(), world.info.statistics.mean_m),
    };
    let settings = Settings { blocks: 12, rings, budget_bytes: BUDGET_BYTES, wait: true, threads: 2 };
    // A low sun: shadows of 20 km.
    let to_sun = terrain::frame::direction(4.2, 0.08);
    let mut newest = Arc::new(over(world.field.clone()));
    let mut window = Window::new(newest.clone(), settings, to_sun);
    let mut device = Device::default();
    let mut random = StdRng::seed_from_u64(11);
    for step in 0..6 {
        let eye = DVec2::new(-20_000.0 + 900.0 * f64::from(step), 5_000.0);
        device.apply(window.update(eye, 300.0));
        let edits: Vec<Edit> = (0..3)
            .map(|_| {
                let away = DVec2::new(random.random_range(-3e4..3e4), random.random_range(-3e4..3e4));
                let radius_m = random.random_range(200.0..2_500.0);
                Edit::Crater(Crater::simple(eye + away, radius_m))
            })
            .collect();
        let (landscape, changed) = newest.edited(&edits).expect("craters");
        newest = Arc::new(landscape);
        window.set_landscape(newest.clone(), &changed);
        device.apply(window.update(eye, 300.0));
        assert!(Arc::ptr_eq(window.landscape(), &newest), "shown in the update after");
    }
    let fresh = over(Arc::new(Field::new(grid, newest.ground.field().heights_m().to_vec()).expect("the posts")));
    assert!(fresh.masks == newest.masks);
    let mut blocks = 0;
    for draw in window.draws(|_, _, _| true) {
        let (held, made) = (&device.blocks[&draw.slot], fresh.payload(draw.block, to_sun));
        assert!(
            held.heights_m.iter().zip(&made.heights_m).all(|(a, b)| a.to_bits() == b.to_bits()),
            "{:?}",
            draw.block
        );
        assert!(held.ground_map == made.ground_map, "ground map of {:?}", draw.block);
        assert!(device.lights[&draw.slot][..] == made.light[..], "light of {:?}", draw.block);
        match (draw.level, fresh.mesh(draw.block, draw.ring)) {
            (Level::Zero, Mesh::Level0) | (Level::One, Mesh::Level1) => {}
            (Level::Own { .. }, Mesh::Own(list)) => assert_eq!(device.indices[&draw.slot], list, "{:?}", draw.block),
            other => panic!("{draw:?} has {other:?}"),
        }
        blocks += 1;
    }
    assert!(blocks > 100, "{blocks}");
    let field = newest.ground.field();
    let mut sheet = Sheet::new(field, window.origin(), 12, DVec3::new(1.0, 2_000.0, 3.0), split);
    for draw in window.draws(|_, _, _| true) {
        let indices = match draw.level {
            Level::Zero => mesh::level_0(),
            Level::One => mesh::level_1(),
            Level::Own { .. } => &*device.indices[&draw.slot],
        };
        sheet.add(Piece { block: draw.block, indices, heights_m: &device.blocks[&draw.slot].heights_m });
    }
    let cracks = sheet.check();
    println!("{blocks} blocks, {cracks:?}");
    assert_eq!((cracks.t_junctions, cracks.position_mismatches), (0, 0));
    assert!(cracks.edges > 100_000);
}

/// The post north-west of an eye, and how far east and south of it the eye is, as the picture takes it.
fn split(grid: &Grid, eye_m: DVec3) -> ([i32; 2], [f32; 2]) {
    let post = |at_m: f64, first_m: f64| ((at_m - first_m) / grid.step_m).floor();
    let (column, row) = (post(eye_m.x, grid.west_m), post(eye_m.z, grid.north_m));
    let east_m = eye_m.x - (grid.west_m + column * grid.step_m);
    let south_m = eye_m.z - (grid.north_m + row * grid.step_m);
    ([column as i32, row as i32], [east_m as f32, south_m as f32])
}

/// What a device would hold, kept up by applying uploads; one layer of light, as the sun stands still.
#[derive(Default)]
struct Device {
    blocks: HashMap<usize, Arc<Payload>>,
    indices: HashMap<usize, Arc<Vec<u16>>>,
    lights: HashMap<usize, Arc<[u8]>>,
}

impl Device {
    fn apply(&mut self, uploads: Vec<Upload>) {
        for upload in uploads {
            match upload {
                Upload::Block { slot, payload, .. } => {
                    self.lights.insert(slot, Arc::from(payload.light.clone()));
                    self.blocks.insert(slot, payload);
                }
                Upload::Light { slot, light, .. } => drop(self.lights.insert(slot, light)),
                Upload::Indices { slot, indices } => drop(self.indices.insert(slot, indices)),
            }
        }
    }
}
