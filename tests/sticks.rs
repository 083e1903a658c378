//! `poligon input` with a stick without hardware: Debian's `umockdev-run` plays a Thrustmaster T.16000M.
//!
//! Skipped with its reason where the tool or the recording (beside the repository, in `../shared`) is absent.

use std::path::{Path, PathBuf};
use std::process::Command;

/// X, Y, twist and slider of the recorded stick, each moved to one end in its turn and held, 2 s apart.
fn moved_in_turn() -> String {
    let mut events = String::from("# EVEMU 1.2\n");
    // Roll to the right, back, twist to the right, slider to its near end, which is its zero's opposite.
    for (at_s, code, value) in [(1.0, 0, 16_383), (3.0, 1, 16_383), (5.0, 5, 255), (7.0, 6, 0)] {
        events += &format!("E: {at_s:.6} 0003 {code:04x} {value}\nE: {at_s:.6} 0000 0000 0\n");
    }
    events
}

/// What the program prints under the recording; `None`, with the reason told, if it cannot be run here.
fn played(name: &str, events: &str, arguments: &[&str]) -> Option<serde_json::Value> {
    let recording = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/joystick");
    if !recording.join("js.umockdev").is_file() {
        println!("skipped: no recording of a stick in ../shared/joystick");
        return None;
    }
    let file = std::env::temp_dir().join(format!("poligon-{name}-{}.events", std::process::id()));
    std::fs::write(&file, events).unwrap();
    let output = Command::new("umockdev-run")
        .arg("-d")
        .arg(recording.join("js.umockdev"))
        .arg("-i")
        .arg(format!("/dev/input/event7={}", recording.join("js.ioctl").display()))
        .arg("-e")
        .arg(format!("/dev/input/event7={}", file.display()))
        .arg("--")
        .arg(env!("CARGO_BIN_EXE_poligon"))
        .args(["input", "--json"])
        .args(arguments)
        .output();
    let _ = std::fs::remove_file(&file);
    match output {
        Ok(output) => {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Some(serde_json::from_slice(&output.stdout).unwrap())
        }
        Err(error) => {
            println!("skipped: umockdev-run: {error}");
            None
        }
    }
}

#[test]
fn a_stick_is_shown_with_its_codes_and_what_they_move() {
    let Some(report) = played("shown", &moved_in_turn(), &["--seconds", "9"]) else { return };
    let device = &report["devices"][0];
    assert_eq!(device["device"], "044f:b10a");
    assert_eq!(device["bound_by"], "Thrustmaster T.16000M");
    let axes = device["axes"].as_array().unwrap();
    let moves = |code: &str| axes.iter().find(|axis| axis["code"] == code).map(|axis| axis["moves"].clone());
    assert_eq!(moves("0x30000"), Some("roll".into()));
    assert_eq!(moves("0x30006"), Some("throttle".into()));
}

#[test]
fn controls_moved_in_turn_make_a_file_that_binds_them() {
    let file: PathBuf = std::env::temp_dir().join(format!("poligon-bound-{}.toml", std::process::id()));
    let path = file.display().to_string();
    // The embedded bindings would do: here the file is what counts.
    let Some(report) = played("bound", &moved_in_turn(), &["--write", "--seconds", "6", "--sticks", &path]) else {
        return;
    };
    assert_eq!(report["written"], path.as_str());
    let text = std::fs::read_to_string(&file).unwrap();
    let bound: toml::Table = text.parse().unwrap();
    let axes = bound["stick"][0]["axes"].as_array().unwrap();
    let of = |code: i64| axes.iter().find(|axis| axis["code"].as_integer() == Some(code)).unwrap();
    for (code, moves) in [(0x30000, "roll"), (0x30001, "pitch"), (0x30005, "yaw"), (0x30006, "throttle")] {
        assert_eq!(of(code)["moves"].as_str(), Some(moves), "{text}");
    }
    assert_eq!(of(0x30006)["inverted"].as_bool(), Some(true), "{text}");
    assert_eq!(of(0x30000)["inverted"].as_bool(), Some(false), "{text}");
    std::fs::remove_file(&file).unwrap();
}
