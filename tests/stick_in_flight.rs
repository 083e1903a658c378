//! `fly` in a window under Xvfb, flown by a stick without hardware (Debian's `umockdev-run`): it takes over, a storm of events
//! does no harm, the latency is told, and what was recorded flies again.
//!
//! Skipped, and said so, where one of the tools or the recording of a stick (beside the repository, in `../shared`) is absent.

mod small_world;

use serde_json::Value;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// The middle of the recorded stick's axes, and a deflection to the right that takes over.
const MIDDLE: u32 = 8_192;
const RIGHT: u32 = 12_000;
/// When the stick begins to move and to storm, and when all is quiet again, seconds after the player's start.
const PULSES_S: (u32, u32) = (5, 16);
const STORM_S: f64 = 17.0;
const QUIET_S: f64 = 18.5;

/// Half a second to the right and back, each second; then 10,000 events a second for a second, of all axes, some of them far out
/// of range; then the stick in the middle.
fn events() -> String {
    let mut text = String::from("# EVEMU 1.2\n");
    let mut add = |at_s: f64, code: u32, value: i64| {
        let _ = writeln!(text, "E: {at_s:.6} 0003 {code:04x} {value}\nE: {at_s:.6} 0000 0000 0");
    };
    for second in PULSES_S.0..PULSES_S.1 {
        add(f64::from(second), 0, RIGHT.into());
        add(f64::from(second) + 0.5, 0, MIDDLE.into());
    }
    for event in 0..10_000_u32 {
        let value = [16_383, 0, i64::from(i32::MAX), i64::from(i32::MIN), -1, 8_000][event as usize % 6];
        add(STORM_S + f64::from(event) * 1e-4, [0, 1, 5, 6][event as usize % 4], value);
    }
    for (number, code) in [0, 1].into_iter().enumerate() {
        add(QUIET_S + 0.1 * number as f64, code, MIDDLE.into());
    }
    text
}

fn is_installed(tool: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(tool).is_file())
}

#[test]
fn a_stick_flies_a_storm_of_events_does_no_harm_and_what_was_recorded_flies_again() {
    let stick = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/joystick");
    if !stick.join("js.umockdev").is_file() {
        println!("skipped: no recording of a stick in ../shared/joystick");
        return;
    }
    for tool in ["xvfb-run", "umockdev-run"] {
        if !is_installed(tool) {
            println!("skipped: {tool} is not installed");
            return;
        }
    }
    let world = small_world::write("stick");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stick-in-flight");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let (played, kept) = (folder.join("stick.events"), folder.join("I.csv"));
    std::fs::write(&played, events()).unwrap();
    let flown = Command::new("xvfb-run")
        .args(["-a", "-s", "-screen 0 640x480x24", "umockdev-run", "-d"])
        .arg(stick.join("js.umockdev"))
        .arg("-i")
        .arg(format!("/dev/input/event7={}", stick.join("js.ioctl").display()))
        .arg("-e")
        .arg(format!("/dev/input/event7={}", played.display()))
        .arg("--")
        .arg(env!("CARGO_BIN_EXE_poligon"))
        .args(["--json", "fly", "--quality", "software", "--speed-mps", "100", "--seconds", "20"])
        .args(["--size", "320x200", "--world"])
        .arg(&world)
        .arg("--record")
        .arg(&kept)
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("xvfb-run starts");
    let told = String::from_utf8_lossy(&flown.stderr);
    if !flown.status.success() && told.contains("expected a Vulkan adapter") {
        println!("skipped: {told}");
        return;
    }
    assert!(flown.status.success(), "{told}");
    let report: Value = serde_json::from_slice(&flown.stdout).expect("stdout is one JSON object");
    assert_eq!(report["mode"], "window");

    // Some pulses come before the first picture on a slow machine, not all of them.
    let latency = &report["latency"];
    let figure = |key: &str| latency[key].as_f64().unwrap_or(f64::NAN);
    assert!(figure("inputs") >= 3.0, "{latency} {told}");
    assert!(figure("sampled_ms_median") > 0.0 && figure("sampled_ms_median") <= figure("sampled_ms_max"), "{latency}");
    assert!(report["latency_ms"].as_f64().unwrap_or(0.0) > figure("sampled_ms_median"), "{report}");
    println!("{latency}, {} ms to the screen, frames {}", report["latency_ms"], report["frame_ms"]);

    // The stick took over and was let go in the end; nothing in between is out of range.
    let text = std::fs::read_to_string(&kept).unwrap();
    let rolls: Vec<f64> = text.lines().skip(1).filter_map(|line| line.split(',').nth(2)?.parse().ok()).collect();
    assert!(text.contains("track") && rolls.len() > 10, "{} rolls", rolls.len());
    assert!(rolls.iter().all(|roll| (-1.0..=1.0).contains(roll)) && rolls.last() == Some(&0.0), "{:?}", rolls.last());

    let again = || {
        let output = Command::new(env!("CARGO_BIN_EXE_poligon"))
            .args(["--json", "fly", "--headless", "--lockstep", "--quality", "software", "--speed-mps", "100"])
            .args(["--seconds", "19", "--size", "64x64", "--world"])
            .arg(&world)
            .arg("--inputs")
            .arg(&kept)
            .arg("--shots")
            .arg(folder.join("shots"))
            .output()
            .expect("the program starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).expect("stdout is one JSON object");
        report["sim"]["hash"].clone()
    };
    assert_eq!(again(), again());
}
