//! The plants of a real world: the same on every machine and in every order, and on the ground everywhere.
//!
//! The ground is the embedded world's around 42.49 N, 78.66 E; its cover is made here by height, so that only a change of what this
//! crate does moves a tree.

use std::sync::Arc;
use terrain::Geodetic;
use terrain::bake::default_world;
use terrain::block::Landscape;
use terrain::block::ground_map::Climate;
use terrain::features::cover::{Cover, CoverClass};
use terrain::near::TileIndex;
use terrain::store::World;
use vegetation::canopy;
use vegetation::place::{Nursery, TIERS, Tier, corner_m};

fn nursery() -> (Nursery, World) {
    let world = default_world(&mut |_, _| ()).expect("the embedded world").world;
    let grid = *world.field.grid();
    let (columns, rows) = (grid.columns() - 1, grid.rows() - 1);
    let cells = (0..columns as usize * rows as usize).map(|at| {
        let (column, row) = (at % columns as usize, at / columns as usize);
        (match world.field.post_m(column as i64, row as i64) {
            h if h < 1_700.0 => CoverClass::Field,
            h if h < 2_000.0 => CoverClass::Broadleaf,
            h if h < 2_800.0 => CoverClass::Conifer,
            h if h < 3_100.0 => CoverClass::Scrub,
            _ => CoverClass::Rock,
        }) as u8
    });
    let cover = Cover::new(&grid, 1, cells.collect()).expect("a cell a post");
    let climate = Climate { snow_line_m: 3_900.0, dryness: 1.0, cold_side: 1.0, ..Climate::new(0.74, 2_400.0) };
    let mut landscape = Landscape::bare(world.field.clone(), [13.9, 27.8, 55.6], climate);
    landscape.cover = Arc::new(cover);
    (Nursery::new(Arc::new(landscape), 42.4_f64.to_radians()), world)
}

/// Tiles within a plan distance of the place, north-western first.
fn near(nursery: &Nursery, world: &World, side_m: f64, reach_m: f64) -> Vec<TileIndex> {
    let at = world.projection.to_world(Geodetic::from_degrees(42.49, 78.66));
    let first = corner_m(nursery.area().grid(), side_m, TileIndex { x: 0, z: 0 });
    let number = |at_m: f64| (at_m / side_m).floor() as i32;
    let (west, north) = (at.x - first.x - reach_m, at.y - first.y - reach_m);
    let rows = number(north)..=number(north + 2.0 * reach_m);
    let columns = number(west)..=number(west + 2.0 * reach_m);
    rows.flat_map(|z| columns.clone().map(move |x| TileIndex { x, z })).collect()
}

fn hash(nursery: &Nursery, tier: &Tier, tiles: impl Iterator<Item = TileIndex>) -> u64 {
    // A sum, so that the order of tiles does not show.
    tiles.fold(0, |sum: u64, tile| {
        let place = (tile.x as u64) << 32 ^ tile.z as u64;
        let own = nursery.plants(tier, tile, 1.0).plants.iter().fold(0xcbf2_9ce4_8422_2325 ^ place, |hash, plant| {
            let places =
                u64::from(plant.at[0]) | u64::from(plant.at[1]) << 16 | u64::from(plant.height_m.to_bits()) << 32;
            let looks = u32::from_le_bytes([plant.species, plant.size, plant.turn, plant.tint]);
            let word = |hash: u64, word: u64| (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
            word(word(hash, places), looks.into())
        });
        sum.wrapping_add(own)
    })
}

#[test]
fn the_population_is_frozen_in_any_order() {
    let (nursery, world) = nursery();
    let found = TIERS.each_ref().map(|tier| {
        let tiles = near(&nursery, &world, tier.side_m, 0.9 * tier.side_m);
        let forwards = hash(&nursery, tier, tiles.iter().copied());
        assert_eq!(forwards, hash(&nursery, tier, tiles.iter().rev().copied()), "tier {}", tier.number);
        forwards
    });
    assert_eq!(found, FROZEN, "{found:#018x?}");
}

/// Found once; a change moves every tree of every world. The first was found again when plants of dry open ground were
/// thinned and those at the water's edge taken away: no plant moved, some are gone.
const FROZEN: [u64; 3] = [0x46a7_5a9d_aca6_e3ce, 0x8654_511c_5d48_394c, 0xda80_b0c4_51e1_03a2];

#[test]
fn every_plant_of_the_near_blocks_stands_on_the_ground() {
    let (nursery, world) = nursery();
    let mut count = 0;
    for tier in &TIERS {
        for tile in near(&nursery, &world, tier.side_m, tier.reach_m.min(13_000.0)) {
            let corner = corner_m(nursery.area().grid(), tier.side_m, tile);
            let planted = nursery.plants(tier, tile, 1.0);
            assert!(planted.plants.len() <= 10_000);
            for plant in &planted.plants {
                let at = plant.plan_m(tier, corner);
                let ground_m = nursery.area().height_m(at.x, at.y).expect("ground under a plant");
                // Half a unit in the last place of an f32 below 8,192 m.
                assert!((f64::from(plant.height_m) - ground_m).abs() <= 0.000_25, "{plant:?}");
                count += 1;
            }
        }
    }
    println!("{count} plants");
    assert!(count > 150_000, "{count}");
}

#[test]
fn neighbouring_canopies_agree_and_stand_above_the_ground() {
    let (nursery, world) = nursery();
    let side_m = canopy::side_m(nursery.area().grid());
    let tile = near(&nursery, &world, side_m, 10.0)[0];
    let [here, east] = [tile, TileIndex { x: tile.x + 1, z: tile.z }].map(|tile| canopy::canopy(&nursery, tile));
    let mut shared = 0;
    for corner in here.corners.iter().filter(|corner| u32::from(corner.at[0]) == canopy::CELLS) {
        if let Some(other) = east.corners.iter().find(|other| other.at == [0, corner.at[1]]) {
            assert_eq!((corner.ground_m, corner.high_m, corner.looks), (other.ground_m, other.high_m, other.looks));
            shared += 1;
        }
    }
    assert!(shared > 5, "{shared}");
    assert!(here.corners.iter().all(|corner| (0.0..=20.0).contains(&corner.high_m)));
    assert!(here.indices.iter().all(|index| usize::from(*index) < here.corners.len()));
    // No more stems than a tile of closed forest has.
    assert!(here.stands_for > 0.0 && here.stands_for <= side_m * side_m * 1e-4 * canopy::STEMS_PER_HA);
}
