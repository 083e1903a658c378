//! The embedded world against what is known of it: the lake's level and area, its shore, its airfields, its shadows.

use glam::{DVec2, DVec3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::sync::OnceLock;
use terrain::bake::default_world;
use terrain::block::ground_map::{MAP_BYTES, SIDE};
use terrain::block::light::sun_seen;
use terrain::block::{Landscape, ground_map::Climate};
use terrain::store::World;
use terrain::{CELLS, Ground, frame};

/// Area of the polygon that an outline's lattice of posts may be off: the lake is 180 km long.
const AREA_SHARE: f64 = 0.02;
/// Published: 6,236 km2 (Lake Issyk-Kul, ILEC World Lake Database); the outline is of another year and scale.
const PUBLISHED_KM2: f64 = 6_236.0;

fn world() -> &'static World {
    static WORLD: OnceLock<World> = OnceLock::new();
    WORLD.get_or_init(|| default_world(&mut |_, _| ()).expect("the embedded world").world)
}

fn outline_area_m2(rings: &[Vec<DVec2>]) -> f64 {
    let area = |ring: &Vec<DVec2>| {
        let next = ring.iter().cycle().skip(1);
        0.5 * ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    };
    // Holes turn the other way in a sound file; the larger ring is the lake.
    let mut areas: Vec<f64> = rings.iter().map(|ring| area(ring).abs()).collect();
    areas.sort_by(f64::total_cmp);
    areas.pop().unwrap_or_default() - areas.iter().sum::<f64>()
}

#[test]
fn issyk_kul_is_at_its_level_and_as_large_as_its_outline() {
    let world = world();
    let lake = world.lakes.lakes().iter().find(|lake| lake.name.contains("Issyk")).expect("Issyk-Kul");
    assert_eq!(lake.level_m, 1607.0);
    let outline_m2 = outline_area_m2(&lake.rings);
    let grid = world.field.grid();
    // Ground whose three corners are at the level is the water that one sees and asks.
    let level = |column: i64, row: i64| world.field.post_m(column, row) == 1607.0;
    let mut flat_m2 = 0.0;
    for row in 0..i64::from(grid.rows()) - 1 {
        for column in 0..i64::from(grid.columns()) - 1 {
            let (nw, ne, sw, se) =
                (level(column, row), level(column + 1, row), level(column, row + 1), level(column + 1, row + 1));
            let half = 0.5 * grid.step_m * grid.step_m;
            flat_m2 += half * f64::from(u8::from(nw && ne && sw) + u8::from(sw && ne && se));
        }
    }
    // Water as it is drawn: the ground map's alpha over its half, in the blocks of the lake.
    let mut landscape = Landscape::bare(world.field.clone(), [13.9, 27.8, 55.6], Climate::new(0.74, 2_400.0));
    landscape.lakes = std::sync::Arc::new(world.lakes.clone());
    let (low, high) = lake
        .rings
        .iter()
        .flatten()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(*at), high.max(*at)));
    let (first, last) = (grid.block_at(low.x, low.y), grid.block_at(high.x, high.y));
    let texel_m = f64::from(CELLS) * grid.step_m / f64::from(SIDE - 1);
    let mut drawn_m2 = 0.0;
    for z in first.z..=last.z {
        for x in first.x..=last.x {
            let map = landscape.payload(terrain::BlockIndex { x, z }, DVec3::Y).ground_map;
            for (at, texel) in map[..MAP_BYTES].chunks_exact(4).enumerate() {
                // Border texels are shared by two blocks.
                let (column, row) = (at as u32 % SIDE, at as u32 / SIDE);
                let edge = |place: u32| if place == 0 || place == SIDE - 1 { 0.5 } else { 1.0 };
                drawn_m2 += f64::from(u8::from(texel[3] > 127)) * edge(column) * edge(row) * texel_m * texel_m;
            }
        }
    }
    println!(
        "outline {:.0} km2, level ground {:.0} km2, drawn {:.0} km2",
        outline_m2 * 1e-6,
        flat_m2 * 1e-6,
        drawn_m2 * 1e-6
    );
    assert!((flat_m2 / outline_m2 - 1.0).abs() < AREA_SHARE);
    assert!((drawn_m2 / outline_m2 - 1.0).abs() < AREA_SHARE);
    assert!((outline_m2 * 1e-6 / PUBLISHED_KM2 - 1.0).abs() < 2.0 * AREA_SHARE, "{outline_m2}");
}

#[test]
fn every_airfield_is_at_its_level_and_its_surfaces_are_planes() {
    let world = world();
    let area = Ground::new(world.field.clone()).whole();
    assert!(world.features.airfields.len() >= 5, "{}", world.features.airfields.len());
    for airfield in &world.features.airfields {
        let height_m = |at: DVec2| area.height_m(at.x, at.y).expect("ground");
        let off_m = (height_m(airfield.reference) - airfield.level_m).abs();
        assert!(off_m < 1.0, "{}: the reference point is {off_m} m off", airfield.code);
        for runway in &airfield.runways {
            let along = (runway.ends[1] - runway.ends[0]).normalize();
            let length_m = runway.ends[0].distance(runway.ends[1]);
            for step in 0..=100 {
                for side in [-0.5, -0.25, 0.0, 0.25, 0.5] {
                    let at = runway.ends[0]
                        + along * (length_m * f64::from(step) / 100.0)
                        + along.perp() * (side * f64::from(runway.width_m));
                    let off_m = (height_m(at) - airfield.level_m).abs();
                    assert!(off_m < 0.2, "{}: {off_m} m off the plane at {at}", airfield.code);
                }
            }
        }
        for at in airfield.aprons.iter().flatten().chain(airfield.taxiways.iter().flat_map(|(line, _)| line)) {
            assert!((height_m(*at) - airfield.level_m).abs() < 0.2, "{}: {at}", airfield.code);
        }
    }
    let almaty = world.features.airfields.iter().find(|airfield| airfield.code == "UAAA").expect("Almaty");
    // The table's 2,238 ft, as an f32 has it (half an ulp: 0.03 mm); the AIP of Kazakhstan has 681 m.
    assert!((almaty.level_m - 2_238.0 * 0.3048).abs() < 1e-4, "{}", almaty.level_m);
}

#[test]
fn shadows_at_posts_agree_with_a_ray_over_the_real_ground() {
    let world = world();
    let ground = Ground::new(world.field.clone());
    let (area, grid) = (ground.whole(), *world.field.grid());
    let highest_m = f64::from(ground.pyramid().all().greatest_m);
    let mut random = StdRng::seed_from_u64(41);
    let (mut agree, mut all, mut dark) = (0, 0, 0);
    while all < 10_000 {
        let column = random.random_range(1..i64::from(grid.columns()) - 1);
        let row = random.random_range(1..i64::from(grid.rows()) - 1);
        let to_sun = frame::direction(random.random_range(0.0..std::f64::consts::TAU), random.random_range(0.05..0.8));
        let height_m = f64::from(world.field.post_m(column, row));
        if height_m.is_nan() {
            continue;
        }
        let from = DVec3::new(grid.x_m(column), height_m + 0.05, grid.z_m(row));
        let lit = area.segment(from, from + to_sun * 80_000.0).is_none();
        let seen = sun_seen(&world.field, column, row, to_sun, highest_m) >= 0.5;
        all += 1;
        agree += u32::from(lit == seen);
        dark += u32::from(!lit);
    }
    println!("{agree} of {all} agree, {dark} in shadow");
    assert!(dark > 500, "{dark}");
    assert!(f64::from(agree) >= 0.99 * f64::from(all), "{agree} of {all}");
}
