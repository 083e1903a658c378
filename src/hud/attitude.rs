//! What lies on the world: pitch ladder, where the nose points, where the aircraft goes; bank scale and slip ball.

use super::numbers::half_turn;
use super::sheet::{AMBER, DIM, GREEN, SMALL, Sheet};
use super::{Anchor, HudInput};
use std::f64::consts::TAU;

/// The ladder is drawn within this of the middle, pixels at 720 rows.
pub(super) const LADDER_RADIUS: f64 = 215.0;

/// Pitch ladder: a rung each 5 or 10 degrees, dashed under the horizon, number at both ends.
pub(super) fn ladder(sheet: &mut Sheet, input: &HudInput) {
    let Some(focal) = focal(sheet, input).filter(|_| input.pitch_rad.is_finite() && input.roll_rad.is_finite()) else {
        return;
    };
    let (sin_roll, cos_roll) = input.roll_rad.sin_cos();
    let on_screen = |along: f64, up: f64| [along * cos_roll - up * sin_roll, -along * sin_roll - up * cos_roll];
    let apart_deg = if focal * 5f64.to_radians().tan() >= 60.0 { 5 } else { 10 };
    for rung in -90 / apart_deg..=90 / apart_deg {
        let elevation_deg: i32 = rung * apart_deg;
        let off_rad = f64::from(elevation_deg).to_radians() - input.pitch_rad;
        if off_rad.abs() > 1.3 {
            continue;
        }
        let up = focal * off_rad.tan();
        let horizon = elevation_deg == 0;
        // The part of the rung inside the ladder's circle.
        let reach = (LADDER_RADIUS * LADDER_RADIUS - up * up).max(0.0).sqrt().min(if horizon { 210.0 } else { 105.0 });
        let gap = 40.0;
        if reach < gap + 20.0 {
            continue;
        }
        for side in [-1.0, 1.0] {
            let dashes = if elevation_deg < 0 { 3 } else { 1 };
            let piece = (reach - gap) / (f64::from(dashes) + f64::from(dashes - 1) * 0.5);
            for dash in 0..dashes {
                let from = gap + f64::from(dash) * 1.5 * piece;
                let width = if horizon { 2.4 } else { 1.8 };
                sheet.line(&[on_screen(side * from, up), on_screen(side * (from + piece), up)], width, GREEN);
            }
            if !horizon {
                // The tick at the inner end points to the horizon.
                let tick = up - 9.0f64.copysign(f64::from(elevation_deg));
                sheet.line(&[on_screen(side * gap, up), on_screen(side * gap, tick)], 1.8, GREEN);
                let label = on_screen(side * (reach + 20.0), up);
                if label[0].hypot(label[1]) < LADDER_RADIUS {
                    sheet.text(label, SMALL, &elevation_deg.abs().to_string(), Anchor::Centre, GREEN);
                }
            }
        }
    }
}

/// Focal length in design pixels, but of the picture: what is drawn with it lies on the world.
pub(super) fn focal(sheet: &Sheet, input: &HudInput) -> Option<f64> {
    let is_sound = input.fov_y_rad > 0.01 && input.fov_y_rad < 3.1 && sheet.scale > 0.0;
    is_sound.then(|| 0.5 * sheet.size.1 / (0.5 * input.fov_y_rad).tan() / sheet.scale)
}

/// Where the aircraft goes: a ring with wings, at the edge of the ladder if it goes beyond.
pub(super) fn flight_path(sheet: &mut Sheet, input: &HudInput) {
    const RADIUS: f64 = 7.0;
    let [right, up, back] = input.velocity_in_view_mps;
    let Some(focal) = focal(sheet, input).filter(|_| back < -1.0) else { return };
    let (x, y) = (-focal * right / back, focal * up / back);
    let beyond = (x.hypot(y) / LADDER_RADIUS).max(1.0);
    let (x, y) = (x / beyond, y / beyond);
    sheet.line(&ring([x, y], RADIUS, 16), 1.8, GREEN);
    sheet.line(&[[x - RADIUS, y], [x - 2.4 * RADIUS, y]], 1.8, GREEN);
    sheet.line(&[[x + RADIUS, y], [x + 2.4 * RADIUS, y]], 1.8, GREEN);
    sheet.line(&[[x, y - RADIUS], [x, y - 2.0 * RADIUS]], 1.8, GREEN);
}

/// Where the nose points.
pub(super) fn boresight(sheet: &mut Sheet) {
    sheet.line(
        &[[-26.0, 0.0], [-13.0, 0.0], [-6.5, 9.0], [0.0, 0.0], [6.5, 9.0], [13.0, 0.0], [26.0, 0.0]],
        2.2,
        GREEN,
    );
}

/// Bank scale under the ladder; the pointer shows the bank up to 60 degrees and stops there, amber.
pub(super) fn bank_scale(sheet: &mut Sheet, roll_rad: f64) {
    const RADIUS: f64 = 232.0;
    let on_arc = |angle_rad: f64, radius: f64| [radius * angle_rad.sin(), radius * angle_rad.cos()];
    let arc: Vec<[f64; 2]> = (-30..=30).map(|i| on_arc(f64::from(2 * i).to_radians(), RADIUS)).collect();
    sheet.line(&arc, 1.4, DIM);
    for degrees in [-60, -45, -30, -20, -10, 0, 10, 20, 30, 45, 60] {
        let length = if degrees % 30 == 0 { 13.0 } else { 8.0 };
        let angle_rad = f64::from(degrees).to_radians();
        sheet.line(&[on_arc(angle_rad, RADIUS), on_arc(angle_rad, RADIUS + length)], 1.6, GREEN);
    }
    if roll_rad.is_finite() {
        let shown = half_turn(roll_rad);
        let limit = 60f64.to_radians();
        let colour = if shown.abs() > limit { AMBER } else { GREEN };
        // The pointer lies where straight down is: to the right in a bank to the right.
        let at = shown.clamp(-limit, limit);
        let (tip, base) = (RADIUS - 2.0, RADIUS - 15.0);
        let triangle = [on_arc(at, tip), on_arc(at - 0.032, base), on_arc(at + 0.032, base), on_arc(at, tip)];
        sheet.line(&triangle, 2.0, colour);
    }
}

/// Slip ball: it rolls towards where the apparent weight pulls, half the tube for 0.15 g.
pub(super) fn slip_ball(sheet: &mut Sheet, side_g: f64) {
    const Y: f64 = 268.0;
    const HALF_TUBE: f64 = 44.0;
    const BALL: f64 = 7.0;
    const FULL_G: f64 = 0.3;
    if !side_g.is_finite() {
        return;
    }
    sheet.line(&[[-HALF_TUBE, Y - 9.0], [HALF_TUBE, Y - 9.0]], 1.4, DIM);
    sheet.line(&[[-HALF_TUBE, Y + 9.0], [HALF_TUBE, Y + 9.0]], 1.4, DIM);
    for side in [-1.0, 1.0] {
        sheet.line(&[[side * (BALL + 2.0), Y - 9.0], [side * (BALL + 2.0), Y + 9.0]], 1.4, DIM);
    }
    // A force to the right lets the ball lag to the left.
    let off = (-side_g / FULL_G).clamp(-1.0, 1.0) * (HALF_TUBE - BALL);
    let colour = if side_g.abs() > 0.15 { AMBER } else { GREEN };
    sheet.line(&ring([off, Y], BALL, 12), 2.2, colour);
    sheet.line(&ring([off, Y], 0.5 * BALL, 8), 2.2, colour);
}

/// A ring about a place.
pub(super) fn ring(middle: [f64; 2], radius: f64, corners: u32) -> Vec<[f64; 2]> {
    (0..=corners)
        .map(|corner| (f64::from(corner) * TAU / f64::from(corners)).sin_cos())
        .map(|(sin, cos)| [middle[0] + radius * sin, middle[1] - radius * cos])
        .collect()
}
