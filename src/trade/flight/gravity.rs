//! What a scene must model of the Earth and the air: a sphere dropped from 30,000 ft, and one shot up at 45 degrees to
//! the east and to the north, 30 s each, from 0 N 0 E, over Earths of rising depth.
//!
//! Setting: the place in the row of models, from the plainest on; each adds to the one before, the two without the
//! right air stand first. Reference: the ellipsoid with J2 and rotation. Error: metres after 30 s, its height and its
//! way over the ground beside it. Cost: nanoseconds a step.
//!
//! Source: NASA/TM-2015-218675, check cases 6, 9 and 10 (the sphere and the starts).

use super::{Effort, costs_s};
use crate::failure::Failure;
use crate::report::{Knob, KnobPoint};
use glam::DVec3;
use sim::ballistics::drag::DragCurve;
use sim::ballistics::motion::{ShellMotion, State, advance, parts, state};
use sim::ballistics::projectile::{Drag, Projectile};
use sim::case::Case;
use sim::integrate::Integrator;
use sim::planet::{Planet, Shape};
use std::hint::black_box;
use std::path::{Path, PathBuf};

const FOOT_M: f64 = 0.3048;
const SECONDS: f64 = 30.0;
/// A power of two, so that the grid of time is exact.
const STEP_S: f64 = 1.0 / 64.0;
/// The Earth's radius at the equator, and that of its meridian's bend there, metres (WGS84: a, a (1 - e2)).
const EQUATOR_M: f64 = 6_378_137.0;
const MERIDIAN_M: f64 = 6_335_439.327;
/// One slug.
const MASS_KG: f64 = 14.593_902_937;
const AREA_M2: f64 = 0.196_349_5 * FOOT_M * FOOT_M;
const CD: f64 = 0.1;

/// Gravity at the equator as a plumb line shows it, m/s2, and the gravitation of a sphere that gives it, m3/s2; by
/// WGS84's GM, J2 and rotation: GM / a2 (1 + 1.5 J2), less omega2 a.
const PLUMB: &str = "9.780281647";
const ROUND_GM: &str = "3.992477468868e14";

/// A name, and the case's `[frame]` and `[atmosphere]`; `OMEGA` and others are replaced by their numbers.
const MODELS: [(&str, &str); 8] = [
    ("no air", "[frame]\ng_mps2 = PLUMB\n[atmosphere]\nmodel = 'none'"),
    ("air as at sea level", "[frame]\ng_mps2 = PLUMB\n[atmosphere]\nmodel = 'constant'"),
    ("flat, g 9.80665", "[frame]\ng_mps2 = 9.80665"),
    ("flat, local g", "[frame]\ng_mps2 = PLUMB"),
    ("+ Coriolis", "[frame]\ng_mps2 = PLUMB\nrotation_radps = OMEGA"),
    ("+ g(h)", "[frame]\ng_mps2 = PLUMB\nrotation_radps = OMEGA\ngravity = 'inverse_square'\nradius_m = 6378137"),
    ("round, turning", "[frame]\nkind = 'round'\nradius_m = 6378137\ngm_m3ps2 = ROUND_GM\nrotation_radps = OMEGA"),
    ("ellipsoid, J2", "[frame]\nkind = 'ellipsoid'"),
];

/// A name, the height in feet, and the velocity north, east, down in feet a second.
const STARTS: [(&str, f64, [f64; 3]); 3] = [
    ("gravity drop", 30_000.0, [0.0; 3]),
    ("gravity shot east", 0.0, [0.0, 1_000.0, -1_000.0]),
    ("gravity shot north", 0.0, [1_000.0, 0.0, -1_000.0]),
];

/// Where a flight ends: over the ground to the north and east, and up, metres.
type End = DVec3;

fn case(frame: &str, height_ft: f64) -> Result<Case, Failure> {
    let frame = frame.replace("PLUMB", PLUMB).replace("ROUND_GM", ROUND_GM).replace("OMEGA", "7.292115e-5");
    let text = format!("{frame}\n[initial]\nlat_deg = 0\nlon_deg = 0\naltitude_m = {:?}", height_ft * FOOT_M);
    Case::from_text(Path::new("gravity"), &text).map_err(|error| Failure::while_doing("reading a built-in case", error))
}

fn sphere() -> Result<Projectile, Failure> {
    let curve = DragCurve::new(&[[0.0, CD], [20.0, CD]], sim::table::Interpolation::Linear)
        .map_err(|why| Failure::while_doing("making a sphere", why))?;
    Ok(Projectile {
        drag_file: None,
        file: PathBuf::from("sphere"),
        mass_kg: MASS_KG,
        diameter_m: None,
        drag: Some(Drag { curve, drag_m2pkg: AREA_M2 / (2.0 * MASS_KG) }),
        spin: None,
        burn: Vec::new(),
    })
}

/// Its motion and its start.
fn start<'a>(projectile: &'a Projectile, case: &'a Case, ned_fps: [f64; 3]) -> (ShellMotion<'a>, State) {
    let place = case.initial.place;
    let velocity = case.planet.frame_from_ned(place) * (DVec3::from_array(ned_fps) * FOOT_M);
    let motion = ShellMotion::new(projectile, case.planet, &case.atmosphere, &case.wind, DVec3::X);
    (motion, state(case.planet.position_m(place), velocity))
}

fn flown(motion: &ShellMotion, start: &State, seconds: f64) -> Result<State, Failure> {
    let mut y = *start;
    for step in 0..(seconds / STEP_S).round() as u32 {
        let t_s = f64::from(step) * STEP_S;
        let stepped = advance(Integrator::Rk4, motion, t_s, &y, STEP_S, &mut None);
        (y, _) = stepped.map_err(|error| Failure::while_doing("dropping a sphere", error))?;
    }
    Ok(y)
}

fn end(planet: &Planet, y: &State) -> End {
    let (position, _) = parts(y);
    let place = planet.place(position);
    match planet.shape {
        Shape::Flat { .. } => DVec3::new(position.x, position.y, -position.z),
        Shape::Round { radius_m } => DVec3::new(place.lat_rad * radius_m, place.lon_rad * radius_m, place.altitude_m),
        // Within 6 km of the equator a meridian's bend changes by 1e-8.
        Shape::Ellipsoid => DVec3::new(place.lat_rad * MERIDIAN_M, place.lon_rad * EQUATOR_M, place.altitude_m),
    }
}

/// A knob for each start.
///
/// # Errors
/// [`Failure::Failed`] if a built-in case cannot be flown.
pub fn knobs(effort: Effort) -> Result<Vec<Knob>, Failure> {
    let projectile = sphere()?;
    let mut knobs = Vec::new();
    for (name, height_ft, ned_fps) in STARTS {
        let cases = MODELS.map(|(_, frame)| case(frame, height_ft));
        let cases: Vec<Case> = cases.into_iter().collect::<Result<_, _>>()?;
        let mut ends = Vec::new();
        for case in &cases {
            let (motion, start) = start(&projectile, case, ned_fps);
            ends.push(end(&case.planet, &flown(&motion, &start, SECONDS)?));
        }
        let mut works: Vec<Box<dyn FnMut() + '_>> = Vec::new();
        for case in &cases {
            let (motion, start) = start(&projectile, case, ned_fps);
            works.push(Box::new(move || {
                let _ = black_box(flown(&motion, black_box(&start), SECONDS));
            }));
        }
        let costs_s = costs_s(effort.rounds, &mut works)?;
        let Some(reference) = ends.last().copied() else { continue };
        let points = MODELS.iter().zip(&ends).zip(costs_s).enumerate().map(|(at, (((label, _), end), cost_s))| {
            let off = *end - reference;
            KnobPoint {
                setting: at as f64,
                error: off.length(),
                cost: cost_s * 1e9 * STEP_S / SECONDS,
                label: Some((*label).into()),
                error_height: Some(off.z.abs()),
                error_horizontal: Some(off.truncate().length()),
                ..KnobPoint::default()
            }
        });
        knobs.push(Knob {
            name: name.into(),
            unit: "model of the Earth".into(),
            error_unit: "m from the ellipsoid's after 30 s".into(),
            cost_unit: "ns a step of rk4".into(),
            points: points.collect(),
            ..Knob::default()
        });
    }
    Ok(knobs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Height and way over the ground in feet for each start, rows in the order of [`MODELS`] from the first to g(h): our
    /// own flat models by an independent integration (SciPy's DOP853) against the median of NASA's check cases.
    const PUBLISHED_FT: [[[f64; 2]; 6]; 2] = [
        [[723.842, 19.495], [655.479, 19.495], [69.463, 19.495], [34.455, 19.495], [34.434, 0.066], [0.061, 0.017]],
        [
            [5_400.51, 7_485.893],
            [561.446, 831.358],
            [98.365, 43.617],
            [65.438, 42.9],
            [19.197, 16.612],
            [11.469, 16.502],
        ],
    ];
    /// How far that median is from the two simulations that agree with each other, feet: the price of its outliers.
    const MEDIAN_OFF_FT: [[f64; 2]; 2] = [[0.006, 0.0], [0.886, 1.002]];
    /// How far those two are from each other at most, feet, and half a digit of the table.
    const AGREED_FT: f64 = 0.014 + 0.0005;

    #[test]
    fn the_ladder_is_the_published_one() {
        let knobs = knobs(Effort { quick: true, rounds: 1 }).unwrap();
        for ((knob, rows), off_ft) in knobs.iter().zip(&PUBLISHED_FT).zip(&MEDIAN_OFF_FT) {
            for (point, published) in knob.points.iter().zip(rows) {
                let ours = [point.error_height, point.error_horizontal].map(|metres| metres.unwrap() / FOOT_M);
                println!("{} {:?}: {ours:.3?} ft, published {published:?}", knob.name, point.label);
                // The published g(h) lets the centrifugal part grow with height, ours does not: 3 omega2 h of acceleration,
                // from 30,000 ft at the most.
                let grows = point.label.as_deref() == Some("+ g(h)");
                let left_out_ft = 3.0 * sim::planet::EARTH_ROTATION_RADPS.powi(2) * 30_000.0 * SECONDS * SECONDS / 2.0;
                let left_out_ft = if grows { left_out_ft } else { 0.0 };
                for part in 0..2 {
                    let gap_ft = (ours[part] - published[part]).abs();
                    assert!(
                        gap_ft < off_ft[part] + AGREED_FT + left_out_ft,
                        "{} {:?}: {gap_ft} ft",
                        knob.name,
                        point.label
                    );
                }
            }
        }
        // The table to the north has whole feet, and the simulations behind its median are not at hand: shown only.
        for point in &knobs[2].points {
            let ours = [point.error_height, point.error_horizontal].map(|metres| metres.unwrap() / FOOT_M);
            println!("{} {:?}: {ours:.3?} ft", knobs[2].name, point.label);
        }
    }
}
