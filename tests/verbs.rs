//! `bake`, `info`, `height` and `sight` from outside, on a world whose heights the test knows.
//!
//! The source is an SRTM tile that the test writes: 1201 x 1201 samples that rise by 2 m a column and 1 m a row, a plane
//! in degrees. Posts of 50 m are finer than the samples, so the kernel is bilinear and keeps a plane, and over a cell
//! of 50 m the map bends it by less than a millimetre: so the ground may be asked for at any place by a formula.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Kernel, map and f32 posts of 3,600 m (rounded to 0.12 mm) together.
const PLANE_M: f64 = 0.005;

fn poligon(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_poligon"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = poligon(folder, &[arguments, &["--json"]].concat());
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {told}");
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON object")
}

/// Ends with 1, nothing on stdout and all of the words on stderr.
fn assert_fails(folder: &Path, arguments: &[&str], words: &[&str]) {
    let output = poligon(folder, arguments);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{arguments:?}: {told}");
    for word in words {
        assert!(told.contains(word), "{arguments:?}: `{word}` is not in: {told}");
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("expected a number, found {value}"))
}

/// A folder of this test's own.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("verbs").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Height of the source, metres: the tile's north-west sample is 43 N 7 E.
fn plane_m(lat_deg: f64, lon_deg: f64) -> f64 {
    2.0 * (lon_deg - 7.0) * 1200.0 + (43.0 - lat_deg) * 1200.0
}

/// Writes the tile and a square lake of 0.02 degrees around 42.53 N 7.53 E with its level at 2000 m.
fn write_sources(folder: &Path) {
    let samples = (0..1201_u16).flat_map(|row| (0..1201_u16).map(move |column| 2 * column + row));
    std::fs::write(folder.join("N42E007.hgt"), samples.flat_map(u16::to_be_bytes).collect::<Vec<u8>>()).unwrap();
    let square = "[[[7.52,42.52],[7.54,42.52],[7.54,42.54],[7.52,42.54],[7.52,42.52]]]";
    let feature = |properties: &str, geometry: &str| {
        format!(r#"{{"type":"Feature","properties":{properties},"geometry":{geometry}}}"#)
    };
    let lake =
        feature(r#"{"name":"Square","level_m":2000}"#, &format!(r#"{{"type":"Polygon","coordinates":{square}}}"#));
    let point = feature("{}", r#"{"type":"Point","coordinates":[7.5,42.5]}"#);
    let far = feature("{}", r#"{"type":"Polygon","coordinates":[[[70,0],[71,0],[71,1],[70,0]]]}"#);
    let all = format!(r#"{{"type":"FeatureCollection","features":[{lake},{point},{far}]}}"#);
    std::fs::write(folder.join("lakes.geojson"), all).unwrap();
}

const BAKE: [&str; 13] = [
    "bake",
    "--dem",
    "N42E007.hgt",
    "--features",
    "lakes.geojson",
    "--step",
    "50",
    "--centre",
    "42.5,7.5",
    "--size-km",
    "24x18",
    "--out",
    "plane.world",
];

/// Metres a degree of latitude and longitude at 42.5 N on WGS84: the radii of curvature.
fn metres_per_degree() -> (f64, f64) {
    let (a, e2) = (6_378_137.0_f64, 0.006_694_379_990_141_3_f64);
    let latitude = 42.5_f64.to_radians();
    let w2 = 1.0 - e2 * latitude.sin().powi(2);
    let (meridian, prime) = (a * (1.0 - e2) / w2.powf(1.5), a / w2.sqrt());
    (meridian.to_radians(), (prime * latitude.cos()).to_radians())
}

#[test]
fn a_world_is_baked_described_and_asked() {
    let folder = &folder("plane");
    write_sources(folder);
    let baked = json(folder, &BAKE);
    assert_eq!(
        (&baked["name"], &baked["blocks"], &baked["step_m"]),
        (&"plane".into(), &Value::from(vec![16, 12]), &50.0.into())
    );
    assert_eq!((&baked["posts"], &baked["voids"]["posts"]), (&(481 * 361).into(), &0.into()));
    let reasons = r#"{"no polygon, and no tag that says what it is":1,"outside the world":1}"#;
    assert_eq!(
        baked["features"]["lakes"].to_string(),
        format!(r#"{{"read":3,"kept":1,"skipped":2,"skipped_for":{reasons},"notes":{{}}}}"#)
    );
    assert_eq!((&baked["lakes"][0]["name"], &baked["lakes"][0]["level_m"]), (&"Square".into(), &2000.0.into()));
    assert_eq!(baked["sources"][0]["name"], "N42E007.hgt");
    assert!(number(&baked["wall_s"]) > 0.0 && baked["peak_rss_mib"].as_f64().is_none_or(|mib| mib > 1.0));

    let mut info = json(folder, &["info", "plane.world"]);
    assert!(info["wall_s"].is_null());
    for field in ["wall_s", "peak_rss_mib"] {
        info[field] = baked[field].clone();
    }
    assert_eq!(info, baked);

    heights(folder);
    sights(folder);
}

fn heights(folder: &Path) {
    let places = [(42.5, 7.5), (42.47, 7.43), (42.513, 7.571)];
    let lines: String = places.iter().map(|(lat, lon)| format!("{lat},{lon}\n")).collect();
    std::fs::write(folder.join("a.csv"), format!("lat_deg,lon_deg\r\n{lines}42.53,7.53\n44,7.5\n-42.5,-172.5\n"))
        .unwrap();
    let points = json(folder, &["height", "plane.world", "--points", "a.csv"])["points"].clone();
    let (per_lat_m, per_lon_m) = metres_per_degree();
    // The plane's gradient: 1200 m down a degree north, 2400 m up a degree east.
    let upward = [-2400.0 / per_lon_m, 1.0, -1200.0 / per_lat_m];
    let length = upward.iter().map(|c| c * c).sum::<f64>().sqrt();
    for (point, (lat, lon)) in points.as_array().unwrap().iter().zip(places) {
        assert_eq!((number(&point["lat_deg"]), number(&point["lon_deg"])), (lat, lon));
        assert!((number(&point["height_m"]) - plane_m(lat, lon)).abs() < PLANE_M, "{point}");
        assert_eq!(point["surface"], "ground");
        for (axis, upward) in upward.iter().enumerate() {
            // Grid north turns by 0.05 degrees within 6 km of the centre, and a degree of longitude shortens by 0.1 %:
            // 0.1 % of a slope of 3 %.
            assert!((number(&point["normal"][axis]) - upward / length).abs() < 1e-4, "{point}");
        }
    }
    assert_eq!((number(&points[0]["x_m"]), number(&points[0]["z_m"])), (0.0, 0.0));
    assert_eq!((number(&points[3]["height_m"]), &points[3]["surface"]), (2000.0, &"water".into()));
    for beyond in [4, 5] {
        let point = &points[beyond];
        assert!(point["height_m"].is_null() && point["normal"].is_null() && point["surface"].is_null(), "{point}");
    }

    // The same places in world coordinates: the same ground.
    let lines: String = (0..4).map(|i| format!("{},{}\n", points[i]["x_m"], points[i]["z_m"])).collect();
    std::fs::write(folder.join("b.csv"), format!("x_m,z_m\n{lines}1e300,0\n-12000.001,0\n-12000,-9000\n12000,9000\n"))
        .unwrap();
    let again = json(folder, &["height", "plane.world", "--points", "b.csv"])["points"].clone();
    for i in 0..4 {
        assert!((number(&again[i]["height_m"]) - number(&points[i]["height_m"])).abs() < 1e-6);
        assert!((number(&again[i]["lat_deg"]) - number(&points[i]["lat_deg"])).abs() < 1e-9);
        assert_eq!(again[i]["surface"], points[i]["surface"]);
    }
    assert!(again[4]["lat_deg"].is_null() && again[4]["height_m"].is_null());
    assert!(again[5]["height_m"].is_null() && number(&again[5]["lon_deg"]) < 7.4);
    // The world's corners are still ground.
    assert!(number(&again[6]["height_m"]) < number(&again[7]["height_m"]));

    for (text, words) in [
        ("x_m,z_m\n1,2\nNaN,0\n", ["line 3", "column `x_m`", "found `NaN`"]),
        ("x_m,z_m\n1,inf\n", ["line 2", "column `z_m`", "found `inf`"]),
        ("lat_deg,lon_deg\n1,2\n3,181\n", ["line 3", "column `lon_deg`", "within -180..=180"]),
        ("lat_deg,lon_deg\n1,2,3\n", ["line 2", "expected 2 values", "found 3"]),
        ("lat,lon\n1,2\n", ["line 1", "`lat_deg,lon_deg` or `x_m,z_m`", "found `lat,lon`"]),
    ] {
        std::fs::write(folder.join("bad.csv"), text).unwrap();
        assert_fails(folder, &["height", "plane.world", "--points", "bad.csv"], &[&["bad.csv"], &words[..]].concat());
    }
}

fn sights(folder: &Path) {
    let look = |from: &str, to: &str| json(folder, &["sight", "plane.world", "--from", from, "--to", to]);
    // North of the lake, 100 m above a plane: 100 m all along, but for the bend of the map (some 0.2 m over 4 km).
    let clear = look("42.56,7.46,100:agl", "42.56,7.51,100:agl");
    assert_eq!((&clear["visible"], &clear["hit"]), (&true.into(), &Value::Null));
    assert!((number(&clear["clearance_min_m"]) - 100.0).abs() < 0.5, "{clear}");
    assert_eq!(number(&clear["ground_share"]), 1.0);
    let (_, per_lon_m) = metres_per_degree();
    assert!((number(&clear["distance_m"]) / (0.05 * per_lon_m) - 1.0).abs() < 2e-3, "{clear}");

    // From 100 m above the plane to 100 m under it: cut half way, and deepest at the far end.
    let cut = look("42.56,7.46,100:agl", "42.56,7.51,-100:agl");
    let distance_m = number(&cut["distance_m"]);
    assert_eq!(cut["visible"], false);
    assert!((number(&cut["hit"]["distance_m"]) / distance_m - 0.5).abs() < 2e-3, "{cut}");
    assert!(
        (number(&cut["hit"]["lon_deg"]) - 7.485).abs() < 1e-4 && (number(&cut["hit"]["lat_deg"]) - 42.56).abs() < 1e-4
    );
    let (lat, lon) = (number(&cut["hit"]["lat_deg"]), number(&cut["hit"]["lon_deg"]));
    assert!((number(&cut["hit"]["height_m"]) - plane_m(lat, lon)).abs() < PLANE_M, "{cut}");
    assert!((number(&cut["clearance_min_m"]) + 100.0).abs() < 1e-3);
    assert!((number(&cut["clearance_min_at_m"]) - distance_m).abs() < 1e-6);

    // Both feet on the ground, over the lake's hollow: they see each other, with nothing to spare at the ends.
    let feet = look("42.53,7.51,2010", "42.53,7.53,0:agl");
    assert_eq!(feet["visible"], true, "{feet}");
    assert!(number(&feet["clearance_min_m"]).abs() < 1e-6, "{feet}");

    // Off the map there is nothing to hide behind, and that is said.
    let off = look("44,7.5,10", "44,7.6,10");
    assert_eq!(
        (&off["visible"], &off["clearance_min_m"], number(&off["ground_share"])),
        (&true.into(), &Value::Null, 0.0)
    );
    let told = poligon(folder, &["sight", "plane.world", "--from", "44,7.5,10", "--to", "44,7.6,10"]);
    assert!(String::from_utf8_lossy(&told.stderr).contains("100.0 % of the line has no ground"));
    let no_ground = ["sight", "plane.world", "--from", "44,7.5,10:agl", "--to", "42.5,7.5,10"];
    assert_fails(folder, &no_ground, &["height above ground", "44, 7.5"]);
}

#[test]
fn a_damaged_world_says_what_was_expected_and_found() {
    let folder = &folder("damaged");
    write_sources(folder);
    json(folder, &BAKE);
    let world = folder.join("plane.world");
    let damage = |file: &str, change: &dyn Fn(Vec<u8>) -> Option<Vec<u8>>, words: &[&str]| {
        let path = world.join(file);
        let whole = std::fs::read(&path).unwrap();
        match change(whole.clone()) {
            Some(bytes) => std::fs::write(&path, bytes).unwrap(),
            None => std::fs::remove_file(&path).unwrap(),
        }
        std::fs::write(folder.join("a.csv"), "x_m,z_m\n0,0\n").unwrap();
        for verb in [
            &["info", "plane.world"][..],
            &["height", "plane.world", "--points", "a.csv"],
            &["sight", "plane.world", "--from", "42,7,1", "--to", "42,7,2", "--json"],
        ] {
            assert_fails(folder, verb, &[words, &[file, "expected", "found"]].concat());
        }
        std::fs::write(&path, whole).unwrap();
    };
    let edited = |from: &'static str, to: &'static str| {
        move |bytes: Vec<u8>| {
            let text = String::from_utf8(bytes).unwrap();
            assert!(text.contains(from), "{text}");
            Some(text.replacen(from, to, 1).into_bytes())
        }
    };
    damage("heights.bin", &|bytes| Some(bytes[..1000].to_vec()), &["694564 bytes", "1000"]);
    damage(
        "heights.bin",
        &|mut bytes| {
            bytes[777] ^= 1;
            Some(bytes)
        },
        &["CRC-32"],
    );
    damage("heights.bin", &|_| None, &["no such file"]);
    damage("lakes.json", &|_| Some(b"[]".to_vec()), &["bytes"]);
    damage("world.toml", &|_| Some(b"\x00\xff".to_vec()), &[]);
    damage("world.toml", &|_| Some(b"= 3".to_vec()), &["TOML"]);
    damage("world.toml", &edited("format_version = 2", "format_version = 99"), &["version 99"]);
    damage("world.toml", &edited("step_m = 50.0", "step_m = 25.0"), &["east_m"]);
    damage("world.toml", &edited("blocks_x = 16", "blocks_x = 6"), &[]);
    damage("world.toml", &edited("centre_lat_deg", "centre_lat"), &[]);
    assert_eq!(json(folder, &["info", "plane.world"])["name"], "plane");
}

#[test]
fn what_is_no_world_is_never_touched_and_a_failed_bake_leaves_nothing() {
    let folder = &folder("kept");
    write_sources(folder);
    std::fs::create_dir(folder.join("plane.world")).unwrap();
    std::fs::write(folder.join("plane.world/thesis.txt"), "ten years").unwrap();
    assert_fails(folder, &BAKE, &["plane.world", "expected a world", "another folder", "not replaced"]);
    // A world with something of a person's in it is kept as well.
    std::fs::write(folder.join("plane.world/world.toml"), "").unwrap();
    assert_fails(folder, &BAKE, &["`thesis.txt`", "not replaced"]);
    assert_eq!(std::fs::read_to_string(folder.join("plane.world/thesis.txt")).unwrap(), "ten years");
    std::fs::remove_dir_all(folder.join("plane.world")).unwrap();
    std::fs::write(folder.join("plane.world"), "a file").unwrap();
    assert_fails(folder, &BAKE, &["found a file", "not replaced"]);
    std::fs::remove_file(folder.join("plane.world")).unwrap();

    let tile = "N42E007.hgt";
    for (dem, more, words) in [
        ("no/such.tif", &[][..], &["no/such.tif", "expected a readable file", "found"][..]),
        ("lakes.geojson", &[], &["lakes.geojson", "expected GeoTIFF", "found"]),
        ("N42E007.hgt@0", &[], &["N42E007.hgt", "height scale", "found 0"]),
        (tile, &["--features", tile], &[tile, "expected OSM PBF, OSM XML, GeoJSON", "found"]),
        (tile, &["--features", "no.geojson"], &["no.geojson", "expected", "found"]),
        (tile, &["--centre", "0,0", "--size-km", "10x10"], &["expected data under the world", "42.500, 7.500"]),
        (tile, &["--centre", "90,0"], &["centre", "86"]),
        (tile, &["--step", "25", "--size-km", "1000x1000"], &["at most 67108864 posts"]),
    ] {
        let arguments = [&["bake", "--dem", dem, "--out", "new.world"], more].concat();
        assert_fails(folder, &arguments, words);
    }
    let mut left: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["N42E007.hgt", "lakes.geojson"]);

    // A world is replaced by the next one.
    json(folder, &["bake", "--dem", tile, "--size-km", "6x6", "--out", "a.world"]);
    json(folder, &["bake", "--dem", "N42E007.hgt@0.5", "--size-km", "12x6", "--out", "a.world"]);
    let info = json(folder, &["info", "a.world"]);
    assert_eq!((&info["blocks"], &info["sources"][0]["height_scale"]), (&Value::from(vec![2, 1]), &0.5.into()));
}
