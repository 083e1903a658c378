//! `fly` in a window, under Xvfb: keys arrive, pausing stops motion, pictures are pictures, the quit key quits.
//!
//! Skipped, and said so, where Xvfb or xdotool are not installed.

mod small_world;

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const SIZE: [u32; 2] = [320, 200];

/// A process that does not outlive the test.
struct Killed(Child);

impl Drop for Killed {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn is_installed(tool: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(tool).is_file())
}

/// Waits until something is there; the limit is for a busy machine without a graphics card.
fn wait_for<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = ask() {
            return found;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "no {what} within a minute");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn xdotool(display: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new("xdotool").env("DISPLAY", display).args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

/// An X server on a display of its own; `-displayfd` makes it choose a free one.
fn x_server() -> (Killed, String) {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("xvfb-display");
    let out = std::fs::File::create(&file).expect("a file for the display's number");
    let server = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "640x480x24", "-nolisten", "tcp"])
        .stdout(out)
        .stderr(Stdio::null())
        .spawn()
        .expect("Xvfb starts");
    let server = Killed(server);
    let number = wait_for("X display", || {
        let text = std::fs::read_to_string(&file).ok()?;
        text.ends_with('\n').then(|| text.trim().to_owned()).filter(|number| !number.is_empty())
    });
    (server, format!(":{number}"))
}

fn pictures(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "png"));
    files.sort();
    files
}

/// Presses the screenshot key and gives the new picture, once it is whole.
fn take_picture(display: &str, folder: &Path) -> image::RgbaImage {
    let before = pictures(folder);
    xdotool(display, &["key", "F12"]).expect("xdotool presses a key");
    wait_for("picture", || {
        let new = pictures(folder).into_iter().find(|path| !before.contains(path))?;
        image::open(new).ok().map(|picture| picture.to_rgba8())
    })
}

fn colours(picture: &image::RgbaImage) -> usize {
    picture.pixels().map(|pixel| pixel.0).collect::<std::collections::HashSet<_>>().len()
}

#[test]
fn a_window_takes_keys_pauses_takes_pictures_and_quits() {
    for tool in ["Xvfb", "xdotool"] {
        if !is_installed(tool) {
            println!("skipped: {tool} is not installed");
            return;
        }
    }
    let world = small_world::write("window");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window-pictures");
    let _ = std::fs::remove_dir_all(&folder);
    let (_server, display) = x_server();
    let mut program = Killed(
        Command::new(env!("CARGO_BIN_EXE_poligon"))
            .env("DISPLAY", &display)
            .env_remove("WAYLAND_DISPLAY")
            .args(["--json", "fly", "--quality", "software", "--speed-mps", "300"])
            .args(["--size", &format!("{}x{}", SIZE[0], SIZE[1])])
            .arg("--world")
            .arg(&world)
            .arg("--shots")
            .arg(&folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts"),
    );
    let window = wait_for("window", || {
        if let Ok(Some(_)) = program.0.try_wait() {
            return Some(String::new());
        }
        xdotool(&display, &["search", "--onlyvisible", "--name", "^Poligon$"]).filter(|id| !id.is_empty())
    });
    if window.is_empty() {
        let mut told = String::new();
        let _ = std::io::Read::read_to_string(&mut program.0.stderr.take().expect("stderr"), &mut told);
        assert!(told.contains("expected a Vulkan adapter"), "the window did not open: {told}");
        println!("skipped: {told}");
        return;
    }
    // There is no window manager to give it the keyboard.
    wait_for("keyboard", || xdotool(&display, &["windowfocus", &window]));
    let key = |name: &str| xdotool(&display, &["key", name]).expect("xdotool presses a key");

    // With the display on; this also waits for the first frame.
    let flying = take_picture(&display, &folder);
    assert_eq!([flying.width(), flying.height()], SIZE);
    assert!(colours(&flying) > 200, "{} colours", colours(&flying));

    // Paused and without the display (it shows the frame's time) two pictures are the same, pixel by pixel.
    key("h");
    key("p");
    std::thread::sleep(Duration::from_millis(700));
    let still = take_picture(&display, &folder);
    std::thread::sleep(Duration::from_millis(700));
    assert!(take_picture(&display, &folder) == still, "it moves while paused");
    assert!(colours(&still) > 100, "{} colours", colours(&still));

    key("p");
    std::thread::sleep(Duration::from_millis(1500));
    assert!(take_picture(&display, &folder) != still, "it does not move after the pause");

    // What the screen shows is a picture too.
    if is_installed("import") {
        let file = folder.join("screen.PNG");
        let done = Command::new("import").env("DISPLAY", &display).args(["-window", &window]).arg(&file).status();
        if done.is_ok_and(|status| status.success()) {
            let screen = image::open(&file).expect("a picture of the screen").to_rgba8();
            assert!(colours(&screen) > 100, "{} colours on the screen", colours(&screen));
        }
    } else {
        println!("skipped: a picture of the screen: import is not installed");
    }

    key("Escape");
    let status = wait_for("end", || program.0.try_wait().ok().flatten());
    let mut printed = String::new();
    let _ = std::io::Read::read_to_string(&mut program.0.stdout.take().expect("stdout"), &mut printed);
    assert_eq!(status.code(), Some(0), "{printed}");
    let report: Value = serde_json::from_str(&printed).expect("stdout is one JSON object");
    assert_eq!((&report["mode"], &report["shots"].as_array().map(Vec::len)), (&"window".into(), &Some(4)));
    // What was flown is what time was not paused for.
    let flown_m = report["track"]["distance_km"].as_f64().unwrap_or(0.0) * 1e3;
    let simulated_m = report["sim"]["steps"].as_f64().unwrap_or(0.0) / 120.0 * 300.0;
    assert!(flown_m > 300.0 && (0.9..1.02).contains(&(flown_m / simulated_m)), "{flown_m} of {simulated_m} m");
}
