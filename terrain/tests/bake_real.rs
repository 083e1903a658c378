//! Whole bakes: the real files of `../shared`, small made ones, and worlds written and read.

use glam::DVec2;
use std::path::{Path, PathBuf};
use std::time::Instant;
use terrain::Geodetic;
use terrain::bake::{BakeError, BakeRequest, Input, bake};
use terrain::store::{StoreError, World};

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain").join(file)
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("poligon-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn request(sources: &[&Path], step_m: f64) -> BakeRequest {
    BakeRequest {
        name: "test".into(),
        sources: sources.iter().map(|path| (Input::File((*path).into()), 1.0)).collect(),
        features: Vec::new(),
        imagery: Vec::new(),
        step_m,
        centre: None,
        size_km: None,
    }
}

fn quietly(request: &BakeRequest) -> Result<World, BakeError> {
    bake(request, &mut |_, _| ())
}

/// Bakes real files, or says why not.
fn real(files: &[&str], change: impl FnOnce(&mut BakeRequest)) -> Option<World> {
    let paths: Vec<PathBuf> = files.iter().map(|file| data(file)).collect();
    if let Some(missing) = paths.iter().find(|path| !path.exists()) {
        println!("skipped: {} is not there", missing.display());
        return None;
    }
    let mut request = request(&paths.iter().map(PathBuf::as_path).collect::<Vec<_>>(), 200.0);
    change(&mut request);
    let started = Instant::now();
    let world = quietly(&request).unwrap_or_else(|e| panic!("{files:?}: {e}"));
    let info = &world.info;
    println!(
        "{files:?} {} m: {} x {} blocks, {:.0}..{:.0} m, voids {:?}, {:.2} s",
        info.step_m,
        info.blocks_x,
        info.blocks_z,
        info.statistics.min_m,
        info.statistics.max_m,
        info.voids,
        started.elapsed().as_secs_f64()
    );
    let void = world.field.heights_m().iter().filter(|h| h.is_nan()).count();
    assert_eq!(void, info.voids.beyond_posts);
    Some(world)
}

fn height_at(world: &World, lat_deg: f64, lon_deg: f64) -> f32 {
    let at = world.projection.to_world(Geodetic::from_degrees(lat_deg, lon_deg));
    let grid = world.field.grid();
    let index = |from: f64, to: f64| ((to - from) / grid.step_m).round() as i64;
    world.field.post_m(index(grid.west_m, at.x), index(grid.north_m, at.y))
}

#[test]
fn the_pyrenees_are_one_world_without_a_seam() {
    let pair = ["tests/dem/srtm3_pyrenees/N41E001.hgt.zip", "tests/dem/srtm3_pyrenees/N42E001.hgt.zip"];
    let Some(world) = real(&pair, |r| r.step_m = 100.0) else { return };
    // 83 km at 42 degrees and 222 km, in blocks of 3 km.
    assert_eq!((world.info.blocks_x, world.info.blocks_z), (29, 75));
    // The README of the data: -20..3100 m; means of several samples stay inside.
    assert!(world.info.statistics.min_m > -20.0 && world.info.statistics.max_m < 3100.0);
    assert!(world.info.statistics.max_m > 3000.0);
    assert!(world.info.voids.posts > 100 && world.info.voids.share < 0.01);
    // Along the shared parallel the second difference of heights is what it is elsewhere: no step.
    let bend = |lat_deg: f64| -> f64 {
        let along = (0..700).map(|i| 1.1 + f64::from(i) * 0.001);
        along
            .map(|lon| {
                let at = |row: f64| f64::from(height_at(&world, lat_deg + row * 0.0009, lon));
                (at(-1.0) - 2.0 * at(0.0) + at(1.0)).abs()
            })
            .sum()
    };
    let (seam, beside) = (bend(42.0), 0.5 * (bend(41.98) + bend(42.02)));
    assert!(seam < 2.0 * beside, "{seam} {beside}");
    assert_eq!(world.info.sources.len(), 2);
    assert_eq!(world.info.sources[0].credit, "SRTM, NASA and USGS");
}

#[test]
fn half_a_tile_of_voids_is_filled_and_reported() {
    let Some(world) = real(&["tests/dem/srtm/N48W125.hgt.zip"], |_| ()) else { return };
    let voids = &world.info.voids;
    assert!((voids.share - 0.5).abs() < 0.01, "{voids:?}");
    assert!(voids.largest_posts > voids.posts / 2);
}

#[test]
fn st_helens_by_two_surveys_is_one_mountain() {
    let Some(usgs) = real(&["tests/dem/usgs_sthelens1980_30m.dem.gz"], |r| r.step_m = 25.0) else { return };
    assert!(usgs.info.sources[0].note.contains("+-10 m"));
    let folder = folder("helens");
    let picture = folder.join("helens.png");
    std::fs::copy(data("tests/dem/ned_sthelens_10m_decimetres.png"), &picture).unwrap();
    std::fs::write(folder.join("helens.pgw"), "8.97e-5\n0\n0\n-8.97e-5\n-122.2774\n46.3270\n").unwrap();
    let mut wanted = request(&[], 25.0);
    wanted.sources = vec![Input::parse(&format!("{}@0.1", picture.display()))];
    let ned = quietly(&wanted).unwrap();
    assert_eq!(ned.info.sources[0].height_scale, 0.1);
    // The rim's highest point after 1980 is at 2549 m; on slopes of one the mean over 25 m of a ridge is 6 m lower, and
    // the survey's own samples miss it by as much.
    assert!((2530.0..=2549.0).contains(&ned.info.statistics.max_m), "{}", ned.info.statistics.max_m);
    // The second georeference is a fit good to 60 m; on slopes of one half that is 30 m, and the glacier has moved.
    let mut apart: Vec<f32> = (0..400)
        .map(|i| (46.17 + f64::from(i / 20) * 0.003, -122.23 + f64::from(i % 20) * 0.004))
        .map(|(lat, lon)| (height_at(&usgs, lat, lon) - height_at(&ned, lat, lon)).abs())
        .filter(|apart| apart.is_finite())
        .collect();
    apart.sort_by(f32::total_cmp);
    assert!(apart.len() > 300 && apart[apart.len() / 2] < 30.0, "{} {:?}", apart.len(), apart.get(apart.len() / 2));
    // Both together: the finer one first.
    wanted.sources.insert(0, (Input::File(data("tests/dem/usgs_sthelens1980_30m.dem.gz")), 1.0));
    let both = quietly(&wanted).unwrap();
    assert_eq!(both.info.sources[0].format, "PNG");
    assert_eq!(height_at(&both, 46.2, -122.19), height_at(&both, 46.2, -122.19));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn mountains_on_survey_grids_have_their_heights() {
    // Highest samples of the files by gdalinfo -stats are below the summits; a post never exceeds them.
    if let Some(world) = real(&["tests/dem/windninja/hi.tif"], |r| r.step_m = 100.0) {
        assert!((4100.0..=4205.0).contains(&world.info.statistics.max_m), "{:?}", world.info.statistics);
    }
    if let Some(world) = real(&["tests/dem/windninja/denali.tif"], |_| ()) {
        assert!((6000.0..=6190.0).contains(&world.info.statistics.max_m), "{:?}", world.info.statistics);
    }
    for file in ["big_butte", "mackay", "missoula_valley", "example_lcp"] {
        real(&[&format!("tests/dem/windninja/{file}.tif")], |r| r.step_m = 50.0);
    }
    real(&["tests/dem/srtm1_bigtujunga_30m_utm11.tif"], |r| r.step_m = 50.0);
    if let Some(world) = real(&["tests/dem/craterlake/craterlake-elev-16bit-30m.tif"], |r| r.step_m = 25.0) {
        assert!(world.info.statistics.min_m > 1000.0 && world.info.voids.share > 0.2);
    }
}

#[test]
fn windows_of_the_large_grid_bake_at_both_steps() {
    let large = ["tests/dem/gebco2023_15s_kyrgyzstan_pamir_tianshan.tif"];
    real(&large, |_| ());
    if let Some(world) = real(&large, |r| {
        r.step_m = 100.0;
        r.centre = Some(Geodetic::from_degrees(38.0, 71.8));
        r.size_km = Some([120.0, 50.0]);
    }) {
        assert_eq!((world.info.blocks_x, world.info.blocks_z), (40, 17));
        assert_eq!(world.info.voids.beyond_posts, 0);
    }
    let away = real(&large, |r| r.size_km = Some([30.0, 30.0]));
    drop(away);
    let path = data(large[0]);
    if path.exists() {
        let mut wanted = request(&[&path], 200.0);
        wanted.centre = Some(Geodetic::from_degrees(-30.0, 10.0));
        let error = quietly(&BakeRequest { size_km: Some([50.0, 50.0]), ..wanted }).unwrap_err();
        assert!(matches!(error, BakeError::NoOverlap { .. }), "{error}");
    }
}

/// A PNG of `columns` x `rows` pixels of 0.001 degrees about a place.
fn made(
    folder: &Path,
    name: &str,
    columns: u32,
    rows: u32,
    place: (f64, f64),
    height: impl Fn(u32, u32) -> u16,
) -> PathBuf {
    let path = folder.join(format!("{name}.png"));
    image::ImageBuffer::<image::Luma<u16>, _>::from_fn(columns, rows, |x, y| image::Luma([height(x, y)]))
        .save(&path)
        .unwrap();
    let west = place.1 - 0.0005 * f64::from(columns - 1);
    let north = place.0 + 0.0005 * f64::from(rows - 1);
    std::fs::write(path.with_extension("wld"), format!("0.001\n0\n0\n-0.001\n{west}\n{north}\n")).unwrap();
    path
}

#[test]
fn two_by_two_samples_are_a_world_also_on_the_date_line_and_in_the_south() {
    let folder = folder("small");
    for (name, place) in [("a", (42.0, 78.0)), ("b", (-16.5, 180.0)), ("c", (-16.5, -179.9999)), ("d", (0.0, 0.0))] {
        let path = made(&folder, name, 2, 2, place, |x, y| (100 * y + 10 * x) as u16);
        let world = quietly(&request(&[&path], 25.0)).unwrap();
        assert_eq!((world.info.blocks_x, world.info.blocks_z), (1, 1));
        // The middle of four samples.
        assert!((world.field.post_m(15, 15) - 55.0).abs() < 1e-3, "{name} {}", world.field.post_m(15, 15));
        assert_eq!(world.info.voids.posts, 0);
        assert!(world.info.voids.beyond_posts > 800);
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_finer_source_covers_a_coarser_one_and_its_voids_do_not() {
    let folder = folder("layers");
    let tile: Vec<u8> =
        (0..1201 * 1201).flat_map(|i| if i % 1201 < 600 { [0x80, 0] } else { 500_i16.to_be_bytes() }).collect();
    let fine = folder.join("N42E078.hgt");
    std::fs::write(&fine, tile).unwrap();
    let coarse = made(&folder, "coarse", 1200, 1200, (42.5, 78.5), |_, _| 100);
    let mut wanted = request(&[&coarse, &fine], 200.0);
    wanted.size_km = Some([40.0, 40.0]);
    let world = quietly(&wanted).unwrap();
    assert_eq!(world.info.sources[0].format, "SRTM .hgt");
    assert_eq!((height_at(&world, 42.5, 78.4), height_at(&world, 42.5, 78.6)), (100.0, 500.0));
    assert_eq!(world.info.voids.posts, 0);
    // Alone, the fine one's void is filled from its rim.
    let world = quietly(&BakeRequest { sources: vec![wanted.sources[1].clone()], ..wanted }).unwrap();
    assert!((height_at(&world, 42.5, 78.4) - 500.0).abs() < 0.5);
    assert!((world.info.voids.share - 0.5).abs() < 0.02, "{:?}", world.info.voids);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn wrong_requests_are_told_what_is_wrong() {
    let folder = folder("wrong");
    let path = made(&folder, "a", 4, 4, (42.0, 78.0), |_, _| 7);
    let said = |change: &dyn Fn(&mut BakeRequest)| {
        let mut wanted = request(&[&path], 100.0);
        change(&mut wanted);
        quietly(&wanted).unwrap_err().to_string()
    };
    for bad in [0.0, 24.9, 401.0, f64::NAN, f64::INFINITY, -100.0] {
        assert!(said(&|r| r.step_m = bad).contains("25..=400"), "{bad}");
        assert!(said(&|r| r.sources[0].1 = if bad == 0.0 { 0.0 } else { f64::NAN }).contains("height scale"));
    }
    for bad in [[0.0, 10.0], [10.0, f64::NAN], [1e9, 10.0], [-1.0, 1.0]] {
        assert!(said(&|r| r.size_km = Some(bad)).contains("at most 1000 km"), "{bad:?}");
    }
    assert!(
        said(&|r| {
            r.size_km = Some([900.0, 900.0]);
            r.step_m = 25.0;
        })
        .contains("larger step")
    );
    assert!(said(&|r| r.centre = Some(Geodetic::from_degrees(89.5, 0.0))).contains("centre"));
    assert!(said(&|r| r.sources.clear()).contains("at least one"));
    assert!(said(&|r| r.sources[0].0 = Input::File("no/such.tif".into())).contains("no/such.tif"));
    assert!(said(&|r| r.features.push(Input::File("no/such.json".into()))).contains("no/such.json"));
    let void = folder.join("N42E078.hgt");
    std::fs::write(&void, [0x80, 0].repeat(1201 * 1201)).unwrap();
    assert!(said(&|r| r.sources[0].0 = Input::File(void.clone())).contains("only voids"));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_world_reads_as_it_was_written_and_damage_is_named() {
    let folder = folder("store");
    let source = made(&folder, "a", 50, 40, (42.0, 78.0), |x, y| (x * y) as u16);
    let lakes = folder.join("lakes.geojson");
    std::fs::write(
        &lakes,
        r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"pond"},
        "geometry":{"type":"Polygon","coordinates":[[[77.99,41.99],[78.01,41.99],[78.0,42.01],[77.99,41.99]]]}}]}"#,
    )
    .unwrap();
    let mut wanted = request(&[&source], 50.0);
    wanted.features.push(Input::File(lakes));
    let mut world = quietly(&wanted).unwrap();
    world.masks = vec![1, 2, 3];
    let level_m = world.info.lakes[0].level_m;
    assert_eq!(height_at(&world, 42.0, 78.0), level_m as f32);
    assert_eq!(world.lakes.lake_at(DVec2::ZERO).unwrap().name, "pond");

    let path = folder.join("a.world");
    world.write(&path).unwrap();
    let read = World::read(&path).unwrap();
    let bits = |world: &World| world.field.heights_m().iter().map(|h| h.to_bits()).collect::<Vec<_>>();
    assert!(bits(&read) == bits(&world) && read.field.grid() == world.field.grid());
    assert_eq!((&read.lakes, &read.projection, &read.masks), (&world.lakes, &world.projection, &world.masks));
    // Replaced by another world, and nothing is left beside it.
    world.masks.clear();
    world.write(&path).unwrap();
    assert!(World::read(&path).unwrap().masks.is_empty());
    let beside = std::fs::read_dir(&folder)
        .unwrap()
        .filter(|e| e.as_ref().unwrap().file_name().to_string_lossy().starts_with('.'));
    assert_eq!(beside.count(), 0);

    let said = |path: &Path| World::read(path).unwrap_err().to_string();
    let whole = std::fs::read(path.join("heights.bin")).unwrap();
    let mut damaged = whole.clone();
    damaged[100] ^= 1;
    std::fs::write(path.join("heights.bin"), &damaged).unwrap();
    assert!(said(&path).contains("CRC-32"), "{}", said(&path));
    std::fs::write(path.join("heights.bin"), &whole[4..]).unwrap();
    assert!(said(&path).contains("bytes"), "{}", said(&path));
    std::fs::remove_file(path.join("heights.bin")).unwrap();
    assert!(said(&path).contains("heights.bin"), "{}", said(&path));
    let text = std::fs::read_to_string(path.join("world.toml")).unwrap();
    for (from, to, expected) in [
        ("format_version = 2", "format_version = 99", "version 99"),
        ("format_version = 2", "format = 2", "format_version"),
        ("step_m = 50.0", "step_m = -50.0", "a grid"),
        ("centre_lat_deg = 4", "centre_lat_deg = 9", "a centre"),
        ("blocks_x", "blocks_y", "description"),
        ("name", "[[[", "TOML"),
    ] {
        std::fs::write(path.join("world.toml"), text.replacen(from, to, 1)).unwrap();
        assert!(said(&path).contains(expected), "{to}: {}", said(&path));
    }
    // What is not a world is neither read nor replaced.
    std::fs::remove_file(path.join("world.toml")).unwrap();
    assert!(matches!(World::read(&path), Err(StoreError::NotAWorld { .. })));
    assert!(matches!(world.write(&path), Err(StoreError::NotAWorld { .. })));
    assert!(matches!(world.write(&source), Err(StoreError::NotAWorld { .. })));
    assert!(said(&folder.join("none.world")).contains("found nothing"));
    std::fs::remove_dir_all(folder).unwrap();
}
