//! Trajectories against tables: our own by another integrator, third parties' and a navy's.
//!
//! What is ours lies in `tests/data`; what is not is read from `../shared/data/physics` beside the repository, and where
//! that is absent the test says so and counts as skipped.

use sim::ballistics::column::Column;
use sim::ballistics::projectile::Projectile;
use sim::ballistics::trajectory::{Trajectory, fly};
use sim::case::Case;
use std::path::{Path, PathBuf};

const YARD_M: f64 = 0.9144;
const FOOT_M: f64 = 0.3048;
const INCH_M: f64 = 0.0254;

fn own_data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/ballistics").join(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A file beside the repository; says so if it is not there.
fn shared(name: &str) -> Option<String> {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/physics").join(name);
    match std::fs::read(&path) {
        // Old programs wrote their degree signs in other encodings.
        Ok(bytes) => Some(String::from_utf8_lossy(&bytes).into_owned()),
        Err(error) => {
            println!("skipped: ../shared/data/physics/{name}: {error}");
            None
        }
    }
}

fn projectile(text: &str) -> Projectile {
    Projectile::from_text(Path::new("p.toml"), text).unwrap()
}

fn case(text: &str) -> Case {
    Case::from_text(Path::new("c.toml"), text).unwrap()
}

fn flown(projectile_text: &str, case_text: &str) -> Trajectory {
    fly(&projectile(projectile_text), &case(case_text), None).unwrap()
}

/// The rows of a CSV file, numbers by column name.
fn rows(text: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let names = lines.next().unwrap().split(',').collect();
    (names, lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect())
}

/// The largest of numbers with what is said about it.
#[derive(Default)]
struct Worst {
    value: f64,
    at: String,
}

impl Worst {
    fn see(&mut self, value: f64, at: impl FnOnce() -> String) {
        assert!(value.is_finite());
        if value > self.value {
            *self = Self { value, at: at() };
        }
    }
}

#[test]
fn small_arms_and_a_30_mm_follow_an_independent_integration() {
    for (name, table, bc, speed, elevation_rad, until, step) in [
        ("308_175gr_G7", "G7", 0.243, 792.48, 0.0058f64, 1500, 50),
        ("308_168gr_G1", "G1", 0.462, 807.72, 0.0058, 1500, 50),
        ("30mm_like_G1", "G1", 0.65, 1005.0, 0.01, 3000, 50),
        ("9mm_G1", "G1", 0.145, 350.0, 0.005, 300, 10),
    ] {
        let text = own_data(&format!("traj_{name}.csv"));
        let (_, expected) = rows(&text);
        let ours = flown(
            &format!("mass_kg = 0.01\ndrag = '{table}'\nbc_lbpin2 = {bc}"),
            &format!(
                "[shot]\nspeed_mps = {speed}\nelevation_deg = {}\nuntil = 'range_m={until}'\nstep_m = {step}",
                elevation_rad.to_degrees()
            ),
        );
        assert_eq!(ours.rows.len(), expected.len(), "{name}");
        let (mut own_drop, mut own_speed, mut pb_drop, mut pb_speed) =
            (Worst::default(), Worst::default(), Worst::default(), Worst::default());
        for (row, expected) in ours.rows.iter().zip(&expected).skip(1) {
            let [x, _, pb_y, _, pb_v, _, own_y, _, own_v] = expected[..] else { panic!("{expected:?}") };
            assert!((row.get(Column::X).unwrap() - x).abs() < 1e-9 * x);
            let drop = |y: f64| x * elevation_rad.tan() - y;
            let (ours_drop, speed) = (row.get(Column::Drop).unwrap(), row.get(Column::Speed).unwrap());
            own_drop.see((ours_drop / drop(own_y) - 1.0).abs(), || format!("{x} m"));
            own_speed.see((speed / own_v - 1.0).abs(), || format!("{x} m"));
            pb_drop.see((ours_drop / drop(pb_y) - 1.0).abs(), || format!("{x} m"));
            pb_speed.see((speed / pb_v - 1.0).abs(), || format!("{x} m"));
        }
        println!(
            "{name}: own drop {:.2e} at {}, speed {:.2e} at {}; pb drop {:.2e} at {}, speed {:.2e} at {}",
            own_drop.value, own_drop.at, own_speed.value, own_speed.at, pb_drop.value, pb_drop.at, pb_speed.value,
            pb_speed.at
        );
        assert!(own_drop.value < 1e-4 && own_speed.value < 2e-4, "{name}");
        assert!(pb_drop.value < 1e-3 && pb_speed.value < 1e-3, "{name}");
    }
}

#[test]
fn a_155_mm_shell_follows_an_independent_integration() {
    let text = own_data("shell155_G7.csv");
    let (names, expected) = rows(&text);
    assert_eq!(names[3..], ["range_m", "tof_s", "impact_v_mps", "angle_of_fall_deg", "apex_m"]);
    let mut worst: [Worst; 5] = Default::default();
    for row in &expected {
        let [elevation, speed, bc, ref sums @ ..] = row[..] else { panic!("{row:?}") };
        let ours = flown(
            &format!("mass_kg = 43.09\ndiameter_m = 0.155\ndrag = 'G7'\nbc_lbpin2 = {bc}"),
            &format!("[shot]\nspeed_mps = {speed}\nelevation_deg = {elevation}"),
        );
        let end = ours.end();
        assert_eq!(end.event, "muzzle_altitude");
        let found = [
            ours.range_m,
            end.get(Column::Time).unwrap(),
            end.get(Column::Speed).unwrap(),
            ours.fall_deg,
            ours.apex_altitude_m,
        ];
        for ((worst, found), expected) in worst.iter_mut().zip(found).zip(sums) {
            worst.see((found / expected - 1.0).abs(), || format!("{elevation} deg, {speed} m/s"));
        }
    }
    for (worst, name) in worst.iter().zip(&names[3..]) {
        println!("155 mm: {name} {:.2e} at {}", worst.value, worst.at);
    }
    // Those rows take geometric height for geopotential (16 m at 10 km) and let the troposphere's lapse run on above
    // 11 km: the air of ours is up to 0.2 % denser at the apex.
    assert!(worst.iter().all(|worst| worst.value < 1e-3));
}

/// A table of the form `range;path;..` in yards, inches, ft/s, with its header's shot.
fn third_party(name: &str) -> Option<Vec<Vec<f64>>> {
    let text = shared(&format!("ballistics/ballisticcalculator1/{name}"))?;
    let number = |cell: &str| cell.trim().parse::<f64>().ok();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| line.split(';').map(|cell| number(cell).unwrap_or(f64::NAN)).collect())
        .collect();
    assert!(rows.len() > 20, "{name}");
    Some(rows)
}

const HUMID: &str =
    "[atmosphere]\nstation = {altitude_m = 0, temperature_K = 288.15, pressure_Pa = 101320.75, humidity = 0.78}\n";

/// Allowed: the share, or half the last printed digit.
fn within(found: f64, expected: f64, share: f64, half_digit: f64) -> f64 {
    (found - expected).abs() / (share * expected.abs()).max(half_digit)
}

/// Our rows at the same ranges, with the sight's line as they have it.
fn compare_g(name: &str, table: &str, bc: f64, mv_ftps: f64, sight_in: f64, zero_yd: f64, more: &str) -> Option<Trajectory> {
    let expected = third_party(name)?;
    let ours = flown(
        &format!("mass_kg = 0.0042\ndrag = '{table}'\nbc_lbpin2 = {bc}"),
        &format!(
            "{HUMID}{more}[shot]\nspeed_mps = {}\nzero_range_m = {}\nsight_height_m = {}\nstep_m = {}\nuntil = 'range_m={}'",
            mv_ftps * FOOT_M,
            zero_yd * YARD_M,
            sight_in * INCH_M,
            50.0 * YARD_M,
            1000.0 * YARD_M,
        ),
    );
    assert_eq!(ours.rows.len(), expected.len());
    let (mut speed, mut path, mut time) = (Worst::default(), Worst::default(), Worst::default());
    let (mut speed_share, mut path_share) = (Worst::default(), Worst::default());
    for (row, expected) in ours.rows.iter().zip(&expected) {
        let yards = expected[0];
        let at = || format!("{yards} yd");
        let (v, p) = (row.get(Column::Speed).unwrap() / FOOT_M, row.get(Column::Path).unwrap() / INCH_M);
        speed.see(within(v, expected[5], 3e-4, 0.05), at);
        path.see(within(p, expected[1], 3e-4, 0.05), at);
        time.see(within(row.get(Column::Time).unwrap(), expected[8], 3e-4, 5e-4), at);
        speed_share.see((v / expected[5] - 1.0).abs(), at);
        path_share.see(if expected[1].abs() > 20.0 { (p / expected[1] - 1.0).abs() } else { 0.0 }, at);
    }
    println!(
        "{name}: of 0.03 % or half a digit: speed {:.2} at {} ({:.1e}), path {:.2} at {} ({:.1e} beyond 20 in), time {:.2} at {}",
        speed.value, speed.at, speed_share.value, path.value, path.at, path_share.value, time.value, time.at
    );
    assert!(speed.value <= 1.0, "{name}: speed");
    Some(ours)
}

#[test]
fn third_party_g1_and_g7_tables_are_met() {
    compare_g("g1_nowind.txt", "G1", 0.365, 2600.0, 2.5, 100.0, "");
    compare_g("g7_nowind.txt", "G7", 0.465, 3200.0, 3.2, 300.0, "");
    // From behind on the left: 20 mph at 30 degrees blows downrange and to the right.
    let (along, across) = (20.0 * 0.44704 * 30f64.to_radians().cos(), 20.0 * 0.44704 * 30f64.to_radians().sin());
    let wind = format!("[[wind]]\nnorth_mps = {along}\neast_mps = {across}\n");
    if let Some(ours) = compare_g("g1_wind.txt", "G1", 0.365, 2600.0, 2.5, 100.0, &wind) {
        let expected = third_party("g1_wind.txt").unwrap();
        let mut aside = Worst::default();
        for (row, expected) in ours.rows.iter().zip(&expected) {
            let inches = row.get(Column::Z).unwrap() / INCH_M;
            aside.see((inches - expected[3]).abs(), || format!("{} yd: {inches} in", expected[0]));
        }
        println!("g1_wind: aside {:.3} in at {}", aside.value, aside.at);
    }
}
