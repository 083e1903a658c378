//! The cover as the bake makes it, against points in polygons one by one and whatever the number of threads.

use super::*;
use crate::features::lakes::{Lake, inside};
use crate::features::model::{BuildingClass, Origin};
use crate::synthetic;

fn world(blocks: u32) -> (Field, Climate) {
    let field = synthetic::ridges(Grid::centred(200.0, blocks, blocks).unwrap(), 4);
    (field, Climate::new(0.74, 1_500.0))
}

/// A star of `points` spikes with a hole: no edge is along an axis.
fn star(middle: DVec2, radius_m: f64, points: usize) -> Vec<Vec<DVec2>> {
    let ring = |scale: f64| {
        (0..2 * points)
            .map(|i| {
                let angle = 0.37 + i as f64 * std::f64::consts::PI / points as f64;
                middle + DVec2::from_angle(angle) * radius_m * scale * if i % 2 == 0 { 1.0 } else { 0.45 }
            })
            .collect()
    };
    vec![ring(1.0), ring(0.3)]
}

#[test]
fn rings_cover_the_cells_whose_centres_they_hold() {
    let (field, climate) = world(3);
    let areas: Vec<LandArea> = [(0.0, 0.0, 7_000.0), (-8_000.0, 5_000.0, 3_000.0), (2_000.0, -9_500.0, 4_000.0)]
        .into_iter()
        .zip([CoverClass::Conifer, CoverClass::Field, CoverClass::Scrub])
        .map(|((x, z, radius_m), cover)| LandArea { cover, rings: star(DVec2::new(x, z), radius_m, 7) })
        .collect();
    let lake = Lake { name: String::new(), level_m: 0.0, rings: star(DVec2::new(3_000.0, 4_000.0), 2_500.0, 5) };
    let (lakes, features) = (Lakes::new(vec![lake]), Features { areas, ..Features::default() });
    let cover = bake_cover(&field, &lakes, &features, &climate);
    let bare = bake_cover(&field, &Lakes::default(), &Features::default(), &climate);
    let raster = Raster::new(field.grid(), cells_per_step(field.grid()));
    let mut from_features = 0;
    for row in 0..raster.rows {
        for column in 0..raster.columns {
            let at = raster.centre(column, row);
            // From the smallest to the largest: the first that holds the centre lies on top.
            let mut held = features.areas.iter().rev().collect::<Vec<_>>();
            held.sort_by(|a, b| {
                let size = |area: &LandArea| {
                    let (low, high) = bounds_m(&area.rings);
                    (high - low).element_product()
                };
                size(a).total_cmp(&size(b))
            });
            let wet = inside(edges(&lakes.lakes()[0].rings), at);
            let area = held.into_iter().find(|area| inside(edges(&area.rings), at)).map(|area| area.cover);
            let expected = if wet { Some(CoverClass::Water) } else { area };
            let cell = cover.cell(column as i64, row as i64);
            match expected {
                Some(class) => assert_eq!(cell, class as u8 | FROM_FEATURES, "{at}"),
                // Beside water the rules know it: sand and wetter ground.
                None => assert!(cell == bare.cell(column as i64, row as i64) || lakes.signed_distance_m(at) < 5_300.0),
            }
            from_features += u64::from(expected.is_some());
        }
    }
    assert!(from_features > 1_000);
    let known = cover.cells().len() as f64;
    assert_eq!(described(&cover).unwrap().from_features, from_features as f64 / known);
    let sum: f64 = described(&cover).unwrap().shares.values().sum();
    // A share is within half a last digit, and there are at most 12.
    assert!((sum - 1.0).abs() < 12.0 * f64::EPSILON);
}

#[test]
fn corners_in_the_middle_of_a_row_lose_no_row() {
    // -7,000 m and -6,187.5 m are middles of rows of cells of 41.67 m, but for rounding.
    let field = synthetic::ridges(Grid::centred(125.0, 4, 4).unwrap(), 4);
    let ring =
        [(-1_000.0, -7_000.0), (1_000.0, -7_000.0), (1_500.0, -6_187.5), (1_000.0, -5_000.0), (-1_000.0, -5_000.0)];
    let rings = vec![ring.map(|(x, z)| DVec2::new(x, z)).to_vec()];
    let lake = Lake { name: String::new(), level_m: 0.0, rings: rings.clone() };
    let cover = bake_cover(&field, &Lakes::new(vec![lake]), &Features::default(), &Climate::new(0.74, 1_500.0));
    let raster = Raster::new(field.grid(), cells_per_step(field.grid()));
    let (mut wet, mut held) = (0, 0);
    for row in 0..raster.rows {
        for column in 0..raster.columns {
            let expected = inside(edges(&rings), raster.centre(column, row));
            let cell = cover.cell(column as i64, row as i64);
            // On an edge that runs along cells' middles, which side a middle is on is a matter of rounding.
            let at = raster.centre(column, row);
            let clear = edges(&rings).all(|(a, b)| {
                let t = ((at - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                at.distance(a.lerp(b, t)) > 1e-6
            });
            let is_wet = cell == CoverClass::Water as u8 | FROM_FEATURES;
            assert!(is_wet == expected || !clear, "{at}");
            (wet, held) = (wet + u32::from(is_wet), held + u32::from(expected));
        }
    }
    assert!(held > 2_000 && wet.abs_diff(held) < 100, "{wet} of {held}");
}

#[test]
fn threads_change_nothing() {
    let (field, climate) = world(5);
    let areas = vec![LandArea { cover: CoverClass::Broadleaf, rings: star(DVec2::new(900.0, -400.0), 11_000.0, 9) }];
    let features = Features { areas, ..Features::default() };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bake_cover(&field, &Lakes::default(), &features, &climate))
    };
    assert!(with(1) == with(5));
}

#[test]
fn close_houses_are_built_up_and_a_lone_one_is_not() {
    let (field, climate) = world(1);
    let house = |x: f64, z: f64| Building {
        class: BuildingClass::House,
        outline: [(0.0, 0.0), (12.0, 0.0), (12.0, 10.0), (0.0, 10.0)].map(|(u, v)| DVec2::new(x + u, z + v)).to_vec(),
        height_m: 6.0,
        height_from: Origin::Assumed,
    };
    // A house every 35 m: 10 % under roofs.
    let mut buildings: Vec<Building> =
        (0..400).map(|i| house(-1_000.0 + 35.0 * f64::from(i % 20), 35.0 * f64::from(i / 20))).collect();
    buildings.push(house(1_500.0, -1_500.0));
    buildings.push(house(1e9, -1_500.0));
    let features = Features { buildings, ..Features::default() };
    let cover = bake_cover(&field, &Lakes::default(), &features, &climate);
    assert_eq!(cover.class_at(-700.0, 350.0), CoverClass::BuiltUp);
    assert_ne!(cover.class_at(1_500.0, -1_500.0), CoverClass::BuiltUp);
    assert_ne!(cover.class_at(-100.0, 350.0), CoverClass::BuiltUp);
}

#[test]
fn an_airfield_is_paved_within_mown_grass() {
    let (field, climate) = world(1);
    let ends = [DVec2::new(-1_200.0, 10.0), DVec2::new(1_300.0, 410.0)];
    let runway = Runway {
        ends,
        width_m: 60.0,
        designators: ["08".into(), "26".into()],
        surface: RunwaySurface::Concrete,
        lit: true,
        from: Origin::Stated,
    };
    let airfield = Airfield {
        code: "X".into(),
        name: String::new(),
        reference: DVec2::ZERO,
        level_m: 0.0,
        runways: vec![runway],
        taxiways: Vec::new(),
        aprons: vec![vec![DVec2::new(0.0, -600.0), DVec2::new(400.0, -600.0), DVec2::new(400.0, -300.0)]],
    };
    let features = Features { airfields: vec![airfield], ..Features::default() };
    let cover = bake_cover(&field, &Lakes::default(), &features, &climate);
    let across = (ends[1] - ends[0]).normalize().perp();
    let mut paved = 0;
    for i in 0..=200 {
        let on = ends[0].lerp(ends[1], f64::from(i) / 200.0);
        paved += i32::from(cover.class_at(on.x, on.y) == CoverClass::Paved);
        // A cell's centre is at most 71 % of its 50 m away, so 100 m off is grass.
        for side in [-1.0, 1.0] {
            let off = on + across * side * 100.0;
            assert_eq!(cover.class_at(off.x, off.y), CoverClass::Grass, "{off}");
        }
    }
    // A runway of 60 m holds the centres of cells of 50 m nearly everywhere.
    assert!(paved > 180, "{paved}");
    assert_eq!(cover.class_at(320.0, -520.0), CoverClass::Paved);
}

#[test]
fn hostile_features_neither_panic_nor_paint_all() {
    let (field, climate) = world(1);
    let far = |v: f64| DVec2::new(v, -v);
    let ring = vec![far(1e300), far(-1e300), DVec2::new(1e300, 1e300)];
    let area = LandArea { cover: CoverClass::Snow, rings: vec![ring, vec![], vec![DVec2::ZERO; 3]] };
    let features = Features { areas: vec![area], ..Features::default() };
    assert_eq!(bake_cover(&field, &Lakes::default(), &features, &climate).cells().len(), (4 * CELLS as usize).pow(2));
}

#[test]
fn cells_are_fine_in_small_worlds_and_few_in_large_ones() {
    let cells = |step_m, blocks| {
        let grid = Grid::centred(step_m, blocks, blocks).unwrap();
        let per_step = cells_per_step(&grid);
        (grid.step_m / f64::from(per_step), u64::from((grid.columns() - 1) * per_step).pow(2))
    };
    assert_eq!(cells(200.0, 4), (50.0, u64::from(4 * 4 * CELLS).pow(2)));
    assert_eq!(cells(25.0, 4).0, 25.0);
    let (cell_m, number) = cells(200.0, 67);
    assert!(cell_m == 100.0 && number <= MAX_CELLS, "{number}");
}
