//! Shots that no table has: their ends, their rows, and what must not break them.

use sim::ballistics::column::{Column, NAMES};
use sim::ballistics::projectile::Projectile;
use sim::ballistics::trajectory::{Trajectory, TrajectoryError, fly};
use sim::case::Case;
use std::f64::consts::FRAC_PI_4;
use std::path::Path;

const SHELL: &str = "mass_kg = 43.09\ndiameter_m = 0.155\ndrag = 'G7'\nform_factor = 1.0";
const STONE: &str = "mass_kg = 1\ndrag = 'none'";
const G: f64 = 9.806_65;

fn tried(projectile: &str, case: &str) -> Result<Trajectory, TrajectoryError> {
    let projectile = Projectile::from_text(Path::new("p.toml"), projectile).unwrap();
    fly(&projectile, &Case::from_text(Path::new("c.toml"), case).unwrap(), None)
}

/// A flight whose every number is finite, with rising times.
fn flown(projectile: &str, case: &str) -> Trajectory {
    let flown = tried(projectile, case).unwrap_or_else(|error| panic!("{case}: {error}"));
    assert!(flown.rows.iter().all(|row| row.values.iter().all(|value| value.is_finite())), "{case}");
    assert!(flown.rows.windows(2).all(|pair| pair[0].values[0] <= pair[1].values[0]), "{case}");
    flown
}

fn at_end(flown: &Trajectory, column: Column) -> f64 {
    flown.end().get(column).unwrap()
}

#[test]
fn a_vacuum_parabola_is_met_at_every_row_and_at_its_end() {
    let ours = flown(STONE, "[shot]\nspeed_mps = 200\nelevation_deg = 45\nazimuth_deg = 30\nstep_m = 100");
    let v = 200.0 * FRAC_PI_4.sin();
    for row in &ours.rows {
        let (t, x, y) = (row.values[0], row.get(Column::X).unwrap(), row.get(Column::Y).unwrap());
        // RK4 is exact for a parabola; 15,000 steps of a rounding of 4 km each are 1e-8 m at the worst.
        assert!((x - v * t).abs() < 1e-8 && (y - (v * t - 0.5 * G * t * t)).abs() < 1e-8, "{t}");
        assert!((row.get(Column::Drop).unwrap() - 0.5 * G * t * t).abs() < 1e-8);
    }
    let range = 200.0 * 200.0 / G;
    assert!((ours.range_m - range).abs() < 1e-7 && (ours.fall_deg - 45.0).abs() < 1e-9);
    assert!((ours.apex_altitude_m - 100.0 * 100.0 / G).abs() < 1e-7, "v sin 45 squared over 2 g");
    assert_eq!(ours.rows.len(), 2 + (range / 100.0) as usize, "muzzle, 40 rows, end");
    for (k, row) in ours.rows[..ours.rows.len() - 1].iter().enumerate() {
        assert!((row.get(Column::X).unwrap() - 100.0 * k as f64).abs() < 1e-9);
    }
    // The plane's metres are degrees of its sphere.
    let last = ours.end();
    assert!(last.get(Column::Lat).unwrap() > 0.0 && last.get(Column::Lon).unwrap() > 0.0);
}

#[test]
fn ends_are_where_they_are_asked_for() {
    let until = |until: &str| {
        let case = format!("[shot]\nspeed_mps = 500\nelevation_deg = 20\nstep_s = 0.25\nuntil = '{until}'");
        flown(SHELL, &case)
    };
    for (text, column, value) in [
        ("t_s=3.3333", Column::Time, 3.3333),
        ("x_m=1500", Column::X, 1500.0),
        ("y_m=700", Column::Y, 700.0),
        ("speed_mps<400", Column::Speed, 400.0),
        ("mach=1.2", Column::Mach, 1.2),
        ("vy_mps=0", Column::Vy, 0.0),
        ("altitude_m>300", Column::Altitude, 300.0),
        ("drop_m>10", Column::Drop, 10.0),
        ("lat_deg=0.01", Column::Lat, 0.01),
    ] {
        let ours = until(text);
        assert_eq!(ours.end().event, text);
        let found = at_end(&ours, column);
        assert!((found - value).abs() <= 1e-9 * value.abs().max(1.0), "{text}: {found}");
        let before = &ours.rows[ours.rows.len() - 2];
        assert!(before.values[0] < at_end(&ours, Column::Time) - 1e-7, "{text}: the end's row is there once");
    }
    assert_eq!(until("range_m=1e6").end().event, "floor");
    assert_eq!(until("speed_mps>100").rows.len(), 2, "over at the muzzle: both rows");
    let limited = flown(SHELL, "[run]\nseconds = 2\noutput_dt_s = 0.5\n[shot]\nspeed_mps = 500\nelevation_deg = 20");
    assert_eq!((limited.end().event.as_str(), limited.rows.len(), at_end(&limited, Column::Time)), ("time", 5, 2.0));
}

#[test]
fn shots_without_an_end_of_their_own_end() {
    for (case, event) in [
        ("[shot]\nspeed_mps = 600\nelevation_deg = 90", "muzzle_altitude"),
        ("[initial]\naltitude_m = 800\n[shot]\nspeed_mps = 600\nelevation_deg = 3", "muzzle_altitude"),
        ("[initial]\naltitude_m = 800\n[shot]\nspeed_mps = 600", "ground"),
        ("[initial]\naltitude_m = 800\nvelocity_ned_mps = [50, 0, 0]", "ground"),
        ("[initial]\naltitude_m = 800", "ground"),
        ("[shot]\nspeed_mps = 600\nelevation_deg = -5", "ground"),
        ("[shot]\nspeed_mps = 0\nelevation_deg = 45", "ground"),
        (
            "[initial]\naltitude_m = -200\n[run]\nstop = ['ground']\n[shot]\nspeed_mps = 600\nelevation_deg = 45",
            "ground",
        ),
        ("[initial]\naltitude_m = -7000\n[shot]\nspeed_mps = 600\nelevation_deg = 45", "muzzle_altitude"),
        ("[frame]\ng_mps2 = 0\n[run]\ndt_s = 0.01\n[shot]\nspeed_mps = 600\nelevation_deg = 45", "time"),
    ] {
        let ours = flown(SHELL, case);
        assert_eq!(ours.end().event, event, "{case}");
        let at_once = case.contains("speed_mps = 0") || case.contains("-5") || case.contains("-200");
        assert_eq!(at_end(&ours, Column::Time) == 0.0, at_once, "{case}");
    }
    let up = flown(STONE, "[shot]\nspeed_mps = 100\nelevation_deg = 90\nstep_m = 10");
    assert!((at_end(&up, Column::Time) - 200.0 / G).abs() < 1e-9 && at_end(&up, Column::X).abs() < 1e-10);
    assert!((up.fall_deg - 90.0).abs() < 1e-6);
}

#[test]
fn a_muzzle_on_the_ellipsoid_is_on_the_ground_only_to_rounding() {
    // Latitudes and longitudes whose height of 0 or 100 m comes back from the frame a nanometre lower or higher.
    for i in 0..60 {
        let (lat, lon) = (-80.0 + 2.7 * f64::from(i), -175.0 + 5.9 * f64::from(i));
        for frame in ["ellipsoid", "round"] {
            for (altitude, elevation, more) in
                [(0, 20, "[run]\nstop = ['ground']"), (0, 20, ""), (100, 0, ""), (100, 5, "")]
            {
                let case = format!(
                    "[frame]\nkind = '{frame}'\n[initial]\nlat_deg = {lat}\nlon_deg = {lon}\naltitude_m = {altitude}\n{more}\n\
                     [shot]\nspeed_mps = 200\nelevation_deg = {elevation}\nazimuth_deg = {}\n",
                    5 * i
                );
                let ours = flown(SHELL, &case);
                assert!(at_end(&ours, Column::Time) > 1.0, "{case}");
            }
        }
    }
}

#[test]
fn a_shot_shorter_than_its_step_still_goes_as_far_as_it_goes() {
    // 2 v sin(e) / g of flight in a vacuum, whatever the step.
    for dt in [1e-3, 0.1, 10.0] {
        for (speed, elevation) in [(300.0, 0.05), (10.0, 0.05), (37.0, 80.0)] {
            let case = format!("[run]\ndt_s = {dt}\n[shot]\nspeed_mps = {speed}\nelevation_deg = {elevation}");
            let ours = flown(STONE, &case);
            let expected = 2.0 * speed * f64::to_radians(elevation).sin() / G;
            // RK4 is exact on a parabola; roundings of a time of 8 s.
            assert!((at_end(&ours, Column::Time) - expected).abs() < 1e-12, "{case}: {}", at_end(&ours, Column::Time));
        }
    }
}

#[test]
fn every_speed_height_and_step_gives_numbers() {
    for frame in ["flat", "round", "ellipsoid"] {
        for altitude in [-9_000.0, 0.0, 30_000.0, 80_000.0, 200_000.0] {
            for mach in [0.05, 0.9, 1.0, 5.0] {
                for dt in [0.002, 0.1, 10.0] {
                    let case = format!(
                        "[frame]\nkind = '{frame}'\n[initial]\nlat_deg = 89.99\nlon_deg = 179.999\naltitude_m = {altitude}\n\
                         [[wind]]\neast_mps = 30\n[run]\ndt_s = {dt}\nseconds = 60\n[shot]\nspeed_mps = {}\n\
                         elevation_deg = 30\nazimuth_deg = 45\nstep_s = 5",
                        mach * 300.0
                    );
                    let ours = flown(SHELL, &case);
                    assert_eq!(ours.end().event, "time", "{case}");
                    assert!(at_end(&ours, Column::Speed) < 5.0 * 300.0 + 60.0 * G, "{case}");
                }
            }
        }
    }
}

#[test]
fn a_step_may_be_long_and_the_default_is_far_from_the_limits() {
    // Differences from a step of a fifth: what the default leaves of 0.01 % of drop and 0.02 % of speed.
    for (shell, speed, elevation, until) in
        [(SHELL, 684.3, 45, "t_s=60"), ("mass_kg=0.0075\ndrag='G1'\nbc_lbpin2=0.145", 350.0, 1, "range_m=300")]
    {
        let shot = |dt: f64| {
            let case = format!(
                "[run]\ndt_s = {dt}\n[shot]\nspeed_mps = {speed}\nelevation_deg = {elevation}\nuntil = '{until}'"
            );
            let ours = flown(shell, &case);
            [Column::Drop, Column::Speed].map(|column| at_end(&ours, column))
        };
        let fine = shot(0.0004);
        for dt in [0.002, 0.01, 0.05, 0.2] {
            let coarse = shot(dt);
            let [drop, speed] = [0, 1].map(|i| (coarse[i] / fine[i] - 1.0).abs());
            println!("step {dt} s, {until}: drop {drop:.1e}, speed {speed:.1e}");
            assert!(dt > 0.002 || (drop < 1e-6 && speed < 1e-6));
        }
    }
}

#[test]
fn spin_drift_is_part_of_every_answer() {
    let spin = |right: bool| {
        format!(
            "mass_kg = 0.0113\ndiameter_m = 0.00782\ndrag = 'G7'\nbc_lbpin2 = 0.243\n\
             spin = {{twist_m = 0.2858, right = {right}, length_m = 0.0315}}"
        )
    };
    let case = "[shot]\nspeed_mps = 792\nelevation_deg = 1\nuntil = 'z_m=0.2'";
    let right = flown(&spin(true), case);
    assert!((at_end(&right, Column::Z) - 0.2).abs() < 1e-9 && at_end(&right, Column::Vz) > 0.0);
    let place = at_end(&right, Column::Lon).to_radians() * 6_371_007.180_9;
    assert!((place - 0.2).abs() < 1e-8, "north, so right is east: {place}");
    let left = flown(&spin(false), &case.replace("z_m=0.2", "z_m=-0.2"));
    assert!((at_end(&left, Column::Time) - at_end(&right, Column::Time)).abs() < 1e-9);
}

#[test]
fn flying_with_the_wind_is_flying_in_a_vacuum() {
    let case = "[frame]\ng_mps2 = 0\n[[wind]]\nnorth_mps = 300\n[run]\nseconds = 5\n[shot]\nspeed_mps = 300";
    let ours = flown(SHELL, case);
    assert_eq!((at_end(&ours, Column::Speed), at_end(&ours, Column::Mach)), (300.0, 0.0));
    assert!((at_end(&ours, Column::X) - 1500.0).abs() < 1e-9);
}

#[test]
fn the_shapes_of_the_earth_agree_near_the_muzzle_and_part_far_off() {
    let shot = |frame: &str| {
        let case = format!(
            "[frame]\n{frame}\n[initial]\nlat_deg = 40\nlon_deg = 20\n[shot]\nspeed_mps = 800\nelevation_deg = 50\nazimuth_deg = 70"
        );
        flown(SHELL, &case)
    };
    let flat = shot("kind = 'flat'\ng_mps2 = 9.80\nrotation_radps = 7.292115e-5");
    let ellipsoid = shot("kind = 'ellipsoid'");
    // 20 km: the ground falls away by 31 m, g at 40 degrees is 9.8017.
    assert!((ellipsoid.range_m / flat.range_m - 1.0).abs() < 3e-3, "{} {}", ellipsoid.range_m, flat.range_m);
    assert!(at_end(&flat, Column::Altitude).abs() < 1e-9 && at_end(&ellipsoid, Column::Altitude).abs() < 1e-6);
    let y = at_end(&ellipsoid, Column::Y);
    let curved = -ellipsoid.range_m.powi(2) / (2.0 * 6.371e6);
    assert!((y / curved - 1.0).abs() < 0.01, "{y} m under the plane of the muzzle");
}

#[test]
fn rows_read_back_to_the_same_numbers() {
    let ours = flown(SHELL, "[shot]\nspeed_mps = 500\nelevation_deg = 20\nstep_s = 1");
    let text = ours.to_csv();
    let mut lines = text.lines();
    let header = "t_s,x_m,y_m,z_m,drop_m,path_m,vx_mps,vy_mps,vz_mps,speed_mps,mach,lat_deg,lon_deg,altitude_m,event";
    assert_eq!(lines.next(), Some(header));
    for (line, row) in lines.zip(&ours.rows) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), 15);
        for (cell, value) in cells.iter().zip(row.values) {
            assert_eq!(cell.parse::<f64>(), Ok(value));
            assert!(cell.chars().all(|c| c.is_ascii_digit() || c == '.' || c == '-') && *cell != "-0", "{cell}");
        }
        assert_eq!(cells[14], row.event);
    }
    assert_eq!(NAMES[13].1, "altitude_m");
}

#[test]
fn what_contradicts_itself_is_refused_with_its_key() {
    for (case, told) in [
        ("[shot]\nspeed_mps = 5\n[initial]\nvelocity_ned_mps = [1, 0, 0]", "shot.speed_mps"),
        ("[shot]\nelevation_deg = 5", "shot.elevation_deg"),
        ("[shot]\nspeed_mps = 5\nuntil = 'range=5'", "shot.until"),
        ("[shot]\nspeed_mps = 5\n[run]\nstop = ['ground', 'alt<0']", "run.stop[1]"),
        ("[shot]\nspeed_mps = 5\nzero_range_m = 5000", "shot.zero_range_m"),
        ("[shot]\nspeed_mps = 0\nzero_range_m = 100", "shot.zero_range_m"),
        ("[turbulence]\nkind = 'dryden'\nsigma_mps = 1", "turbulence"),
        ("[trim]\nvary = []", "trim"),
    ] {
        match tried(SHELL, case) {
            Err(TrajectoryError::Input(error)) => {
                let text = error.to_string();
                assert!(text.starts_with("c.toml: ") && text.contains(told), "{case}: {text}");
            }
            other => panic!("{case}: {other:?}"),
        }
    }
    let rows = tried(SHELL, "[shot]\nspeed_mps = 500\nelevation_deg = 45\nstep_s = 1e-6");
    assert!(matches!(rows, Err(TrajectoryError::TooMuch { what: "rows", .. })));
}
