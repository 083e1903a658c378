//! One ground: what is drawn near the eye is the ground of the queries, on the processor and on the device, and does not
//! change while the eye moves; beyond, it keeps its limit.
//!
//! On made-up worlds at the extremes; `poligon verify` proves the same of a real one. The device's part needs a Vulkan
//! adapter, which may be software; without one it says so.

use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;
use terrain::block::window::Level;
use terrain::block::{Landscape, Rings, ground_map::Climate};
use terrain::verify::flight::Flight;
use terrain::verify::near::Near;
use terrain::verify::{far, pop};
use terrain::{Field, Grid, Ground, RingMasks, synthetic};
use visual::camera::View;
use visual::proof::{Stage, depth, grey, heights};
use visual::{Gpu, Scene};

fn landscape(field: Arc<Field>, rings: &Rings) -> Arc<Landscape> {
    Arc::new(Landscape::bare(field, rings.limits_m, Climate::new(0.7, 1_000.0)))
}

/// A world with mountains, holes and a cliff, and rings near enough for all of them to be in a window of 12.
fn mountains() -> (Arc<Landscape>, Rings) {
    let grid = Grid::centred(200.0, 16, 16).unwrap();
    let ridges = synthetic::ridges(grid, 5);
    let field = synthetic::from_fn(grid, |column, row| {
        let hole = (f64::from(column) - 200.0).hypot(f64::from(row) - 300.0) < 9.0;
        let cliff = if column > 330 { 3_000.0 } else { 0.0 };
        if hole { f32::NAN } else { ridges.heights_m()[(row * grid.columns() + column) as usize] + cliff }
    });
    let rings = Rings::with_near_radius(7_000.0, 1.0);
    (landscape(Arc::new(field), &rings), rings)
}

#[test]
fn nothing_near_moves_and_all_of_it_is_the_ground() {
    let (landscape, rings) = mountains();
    let mut near = Near::new(landscape.ground.whole());
    let mut flight = Flight::new(landscape, rings, 12);
    for (at, eye) in
        pop::line(DVec2::new(-21_000.0, -15_000.0), DVec2::new(14_000.0, 19_000.0), 60.0).iter().enumerate()
    {
        flight.fly_to(*eye, 300.0);
        near.look(&flight, *eye, if at % 20 == 0 { 8 } else { 0 });
    }
    assert_eq!((near.height_changes, near.max_difference_m), (0, 0.0));
    assert!(near.places > 1_000 && near.blocks > 5_000, "{} {}", near.places, near.blocks);
}

#[test]
fn a_near_zone_that_is_not_the_ground_is_found() {
    let (landscape, rings) = mountains();
    // The flight's near zone is smaller than it should be: coarse blocks stand where level 0 was promised.
    let smaller = Rings { radii_m: rings.radii_m.map(|radius_m| 0.2 * radius_m), ..rings };
    let mut flight = Flight::new(landscape.clone(), smaller, 12);
    let eye = DVec2::new(3_100.0, 2_900.0);
    flight.fly_to(eye, 0.0);
    let coarse = flight.draws().into_iter().find(|draw| draw.level != Level::Zero).unwrap();
    let piece = flight.drawn(&coarse).unwrap();
    let drawn = terrain::verify::surface::Surface::of(piece.indices, piece.heights_m);
    let ground = terrain::verify::surface::Surface::ground(piece.heights_m);
    assert!(terrain::verify::surface::greatest_difference_m(&drawn, &ground) > 0.0);
    // Seen through the near radius of another world, heights differ.
    let other = synthetic::ridges(*landscape.ground.field().grid(), 6);
    let mut near = Near::new(Ground::new(Arc::new(other)).whole());
    near.look(&flight, eye, 8);
    assert!(near.max_difference_m > 100.0);
}

#[test]
fn far_meshes_keep_their_limits_on_worlds_at_the_extremes() {
    let grid = Grid::centred(200.0, 8, 8).unwrap();
    let rings = Rings::new(&grid, 24, 1.0);
    let rough = synthetic::rough(grid, 3, 60.0);
    for (name, field, least_m) in [
        ("ridges", synthetic::ridges(grid, 7), 10.0),
        ("noise", rough.clone(), 10.0),
        ("flat", synthetic::flat(grid, -430.0), 0.0),
        ("spike", synthetic::spike(grid, 100, 101, 9_000.0), 0.0),
        ("cliff", synthetic::cliff(grid, 120, 10_000.0), 0.0),
        ("void", synthetic::from_fn(grid, |c, r| if c % 9 == 4 && r % 7 == 3 { f32::NAN } else { 5.0 }), 0.0),
    ] {
        let found = far::prove(&landscape(Arc::new(field), &rings));
        assert_eq!(found.violations, 0, "{name}: {found:?}");
        assert!(found.errors_max_m[0] >= least_m, "{name}: {found:?}");
    }
    // Masks of a wider limit are beyond this one.
    let mut wrong = Arc::into_inner(landscape(Arc::new(rough), &rings)).unwrap();
    wrong.masks = RingMasks::new(wrong.ground.field(), rings.limits_m.map(|limit_m| 1.5 * limit_m));
    wrong.masks.limits_m = rings.limits_m;
    assert!(far::prove(&wrong).violations > 0);
}

#[test]
fn a_switch_of_ring_moves_less_than_a_pixel() {
    let (landscape, rings) = mountains();
    let mut flight = Flight::new(landscape, rings, 12);
    let mut pops = Vec::new();
    let start = DVec2::new(-20_000.0, 9_000.0);
    // The first update fills the window by distance alone, the second brings the margins of flight.
    flight.fly_to(start, 300.0);
    flight.fly_to(start, 300.0);
    for eye in pop::line(start, DVec2::new(20_000.0, -8_000.0), 50.0) {
        pops.extend(pop::step(&mut flight, DVec3::new(eye.x, 4_000.0, eye.y), 300.0));
    }
    let worst = pops.iter().map(|pop| pop.px).fold(0.0, f64::max);
    assert!(pops.len() > 100 && worst > 0.1 && worst <= 1.0, "{} switches, {worst} px", pops.len());
    for pop in &pops {
        // Finer 60 m and 0.2 s of flight early, coarser 60 m behind that: never inside the radius of its coarser ring.
        assert!(pop.switch.distance_m > rings.radii_m[pop.switch.from.max(pop.switch.to) - 1], "{pop:?}");
    }
}

fn adapter() -> Option<Gpu> {
    Gpu::headless().inspect_err(|error| println!("skipped: {error}")).ok()
}

#[test]
fn the_device_has_the_posts_and_draws_the_ground() {
    let Some(gpu) = adapter() else { return };
    let (landscape, rings) = mountains();
    let area = landscape.ground.whole();
    let mut stage = Stage::new(gpu, landscape, rings, 12, [480, 360], Scene::default()).unwrap();
    let mut rng = StdRng::seed_from_u64(6);
    let mut sum = depth::Depths::default();
    for (x, z, above_m, elevation_rad) in
        [(0.0, 0.0, 3.0, -0.1), (9_000.0, -12_000.0, 800.0, -0.5), (-14_000.0, 3_000.0, 4_000.0, -1.5)]
    {
        let eye_m = DVec3::new(x, area.height_m(x, z).unwrap() + above_m, z);
        let attitude = terrain::frame::attitude(rng.random_range(0.0..6.0), elevation_rad, 0.2);
        let view = View::fov_y(eye_m, attitude, 1.0, [480, 360]);
        stage.follow(&view);
        stage.draw(&view).unwrap();
        let found = heights::compare(&stage, &view).unwrap();
        assert!(found.vertices_checked > 100_000);
        assert_eq!((found.height_mismatches, found.position_mismatches), (0, 0));
        let pixels = (0..40_000).map(|_| [rng.random_range(0..480), rng.random_range(0..360)]);
        let drawn = stage.depth().unwrap();
        sum = sum.and(depth::compare(&area, &view, &drawn, rings.radii_m[0], 4_000, pixels));
        // The same picture seen from 2 % higher is not the ground's.
        let off = View { eye_m: eye_m + DVec3::Y * (0.02 * above_m), ..view };
        let pixels = (0..40_000).map(|_| [rng.random_range(0..480), rng.random_range(0..360)]);
        let found = depth::compare(&area, &off, &drawn, rings.radii_m[0], 1_000, pixels);
        assert!(2 * found.pixels_outside > found.pixels_checked, "{found:?}");
    }
    assert!(sum.pixels_checked > 8_000, "{sum:?}");
    assert_eq!(sum.pixels_outside, 0, "{sum:?}");
    assert!(sum.pixels_excluded * 50 <= sum.pixels_checked + sum.pixels_excluded, "{sum:?}");
}

#[test]
fn a_switch_changes_no_grey_where_nothing_moves_and_some_where_much_does() {
    let Some(gpu) = adapter() else { return };
    let (landscape, rings) = mountains();
    let mut stage = Stage::new(gpu, landscape, rings, 12, [400, 400], Scene::default()).unwrap();
    let block = stage.terrain.window().landscape().ground.field().grid().block_at(3_000.0, 3_000.0);
    let view = grey::view_of(&stage, block, DVec3::new(-6_000.0, 7_000.0, -5_000.0));
    let same = grey::change(&mut stage, &view, block, 1, 1).unwrap();
    assert!(same.pixels > 1_000, "{same:?}");
    assert_eq!((same.mean, same.worst), (0.0, 0.0));
    let coarser = grey::change(&mut stage, &view, block, 0, 3).unwrap();
    assert!(coarser.mean > 0.0 && coarser.worst >= coarser.mean, "{coarser:?}");
}
