//! `fly --lockstep` twice: the same hashes of the simulation, of every mesh and of the pictures.

mod small_world;

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// The report of a short flight, or `None` where there is nothing to draw with.
fn flown(world: &Path, folder: &str, speed_mps: &str) -> Option<Value> {
    let shots = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let report = shots.join("report.json");
    let output = Command::new(env!("CARGO_BIN_EXE_poligon"))
        .args(["--json", "fly", "--headless", "--lockstep", "--frames", "40", "--size", "64x48", "--window", "12"])
        .args(["--speed-mps", speed_mps, "--quality", "standard"])
        .arg("--world")
        .arg(world)
        .arg("--shots")
        .arg(&shots)
        .arg("--report")
        .arg(&report)
        .output()
        .expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    if told.contains("expected a Vulkan adapter") {
        println!("skipped: no Vulkan adapter");
        return None;
    }
    assert!(output.status.success(), "{told}");
    let printed: Value = serde_json::from_slice(&output.stdout).expect("stdout is one JSON object");
    let written: Value = serde_json::from_slice(&std::fs::read(&report).expect("a report file")).expect("JSON");
    assert_eq!(printed, written, "the report printed and the report written");
    for shot in printed["shots"].as_array().expect("a list of pictures") {
        assert!(Path::new(shot.as_str().unwrap_or_default()).exists(), "{shot} is not there");
    }
    Some(printed)
}

#[test]
fn two_lockstep_flights_are_the_same_and_another_is_another() {
    let world = small_world::write("determinism");
    // 6.7 km in 40 frames: over a block border, with rows to build and rings to switch.
    let Some(first) = flown(&world, "determinism-1", "10000") else { return };
    let Some(second) = flown(&world, "determinism-2", "10000") else { return };
    let hashes =
        |report: &Value| [&report["sim"]["hash"], &report["mesh_hash"], &report["image_hash"]].map(Value::clone);
    assert!(hashes(&first).iter().all(|hash| hash.as_str().is_some_and(|text| text.len() == 16)), "{first}");
    assert_eq!(hashes(&first), hashes(&second), "simulation, meshes, pictures");

    assert_eq!(first["frames"], 40);
    assert_eq!(first["sim"]["steps"], 80);
    assert_eq!(first["terrain"]["late_blocks"], 0, "lockstep waits for every block");
    assert_eq!(first["shots"].as_array().map(Vec::len), Some(9), "eight pictures and a contact sheet");
    let track = &first["track"];
    assert!(track["block_crossings"].as_u64() >= Some(1), "{track}");
    // 39 intervals of 1/60 s at 10 km/s, along a track that climbs and sinks with the ground.
    let distance_km = track["distance_km"].as_f64().unwrap_or(0.0);
    assert!((6.49..6.8).contains(&distance_km), "{track}");

    let Some(slower) = flown(&world, "determinism-3", "9000") else { return };
    for (one, other) in hashes(&first).iter().zip(&hashes(&slower)) {
        assert_ne!(one, other, "a slower flight");
    }
}
