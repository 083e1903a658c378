//! A stick without hardware: Debian's `umockdev-run` plays a Thrustmaster T.16000M to the unchanged input code.
//!
//! Skipped with its reason where the tool or the recording (beside the repository, in `../shared`) is absent.

use std::path::{Path, PathBuf};
use std::process::Command;

fn recording() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/joystick");
    // A worktree lies beside the repository, so the same path serves both.
    folder.join("js.umockdev").is_file().then_some(folder)
}

/// The example beside this test's own executable: target/debug/deps/fake_stick-... and target/debug/examples/sticks.
fn sticks() -> Option<PathBuf> {
    let deps = std::env::current_exe().ok()?;
    let program = deps.parent()?.parent()?.join("examples/sticks");
    program.is_file().then_some(program)
}

/// Output of the example under a recording of events; `None` if it cannot be run here.
fn played(events: &str, seconds: &str) -> Option<String> {
    let Some(folder) = recording() else {
        println!("skipped: no recording of a stick in ../shared/joystick");
        return None;
    };
    let Some(program) = sticks() else {
        println!("skipped: the example `sticks` is not built");
        return None;
    };
    let file = std::env::temp_dir().join(format!("poligon-stick-{}-{}.events", std::process::id(), events.len()));
    std::fs::write(&file, events).unwrap();
    let output = Command::new("umockdev-run")
        .arg("-d")
        .arg(folder.join("js.umockdev"))
        .arg("-i")
        .arg(format!("/dev/input/event7={}", folder.join("js.ioctl").display()))
        .arg("-e")
        .arg(format!("/dev/input/event7={}", file.display()))
        .arg("--")
        .arg(program)
        .arg(seconds)
        .output();
    let _ = std::fs::remove_file(&file);
    match output {
        Ok(output) => {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            Some(String::from_utf8_lossy(&output.stdout).into_owned())
        }
        Err(error) => {
            println!("skipped: umockdev-run: {error}");
            None
        }
    }
}

#[test]
fn axes_throttle_and_trigger_arrive() {
    // X to full right, trigger, throttle slider to 200 of 255, Y pulled back. 8,192 is the middle of 16,383.
    let events = "# EVEMU 1.2\n\
        E: 0.600000 0003 0000 16383\nE: 0.600000 0000 0000 0\n\
        E: 0.700000 0001 0120 1\nE: 0.700000 0000 0000 0\n\
        E: 0.800000 0001 0120 0\nE: 0.800000 0000 0000 0\n\
        E: 0.900000 0003 0006 200\nE: 0.900000 0000 0000 0\n\
        E: 1.000000 0003 0001 16383\nE: 1.000000 0000 0000 0\n";
    let Some(output) = played(events, "2.5") else { return };
    assert!(output.contains("(044f:b10a)"), "{output}");
    assert!(output.contains("roll Some(1.0)"), "{output}");
    assert!(output.contains("command trigger"), "{output}");
    // 200 of 255 counted from the far end, the lever's zero: 1 - 201/256 = 0.215.
    assert!(output.contains("throttle Some(0.2148"), "{output}");
    assert!(output.contains("pitch Some(1.0)"), "pulled back is nose up: {output}");
}

#[test]
fn values_out_of_range_and_a_flood_of_events_do_no_harm() {
    let mut events = String::from("# EVEMU 1.2\n");
    for (i, value) in [i32::MAX, i32::MIN, -1, 99_999].iter().cycle().take(3_000).enumerate() {
        let at = 0.6 + f64::from(i as u32) * 1e-4;
        events += &format!("E: {at:.6} 0003 0000 {value}\nE: {at:.6} 0000 0000 0\n");
    }
    let Some(output) = played(&events, "2.5") else { return };
    assert!(output.contains("(044f:b10a)") && !output.contains("NaN"), "{output}");
}

#[test]
fn an_axis_that_was_never_announced_does_not_end_the_program() {
    let events = "# EVEMU 1.2\n\
        E: 0.600000 0003 0002 100\nE: 0.600000 0000 0000 0\n\
        E: 0.700000 0001 02ff 1\nE: 0.700000 0000 0000 0\n\
        E: 0.800000 0003 0000 16383\nE: 0.800000 0000 0000 0\n";
    let Some(output) = played(events, "2.0") else { return };
    assert!(output.contains("roll Some(1.0)"), "what follows still counts: {output}");
}
