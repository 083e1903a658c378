//! The program at the ends of what it takes: no adapter, pictures of one pixel and of the widest, the eye on, under and
//! far off the ground, no speed and the highest, and a world proven from end to end.
//!
//! Where there is no Vulkan adapter, what needs one is skipped and says so; that there is none is itself tested, by
//! telling the loader of no driver.

mod small_world;

use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Said by whatever needs an adapter and finds none.
const NO_ADAPTER: &str = "expected a Vulkan adapter";

fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_poligon"));
    command.args(arguments);
    command
}

fn run(mut command: Command) -> Output {
    command.output().expect("the program starts")
}

fn told(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|error| panic!("stdout is no JSON: {error}: {}", told(output)))
}

/// The report, or `None` where there is nothing to draw with.
fn report(arguments: &[&str]) -> Option<Value> {
    let output = run(program(arguments));
    let told = told(&output);
    if told.contains(NO_ADAPTER) {
        println!("skipped: no Vulkan adapter");
        return None;
    }
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {told}");
    Some(json(&output))
}

/// Where a test's pictures go.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// Takes a picture; its number of colours, or `None` where there is nothing to draw with.
fn colours(world: &Path, out: &Path, eye: &str, look: &str, size: [u32; 2]) -> Option<usize> {
    let [width, height] = size;
    let size = format!("{width}x{height}");
    let shot = ["--json", "shot", text(world), "--eye", eye, "--look", look, "--size", &size, "--window", "12"];
    let taken = report(&[&shot[..], &["--quality", "software", "--out", text(out)]].concat())?;
    assert_eq!((&taken["size"], &taken["late_blocks"]), (&size.as_str().into(), &0.into()), "{eye} {look}");
    let picture = image::open(out).expect("a PNG").to_rgb8();
    assert_eq!(picture.dimensions(), (width, height), "{eye} {look}");
    Some(picture.pixels().map(|pixel| pixel.0).collect::<HashSet<_>>().len())
}

/// What a proof must find none of, with the device's where there is one.
fn assert_zeros(proof: &Value) {
    for zero in ["/t_junctions", "/position_mismatches", "/far/violations", "/near/height_changes"] {
        assert_eq!(proof.pointer(zero), Some(&0.into()), "{zero}: {proof}");
    }
    for some in ["/edges_checked/templates", "/edges_checked/pairs", "/edges_checked/window", "/eyes", "/near/places"] {
        assert!(proof.pointer(some).and_then(Value::as_u64) > Some(0), "{some}: {proof}");
    }
    assert!(proof["pop"]["max_px"].as_f64().is_some_and(|px| px <= 1.0), "{proof}");
}

#[test]
fn without_an_adapter_the_ground_still_answers() {
    let world = &small_world::write("extremes-none");
    let folder = &folder("extremes-none");
    let without = |arguments: &[&str]| {
        let mut command = program(arguments);
        command.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent").current_dir(folder);
        run(command)
    };
    let answers = |arguments: &[&str]| {
        let output = without(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", told(&output));
        json(&output)
    };
    assert_eq!(answers(&["--json", "info", text(world)])["name"], "Ridges");
    std::fs::write(folder.join("a.csv"), "x_m,z_m\n0,0\n").expect("a file");
    let heights = answers(&["--json", "height", text(world), "--points", "a.csv"]);
    assert!(heights["points"][0]["height_m"].is_number(), "{heights}");

    for picture in [
        &["--json", "fly", "--headless", "--frames", "2", "--shots", "shots", "--world", text(world)][..],
        &["--json", "shot", text(world), "--eye", "42,77,9:agl", "--look", "0,0", "--out", "a.png"],
    ] {
        let output = without(picture);
        let told = told(&output);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{picture:?}: {told}");
        assert!(told.contains(NO_ADAPTER) && told.contains("mesa-vulkan-drivers"), "{picture:?}: {told}");
    }
    assert!(!folder.join("a.png").exists());

    let proof = answers(&["--json", "verify", text(world)]);
    assert!(proof["gpu"].is_null() && proof["pop"]["max_grey"].is_null(), "{proof}");
    assert_zeros(&proof);
}

#[test]
fn a_small_world_is_proven_from_end_to_end() {
    let world = &small_world::write("extremes-verify");
    let Some(proof) = report(&["--json", "verify", text(world)]) else { return };
    assert_zeros(&proof);
    let gpu = &proof["gpu"];
    for zero in ["height_mismatches", "position_mismatches", "pixels_outside"] {
        assert_eq!(gpu[zero], 0, "{zero}: {proof}");
    }
    assert!(gpu["vertices_checked"].as_u64() > Some(0) && gpu["pixels_checked"].as_u64() >= Some(100_000), "{proof}");
}

#[test]
fn pictures_of_any_size_from_anywhere() {
    let world = &small_world::write("extremes-shots");
    let out = &folder("extremes-shots").join("a.png");
    // A pixel, and the widest picture that is taken: 16 rows about the horizon.
    if colours(world, out, "42,77,100:agl", "30,-5", [1, 1]).is_none() {
        return;
    }
    let small = [64, 48];
    for (eye, look, size) in [
        ("42,77,100:agl", "30,-5", [8192, 16]),
        ("42,77,0:agl", "30,0", small),
        ("42,77,0.5:agl", "30,-5", small),
        ("42,77,30000:agl", "30,-60", small),
        ("42,77,100:agl", "0,90", small),
        ("42,77,100:agl", "0,-90", small),
        ("42,77,-50:agl", "30,10", small),
        ("42,77,-12000", "30,90", small),
    ] {
        let found = colours(world, out, eye, look, size);
        println!("{eye} {look}: {found:?} colours");
        assert!(found > Some(1), "{eye} {look}: one flat colour");
    }
    // 1,000 km to the north, where only the sky is; any way one looks.
    for look in ["180,0", "0,90", "0,-90"] {
        assert!(colours(world, out, "51,77,1000", look, small).is_some());
    }
}

#[test]
fn the_eye_on_the_edge_of_the_world() {
    let world = &small_world::write("extremes-edge");
    let folder = &folder("extremes-edge");
    let out = &folder.join("a.png");
    // 14 blocks of 6 km about the centre: a corner, and the middles of two edges.
    std::fs::write(folder.join("edge.csv"), "x_m,z_m\n-42000,-42000\n42000,42000\n42000,0\n0,-42000\n")
        .expect("a file");
    let csv = folder.join("edge.csv");
    let output = run(program(&["--json", "height", text(world), "--points", text(&csv)]));
    let points = json(&output)["points"].as_array().cloned().expect("a list of points");
    assert_eq!(points.len(), 4);
    for point in points {
        let [lat, lon, height] = ["lat_deg", "lon_deg", "height_m"].map(|name| point[name].as_f64());
        let (lat, lon) = (lat.expect("a latitude"), lon.expect("a longitude"));
        let height = height.unwrap_or_else(|| panic!("the edge is ground: {point}"));
        // Above sea level, as degrees are rounded and may fall a nanometre outside, where nothing is above ground.
        let eye = format!("{lat},{lon},{}", height + 2.0);
        for look in ["45,-5", "225,-5", "0,-90"] {
            match colours(world, out, &eye, look, [64, 48]) {
                Some(found) => assert!(found > 1, "{eye} {look}: one flat colour"),
                None => return,
            }
        }
    }
}

#[test]
fn a_flight_at_no_speed_and_at_the_highest() {
    let world = &small_world::write("extremes-fly");
    let folder = &folder("extremes-fly");
    for speed_mps in ["0", "10000"] {
        let fly = ["--json", "fly", "--headless", "--frames", "5", "--size", "64x48", "--window", "12"];
        let with = ["--speed-mps", speed_mps, "--world", text(world), "--shots", text(folder)];
        let Some(flown) = report(&[&fly[..], &with].concat()) else { return };
        assert_eq!((&flown["frames"], &flown["terrain"]["late_blocks"]), (&5.into(), &0.into()), "{flown}");
        let found = flown["track"]["speed_mps"].as_f64().unwrap_or(f64::NAN);
        assert!(found.is_finite() && (speed_mps == "0") == (found == 0.0), "{flown}");
    }
}
