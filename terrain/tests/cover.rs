//! The cover of the default world, by rule: plausible shares, every class inside its belt.

use terrain::bake::{bake, default_request};
use terrain::features::cover::{CLASSES, CoverClass, FROM_FEATURES};
use terrain::store::World;

#[test]
fn the_default_world_is_covered_as_the_tian_shan_is() {
    let world = bake(&default_request(), &mut |_, _| ()).unwrap();
    let cover = &world.cover;
    let started = std::time::Instant::now();
    let climate = terrain::block::ground_map::Climate::of(world.projection.centre(), world.info.statistics.mean_m);
    let again = terrain::features::cover_bake::bake_cover(&world.field, &world.lakes, &world.features, &climate);
    println!("cover of {:?} cells in {:.2} s", cover.size(), started.elapsed().as_secs_f64());
    assert!(again == **cover);
    let info = world.info.cover.as_ref().unwrap();
    println!("{info:#?}");
    assert_eq!(info.cell_m, 100.0);
    let share = |class: CoverClass| info.shares.get(&format!("{class:?}")).copied().unwrap_or(0.0);
    let known = (world.field.grid().posts() - world.info.voids.beyond_posts) as f64;
    // A post and a cell each stand for their square; along a shore of some 700 km they differ by less than a tenth of it.
    let posts = world.info.lakes.iter().map(|lake| lake.posts).sum::<usize>() as f64 / known;
    let bound = 0.1 * 700_000.0 * 200.0 / (402_000.0 * 402_000.0);
    assert!((share(CoverClass::Water) - posts).abs() < bound, "{} and {posts}", share(CoverClass::Water));
    // Forests are some 5 % of the land of Kyrgyzstan and the ranges here are its most wooded.
    assert!((0.02..0.12).contains(&share(CoverClass::Conifer)), "{}", share(CoverClass::Conifer));
    assert!((0.02..0.15).contains(&share(CoverClass::Snow)), "{}", share(CoverClass::Snow));
    assert_eq!(share(CoverClass::Broadleaf) + share(CoverClass::MixedForest), 0.0);

    let [columns, rows] = cover.size();
    let mut lowest = [f64::INFINITY; CLASSES.len()];
    let mut highest = [f64::NEG_INFINITY; CLASSES.len()];
    let (mut north_facing, mut woods) = (0_u32, 0_u32);
    let area = terrain::Ground::new(world.field.clone()).whole();
    for row in (0..i64::from(rows)).step_by(7) {
        for column in (0..i64::from(columns)).step_by(7) {
            let class = CoverClass::of(cover.cell(column, row));
            let grid = world.field.grid();
            let x_m = grid.west_m + (column as f64 + 0.5) * cover.cell_m();
            let z_m = grid.north_m + (row as f64 + 0.5) * cover.cell_m();
            let Some(height_m) = area.height_m(x_m, z_m) else { continue };
            lowest[class as usize] = lowest[class as usize].min(height_m);
            highest[class as usize] = highest[class as usize].max(height_m);
            if class == CoverClass::Conifer {
                woods += 1;
                let north_m = area.height_m(x_m, z_m - 200.0).unwrap_or(height_m);
                let south_m = area.height_m(x_m, z_m + 200.0).unwrap_or(height_m);
                north_facing += u32::from(north_m < south_m);
            }
        }
    }
    // The snow line is near 3,840 m; noise, hollows and aspect move belts by some 12 % of it.
    let within = |class: CoverClass, low_m: f64, high_m: f64| {
        let (lowest_m, highest_m) = (lowest[class as usize], highest[class as usize]);
        println!("{class:?} {lowest_m:.0} to {highest_m:.0} m");
        assert!(lowest_m > low_m && highest_m < high_m, "{class:?} stands from {lowest_m} to {highest_m} m");
    };
    within(CoverClass::Conifer, 1_400.0, 3_150.0);
    within(CoverClass::Snow, 3_000.0, 7_500.0);
    within(CoverClass::Field, 300.0, 2_300.0);
    assert!(f64::from(north_facing) > 0.75 * f64::from(woods), "{north_facing} of {woods}");
    let lake = world.projection.to_world(terrain::Geodetic::from_degrees(42.4, 77.2));
    assert_eq!(cover.class_at(lake.x, lake.y), CoverClass::Water);
    let marked = |cell: &&u8| **cell & FROM_FEATURES != 0;
    assert!(cover.cells().iter().filter(marked).all(|cell| CoverClass::of(*cell) == CoverClass::Water));
}

#[test]
fn a_world_keeps_its_cover() {
    let mut request = default_request();
    request.size_km = Some([24.0, 24.0]);
    let world = bake(&request, &mut |_, _| ()).unwrap();
    let folder = std::env::temp_dir().join(format!("poligon-cover-{}.world", std::process::id()));
    world.write(&folder).unwrap();
    let read = World::read(&folder).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(read.cover == world.cover && read.info.cover == world.info.cover);
    assert_eq!(read.cover.cell_m(), 50.0);
}
