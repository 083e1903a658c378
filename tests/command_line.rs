//! The program from outside: exit status, what goes to which stream, help.

use std::path::Path;
use std::process::{Command, Output};

const VERBS: [&str; 12] =
    ["fly", "bake", "info", "verify", "height", "sight", "simulate", "modes", "trajectory", "shot", "bench", "trade"];

/// A folder that is nowhere.
const NO_WORLD: &str = "no/such/place.world";

fn poligon(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_poligon"))
        .args(arguments)
        .current_dir(env!("CARGO_TARGET_TMPDIR"))
        .output()
        .expect("the program starts")
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("stdout is UTF-8")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("stderr is UTF-8")
}

/// Ends with the status, says something on stderr that contains the words, and nothing on stdout.
fn assert_refused(arguments: &[&str], status: i32, words: &[&str]) {
    let output = poligon(arguments);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {told}");
    assert_eq!(stdout(&output), "", "{arguments:?}");
    for word in words {
        assert!(told.contains(word), "{arguments:?}: `{word}` is not in: {told}");
    }
    assert!(!told.contains("panicked"), "{arguments:?}: {told}");
}

#[test]
fn help_and_version_go_to_stdout() {
    let help = poligon(&["--help"]);
    assert_eq!((help.status.code(), stderr(&help).as_str()), (Some(0), ""));
    for verb in VERBS {
        assert!(stdout(&help).contains(&format!("\n  {verb} ")), "{verb} is not listed");
        let output = poligon(&[verb, "--help"]);
        assert_eq!(output.status.code(), Some(0), "{verb}");
        assert!(stdout(&output).contains(&format!("Usage: poligon {verb}")), "{verb}: {}", stdout(&output));
        assert!(stdout(&output).contains("--json"), "{verb}");
    }
    let version = poligon(&["--version"]);
    assert_eq!(stdout(&version), format!("poligon {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn verbs_that_do_not_exist_yet_are_neither_listed_nor_taken() {
    let help = stdout(&poligon(&["--help"]));
    for verb in ["scenario", "instructor", "replay", "serve"] {
        assert!(!help.contains(verb), "{verb} is listed");
        assert_refused(&[verb], 2, &["unrecognized subcommand", verb]);
    }
}

#[test]
fn a_trajectory_is_told_as_rows_as_json_or_as_a_file() {
    let assets = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/ballistics/");
    let shell = format!("{assets}projectiles/308_175gr.toml");
    let case = format!("{assets}cases/rifle_1000m.toml");
    let shot = ["trajectory", "--projectile", &shell, "--case", &case];
    let rows = poligon(&shot);
    let text = stdout(&rows);
    assert_eq!((rows.status.code(), stderr(&rows).as_str()), (Some(0), ""));
    assert!(text.starts_with("t_s,x_m,y_m,z_m,drop_m,path_m,vx_mps,vy_mps,vz_mps,speed_mps,mach,lat_deg,"));
    assert_eq!(text.lines().count(), 1 + 21, "a header and a row every 50 m");
    assert!(text.ends_with(",range_m=1000\n"));
    let json = stdout(&poligon(&[&shot[..], &["--json"]].concat()));
    assert!(json.starts_with("{\"range_m\":1000") && json.lines().count() == 1, "{json}");
    let told = stdout(&poligon(&[&shot[..], &["--out", "trajectory.csv"]].concat()));
    assert!(told.contains("modified point mass"), "{told}");
    let written = Path::new(env!("CARGO_TARGET_TMPDIR")).join("trajectory.csv");
    assert_eq!(std::fs::read_to_string(&written).unwrap(), text);

    assert_refused(&["trajectory", "--projectile", &shell], 2, &["--case"]);
    assert_refused(&["trajectory", "--projectile", "no.toml", "--case", &case], 2, &["no.toml"]);
    // The files the other way round: an unknown key is named.
    assert_refused(&["trajectory", "--projectile", &case, "--case", &shell], 2, &["rifle_1000m.toml", "unknown field"]);
    assert_refused(&[&shot[..], &["--out", "trajectory.csv/o.csv"]].concat(), 1, &["trajectory.csv/o.csv"]);
}

#[test]
fn misuse_ends_with_2_and_says_what_was_expected_and_found() {
    assert_refused(&[], 2, &["Usage"]);
    assert_refused(
        &["fly", "--eye", "91,0,0"],
        2,
        &["--eye", "expected a latitude in degrees within -90..=90, found `91`"],
    );
    assert_refused(&["fly", "--eye", "--json"], 2, &["expected LAT,LON,ALT"]);
    assert_refused(&["fly", "--size", "0x0"], 2, &["expected a side of 1..=8192 whole pixels, found `0`"]);
    assert_refused(&["fly", "--size", "1e9x1"], 2, &["found `1e9`"]);
    assert_refused(&["fly", "--window", "18"], 2, &["expected 12 or 24 blocks, found `18`"]);
    assert_refused(&["fly", "--time", "noon"], 2, &["expected a time such as", "found `noon`"]);
    assert_refused(&["fly", "--speed-mps", "nan"], 2, &["expected a speed", "found `nan`"]);
    assert_refused(&["fly", "--lockstep", "--paced", "60"], 2, &["--lockstep", "--paced"]);
    assert_refused(&["fly", "--scenario", "a.toml"], 2, &["circuit, valley, range", "a.toml"]);
    assert_refused(&["bake", "--dem", "a.tif", "--out", "c"], 2, &["ends in .world", "`c`"]);
    assert_refused(&["bake", "--dem", "a.tif", "--out", "c.world", "--step", "24"], 2, &["25..=400", "found `24`"]);
    assert_refused(&["shot", "--eye", "1,2,3", "--look", "0,0", "--out", "a.jpg"], 2, &[".png", "a.jpg"]);
    assert_refused(&["sight", "--from", "1,2,3"], 2, &["--to"]);
    assert_refused(&["bench", "everything"], 2, &["ground", "frame", "bake", "mesh", "flight", "all"]);
}

#[test]
fn what_cannot_be_done_ends_with_1_also_with_json() {
    for json in [&[][..], &["--json"]] {
        let with = |arguments: &[&'static str]| [arguments, json].concat();
        assert_refused(&with(&["info", NO_WORLD]), 1, &["poligon: "]);
        assert_refused(&with(&["verify", NO_WORLD]), 1, &["poligon: "]);
        assert_refused(&with(&["height", NO_WORLD, "--points", "no/points.csv"]), 1, &["no/points.csv"]);
        assert_refused(&with(&["sight", NO_WORLD, "--from", "1,2,3", "--to", "-1,2,3:agl"]), 1, &["poligon: "]);
        assert_refused(&with(&["bake", "--dem", "no/such.tif", "--out", "new.world"]), 1, &["poligon: "]);
        assert_refused(&with(&["fly", "--world", NO_WORLD, "--headless", "--frames", "1"]), 1, &["poligon: "]);
        assert_refused(
            &with(&["shot", NO_WORLD, "--eye", "1,2,3", "--look", "0,0", "--out", "a.png"]),
            1,
            &["poligon: "],
        );
    }
}

#[test]
fn a_file_of_points_is_read_to_its_line() {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("points_with_a_gap.csv");
    std::fs::write(&path, "x_m,z_m\n1,2\n3\n").unwrap();
    let path = path.to_str().unwrap();
    assert_refused(&["height", NO_WORLD, "--points", path], 1, &[path, "expected 2 values on line 3, found 1"]);
}
