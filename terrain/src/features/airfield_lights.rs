//! The lights of an airfield, from its geometry alone.
//!
//! Frame and standing: [`super::light_point`]. Nothing here knows a file: where the runway is said to be lit, it gets the
//! lights that its length and surface would have. A runway's lights are made for both of its directions.
//!
//! Source: ICAO Annex 14 volume I, 8th edition: 5.2.5 (aiming point), 5.3.3 (beacon), 5.3.4 (approach lights), 5.3.5
//! (PAPI), 5.3.9 to 5.3.11 (edge, threshold, end), 5.3.18 (taxiway edge), 5.3.24 (apron), 6.2 (obstacles); intensities
//! and beams after its appendix 2.

use super::light_point::{BLUE, Beam, COOL, DARK, GREEN, LightPoint, Lit, RED, WHITE, YELLOW};
use super::model::{Airfield, Features, Runway, RunwaySurface};
use glam::{DVec2, DVec3};

/// From one edge light to the next, at most, metres.
pub const EDGE_SPACING_M: f64 = 60.0;
/// Edge, threshold and end lights stand this far outside the runway, metres.
pub const OUTSIDE_M: f64 = 1.5;
/// Glide slope that a PAPI shows, degrees.
pub const GLIDE_DEG: f64 = 3.0;
/// Elevations of the four units' red-white borders, from the unit nearest the runway outwards, degrees.
pub const PAPI_DEG: [f64; 4] = [3.5, 3.0 + 10.0 / 60.0, 3.0 - 10.0 / 60.0, 2.5];
/// Whole angle over which a unit turns from red to white, degrees: 3 minutes of arc.
pub const PAPI_TRANSITION_DEG: f64 = 3.0 / 60.0;
/// Runways at least this long and paved have precision approach lights of category I, metres.
pub const PRECISION_FROM_M: f64 = 1_800.0;
/// Shorter paved runways than this have no approach lights, metres.
pub const SIMPLE_FROM_M: f64 = 800.0;
/// Masts from this height on carry obstruction lights, metres.
pub const OBSTRUCTION_FROM_M: f32 = 45.0;

/// Height of what stands beside a runway, metres.
const LOW_M: f32 = 0.35;

/// All lights of a world's airfields and masts.
pub fn all(features: &Features) -> Vec<LightPoint> {
    let mut lights: Vec<LightPoint> = features.airfields.iter().flat_map(airfield).collect();
    for mast in features.masts.iter().filter(|mast| mast.height_m >= OBSTRUCTION_FROM_M) {
        obstruction(mast.at, mast.height_m, &mut lights);
    }
    lights
}

/// The lights of one airfield; none if no runway is lit.
pub fn airfield(field: &Airfield) -> Vec<LightPoint> {
    let mut lights = Vec::new();
    let lit: Vec<&Runway> = field.runways.iter().filter(|runway| runway.lit && length_m(runway) > 1.0).collect();
    for runway in &lit {
        for end in [0, 1] {
            direction(runway, end, &mut lights);
        }
        edges(runway, &mut lights);
    }
    let Some(longest) = lit.iter().max_by(|a, b| length_m(a).total_cmp(&length_m(b))) else { return lights };
    taxiways(field, &mut lights);
    for apron in &field.aprons {
        floods(apron, &mut lights);
    }
    lights.push(beacon(field, longest));
    lights
}

/// Distance from the threshold to the aiming point's near edge (Annex 14, table 5-1), metres.
pub fn aiming_point_m(runway_length_m: f64) -> f64 {
    match runway_length_m {
        length_m if length_m < 800.0 => 150.0,
        length_m if length_m < 1_200.0 => 250.0,
        length_m if length_m < 2_400.0 => 300.0,
        _ => 400.0,
    }
}

/// Length between the thresholds, metres.
pub fn length_m(runway: &Runway) -> f64 {
    runway.ends[0].distance(runway.ends[1])
}

fn is_paved(runway: &Runway) -> bool {
    matches!(runway.surface, RunwaySurface::Asphalt | RunwaySurface::Concrete)
}

/// Unit plan vector of landing at an end, and the one to its right.
fn ahead_and_right(runway: &Runway, end: usize) -> (DVec2, DVec2) {
    let ahead = (runway.ends[1 - end] - runway.ends[end]).normalize_or(DVec2::NEG_Y);
    (ahead, DVec2::new(-ahead.y, ahead.x))
}

/// A plan direction raised by an elevation, degrees.
fn raised(plan: DVec2, elevation_deg: f64) -> DVec3 {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    DVec3::new(plan.x * cos, sin, plan.y * cos)
}

fn two_sided(at: DVec2, colours: [[f32; 3]; 2], intensity_cd: f32, axis: DVec3, half_deg: [f32; 2]) -> LightPoint {
    LightPoint {
        at,
        above_m: LOW_M,
        colour: colours[0],
        back: colours[1],
        intensity_cd,
        axis,
        half_rad: half_deg.map(f32::to_radians),
        beam: Beam::TwoSided,
        lit: Lit::Dusk,
    }
}

/// Edge lights, white all around and stronger along the runway; there yellow over the last 600 m or third of each direction's run, whichever is less.
fn edges(runway: &Runway, lights: &mut Vec<LightPoint>) {
    let length_m = length_m(runway);
    let (ahead, right) = ahead_and_right(runway, 0);
    let gaps = (length_m / EDGE_SPACING_M).ceil().clamp(1.0, 1_000.0) as u32;
    let caution_m = (length_m / 3.0).min(600.0);
    let intensity_cd = if is_paved(runway) { 5_000.0 } else { 200.0 };
    // All around for who circles: at least 50 cd; at places without other lights 25 will do (5.3.9.8, 5.3.9.9).
    // Along a paved runway its beams' yellow must stay yellow.
    let (around, around_cd) = if is_paved(runway) { (Beam::Beside, 50.0) } else { (Beam::Even, 25.0) };
    let seen = |left_m: f64| if is_paved(runway) && left_m < caution_m { YELLOW } else { WHITE };
    for number in 0..=gaps {
        let along_m = length_m * f64::from(number) / f64::from(gaps);
        // In front: seen by who lands at the first end and so comes along `ahead`.
        let colours = [seen(length_m - along_m), seen(along_m)];
        for side in [-1.0, 1.0] {
            let out_m = 0.5 * f64::from(runway.width_m) + OUTSIDE_M;
            let at = runway.ends[0] + ahead * along_m + right * (side * out_m);
            let beam = two_sided(at, colours, intensity_cd, raised(-ahead, 3.5), [8.0, 5.0]);
            let LightPoint { axis, half_rad, .. } = beam;
            lights.push(beam);
            lights.push(LightPoint { axis, half_rad, beam: around, ..LightPoint::even(at, LOW_M, WHITE, around_cd) });
        }
    }
}

/// Threshold, end, PAPI and approach lights of one direction.
fn direction(runway: &Runway, end: usize, lights: &mut Vec<LightPoint>) {
    let (ahead, right) = ahead_and_right(runway, end);
    let threshold = runway.ends[end];
    let length_m = length_m(runway);
    let half_width_m = 0.5 * f64::from(runway.width_m) + OUTSIDE_M;
    let precision = is_paved(runway) && length_m >= PRECISION_FROM_M;
    let place = |before_m: f64, right_m: f64| threshold - ahead * before_m + right * right_m;

    // Green towards who comes, 3 m apart before a precision runway, else six.
    let count = if precision { (2.0 * half_width_m / 3.0).ceil().clamp(6.0, 60.0) as u32 } else { 6 };
    for number in 0..count {
        let across_m = half_width_m * (2.0 * f64::from(number) / f64::from(count - 1) - 1.0);
        lights.push(two_sided(place(OUTSIDE_M, across_m), [GREEN, DARK], 5_000.0, raised(-ahead, 5.5), [8.0, 6.0]));
    }
    // Red towards who has landed from the other side.
    for number in 0..6 {
        let across_m = half_width_m * (2.0 * f64::from(number) / 5.0 - 1.0);
        lights.push(two_sided(place(OUTSIDE_M, across_m), [RED, DARK], 2_500.0, raised(ahead, 2.5), [8.0, 5.0]));
    }
    if is_paved(runway) && length_m >= SIMPLE_FROM_M {
        papi(runway, end, lights);
        let mut lamp = |before_m: f64, right_m: f64| {
            let intensity_cd = if precision { 20_000.0 } else { 5_000.0 };
            let axis = raised(-ahead, if before_m > 450.0 { 6.5 } else { 5.5 });
            let light = two_sided(place(before_m, right_m), [WHITE, DARK], intensity_cd, axis, [12.0, 8.0]);
            lights.push(LightPoint { lit: Lit::Always, ..light });
        };
        if precision {
            // Barrettes 4 m wide every 30 m out to 900 m, a crossbar 30 m wide at 300 m.
            for bar in 1..=30 {
                for number in -2..=2 {
                    lamp(30.0 * f64::from(bar), f64::from(number));
                }
            }
            for number in 2..=7 {
                lamp(300.0, -15.0 + 2.6 * f64::from(number - 2));
                lamp(300.0, 15.0 - 2.6 * f64::from(number - 2));
            }
        } else {
            // Single lights every 60 m out to 420 m, a crossbar 18 m wide at 300 m.
            for number in 1..=7 {
                lamp(60.0 * f64::from(number), 0.0);
            }
            for number in 1..=3 {
                lamp(300.0, 3.0 * f64::from(number));
                lamp(300.0, -3.0 * f64::from(number));
            }
        }
    }
}

/// Four units on the left beside the aiming point, the nearest 15 m from the runway's edge and 9 m between them.
fn papi(runway: &Runway, end: usize, lights: &mut Vec<LightPoint>) {
    let (ahead, right) = ahead_and_right(runway, end);
    let abeam = runway.ends[end] + ahead * aiming_point_m(length_m(runway));
    for (number, border_deg) in (0..).zip(PAPI_DEG) {
        let out_m = 0.5 * f64::from(runway.width_m) + 15.0 + 9.0 * f64::from(number);
        lights.push(LightPoint {
            at: abeam - right * out_m,
            above_m: 0.0,
            colour: COOL,
            back: RED,
            intensity_cd: 40_000.0,
            axis: raised(-ahead, border_deg),
            half_rad: [10f32.to_radians(), 10f32.to_radians()],
            beam: Beam::Slope { transition_rad: PAPI_TRANSITION_DEG.to_radians() as f32 },
            lit: Lit::Always,
        });
    }
}

/// Blue on both sides of taxiways, but not on a runway or on another taxiway.
fn taxiways(field: &Airfield, lights: &mut Vec<LightPoint>) {
    const MOST: usize = 20_000;
    let on_runway = |at: DVec2| {
        field.runways.iter().any(|runway| distance_m(at, &runway.ends) < 0.5 * f64::from(runway.width_m) + 4.0)
    };
    let before = lights.len();
    for (own, (way, width_m)) in field.taxiways.iter().enumerate() {
        let out_m = 0.5 * f64::from(*width_m) + OUTSIDE_M;
        let on_another = |at: DVec2| {
            field.taxiways.iter().enumerate().any(|(other, (way, width_m))| {
                other != own && distance_m(at, way) < 0.5 * f64::from(*width_m) + 0.5 * OUTSIDE_M
            })
        };
        along(way, 0.5 * EDGE_SPACING_M, |at, ahead| {
            let right = DVec2::new(-ahead.y, ahead.x);
            for side in [-1.0, 1.0] {
                let at = at + right * (side * out_m);
                if lights.len() - before < MOST && !on_runway(at) && !on_another(at) {
                    lights.push(LightPoint::even(at, LOW_M, BLUE, 8.0));
                }
            }
        });
    }
}

/// Flood lights on poles around an apron.
fn floods(outline: &[DVec2], lights: &mut Vec<LightPoint>) {
    let mut ring = outline.to_vec();
    ring.extend(outline.first());
    along(&ring, 80.0, |at, _| lights.push(LightPoint::even(at, 18.0, COOL, 900.0)));
}

/// White and green by turns, 24 flashes a minute, off the side of the longest runway or over the first apron.
fn beacon(field: &Airfield, longest: &Runway) -> LightPoint {
    let (_, right) = ahead_and_right(longest, 0);
    let middle = longest.ends[0].midpoint(longest.ends[1]);
    let at = match field.aprons.first() {
        Some(apron) if !apron.is_empty() => apron.iter().sum::<DVec2>() / apron.len() as f64,
        _ => middle + right * (0.5 * f64::from(longest.width_m) + 180.0),
    };
    LightPoint {
        back: GREEN,
        axis: DVec3::X,
        half_rad: [5f32.to_radians(), 8f32.to_radians()],
        beam: Beam::Turning { period_s: 5.0 },
        ..LightPoint::even(at, 25.0, COOL, 30_000.0)
    }
}

/// Red at the top, and half way up what is higher than 105 m.
fn obstruction(at: DVec2, height_m: f32, lights: &mut Vec<LightPoint>) {
    lights.push(LightPoint::even(at, height_m, RED, 1_000.0));
    if height_m > 105.0 {
        lights.push(LightPoint::even(at, 0.5 * height_m, RED, 100.0));
    }
}

/// Calls for points along a line, evenly, at most a spacing apart, with the unit direction there. Bounded: at most
/// 100,000 points a line.
pub(super) fn along(line: &[DVec2], spacing_m: f64, mut point: impl FnMut(DVec2, DVec2)) {
    let mut left = 100_000_u32;
    // Way still to go to the next point.
    let mut next_m = 0.5 * spacing_m;
    for pair in line.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        if length_m.is_nan() || length_m <= 0.0 {
            continue;
        }
        let ahead = (pair[1] - pair[0]) / length_m;
        while next_m <= length_m && left > 0 {
            point(pair[0] + ahead * next_m, ahead);
            next_m += spacing_m;
            left -= 1;
        }
        next_m -= length_m;
    }
}

/// Distance from a point to a line, metres.
fn distance_m(at: DVec2, line: &[DVec2]) -> f64 {
    let to_piece = |pair: &[DVec2]| {
        let way = pair[1] - pair[0];
        let share = ((at - pair[0]).dot(way) / way.length_squared().max(1e-9)).clamp(0.0, 1.0);
        at.distance(pair[0] + way * share)
    };
    line.windows(2).map(to_piece).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests;
