//! Plants: the same in any order, nested by share, on the ground, never in a clearing.

use super::*;
use terrain::block::ground_map::Climate;
use terrain::features::cover::{CoverClass, FROM_FEATURES};
use terrain::features::lakes::{Lake, Lakes};
use terrain::features::model::{Building, BuildingClass, Features, Origin, Road, RoadClass};
use terrain::{Grid, synthetic};

/// Ridges of 12 x 12 km, forest below 2,600 m, scrub to 3,200 m, a pond, a road and houses along it.
pub fn nursery() -> Nursery {
    let grid = Grid::centred(200.0, 2, 2).unwrap();
    let field = Arc::new(synthetic::ridges(grid, 3));
    let per_step = 2;
    let (columns, rows) = ((grid.columns() - 1) * per_step, (grid.rows() - 1) * per_step);
    let cells = (0..columns * rows).map(|at| {
        let (column, row) = (at % columns, at / columns);
        let height_m = field.post_m(i64::from(column / per_step), i64::from(row / per_step));
        let class = match height_m {
            h if h < 600.0 => CoverClass::Grass,
            h if h < 2_000.0 => CoverClass::Broadleaf,
            h if h < 2_600.0 => CoverClass::Conifer,
            h if h < 3_200.0 => CoverClass::Scrub,
            _ => CoverClass::Rock,
        };
        class as u8 | if column % 2 == 0 { FROM_FEATURES } else { 0 }
    });
    let cover = Cover::new(&grid, per_step, cells.collect()).unwrap();
    let mut landscape = Landscape::bare(field, [13.9, 27.8, 55.6], Climate::new(0.74, 1_500.0));
    landscape.cover = Arc::new(cover);
    let pond = [(-900.0, 300.0), (-400.0, 500.0), (-500.0, 1_100.0)].map(|(x, z)| DVec2::new(x, z));
    landscape.lakes = Arc::new(Lakes::new(vec![Lake { name: "pond".into(), level_m: 0.0, rings: vec![pond.into()] }]));
    let line: Vec<DVec2> =
        (0..12).map(|i| DVec2::new(f64::from(i) * 1_000.0 - 5_500.0, f64::from(i * i % 7) * 700.0 - 2_000.0)).collect();
    let house = |at: &DVec2| Building {
        class: BuildingClass::House,
        outline: [(0.0, 0.0), (0.0, 90.0), (70.0, 90.0), (70.0, 0.0)].map(|(x, z)| *at + DVec2::new(x, z)).into(),
        height_m: 8.0,
        height_from: Origin::Assumed,
    };
    let buildings = line.iter().map(house).collect();
    let road = Road { class: RoadClass::Primary, width_m: 9.0, paved: true, tunnel: false, bridge: false, line };
    landscape.features = Arc::new(Features { roads: vec![road], buildings, ..Features::default() });
    Nursery::new(Arc::new(landscape), 0.74)
}

pub fn tiles(grid: &Grid, tier: &Tier) -> Vec<TileIndex> {
    let side = ((grid.east_m() - grid.west_m) / tier.side_m).ceil() as i32;
    (0..side * side).map(|at| TileIndex { x: at % side, z: at / side }).collect()
}

#[test]
fn every_plant_stands_on_the_ground_query_to_half_a_bit() {
    let nursery = nursery();
    let grid = *nursery.area().grid();
    let mut count = 0;
    for tier in &TIERS {
        for tile in tiles(&grid, tier) {
            let corner = corner_m(&grid, tier.side_m, tile);
            let planted = nursery.plants(tier, tile, 1.0);
            assert!(planted.plants.len() <= if tier.number == 0 { 8_000 } else { 10_000 });
            assert_eq!(planted.squares.last().unwrap().end as usize, planted.plants.len());
            for plant in &planted.plants {
                let at = plant.plan_m(tier, corner);
                let ground = nursery.area().height_m(at.x, at.y).unwrap();
                // Half a unit in the last place of an f32 below 8,192 m: 0.25 mm.
                assert!((f64::from(plant.height_m) - ground).abs() <= 0.000_25, "{plant:?}");
                count += 1;
            }
        }
    }
    assert!(count > 100_000, "{count}");
}

#[test]
fn the_order_of_tiles_does_not_matter() {
    let grid = *nursery().area().grid();
    let mut forwards = Vec::new();
    let nursery_a = nursery();
    for tier in &TIERS[..2] {
        for tile in tiles(&grid, tier) {
            forwards.push(nursery_a.plants(tier, tile, 1.0).plants);
        }
    }
    let nursery_b = nursery();
    let mut backwards = Vec::new();
    for tier in TIERS[..2].iter().rev() {
        for tile in tiles(&grid, tier).into_iter().rev() {
            backwards.push(nursery_b.plants(tier, tile, 1.0).plants);
        }
    }
    backwards.reverse();
    assert_eq!(forwards, backwards);
}

#[test]
fn fewer_plants_are_some_of_the_more() {
    let nursery = nursery();
    let tile = TileIndex { x: 0, z: 0 };
    let all = nursery.plants(&TIERS[0], tile, 1.0).plants;
    let mut last = all.clone();
    for share in [0.7, 0.4, 0.1, 0.0] {
        let some = nursery.plants(&TIERS[0], tile, share).plants;
        assert!(some.iter().all(|plant| last.contains(plant)), "{share}");
        // A share of independent coins: five deviations of a binomial.
        let expected = f64::from(share) * all.len() as f64;
        assert!(
            (some.len() as f64 - expected).abs() <= 5.0 * (all.len() as f64 * 0.25).sqrt(),
            "{share}: {}",
            some.len()
        );
        last = some;
    }
}

#[test]
fn cells_of_neighbouring_tiles_do_not_repeat() {
    let nursery = nursery();
    let [a, b] = [0, 1].map(|x| nursery.plants(&TIERS[1], TileIndex { x, z: 2 }, 1.0).plants);
    let common = a.iter().filter(|p| b.iter().any(|q| q.at == p.at)).count();
    assert!(common * 20 < a.len() + b.len(), "{common} of {} and {}", a.len(), b.len());
}

#[test]
fn where_nothing_may_grow_there_is_no_nursery_of_plants_and_without_forest_none_of_canopy() {
    let grid = Grid::centred(200.0, 1, 1).unwrap();
    let of = |class: Option<CoverClass>, one: CoverClass| {
        let field = Arc::new(synthetic::ridges(grid, 3));
        let mut landscape = Landscape::bare(field, [13.9, 27.8, 55.6], Climate::new(0.74, 1_500.0));
        if let Some(class) = class {
            let mut cells = vec![class as u8 | FROM_FEATURES; ((grid.columns() - 1) * (grid.rows() - 1)) as usize];
            cells[77] = one as u8;
            landscape.cover = Arc::new(Cover::new(&grid, 1, cells).unwrap());
        }
        let nursery = Nursery::new(Arc::new(landscape), 0.74);
        (nursery.is_bare(), nursery.has_forest())
    };
    use CoverClass as C;
    assert_eq!(of(None, C::Unknown), (true, false));
    for bare in [C::Snow, C::Rock, C::Sand, C::Water, C::Paved, C::Unknown] {
        assert_eq!(of(Some(bare), bare), (true, false), "{bare:?}");
        assert_eq!(of(Some(bare), C::Grass), (false, false), "{bare:?} and a cell of grass");
        assert_eq!(of(Some(bare), C::MixedForest), (false, true), "{bare:?} and a cell of forest");
    }
}
