//! Edits against a ground that has had these posts from the start.

use super::*;
use crate::block::light::light_map;
use crate::block::payload::Landscape;
use crate::block::rings::{RingMasks, Rings};
use crate::features::cover_rules::Climate;
use crate::ground::Ground;
use crate::synthetic;
use glam::DVec3;
use rand::{RngExt, SeedableRng, rngs::StdRng};
use std::sync::Arc;

fn grounds() -> Vec<Ground> {
    let grid = Grid::centred(200.0, 5, 4).unwrap();
    let mut holed = synthetic::ridges(grid, 3).heights_m().to_vec();
    for at in [0, 5, 200, 201, 202, 900, 1_500, 9_000, 9_001, 9_002, 9_151, 9_152] {
        holed[at] = f32::NAN;
    }
    let fields = [
        synthetic::ridges(grid, 1),
        synthetic::rough(grid, 2, 800.0),
        synthetic::flat(grid, 100.0),
        Field::new(grid, holed).unwrap(),
    ];
    fields.map(|field| Ground::new(Arc::new(field))).into()
}

/// Craters of all sizes, also at corners of blocks, on and beyond the world's edge and in void; and single posts.
fn some_edit(grid: &Grid, random: &mut StdRng) -> Edit {
    let corner = |random: &mut StdRng| Corner {
        column: random.random_range(0..grid.columns()),
        row: random.random_range(0..grid.rows()),
    };
    if random.random_bool(0.3) {
        let posts = (0..random.random_range(0..6)).map(|_| (corner(random), random.random_range(-50.0..3_000.0)));
        return Edit::Posts(posts.collect());
    }
    let mut centre_m = DVec2::new(
        random.random_range(grid.west_m - 2_000.0..grid.east_m() + 2_000.0),
        random.random_range(grid.north_m - 2_000.0..grid.south_m() + 2_000.0),
    );
    if random.random_bool(0.4) {
        centre_m = (centre_m / grid.block_m()).round() * grid.block_m();
    }
    let radius_m = random.random_range(100.0..2_000.0);
    Edit::Crater(Crater { centre_m, radius_m, depth_m: random.random_range(1.0..600.0) })
}

/// The field with the same posts from the start.
fn anew(field: &Field) -> Field {
    Field::new(*field.grid(), field.heights_m().to_vec()).unwrap()
}

#[test]
fn an_edited_ground_answers_as_one_with_these_posts_from_the_start() {
    let mut random = StdRng::seed_from_u64(1);
    for before in grounds() {
        let mut ground = before.clone();
        for number in 1..=8 {
            let edits: Vec<Edit> = (0..3).map(|_| some_edit(ground.field().grid(), &mut random)).collect();
            ground = ground.edited(&edits).unwrap().0;
            assert_eq!(ground.version(), number);
        }
        assert_eq!(before.version(), 0);
        let fresh = Ground::new(Arc::new(anew(ground.field())));
        // Slow and fast both by bits: NaN is void.
        assert!(ground.pyramid() == fresh.pyramid());
        let (edited, fresh) = (ground.whole(), fresh.whole());
        let grid = *edited.grid();
        let mut point = |low: f64, high: f64| {
            DVec3::new(
                random.random_range(grid.west_m..grid.east_m()),
                random.random_range(low..high),
                random.random_range(grid.north_m..grid.south_m()),
            )
        };
        for _ in 0..2_000 {
            let (from, to) = (point(0.0, 4_000.0), point(-500.0, 3_000.0));
            assert_eq!(edited.height_and_normal(from.x, from.z), fresh.height_and_normal(from.x, from.z));
            assert_eq!(edited.segment(from, to), fresh.segment(from, to));
            assert_eq!(edited.clearance(from, to), fresh.clearance(from, to));
        }
    }
}

#[test]
fn what_a_change_does_not_reach_is_as_before_and_masks_are_those_of_the_new_posts() {
    let mut random = StdRng::seed_from_u64(2);
    let (mut same, mut payloads, mut lights) = (0, 0, 0);
    for ground in grounds() {
        let rings = Rings::with_near_radius(6_000.0, 1.0);
        let climate = Climate::new(0.7, 1_000.0);
        let before = Landscape::bare(ground.field().clone(), rings.limits_m, climate);
        let grid = *ground.field().grid();
        for (heading, elevation) in [(0.6, 0.7), (2.1, 0.12), (4.0, 0.02), (5.1, -0.01), (0.0, 0.4), (3.0, -0.5)] {
            let to_sun = crate::frame::direction(heading, elevation);
            let walk = Walk::new(grid.step_m, to_sun);
            let (after, changed) = before.edited(&[some_edit(&grid, &mut random)]).unwrap();
            assert_eq!(after.masks, RingMasks::new(&anew(after.ground.field()), rings.limits_m));
            for block in grid.blocks() {
                let (old, new) = (before.payload(block, to_sun), after.payload(block, to_sun));
                let lowest_m = old.lowest_m().min(new.lowest_m());
                if !changed.reaches_surface(block) {
                    assert_eq!(bits(&old.heights_m), bits(&new.heights_m), "{block:?} of {changed:?}");
                    assert!((0..=3).all(|ring| before.mesh(block, ring) == after.mesh(block, ring)));
                }
                if changed.reaches_payload(block) {
                    payloads += 1;
                } else {
                    same += 1;
                    assert_eq!(old.ground_map, new.ground_map, "{block:?} of {changed:?}");
                    assert_eq!((old.range, old.ground_triangles), (new.range, new.ground_triangles));
                }
                if changed.reaches_light(block, &walk, lowest_m) {
                    lights += 1;
                } else {
                    assert_eq!(old.light, new.light, "{block:?} of {changed:?}, sun {to_sun}");
                }
            }
        }
    }
    println!("{same} payloads were not reached, {payloads} were; {lights} lights");
    assert!(same > 200 && payloads > 20 && lights > payloads);
}

fn bits(heights_m: &[f32]) -> Vec<u32> {
    heights_m.iter().map(|height_m| height_m.to_bits()).collect()
}

#[test]
fn light_beyond_the_reach_of_a_walk_that_ends_early_is_that_of_a_whole_walk() {
    for ground in grounds() {
        let (field, pyramid) = (ground.field(), ground.pyramid());
        for (heading, elevation) in [(0.6, 0.7), (2.1, 0.12), (4.0, 0.02), (5.1, -0.01), (1.2, 1.2)] {
            let to_sun = crate::frame::direction(heading, elevation);
            // With a summit far off the walks are as long as they may be.
            let corner = Corner { column: 0, row: 0 };
            let (with_summit, _) = ground.edited(&[Edit::Posts(vec![(corner, 90_000.0)])]).unwrap();
            let summit_m = with_summit.pyramid();
            for block in field.grid().blocks() {
                assert_eq!(
                    light_map(field, pyramid, block, to_sun),
                    light_map(field, summit_m, block, to_sun),
                    "{block:?}, sun {to_sun}"
                );
            }
        }
    }
}

#[test]
fn what_cannot_be_made_is_refused_and_says_why() {
    let ground = &grounds()[3];
    let crater =
        |x: f64, radius_m: f64, depth_m: f64| Edit::Crater(Crater { centre_m: DVec2::new(x, 0.0), radius_m, depth_m });
    for wrong in [
        crater(f64::NAN, 400.0, 10.0),
        crater(f64::INFINITY, 400.0, 10.0),
        crater(0.0, 0.0, 10.0),
        crater(0.0, -400.0, 10.0),
        crater(0.0, f64::NAN, 10.0),
        crater(0.0, 1e9, 10.0),
        crater(0.0, 400.0, f64::NAN),
        crater(0.0, 400.0, 0.0),
        crater(0.0, 400.0, 1e9),
    ] {
        assert!(ground.edited(&[crater(0.0, 400.0, 10.0), wrong.clone()]).is_err(), "{wrong:?}");
    }
    let (inside, outside) = (Corner { column: 3, row: 4 }, Corner { column: 3, row: ground.field().grid().rows() });
    for (corner, height_m) in [(inside, f32::NAN), (inside, f32::INFINITY), (inside, 2e5), (outside, 3.0)] {
        let error = ground.edited(&[Edit::Posts(vec![(corner, height_m)])]).unwrap_err();
        assert!(error.to_string().contains("column 3"), "{error}");
    }
    // Too small for the posts, beyond the world, no post, or the height that is there: nothing changes.
    let there_m = ground.field().post_m(3, 4);
    for nothing in
        [crater(0.0, 199.0, 50.0), crater(1e7, 400.0, 10.0), Edit::Posts(vec![]), Edit::Posts(vec![(inside, there_m)])]
    {
        let (after, changed) = ground.edited(&[nothing]).unwrap();
        assert!(changed.is_empty());
        assert_eq!(bits(&after.field().heights_m()), bits(&ground.field().heights_m()));
    }
}

#[test]
fn a_crater_has_its_depth_its_rim_and_its_end() {
    let crater = Crater::simple(DVec2::ZERO, 1_000.0);
    assert_eq!(crater.rise_m(0.0), -320.0);
    assert!((crater.rise_m(1_000.0) - 72.0).abs() < 1e-9 && (crater.rise_m(999.999) - 72.0).abs() < 0.001);
    assert_eq!((crater.rise_m(3_000.0), crater.rise_m(1e9)), (0.0, 0.0));
    // What is thrown out is no more than what is missing: the bowl's volume below, the rim's and the ejecta's above.
    let volume = |from: f64, to: f64| {
        let step = (to - from) / 10_000.0;
        (0..10_000).map(|i| from + (f64::from(i) + 0.5) * step).map(|r| crater.rise_m(r) * r * step).sum::<f64>()
    };
    assert!(volume(0.0, 1_000.0) < 0.0 && volume(1_000.0, 3_000.0) > 0.0);
    assert!(volume(1_000.0, 3_000.0) < -volume(0.0, 1_000.0));
}
