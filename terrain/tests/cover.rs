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
    // Lakes, and the airfields' surfaces with the grass beside them.
    let stated = [CoverClass::Water, CoverClass::Paved, CoverClass::Grass];
    assert!(cover.cells().iter().filter(marked).all(|cell| stated.contains(&CoverClass::of(*cell))));
    let paved = cover.cells().iter().filter(marked).filter(|cell| CoverClass::of(**cell) == CoverClass::Paved).count();
    assert!(paved > 0, "there are airfields");
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

/// Bakes the middle of the default world with a photograph and without features, so that the ground is all by rule.
fn with_imagery(pictures: &[std::path::PathBuf]) -> World {
    let mut request = default_request();
    request.size_km = Some([60.0, 60.0]);
    request.features.clear();
    request.imagery = pictures.to_vec();
    bake(&request, &mut |_, _| ()).unwrap()
}

/// Texels of all ground maps as if there were no water: place, and square roots of the albedo, 0..=255.
fn texels(world: &World) -> Vec<([f64; 2], [u8; 3])> {
    let grid = world.field.grid();
    let climate = terrain::block::ground_map::Climate::of(world.projection.centre(), world.info.statistics.mean_m);
    let mut all = Vec::new();
    for block in grid.blocks() {
        let dress =
            terrain::block::ground_map::Dress { cover: &world.cover, strips: &[], imagery: world.imagery.as_deref() };
        let map = terrain::block::ground_map::ground_map(
            &world.field,
            block,
            &climate,
            &dress,
            &|_, _| f64::INFINITY,
            &|_, _| false,
        );
        for (at, texel) in map[..terrain::block::ground_map::MAP_BYTES].chunks_exact(4).enumerate() {
            let part = |i: usize| i as f64 * grid.block_m() / 63.0;
            let place = [grid.x_m(block.first_column()) + part(at % 64), grid.z_m(block.first_row()) + part(at / 64)];
            all.push((place, [texel[0], texel[1], texel[2]]));
        }
    }
    all
}

#[test]
fn a_coarse_photograph_tints_and_keeps_the_detail() {
    let picture = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/data/terrain/committable/imagery/bluemarble_240s_kyrgyzstan.png");
    if !picture.is_file() {
        println!("skipped: {} is not there", picture.display());
        return;
    }
    let (plain, tinted) = (with_imagery(&[]), with_imagery(&[picture]));
    assert!(plain.imagery.is_none() && tinted.imagery.is_some());
    assert!((4_000.0..9_000.0).contains(&tinted.info.imagery[0].pixel_m[0]));
    let imagery = tinted.imagery.as_ref().unwrap();
    let mut far = 0;
    for ((place, by_rule), (_, shown)) in texels(&plain).into_iter().zip(texels(&tinted)) {
        let factors = imagery.factors(tinted.field.grid(), place[0], place[1]);
        for channel in 0..3 {
            let root = f64::from(factors[channel]).sqrt();
            let (rule, shown) = (f64::from(by_rule[channel]), f64::from(shown[channel]));
            // Both are whole numbers: half of one after, half of one before times the factor; and f32.
            let rounding = 0.5 + 0.5 * root + 1e-3;
            assert!((shown - (rule * root).min(255.0)).abs() <= rounding, "{place:?}: {rule} x {root} is {shown}");
            far += u32::from((shown - rule).abs() > 10.0);
        }
    }
    println!("{far} colours of texels are more than 10 of 255 from the rule's");
    assert!(far > 1_000);
    let folder = std::env::temp_dir().join(format!("poligon-imagery-{}.world", std::process::id()));
    tinted.write(&folder).unwrap();
    let read = World::read(&folder).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(read.imagery == tinted.imagery);
}

#[test]
fn a_fine_photograph_replaces() {
    let folder =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain/tests/dem/craterlake");
    let elevation = folder.join("craterlake-elev-16bit-30m.tif");
    if !elevation.is_file() {
        println!("skipped: {} is not there", elevation.display());
        return;
    }
    let request = terrain::bake::BakeRequest {
        name: "Crater Lake".into(),
        sources: vec![(terrain::bake::Input::File(elevation), 1.0)],
        features: Vec::new(),
        imagery: vec![folder.join("craterlake-imagery-30m.tif")],
        step_m: 50.0,
        centre: None,
        size_km: None,
    };
    let world = bake(&request, &mut |_, _| ()).unwrap();
    println!("{:#?}", world.info.imagery);
    let imagery = world.imagery.as_ref().unwrap();
    let grid = world.field.grid();
    let photo = terrain::bake::photo::open(&request.imagery[0]).unwrap();
    let inverse = photo.place.inverse();
    let (mut seen, mut number, mut difference) = (0_u32, 0_u32, 0.0);
    for block in grid.blocks() {
        let Some(texels) = imagery.texels(grid, block) else { continue };
        for (at, texel) in texels.chunks_exact(4).enumerate().filter(|(_, texel)| texel[3] == 255) {
            let part = |i: usize| i as f64 * grid.block_m() / 63.0;
            let x_m = grid.x_m(block.first_column()) + part(at % 64);
            let z_m = grid.z_m(block.first_row()) + part(at / 64);
            let pixel = photo.place.pixel(&inverse, world.projection.to_geodetic((x_m, z_m).into()));
            let (column, row) = (pixel.x as usize, pixel.y as usize);
            let green = f64::from(photo.pixels[row * photo.place.columns + column][1]) / 255.0;
            // The square root of linear light is close to the sRGB code itself.
            difference += (f64::from(texel[1]) / 255.0 - green).abs();
            number += 1;
            seen += u32::from(column < photo.place.columns);
        }
    }
    assert_eq!(seen, number, "texels shown lie in the picture");
    println!("{seen} texels, mean difference {:.4}", difference / f64::from(number));
    assert!(number > 20_000);
    // Codes and roots differ by at most 0.04; texels mean over pixels of a picture with edges.
    assert!(difference / f64::from(number) < 0.06);
}

#[test]
fn what_is_no_photograph_is_said() {
    use terrain::bake::photo::read;
    let said = |bytes: &[u8], world_file: Option<&str>| read(bytes, world_file).unwrap_err().to_string();
    assert!(said(b"hello", None).contains("expected GeoTIFF of red, green, blue"));
    assert!(said(b"\x89PNG\r\n\x1a\n", None).contains("a world file"));
    assert!(said(&[0xff, 0xd8, 0xff, 0xe0], Some("1 0 0 -1 10 50")).contains("undamaged JPEG"));
    assert!(said(b"II*\0\x08\0\0\0", None).contains("TIFF"));
}
