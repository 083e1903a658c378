//! The window against what it promises: complete within its range, one row at a time, within budget, never stale.

use super::*;
use crate::block::ground_map::Climate;
use crate::block::light;
use crate::block::payload::tile_heights_m;
use crate::edit::{Crater, Edit};
use crate::{Corner, Field, Grid, synthetic};
use rand::{RngExt, SeedableRng, rngs::StdRng};

const BLOCKS: u32 = 12;

fn window(wait: bool) -> Window {
    let grid = Grid::centred(200.0, 20, 20).unwrap();
    let field = Arc::new(synthetic::ridges(grid, 5));
    // Near rings, so that all kinds of mesh occur in a small window.
    let rings = Rings::with_near_radius(6_000.0, 1.0);
    let landscape = Landscape::bare(field, rings.limits_m, Climate::new(0.7, 1_000.0));
    let settings = Settings { blocks: BLOCKS, rings, budget_bytes: BUDGET_BYTES, wait, threads: 2 };
    Window::new(Arc::new(landscape), settings, DVec3::new(0.3, 0.8, 0.2).normalize())
}

/// What a GPU would hold, kept up by applying uploads.
#[derive(Default)]
struct Gpu {
    blocks: HashMap<usize, Arc<Payload>>,
    indices: HashMap<usize, Arc<Vec<u16>>>,
    lights: [HashMap<usize, Arc<[u8]>>; 2],
}

impl Gpu {
    fn apply(&mut self, uploads: Vec<Upload>) {
        for upload in uploads {
            match upload {
                Upload::Block { slot, layer, payload } => {
                    self.lights[layer].insert(slot, Arc::from(payload.light.clone()));
                    self.blocks.insert(slot, payload);
                }
                Upload::Light { slot, layer, light } => {
                    self.lights[layer].insert(slot, light);
                }
                Upload::Indices { slot, indices } => {
                    self.indices.insert(slot, indices);
                }
            }
        }
    }

    /// Every block drawn is the block in its slot, with the triangles of its ring and light of the sun in use.
    fn check(&self, window: &Window) {
        let (layer, to_sun) = window.light();
        let landscape = window.landscape();
        for draw in window.draws(|_, _, _| true) {
            assert_eq!(self.blocks[&draw.slot].block, draw.block);
            match (draw.level, landscape.mesh(draw.block, draw.ring)) {
                (Level::Zero, Mesh::Level0) | (Level::One, Mesh::Level1) => {}
                (Level::Own { indices }, Mesh::Own(list)) => {
                    assert_eq!(indices as usize, list.len());
                    assert_eq!(self.indices[&draw.slot], list);
                }
                other => panic!("{draw:?} has {other:?}"),
            }
            let ground = &landscape.ground;
            let fresh = light::light_map(ground.field(), ground.pyramid(), draw.block, to_sun);
            assert_eq!(self.lights[layer][&draw.slot][..], fresh[..], "stale light in {:?}", draw.block);
        }
    }
}

#[test]
fn a_diagonal_flight_has_every_block_in_time_and_within_budget() {
    let mut window = window(true);
    let mut gpu = Gpu::default();
    let (step_m, speed) = (50.0, 3_000.0);
    let mut eye = DVec2::new(-20_000.0, -21_000.0);
    gpu.apply(window.update(eye, speed));
    assert_eq!(window.late_blocks(), 0);
    for frame in 0..800 {
        eye += DVec2::new(0.8, 0.6) * step_m;
        gpu.apply(window.update(eye, speed));
        assert!(window.counters().upload_bytes <= BUDGET_BYTES);
        assert_eq!(window.late_blocks(), 0, "frame {frame} at {eye}");
        if frame % 40 == 0 {
            gpu.check(&window);
        }
    }
    // 32 km east and 24 km south are at least 5 and 3 borders of 6 km.
    assert!(window.counters().shifts >= 8, "{:?}", window.counters());
    assert!(window.counters().switches > 50);
}

#[test]
fn a_jump_off_the_map_and_back_recovers() {
    let mut window = window(true);
    let mut gpu = Gpu::default();
    for eye in [
        DVec2::ZERO,
        DVec2::splat(1e6),
        DVec2::new(f64::NAN, 0.0),
        DVec2::splat(-1e300),
        DVec2::new(31_000.0, -28_000.0),
    ] {
        for _ in 0..60 {
            gpu.apply(window.update(eye, 0.0));
        }
        gpu.check(&window);
        assert_eq!(window.late_blocks(), 0);
    }
    assert!(!window.draws(|_, _, _| true).is_empty());
}

#[test]
fn the_same_path_gives_the_same_meshes() {
    let fly = || {
        let mut window = window(true);
        let mut hashes = Vec::new();
        for frame in 0..200 {
            window.update(DVec2::new(-9_000.0 + 90.0 * f64::from(frame), 40.0 * f64::from(frame)), 90.0);
            hashes.push(window.mesh_hash());
        }
        hashes
    };
    assert_eq!(fly(), fly());
}

#[test]
fn light_flips_for_all_blocks_at_once() {
    let mut window = window(true);
    let mut gpu = Gpu::default();
    gpu.apply(window.update(DVec2::ZERO, 0.0));
    let old = window.light();
    let sun = DVec3::new(-0.5, 0.5, 0.2).normalize();
    window.set_sun(sun);
    let mut frames = 0;
    while window.light() == old {
        assert_eq!(window.light(), old, "no half-lit picture");
        gpu.apply(window.update(DVec2::new(10.0 * f64::from(frames), 0.0), 10.0));
        frames += 1;
        assert!(frames < 100);
    }
    assert_eq!(window.light().1, sun);
    let landscape = window.landscape().clone();
    let (layer, _) = window.light();
    for draw in window.draws(|_, _, _| true) {
        let fresh = landscape.payload(draw.block, sun);
        assert_eq!(gpu.lights[layer][&draw.slot][..], fresh.light[..], "{:?}", draw.block);
    }
    // Less than half a degree is left alone.
    window.set_sun((sun + DVec3::new(0.002, 0.0, 0.0)).normalize());
    assert!(!window.relighting);
}

#[test]
fn light_stays_right_through_shifts_jumps_and_a_racing_sun() {
    let mut window = window(true);
    let mut gpu = Gpu::default();
    for frame in 0..240 {
        // A day in 240 frames, faster than one relight can follow.
        let turn = f64::from(frame) / 240.0 * std::f64::consts::TAU;
        window.set_sun(DVec3::new(turn.cos(), 0.4, turn.sin()).normalize());
        let jump = if frame >= 120 { 30_000.0 } else { 0.0 };
        gpu.apply(window.update(DVec2::new(-15_000.0 + jump + 60.0 * f64::from(frame), 50.0 * f64::from(frame)), 60.0));
        if frame % 24 == 0 {
            gpu.check(&window);
        }
    }
    assert!(window.counters().relights >= 10, "{:?}", window.counters());
    assert!(window.counters().shifts >= 2, "{:?}", window.counters());
}

#[test]
fn without_waiting_it_still_settles() {
    let mut window = window(false);
    let mut gpu = Gpu::default();
    for frame in 0..400 {
        gpu.apply(window.update(DVec2::new(20.0 * f64::from(frame), 0.0), 300.0));
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    gpu.check(&window);
    assert_eq!(window.late_blocks(), 0);
}

#[test]
fn near_blocks_are_level_0() {
    let mut window = window(true);
    for frame in 0..100 {
        window.update(DVec2::new(150.0 * f64::from(frame), -70.0 * f64::from(frame)), 300.0);
        for draw in window.draws(|_, _, _| true) {
            assert!(draw.ring <= window.settings().rings.ring_at(draw.distance_m));
            if draw.distance_m < window.settings().rings.radii_m[0] {
                assert_eq!((draw.ring, draw.level), (0, Level::Zero));
            }
        }
    }
}

/// A crater or some posts in the window's middle.
fn edits(random: &mut StdRng, number: usize) -> Vec<Edit> {
    let mut place = || random.random_range(-16_000.0..16_000.0_f64);
    let mut all: Vec<Edit> = (0..number)
        .map(|at| {
            let mut centre_m = DVec2::new(place(), place());
            if at % 2 == 1 {
                // On a corner of four blocks.
                centre_m = (centre_m / 6_000.0).round() * 6_000.0;
            }
            Edit::Crater(Crater { centre_m, radius_m: 250.0 + place().abs() / 10.0, depth_m: 150.0 })
        })
        .collect();
    let corner = Corner { column: random.random_range(200..400), row: random.random_range(200..400) };
    all.push(Edit::Posts(vec![(corner, random.random_range(0.0..4_000.0))]));
    all
}

/// The same ground with all its posts from the start, and nothing shared.
fn anew(landscape: &Landscape, rings: &Rings) -> Landscape {
    let field = landscape.ground.field();
    let field = Field::new(*field.grid(), field.heights_m().to_vec()).unwrap();
    Landscape { lakes: landscape.lakes.clone(), ..Landscape::bare(Arc::new(field), rings.limits_m, landscape.climate) }
}

/// Every block is to the bit what a window over this ground from the start has.
fn as_anew(gpu: &Gpu, window: &Window) {
    let fresh = anew(window.landscape(), &window.settings().rings);
    let (layer, to_sun) = window.light();
    for draw in window.draws(|_, _, _| true) {
        let (held, made) = (&gpu.blocks[&draw.slot], fresh.payload(draw.block, to_sun));
        let bits = |heights: &[f32]| heights.iter().map(|h| h.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&held.heights_m), bits(&made.heights_m), "{:?}", draw.block);
        assert_eq!(held.ground_map, made.ground_map, "{:?}", draw.block);
        assert_eq!(gpu.lights[layer][&draw.slot][..], made.light[..], "{:?}", draw.block);
        let shown = (draw.range, draw.has_water, draw.ground_triangles);
        assert_eq!(shown, (made.range, made.has_water, made.ground_triangles));
        match (draw.level, fresh.mesh(draw.block, draw.ring)) {
            (Level::Zero, Mesh::Level0) | (Level::One, Mesh::Level1) => {}
            (Level::Own { indices }, Mesh::Own(list)) => {
                assert_eq!((indices as usize, &gpu.indices[&draw.slot]), (list.len(), &list));
            }
            other => panic!("{draw:?} has {other:?}"),
        }
    }
}

/// Every height that is drawn is one version's: no border is between two.
fn one_version(gpu: &Gpu, window: &Window) {
    let field = window.landscape().ground.field();
    for draw in window.draws(|_, _, _| true) {
        let now = tile_heights_m(field, draw.block);
        let held = &gpu.blocks[&draw.slot].heights_m;
        assert!(held.iter().zip(&now).all(|(a, b)| a.to_bits() == b.to_bits()), "{:?}", draw.block);
    }
}

#[test]
fn a_window_that_waits_shows_an_edit_in_its_next_update_as_one_made_over_it() {
    let mut random = StdRng::seed_from_u64(4);
    let mut window = window(true);
    let mut gpu = Gpu::default();
    gpu.apply(window.update(DVec2::new(-9_000.0, 0.0), 0.0));
    let mut newest = window.landscape().clone();
    for frame in 0..90 {
        // Shifts, ring switches and relights go on meanwhile.
        let turn = f64::from(frame) / 40.0;
        window.set_sun(DVec3::new(turn.cos(), 0.2, turn.sin()).normalize());
        let edited = frame % 3 == 0;
        if edited {
            let (landscape, changed) = newest.edited(&edits(&mut random, 1 + frame as usize % 2)).unwrap();
            newest = Arc::new(landscape);
            window.set_landscape(newest.clone(), &changed);
        }
        let eye = DVec2::new(-9_000.0 + 150.0 * f64::from(frame), 90.0 * f64::from(frame));
        // 175 m a frame, thirty a second: at less than its true speed it would ask for blocks too late.
        gpu.apply(window.update(eye, 5_250.0));
        assert!(!window.is_changing() && Arc::ptr_eq(window.landscape(), &newest), "frame {frame}");
        assert_eq!(window.late_blocks(), 0, "frame {frame}");
        one_version(&gpu, &window);
        if frame % 15 == 0 {
            as_anew(&gpu, &window);
        }
    }
    assert_eq!(window.counters().changes, 30);
    assert!(window.counters().relights >= 3 && window.counters().shifts >= 2, "{:?}", window.counters());
}

#[test]
fn edits_that_stream_in_are_shown_whole_or_not_at_all() {
    let mut random = StdRng::seed_from_u64(5);
    let mut window = window(false);
    let mut gpu = Gpu::default();
    gpu.apply(window.update(DVec2::ZERO, 0.0));
    let mut newest = window.landscape().clone();
    let mut before = 0;
    for frame in 0..240 {
        if frame < 120 && frame % 2 == 0 {
            let (landscape, changed) = newest.edited(&edits(&mut random, 1)).unwrap();
            newest = Arc::new(landscape);
            window.set_landscape(newest.clone(), &changed);
        }
        gpu.apply(window.update(DVec2::new(40.0 * f64::from(frame), 0.0), 300.0));
        one_version(&gpu, &window);
        if window.counters().changes > before {
            before = window.counters().changes;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    while window.is_changing() || window.late_blocks() > 0 {
        gpu.apply(window.update(DVec2::new(9_560.0, 0.0), 300.0));
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    assert!(before >= 2 && Arc::ptr_eq(window.landscape(), &newest), "{before} versions were shown");
    as_anew(&gpu, &window);
}

#[test]
fn an_edit_before_the_first_picture_or_during_a_jump_is_no_other() {
    let mut random = StdRng::seed_from_u64(6);
    for wait in [true, false] {
        let mut window = window(wait);
        let mut gpu = Gpu::default();
        let mut newest = window.landscape().clone();
        for eye in [DVec2::ZERO, DVec2::splat(20_000.0), DVec2::splat(1e6), DVec2::splat(-9_000.0)] {
            let (landscape, changed) = newest.edited(&edits(&mut random, 2)).unwrap();
            newest = Arc::new(landscape);
            window.set_landscape(newest.clone(), &changed);
            for _ in 0..300 {
                gpu.apply(window.update(eye, 0.0));
                if window.late_blocks() == 0 && !window.is_changing() && !window.is_jumping() {
                    break;
                }
                std::thread::sleep(std::time::Duration::from_millis(u64::from(!wait) * 2));
            }
            assert!(Arc::ptr_eq(window.landscape(), &newest));
            one_version(&gpu, &window);
        }
        as_anew(&gpu, &window);
    }
}
