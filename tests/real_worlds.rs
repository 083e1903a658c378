//! Worlds baked from real data, and places whose height is published.
//!
//! The data lie in `../shared`; without it each test says so and counts as skipped.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a coarse sample, a cell of 50 m and a place published to a second of arc take from a peak.
const SPOT_M: f64 = 30.0;

/// The data's folder, if it is there.
fn data(needed_by: &str) -> Option<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/terrain");
    if !data.is_dir() {
        println!("skipped: {needed_by} needs {}, which is absent", data.display());
        return None;
    }
    Some(data)
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("real_worlds").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poligon"));
    let output = command.args(arguments).arg("--json").current_dir(folder).output().expect("the program starts");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON object")
}

/// The ground at places (degrees), as `height` has it.
fn ground(folder: &Path, world: &str, places: &[(f64, f64)]) -> Vec<Value> {
    let lines: String = places.iter().map(|(lat, lon)| format!("{lat},{lon}\n")).collect();
    std::fs::write(folder.join("places.csv"), format!("lat_deg,lon_deg\n{lines}")).unwrap();
    let report = json(folder, &["height", world, "--points", "places.csv"]);
    report["points"].as_array().expect("points").clone()
}

fn height_m(point: &Value) -> f64 {
    point["height_m"].as_f64().unwrap_or_else(|| panic!("no height: {point}"))
}

/// Two tiles of SRTM with voids and a coast, natural lakes that lie elsewhere and one that lies here.
#[test]
fn the_pyrenees() {
    let Some(data) = data("the_pyrenees") else { return };
    let folder = &folder("pyrenees");
    // A square at the Baells reservoir, with a level that is this test's own.
    let lake = r#"{"type":"Feature","properties":{"name":"La Baells","level_m":631},"geometry":{"type":"Polygon",
        "coordinates":[[[1.876,42.138],[1.886,42.138],[1.886,42.148],[1.876,42.148],[1.876,42.138]]]}}"#;
    std::fs::write(folder.join("baells.geojson"), lake).unwrap();
    let tile = |name: &str| data.join("tests/dem/srtm3_pyrenees").join(name).display().to_string();
    let lakes = data.join("committable/gis/naturalearth10m_lakes_regions.geojson").display().to_string();
    let (north, south) = (tile("N42E001.hgt.zip"), tile("N41E001.hgt.zip"));
    let bake =
        ["bake", "--dem", &north, &south, "--features", &lakes, "baells.geojson", "--step", "100", "--out", "p.world"];
    let world = json(folder, &bake);
    assert_eq!(
        world["features"]["lakes"].to_string(),
        r#"{"read":9,"kept":1,"skipped":8,"skipped_for":{"outside the world":8},"notes":{}}"#
    );
    assert!(world["voids"]["posts"].as_u64().is_some_and(|posts| posts > 1_000), "{}", world["voids"]);
    // The sea of the coast at Tarragona; SRTM has noise of a few metres on it.
    assert!(world["extent"]["lowest_m"].as_f64().is_some_and(|m| (-30.0..1.0).contains(&m)), "{}", world["extent"]);

    // Aerodromes as airportsdata 20260905 (airports.csv) has them: La Seu d'Urgell LESU 2,625 ft, La Cerdanya LECD
    // 3,586 ft. Then the sea off Tarragona, and the lake.
    let spots = [(42.3386, 1.40917, 800.1), (42.3864, 1.86667, 1_093.0), (41.05, 1.4, 0.0), (42.143, 1.881, 631.0)];
    let points = ground(folder, "p.world", &spots.map(|(lat, lon, _)| (lat, lon)));
    for (point, (lat, lon, published_m)) in points.iter().zip(spots) {
        assert!((height_m(point) - published_m).abs() < SPOT_M, "{lat}, {lon}: {point}, published {published_m}");
    }
    assert_eq!((&points[3]["surface"], height_m(&points[3])), (&"water".into(), 631.0));
    assert_eq!(points[0]["surface"], "ground");

    // From the aerodrome one sees what is above it, and not the other aerodrome 40 km up a bent valley.
    let sight = |to: &str| json(folder, &["sight", "p.world", "--from", "42.3386,1.40917,5:agl", "--to", to]);
    assert_eq!(sight("42.3486,1.42,300:agl")["visible"], true);
    let hidden = sight("42.3864,1.86667,5:agl");
    assert_eq!((&hidden["visible"], hidden["ground_share"].as_f64()), (&false.into(), Some(1.0)));
    assert!(hidden["clearance_min_m"].as_f64().is_some_and(|m| m < -100.0), "{hidden}");
}

/// The summit of Mount St Helens after 1980: 8,363 ft (USGS, Volcano Hazards Program), 46.1914 N 122.1956 W.
const ST_HELENS: (f64, f64, f64) = (46.1914, -122.1956, 2_549.0);

/// USGS DEM on UTM NAD27.
#[test]
fn st_helens_after_the_eruption() {
    let Some(data) = data("st_helens_after_the_eruption") else { return };
    let folder = &folder("st_helens");
    let dem = data.join("tests/dem/usgs_sthelens1980_30m.dem.gz").display().to_string();
    let world = json(folder, &["bake", "--dem", &dem, "--step", "25", "--out", "s.world"]);
    assert_eq!(world["sources"][0]["format"], "USGS DEM");
    let note = world["sources"][0]["note"].as_str().unwrap_or_default();
    assert!(note.contains("10 m"), "the datum shift without grids is not said: `{note}`");
    let point = &ground(folder, "s.world", &[(ST_HELENS.0, ST_HELENS.1)])[0];
    assert!((height_m(point) - ST_HELENS.2).abs() < SPOT_M, "{point}");
}

/// A PNG in decimetres, with a world file that the test writes: the place is the data's README's, good to 60 m.
#[test]
fn st_helens_in_decimetres() {
    let Some(data) = data("st_helens_in_decimetres") else { return };
    let folder = &folder("st_helens_png");
    std::fs::copy(data.join("tests/dem/ned_sthelens_10m_decimetres.png"), folder.join("s.png")).unwrap();
    std::fs::write(folder.join("s.pgw"), "8.97e-5\n0\n0\n-8.97e-5\n-122.277355\n46.326955\n").unwrap();
    let world = json(folder, &["bake", "--dem", "s.png@0.1", "--step", "25", "--out", "s.world"]);
    assert_eq!(world["sources"][0]["height_scale"], 0.1);
    let highest_m = world["extent"]["highest_m"].as_f64().unwrap_or_default();
    assert!((highest_m - ST_HELENS.2).abs() < SPOT_M, "{highest_m}");
    // The rim is steep: within 60 m in plan the summit is found.
    let around: Vec<(f64, f64)> = (-2..=2)
        .flat_map(|i| (-2..=2).map(move |j| (ST_HELENS.0 + f64::from(i) * 2.7e-4, ST_HELENS.1 + f64::from(j) * 3.9e-4)))
        .collect();
    let top_m = ground(folder, "s.world", &around).iter().map(height_m).fold(f64::NEG_INFINITY, f64::max);
    assert!((top_m - ST_HELENS.2).abs() < SPOT_M, "{top_m}");
}
