//! The head-up display as plain lines and texts: what to draw, not how.
//!
//! Screen: pixels, x right, y down, (0, 0) the top left corner. Designed at 1280 x 720 and scaled as a whole with the
//! smaller side, about the middle. The pitch ladder is conformal: a rung lies where that elevation is in the picture,
//! and the horizon's rung on the horizon.
//!
//! Invariant others rely on: every point and every text's box lies within the viewport and nothing is NaN, whatever the
//! numbers. A number that is not finite is shown as dashes.

use std::f64::consts::{PI, TAU};

/// A polyline.
#[derive(Debug, Clone, PartialEq)]
pub struct HudLine {
    /// Points, pixels; at least two.
    pub points_px: Vec<[f32; 2]>,
    /// Width, pixels.
    pub width_px: f32,
    /// Red, green, blue, alpha; linear light, 0..1.
    pub colour: [f32; 4],
}

/// Which part of a text is at its place. Vertically it is always the middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Left,
    /// Its middle.
    Centre,
    /// Its right end.
    Right,
}

/// A text on one line.
#[derive(Debug, Clone, PartialEq)]
pub struct HudText {
    /// Place of the anchor, pixels.
    pub at_px: [f32; 2],
    /// Height of a capital letter, pixels.
    pub height_px: f32,
    /// ASCII.
    pub text: String,
    /// Which part is at the place.
    pub anchor: Anchor,
    /// Red, green, blue, alpha; linear light, 0..1.
    pub colour: [f32; 4],
}

/// Distance from one character to the next over the height: what the drawn font has to keep to.
pub const ADVANCE: f32 = 0.8;

/// Width of a text over its height, as drawn.
pub fn text_width(text: &str) -> f32 {
    text.chars().count() as f32 * ADVANCE
}

/// All that is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HudInput<'a> {
    /// Speed through the air, m/s.
    pub speed_mps: f64,
    /// Above mean sea level, metres.
    pub altitude_m: f64,
    /// Above the ground, metres; `None` where there is none.
    pub height_above_ground_m: Option<f64>,
    /// From true north, radians.
    pub true_heading_rad: f64,
    /// Nose up positive, radians.
    pub pitch_rad: f64,
    /// Right wing down positive, radians.
    pub roll_rad: f64,
    /// Climb positive, m/s.
    pub vertical_speed_mps: f64,
    /// Velocity in view axes (x right, y up, z backward), m/s: where the aircraft goes.
    pub velocity_in_view_mps: [f64; 3],
    /// Lift over weight.
    pub load_factor: f64,
    /// 0..1.
    pub throttle: f64,
    /// Time of the last frame, milliseconds; not shown if it is not a time.
    pub frame_ms: f64,
    /// Date and time of day, as it shall read.
    pub date: &'a str,
    /// States in capitals: `PAUSED`, `SLEW`, `SLOWED`.
    pub status: &'a [&'a str],
    /// What the pilot can do next, one line.
    pub hint: &'a str,
    /// Width and height, pixels.
    pub viewport_px: (u32, u32),
    /// Vertical field of view, radians.
    pub fov_y_rad: f64,
    /// Whether the view looks along the nose; turned away, the ladder would be wrong and is left out.
    pub looking_ahead: bool,
}

const GREEN: [f32; 4] = [0.10, 1.0, 0.25, 0.95];
const DIM: [f32; 4] = [0.10, 1.0, 0.25, 0.75];
const AMBER: [f32; 4] = [1.0, 0.55, 0.05, 1.0];
/// Letter heights at 720 rows, pixels.
const LARGE: f64 = 18.0;
const MEDIUM: f64 = 14.0;
const SMALL: f64 = 11.0;
/// The ladder is drawn within this of the middle, pixels at 720 rows.
const LADDER_RADIUS: f64 = 215.0;
/// A text lower than this cannot be read and is left out, pixels.
const LEAST_TEXT_PX: f64 = 5.0;

/// The display's lines and texts.
pub fn hud(input: &HudInput) -> (Vec<HudLine>, Vec<HudText>) {
    let mut sheet = Sheet::new(input.viewport_px);
    if input.looking_ahead {
        ladder(&mut sheet, input);
        boresight(&mut sheet);
        flight_path(&mut sheet, input);
        bank_scale(&mut sheet, input.roll_rad);
    }
    heading_tape(&mut sheet, input.true_heading_rad);
    let speed_kmph = input.speed_mps * 3.6;
    side_tape(&mut sheet, Side::Left, speed_kmph, 10.0, 50.0, 0.8, "KM/H");
    side_tape(&mut sheet, Side::Right, input.altitude_m, 20.0, 100.0, 0.4, "M");
    numbers(&mut sheet, input);
    (sheet.lines, sheet.texts)
}

/// Lines and texts in design pixels about the middle, clipped to the viewport as they come.
struct Sheet {
    lines: Vec<HudLine>,
    texts: Vec<HudText>,
    scale: f64,
    size: (f64, f64),
}

impl Sheet {
    fn new(viewport_px: (u32, u32)) -> Self {
        let size = (f64::from(viewport_px.0), f64::from(viewport_px.1));
        Self { lines: Vec::new(), texts: Vec::new(), scale: (size.0 / 1280.0).min(size.1 / 720.0), size }
    }

    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        [0.5 * self.size.0 + at[0] * self.scale, 0.5 * self.size.1 + at[1] * self.scale]
    }

    /// A polyline; what leaves the viewport is left out piece by piece.
    fn line(&mut self, points: &[[f64; 2]], width: f64, colour: [f32; 4]) {
        let points: Vec<[f64; 2]> = points.iter().map(|&p| self.place(p)).collect();
        let inside = |p: &[f64; 2]| (0.0..=self.size.0).contains(&p[0]) && (0.0..=self.size.1).contains(&p[1]);
        // NaN is inside nothing.
        if self.size.0 < 1.0 || self.size.1 < 1.0 || points.len() < 2 || !points.iter().all(inside) {
            return;
        }
        let points_px = points.iter().map(|p| [p[0] as f32, p[1] as f32]).collect();
        self.lines.push(HudLine { points_px, width_px: (width * self.scale).max(1.0) as f32, colour });
    }

    fn text(&mut self, at: [f64; 2], height: f64, text: &str, anchor: Anchor, colour: [f32; 4]) {
        let height_px = height * self.scale;
        let text: String = text.chars().map(|c| if c == ' ' || c.is_ascii_graphic() { c } else { '?' }).collect();
        let at = self.place(at);
        let width_px = f64::from(text_width(&text)) * height_px;
        let left = match anchor {
            Anchor::Left => at[0],
            Anchor::Centre => at[0] - 0.5 * width_px,
            Anchor::Right => at[0] - width_px,
        };
        let (top, bottom) = (at[1] - 0.5 * height_px, at[1] + 0.5 * height_px);
        let fits = left >= 0.0 && left + width_px <= self.size.0 && top >= 0.0 && bottom <= self.size.1;
        if fits && height_px >= LEAST_TEXT_PX && !text.is_empty() {
            self.texts.push(HudText {
                at_px: [at[0] as f32, at[1] as f32],
                height_px: height_px as f32,
                text,
                anchor,
                colour,
            });
        }
    }

    fn frame(&mut self, left: f64, right: f64, middle: f64, half_height: f64) {
        let (top, bottom) = (middle - half_height, middle + half_height);
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        self.line(&corners, 1.8, GREEN);
    }
}

/// Pitch ladder: a rung each 5 or 10 degrees, dashed under the horizon, number at both ends.
fn ladder(sheet: &mut Sheet, input: &HudInput) {
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
fn focal(sheet: &Sheet, input: &HudInput) -> Option<f64> {
    let is_sound = input.fov_y_rad > 0.01 && input.fov_y_rad < 3.1 && sheet.scale > 0.0;
    is_sound.then(|| 0.5 * sheet.size.1 / (0.5 * input.fov_y_rad).tan() / sheet.scale)
}

/// Where the aircraft goes: a ring with wings, at the edge of the ladder if it goes beyond.
fn flight_path(sheet: &mut Sheet, input: &HudInput) {
    const RADIUS: f64 = 7.0;
    let [right, up, back] = input.velocity_in_view_mps;
    let Some(focal) = focal(sheet, input).filter(|_| back < -1.0) else { return };
    let (x, y) = (-focal * right / back, focal * up / back);
    let beyond = (x.hypot(y) / LADDER_RADIUS).max(1.0);
    let (x, y) = (x / beyond, y / beyond);
    let ring: Vec<[f64; 2]> = (0..=16)
        .map(|i| (f64::from(i) * TAU / 16.0).sin_cos())
        .map(|(sin, cos)| [x + RADIUS * sin, y - RADIUS * cos])
        .collect();
    sheet.line(&ring, 1.8, GREEN);
    sheet.line(&[[x - RADIUS, y], [x - 2.4 * RADIUS, y]], 1.8, GREEN);
    sheet.line(&[[x + RADIUS, y], [x + 2.4 * RADIUS, y]], 1.8, GREEN);
    sheet.line(&[[x, y - RADIUS], [x, y - 2.0 * RADIUS]], 1.8, GREEN);
}

/// Where the nose points.
fn boresight(sheet: &mut Sheet) {
    sheet.line(
        &[[-26.0, 0.0], [-13.0, 0.0], [-6.5, 9.0], [0.0, 0.0], [6.5, 9.0], [13.0, 0.0], [26.0, 0.0]],
        2.2,
        GREEN,
    );
}

/// Bank scale under the ladder; the pointer shows the bank up to 60 degrees and stops there, amber.
fn bank_scale(sheet: &mut Sheet, roll_rad: f64) {
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

/// Heading tape along the top with the heading in a box.
fn heading_tape(sheet: &mut Sheet, heading_rad: f64) {
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
enum Side {
    Left,
    Right,
}

/// A vertical tape with its number in a box: a tick each `tick`, a number each `named`, `scale` pixels a unit.
fn side_tape(sheet: &mut Sheet, side: Side, value: f64, tick: f64, named: f64, scale: f64, unit: &str) {
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

/// Numbers and states about the edges.
fn numbers(sheet: &mut Sheet, input: &HudInput) {
    let shown = |value: f64, digits: usize| {
        if value.is_finite() {
            format!("{:.digits$}", value.clamp(-999_999.0, 999_999.0) + 0.0)
        } else {
            "---".to_owned()
        }
    };
    // Under the altitude: height above ground and climb; under the speed: load and throttle.
    let height = input.height_above_ground_m.map_or("---".to_owned(), |h| shown(rounded(h), 0));
    let low = input.height_above_ground_m.is_some_and(|h| h < 100.0);
    sheet.text([348.0, 182.0], MEDIUM, &format!("AGL {height}"), Anchor::Left, if low { AMBER } else { GREEN });
    let climb = tenth(input.vertical_speed_mps);
    let sign = if climb > 0.0 { "+" } else { "" };
    sheet.text([348.0, 204.0], MEDIUM, &format!("V/S {sign}{}", shown(climb, 1)), Anchor::Left, GREEN);
    sheet.text([-348.0, 182.0], MEDIUM, &format!("G {}", shown(tenth(input.load_factor), 1)), Anchor::Right, GREEN);
    let throttle = rounded(100.0 * input.throttle);
    sheet.text([-348.0, 204.0], MEDIUM, &format!("THR {}", shown(throttle, 0)), Anchor::Right, GREEN);

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

/// To a whole number that never reads `-0`.
fn rounded(value: f64) -> f64 {
    value.round() + 0.0
}

/// To a tenth that never reads `-0.0`.
fn tenth(value: f64) -> f64 {
    (value * 10.0).round() / 10.0 + 0.0
}

/// The same angle within -pi..pi.
fn half_turn(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level() -> HudInput<'static> {
        HudInput {
            speed_mps: 250.0,
            altitude_m: 4_210.0,
            height_above_ground_m: Some(1_234.0),
            true_heading_rad: 1.2,
            pitch_rad: 0.0,
            roll_rad: 0.0,
            vertical_speed_mps: -3.25,
            velocity_in_view_mps: [0.0, -6.0, -250.0],
            load_factor: 1.0,
            throttle: 0.5,
            frame_ms: 16.7,
            date: "2026-06-21 06:30 UTC",
            status: &["PAUSED", "SLEW"],
            hint: "ESC QUIT",
            viewport_px: (1280, 720),
            fov_y_rad: 60f64.to_radians(),
            looking_ahead: true,
        }
    }

    fn assert_inside(input: &HudInput) -> usize {
        let (lines, texts) = hud(input);
        let (width, height) = (input.viewport_px.0 as f32, input.viewport_px.1 as f32);
        // A float's rounding of a pixel place of up to 8,192.
        let slack = 1e-3;
        for line in &lines {
            assert!(line.points_px.len() >= 2 && line.width_px.is_finite() && line.width_px > 0.0);
            for [x, y] in &line.points_px {
                assert!((0.0..=width + slack).contains(x) && (0.0..=height + slack).contains(y), "{input:?} {x} {y}");
            }
        }
        for text in &texts {
            let long = text_width(&text.text) * text.height_px;
            let left = match text.anchor {
                Anchor::Left => text.at_px[0],
                Anchor::Centre => text.at_px[0] - 0.5 * long,
                Anchor::Right => text.at_px[0] - long,
            };
            assert!(left >= -slack && left + long <= width + slack, "{text:?}");
            let half = 0.5 * text.height_px;
            assert!(text.at_px[1] - half >= -slack && text.at_px[1] + half <= height + slack, "{text:?}");
            assert!(text.text.is_ascii() && !text.text.contains("NaN") && !text.text.contains("inf"), "{text:?}");
        }
        lines.len() + texts.len()
    }

    #[test]
    fn everything_stays_within_the_viewport_at_every_attitude_and_size() {
        for viewport_px in [
            (0, 0),
            (1, 1),
            (1, 4_320),
            (7_680, 1),
            (64, 64),
            (320, 200),
            (720, 1_280),
            (1_280, 720),
            (3_440, 1_440),
            (7_680, 4_320),
        ] {
            for pitch in -9..=9 {
                for roll in -6..=6 {
                    let input = HudInput {
                        pitch_rad: f64::from(pitch) * 0.1745,
                        roll_rad: f64::from(roll) * std::f64::consts::FRAC_PI_6,
                        true_heading_rad: f64::from(pitch * 7 + roll),
                        viewport_px,
                        ..level()
                    };
                    assert_inside(&input);
                }
            }
        }
    }

    #[test]
    fn wild_numbers_are_dashes_not_nan() {
        for v in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0, -0.0] {
            let input = HudInput {
                speed_mps: v,
                altitude_m: v,
                height_above_ground_m: Some(v),
                true_heading_rad: v,
                pitch_rad: v,
                roll_rad: v,
                vertical_speed_mps: v,
                velocity_in_view_mps: [v; 3],
                load_factor: v,
                throttle: v,
                frame_ms: v,
                fov_y_rad: v,
                date: "юный \u{0} date that is much longer than anything one would ever want to read here",
                status: &["A STATUS LONGER THAN ANY SCREEN IS WIDE, AND THEN SOME MORE OF IT, AND MORE STILL"],
                hint: "A HINT LONGER THAN ANY SCREEN IS WIDE, AND THEN SOME MORE OF IT, AND MORE STILL, AND ON AND ON",
                ..level()
            };
            assert!(assert_inside(&input) > 10);
        }
    }

    #[test]
    fn the_horizon_rung_lies_on_the_horizon() {
        let input = HudInput { pitch_rad: 0.1, roll_rad: 0.4, ..level() };
        let focal_px = 360.0 / 30f64.to_radians().tan();
        let (lines, _) = hud(&input);
        // The horizon is the set of screen points (x, y) whose ray is level: in view axes (x, -y, -focal) dot up = 0,
        // with up turned by pitch and roll.
        let (sin_roll, cos_roll) = 0.4f64.sin_cos();
        let off_px = |p: &[f32; 2]| {
            let (x, y) = (f64::from(p[0]) - 640.0, 360.0 - f64::from(p[1]));
            let across = -x * sin_roll + y * cos_roll;
            across * 0.1f64.cos() + focal_px * 0.1f64.sin()
        };
        let on_horizon = lines.iter().filter(|line| line.points_px.iter().all(|p| off_px(p).abs() < 0.01)).count();
        assert_eq!(on_horizon, 2);
    }

    #[test]
    fn level_flight_is_symmetric_left_and_right() {
        let (lines, _) = hud(&HudInput { true_heading_rad: 0.0, speed_mps: 0.0, altitude_m: 0.0, ..level() });
        let ends = |line: &HudLine, mirror: bool| {
            let key = |p: &[f32; 2]| {
                let x = if mirror { 1_280.0 - p[0] } else { p[0] };
                ((x * 8.0).round() as i32, (p[1] * 8.0).round() as i32)
            };
            let mut keys: Vec<_> = line.points_px.iter().map(key).collect();
            keys.sort_unstable();
            keys.dedup();
            keys
        };
        // The tapes' scales differ by nature; all else has its mirror image.
        let middle: Vec<&HudLine> =
            lines.iter().filter(|l| l.points_px.iter().all(|p| (p[0] - 640.0).abs() < 320.0)).collect();
        assert!(middle.len() > 40);
        for line in &middle {
            assert!(middle.iter().any(|other| ends(other, true) == ends(line, false)), "{line:?}");
        }
    }

    #[test]
    fn numbers_read_as_a_pilot_expects() {
        let (_, texts) = hud(&level());
        let has = |text: &str| texts.iter().any(|t| t.text == text);
        for text in ["900", "4210", "069", "AGL 1234", "V/S -3.3", "G 1.0", "THR 50", "PAUSED  SLEW", "16.7 MS 60 FPS"]
        {
            assert!(has(text), "{text} in {:?}", texts.iter().map(|t| &t.text).collect::<Vec<_>>());
        }
        let (_, texts) = hud(&HudInput { true_heading_rad: -0.001, vertical_speed_mps: -0.01, ..level() });
        assert!(texts.iter().any(|t| t.text == "000") && texts.iter().any(|t| t.text == "V/S 0.0"));
    }
}
