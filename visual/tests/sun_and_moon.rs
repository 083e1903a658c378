//! Sun and moon against other programs' answers, stored in `tests/data` beside the scripts that made them.

use std::f64::consts::TAU;
use visual::{moon, sun};

/// The numbers of a file's lines, without its header.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let numbers = |line: &str| line.split(',').map(|field| field.parse().expect("a number")).collect();
    text.lines().skip(1).map(numbers).collect()
}

/// Angle between two directions given as azimuth and elevation, degrees.
fn apart_deg(a: [f64; 2], b: [f64; 2]) -> f64 {
    let unit = |[azimuth_rad, elevation_rad]: [f64; 2]| terrain::frame::direction(azimuth_rad, elevation_rad);
    unit(a).angle_between(unit(b)).to_degrees()
}

#[test]
fn the_sun_is_where_pvlib_sees_it_at_a_thousand_dates_and_places() {
    let rows = rows(include_str!("data/sun_pvlib.csv"));
    assert_eq!(rows.len(), 1_000);
    let (mut worst, mut worst_azimuth, mut worst_elevation) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in &rows {
        let [unix_s, lat_deg, lon_deg, azimuth_deg, elevation_deg] = row[..] else { panic!("{row:?}") };
        let ours = sun::position(unix_s, lat_deg, lon_deg).expect("position");
        let theirs = [azimuth_deg.to_radians(), elevation_deg.to_radians()];
        let turn = (ours.true_azimuth_rad - theirs[0] + 1.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        // Near the zenith an azimuth means little: what it moves the sun by counts.
        worst_azimuth = worst_azimuth.max((turn * theirs[1].cos()).abs().to_degrees());
        worst_elevation = worst_elevation.max((ours.elevation_rad - theirs[1]).abs().to_degrees());
        worst = worst.max(apart_deg([ours.true_azimuth_rad, ours.elevation_rad], theirs));
    }
    println!("1,000 suns: worst {worst:.5} deg, azimuth {worst_azimuth:.5}, elevation {worst_elevation:.5}");
    assert!(worst < 0.05 && worst_azimuth < 0.05 && worst_elevation < 0.05, "{worst}");
}

#[test]
fn the_moon_is_where_pyephem_sees_it_and_as_full() {
    let rows = rows(include_str!("data/moon_ephem.csv"));
    assert_eq!(rows.len(), 400);
    let (mut worst, mut worst_km, mut worst_lit) = (0.0_f64, 0.0_f64, 0.0_f64);
    for row in &rows {
        let [unix_s, lat_deg, lon_deg, azimuth_deg, elevation_deg, distance_km, lit] = row[..] else {
            panic!("{row:?}")
        };
        let ours = moon::position(unix_s, lat_deg, lon_deg).expect("position");
        let theirs = [azimuth_deg.to_radians(), elevation_deg.to_radians()];
        worst = worst.max(apart_deg([ours.true_azimuth_rad, ours.elevation_rad], theirs));
        let sun = sun::position(unix_s, lat_deg, lon_deg).expect("position");
        let to_sun = terrain::frame::direction(sun.true_azimuth_rad, sun.elevation_rad);
        let to_moon = terrain::frame::direction(ours.true_azimuth_rad, ours.elevation_rad);
        worst_lit = worst_lit.max((moon::illuminated(moon::phase_rad(to_sun, to_moon)) - lit).abs());
        worst_km = worst_km.max((ours.distance_km - distance_km).abs());
    }
    println!("400 moons: worst {worst:.4} deg, {worst_lit:.4} of the disc, {worst_km:.0} km");
    // What is promised; the series leaves out 0.02 degrees and as much of the distance (130 km), nutation is 0.005 more.
    assert!(worst < 0.1, "{worst}");
    // Half a degree of phase angle changes what is lit by 0.0044; theirs is taken from the Earth's centre (up to a degree).
    assert!(worst_lit < 0.012, "{worst_lit}");
    assert!(worst_km < 200.0, "{worst_km}");
}
