//! Tapes with their numbers in boxes: heading along the top, speed and altitude at the sides.

use super::Anchor;
use super::numbers::rounded;
use super::sheet::{DIM, GREEN, LARGE, SMALL, Sheet};
use std::f64::consts::TAU;

/// Heading tape along the top with the heading in a box.
pub(super) fn heading_tape(sheet: &mut Sheet, heading_rad: f64) {
    const Y: f64 = -292.0;
    const HALF_WIDTH: f64 = 200.0;
    const PX_PER_DEG: f64 = 8.0;
    sheet.line(&[[-HALF_WIDTH, Y], [HALF_WIDTH, Y]], 1.4, DIM);
    sheet.frame(-34.0, 34.0, Y + 22.0, 13.0);
    sheet.line(&[[-6.0, Y + 9.0], [0.0, Y + 1.0], [6.0, Y + 9.0]], 1.8, GREEN);
    let Some(heading_deg) = heading_rad.is_finite().then(|| heading_rad.rem_euclid(TAU).to_degrees()) else {
        sheet.text([0.0, Y + 22.0], LARGE, "---", Anchor::Centre, GREEN);
        return;
    };
    sheet.text([0.0, Y + 22.0], LARGE, &format!("{:03}", heading_deg.round() as i32 % 360), Anchor::Centre, GREEN);
    let first = ((heading_deg - HALF_WIDTH / PX_PER_DEG) / 5.0).ceil() as i32;
    let last = ((heading_deg + HALF_WIDTH / PX_PER_DEG) / 5.0).floor() as i32;
    for five in first..=last {
        let x = (f64::from(five * 5) - heading_deg) * PX_PER_DEG;
        let named = five % 2 == 0;
        sheet.line(&[[x, Y], [x, Y - if named { 10.0 } else { 6.0 }]], 1.6, GREEN);
        if named && x.abs() < HALF_WIDTH - 10.0 {
            let name = match (five * 5).rem_euclid(360) {
                0 => "N".to_owned(),
                90 => "E".to_owned(),
                180 => "S".to_owned(),
                270 => "W".to_owned(),
                degrees => format!("{degrees:03}"),
            };
            sheet.text([x, Y - 20.0], SMALL, &name, Anchor::Centre, GREEN);
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Side {
    Left,
    Right,
}

/// A vertical tape with its number in a box: a tick each `tick`, a number each `named`, `scale` pixels a unit.
pub(super) fn side_tape(sheet: &mut Sheet, side: Side, value: f64, tick: f64, named: f64, scale: f64, unit: &str) {
    const EDGE: f64 = 330.0;
    const HALF_HEIGHT: f64 = 150.0;
    let sign = if side == Side::Left { -1.0 } else { 1.0 };
    let anchor = if side == Side::Left { Anchor::Right } else { Anchor::Left };
    let edge = sign * EDGE;
    sheet.line(&[[edge, -HALF_HEIGHT], [edge, HALF_HEIGHT]], 1.4, DIM);
    let (near, far) = (edge + sign * 12.0, edge + sign * 112.0);
    sheet.frame(near.min(far), near.max(far), 0.0, 15.0);
    sheet.line(&[[near, -6.0], [edge + sign * 2.0, 0.0], [near, 6.0]], 1.8, GREEN);
    sheet.text([edge + sign * 18.0, -HALF_HEIGHT - 16.0], SMALL, unit, anchor, DIM);
    // Six characters fit; more is neither a speed nor an altitude.
    let sound = value.abs() < 99_999.5;
    let number = if sound { format!("{:.0}", rounded(value)) } else { "---".to_owned() };
    sheet.text([0.5 * (near + far), 0.0], LARGE, &number, Anchor::Centre, GREEN);
    if !sound {
        return;
    }
    let first = ((value - HALF_HEIGHT / scale) / tick).ceil() as i64;
    let last = ((value + HALF_HEIGHT / scale) / tick).floor() as i64;
    let every = (named / tick).round() as i64;
    for step in first..=last {
        let at = step as f64 * tick;
        let y = (value - at) * scale;
        let is_named = step % every == 0;
        sheet.line(&[[edge, y], [edge + sign * if is_named { 11.0 } else { 6.0 }, y]], 1.6, GREEN);
        if is_named && y.abs() > 24.0 && y.abs() < HALF_HEIGHT - 4.0 {
            sheet.text([edge + sign * 18.0, y], SMALL, &format!("{at:.0}"), anchor, GREEN);
        }
    }
}
