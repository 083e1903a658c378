//! Numbers and states about the edges, and how numbers are written.

use super::sheet::{AMBER, DIM, GREEN, LARGE, MEDIUM, SMALL, Sheet};
use super::{Anchor, HudInput};
use std::f64::consts::{PI, TAU};

/// Numbers and states about the edges.
pub(super) fn numbers(sheet: &mut Sheet, input: &HudInput) {
    // Under the altitude: height above ground and climb; under the speed: load and throttle.
    let height = input.height_above_ground_m.map_or("---".to_owned(), |h| shown(rounded(h), 0));
    let low = input.height_above_ground_m.is_some_and(|h| h < 100.0);
    sheet.text([348.0, 182.0], MEDIUM, &format!("AGL {height}"), Anchor::Left, if low { AMBER } else { GREEN });
    let climb = tenth(input.vertical_speed_mps);
    let sign = if climb > 0.0 { "+" } else { "" };
    sheet.text([348.0, 204.0], MEDIUM, &format!("V/S {sign}{}", shown(climb, 1)), Anchor::Left, GREEN);
    sheet.text([-348.0, 182.0], MEDIUM, &format!("G {}", shown(tenth(input.load_factor), 1)), Anchor::Right, GREEN);
    // Where there is an engine, its panel says more than the lever.
    if input.instruments.engine.is_none() {
        let throttle = rounded(100.0 * input.throttle);
        sheet.text([-348.0, 204.0], MEDIUM, &format!("THR {}", shown(throttle, 0)), Anchor::Right, GREEN);
    }
    if let Some(alpha_rad) = input.instruments.alpha_rad {
        let alpha = shown(tenth(alpha_rad.to_degrees()), 1);
        sheet.text([-348.0, 226.0], MEDIUM, &format!("AOA {alpha}"), Anchor::Right, GREEN);
    }
    if let Some(qnh_pa) = input.instruments.qnh_pa {
        let qnh = shown(rounded(qnh_pa / 100.0), 0);
        sheet.text([348.0, 226.0], MEDIUM, &format!("QNH {qnh}"), Anchor::Left, DIM);
    }
    if input.instruments.stalling {
        sheet.text([0.0, -150.0], LARGE, "STALL", Anchor::Centre, AMBER);
    }

    if let Some([pitch, roll]) = input.mouse.filter(|stick| stick.iter().all(|part| part.is_finite())) {
        stick(sheet, pitch, roll);
    }

    let date: String = input.date.chars().take(40).collect();
    sheet.text([-620.0, 340.0], SMALL, &date, Anchor::Left, DIM);
    // Where frames are not timed there is nothing to say.
    if input.frame_ms > 0.0 {
        let (ms, rate) = (shown(tenth(input.frame_ms), 1), shown((1_000.0 / input.frame_ms).round(), 0));
        sheet.text([620.0, 340.0], SMALL, &format!("{ms} MS {rate} FPS"), Anchor::Right, DIM);
    }
    let hint: String = input.hint.chars().take(92).collect();
    sheet.text([0.0, 340.0], SMALL, &hint, Anchor::Centre, GREEN);

    let status = input.status.iter().take(8).copied().collect::<Vec<_>>().join("  ");
    let status: String = status.chars().take(80).collect();
    sheet.text([0.0, 300.0], LARGE, &status, Anchor::Centre, AMBER);
}

/// Where a mouse that flies holds the stick, as seen from above: a cross in a box.
fn stick(sheet: &mut Sheet, pitch: f64, roll: f64) {
    const MIDDLE: [f64; 2] = [-404.0, 276.0];
    const HALF: f64 = 34.0;
    let [x, y] = MIDDLE;
    sheet.line(
        &[[x - HALF, y - HALF], [x + HALF, y - HALF], [x + HALF, y + HALF], [x - HALF, y + HALF], [x - HALF, y - HALF]],
        1.4,
        DIM,
    );
    let at = [x + HALF * roll.clamp(-1.0, 1.0), y + HALF * pitch.clamp(-1.0, 1.0)];
    sheet.line(&[[at[0] - 6.0, at[1]], [at[0] + 6.0, at[1]]], 1.8, GREEN);
    sheet.line(&[[at[0], at[1] - 6.0], [at[0], at[1] + 6.0]], 1.8, GREEN);
}

/// A number with so many digits, dashes if it is none.
pub(super) fn shown(value: f64, digits: usize) -> String {
    if value.is_finite() { format!("{:.digits$}", value.clamp(-999_999.0, 999_999.0) + 0.0) } else { "---".to_owned() }
}

/// To a whole number that never reads `-0`.
pub(super) fn rounded(value: f64) -> f64 {
    value.round() + 0.0
}

/// To a tenth that never reads `-0.0`.
pub(super) fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0 + 0.0
}

/// The same angle within -pi..pi.
pub(super) fn half_turn(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}
