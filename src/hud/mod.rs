//! The head-up display as plain lines and texts: what to draw, not how.
//!
//! Screen: pixels, x right, y down, (0, 0) the top left corner. Designed at 1280 x 720 and scaled as a whole with the
//! smaller side, about the middle. The pitch ladder is conformal: a rung lies where that elevation is in the picture,
//! and the horizon's rung on the horizon.
//!
//! Invariant others rely on: every point and every text's box lies within the viewport and nothing is NaN, whatever the
//! numbers. A number that is not finite is shown as dashes.

mod attitude;
mod numbers;
mod panel;
mod sheet;
mod tapes;
#[cfg(test)]
mod tests;
mod weapons;

pub use panel::{Engine, Instruments};
pub use weapons::{Sight, Store, WeaponPage};

use sheet::Sheet;
use tapes::Side;

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
    /// Indicated airspeed, m/s.
    pub speed_mps: f64,
    /// As the altimeter reads it, metres.
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
    /// Pitch and roll of a mouse that flies, -1..1, back and right positive.
    pub mouse: Option<[f64; 2]>,
    /// Width and height, pixels.
    pub viewport_px: (u32, u32),
    /// Vertical field of view, radians.
    pub fov_y_rad: f64,
    /// What else the aircraft has instruments for.
    pub instruments: Instruments,
    /// Its weapons, if it has any.
    pub weapons: Option<WeaponPage<'a>>,
    /// How bright it is shown, 0..1: dim at night.
    pub brightness: f64,
    /// Whether the view looks along the nose; turned away, the ladder would be wrong and is left out.
    pub looking_ahead: bool,
}

/// The display's lines and texts.
pub fn hud(input: &HudInput) -> (Vec<HudLine>, Vec<HudText>) {
    let mut sheet = Sheet::new(input.viewport_px, input.brightness);
    if input.looking_ahead {
        attitude::ladder(&mut sheet, input);
        attitude::boresight(&mut sheet);
        attitude::flight_path(&mut sheet, input);
        attitude::bank_scale(&mut sheet, input.roll_rad);
    }
    if let Some(side_g) = input.instruments.side_g {
        attitude::slip_ball(&mut sheet, side_g);
    }
    tapes::heading_tape(&mut sheet, input.true_heading_rad);
    let speed_kmph = input.speed_mps * 3.6;
    tapes::side_tape(&mut sheet, Side::Left, speed_kmph, 10.0, 50.0, 0.8, "IAS KM/H");
    tapes::side_tape(&mut sheet, Side::Right, input.altitude_m, 20.0, 100.0, 0.4, "M");
    numbers::numbers(&mut sheet, input);
    panel::panel(&mut sheet, &input.instruments);
    if let Some(weapons) = &input.weapons {
        weapons::page(&mut sheet, weapons);
        weapons::sight(&mut sheet, input, weapons);
    }
    (sheet.lines, sheet.texts)
}
