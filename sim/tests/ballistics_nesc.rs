//! Balls over the turning ellipsoid against two of NASA's simulations (NASA/TM-2015-218675, cases 06, 07 and 09).
//!
//! The tables are read from `../shared/data/physics` beside the repository; where that is absent the test says so and
//! counts as skipped. A ball of a slug with Cd 0.1 at every Mach number: dropped, dropped in a steady wind, and thrown.

use sim::ballistics::column::Column;
use sim::ballistics::drag::DragCurve;
use sim::ballistics::projectile::Projectile;
use sim::ballistics::trajectory::fly;
use sim::case::Case;
use sim::table::Interpolation;
use std::path::Path;

const FOOT_M: f64 = 0.3048;
const SLUG_KG: f64 = 14.593_902_937;

/// Largest difference of place, feet, and of speed, ft/s, from one table.
fn compared(folder: &str, file: &str, case_text: &str) -> Option<[f64; 2]> {
    let name = format!("nesc/NESC_data/Atmospheric_checkcases/{folder}/{file}");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/physics").join(&name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: no ../shared/data/physics/{name}");
        return None;
    };
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    let column = |name: &str| names.iter().position(|known| *known == name).unwrap();
    let [time, altitude, lon, lat] = ["time", "altitudeMsl_ft", "longitude_deg", "latitude_deg"].map(column);
    let velocity = ["feVelocity_ft_s_X", "feVelocity_ft_s_Y", "feVelocity_ft_s_Z"].map(column);

    let ball = format!("mass_kg = {SLUG_KG}\ndrag = 'G1'\ndrag_area_m2 = {}", 0.196_349_5 * FOOT_M * FOOT_M);
    let mut ball = Projectile::from_text(Path::new("ball.toml"), &ball).unwrap();
    ball.drag.as_mut().unwrap().curve = DragCurve::new(&[[0.0, 0.1]], Interpolation::Linear).unwrap();
    // Their times are sums in single precision.
    let step_s = rows.last().unwrap()[time] / (rows.len() - 1) as f64;
    let last_s = rows.last().unwrap()[time];
    let text =
        format!("[frame]\nkind = 'ellipsoid'\n{case_text}\n[run]\nseconds = {last_s}\n[shot]\nstep_s = {step_s}");
    let case = Case::from_text(Path::new("c.toml"), &text).unwrap();
    let ours = fly(&ball, &case, None).unwrap();
    assert_eq!(ours.rows.len(), rows.len(), "{name}");
    let mut worst = [0.0f64; 2];
    for (ours, theirs) in ours.rows.iter().zip(&rows) {
        let value = |column| ours.get(column).unwrap();
        assert!((value(Column::Time) - theirs[time]).abs() < 1e-5);
        let up = value(Column::Altitude) / FOOT_M - theirs[altitude];
        let radius_ft = 6_378_137.0 / FOOT_M;
        let east = (value(Column::Lon) - theirs[lon]).to_radians() * radius_ft;
        let north = (value(Column::Lat) - theirs[lat]).to_radians() * radius_ft;
        let speed = velocity.iter().map(|&i| theirs[i].powi(2)).sum::<f64>().sqrt();
        worst[0] = worst[0].max(up.abs()).max(east.abs()).max(north.abs());
        worst[1] = worst[1].max((value(Column::Speed) / FOOT_M - speed).abs());
    }
    println!("{file}: {:.5} ft, {:.6} ft/s over {} rows", worst[0], worst[1], rows.len());
    Some(worst)
}

#[test]
fn balls_over_the_ellipsoid_are_where_nasa_s_simulations_have_them() {
    let dropped = "[initial]\nlat_deg = 0\nlon_deg = 0\naltitude_m = 9144";
    // 20 ft/s from the west.
    let windy = format!("{dropped}\n[[wind]]\neast_mps = {}", 20.0 * FOOT_M);
    let thrown = "[initial]\nlat_deg = 0\nlon_deg = 0\naltitude_m = 0\nvelocity_ned_mps = [0, 304.8, -304.8]";
    for (folder, case, text, limits) in [
        ("Atmos_06_DroppedSphereEllipsoidalNoWind", "06", dropped, [0.005, 0.0005]),
        ("Atmos_07_DroppedSphereSteadyWind", "07", &windy, [0.005, 0.0005]),
        ("Atmos_09_EastwardCannonball", "09", thrown, [0.02, 0.002]),
    ] {
        for sim in ["04", "05"] {
            let Some(worst) = compared(folder, &format!("Atmos_{case}_sim_{sim}.csv"), text) else { return };
            assert!(worst[0] <= limits[0] && worst[1] <= limits[1], "case {case}, sim {sim}: {worst:?}");
        }
    }
}
