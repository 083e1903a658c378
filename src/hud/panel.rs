//! The aircraft's own instruments: engine, fuel, flaps, gear, brakes, trim, as bars and words at the lower left.
//!
//! What an aircraft has no instrument for is `None` and takes no place. SI units.

use super::Anchor;
use super::numbers::{rounded, shown};
use super::sheet::{AMBER, DIM, GREEN, SMALL, Sheet};

/// An engine's instruments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engine {
    /// Turns a minute.
    pub rpm: f64,
    /// The highest allowed.
    pub most_rpm: f64,
    /// Throttle lever, 0..1.
    pub throttle: f64,
    /// Mixture lever, 0 lean .. 1 rich; `None` where there is none.
    pub mixture: Option<f64>,
    /// Whether it runs.
    pub running: bool,
}

/// What is shown beside attitude, speed and altitude.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Instruments {
    /// Force to the right over weight, what the slip ball shows, g.
    pub side_g: Option<f64>,
    /// Angle of attack, radians.
    pub alpha_rad: Option<f64>,
    /// Whether the stall warning sounds.
    pub stalling: bool,
    /// What the altimeter is set to, Pa.
    pub qnh_pa: Option<f64>,
    /// The engine.
    pub engine: Option<Engine>,
    /// Fuel left and what the tanks hold, kg.
    pub fuel_kg: Option<[f64; 2]>,
    /// Flaps and how far they go, radians.
    pub flaps_rad: Option<[f64; 2]>,
    /// Pitch trim, -1 nose down .. 1 nose up.
    pub trim: Option<f64>,
    /// Gear: 0 up, 1 down.
    pub gear: Option<f64>,
    /// Wheel brakes, 0..1.
    pub brakes: Option<f64>,
    /// Whether the parking brake is set.
    pub parked: bool,
}

/// Left end of names, of bars, right end of bars, and of numbers; the first row, and from row to row.
const NAME_X: f64 = -620.0;
const BAR_X: [f64; 2] = [-572.0, -502.0];
const VALUE_X: f64 = -494.0;
const TOP_Y: f64 = 178.0;
const ROW: f64 = 19.0;

/// Draws what there is, from the top down.
pub(super) fn panel(sheet: &mut Sheet, of: &Instruments) {
    let mut rows = Rows { sheet, y: TOP_Y };
    if let Some(engine) = of.engine {
        let share = engine.rpm / engine.most_rpm;
        let warn = !engine.running || share > 1.0;
        let rpm = if engine.running { shown(10.0 * rounded(engine.rpm / 10.0), 0) } else { "OFF".to_owned() };
        rows.bar("RPM", share, None, &rpm, warn);
        rows.bar("THR", engine.throttle, None, &percent(engine.throttle), false);
        if let Some(mixture) = engine.mixture {
            rows.bar("MIX", mixture, None, &percent(mixture), false);
        }
    }
    if let Some([left_kg, full_kg]) = of.fuel_kg {
        let share = left_kg / full_kg;
        rows.bar("FUEL", share, None, &format!("{} KG", shown(rounded(left_kg), 0)), share.is_nan() || share <= 0.15);
    }
    if let Some([flaps_rad, most_rad]) = of.flaps_rad {
        rows.bar("FLAP", flaps_rad / most_rad, None, &shown(rounded(flaps_rad.to_degrees()), 0), false);
    }
    if let Some(trim) = of.trim {
        rows.bar("TRIM", 0.5 + 0.5 * trim, Some(0.5), &shown(rounded(100.0 * trim), 0), false);
    }
    if let Some(gear) = of.gear {
        let word = match gear {
            gear if gear >= 1.0 => "DOWN",
            gear if gear <= 0.0 => "UP",
            _ => "MOVING",
        };
        rows.word("GEAR", word, word == "MOVING");
    }
    if of.parked {
        rows.word("BRK", "PARKED", true);
    } else if let Some(brakes) = of.brakes.filter(|brakes| *brakes > 0.01) {
        rows.bar("BRK", brakes, None, &percent(brakes), false);
    }
}

fn percent(share: f64) -> String {
    shown(rounded(100.0 * share), 0)
}

struct Rows<'a> {
    sheet: &'a mut Sheet,
    y: f64,
}

impl Rows<'_> {
    /// A bar filled up to a share, from its left end or from a place on it.
    fn bar(&mut self, name: &str, share: f64, from: Option<f64>, value: &str, warn: bool) {
        let colour = if warn { AMBER } else { GREEN };
        let [left, right] = BAR_X;
        let y = self.y;
        let (top, bottom) = (y - 5.0, y + 5.0);
        self.sheet.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], 1.2, DIM);
        if share.is_finite() {
            let at = |share: f64| left + share.clamp(0.0, 1.0) * (right - left);
            let (start, end) = (at(from.unwrap_or(0.0)), at(share));
            if (end - start).abs() > 0.5 {
                self.sheet.line(&[[start, y], [end, y]], 7.0, colour);
            }
            if from.is_some() {
                self.sheet.line(&[[start, top - 2.0], [start, bottom + 2.0]], 1.4, colour);
            }
        }
        self.texts(name, value, colour);
    }

    fn word(&mut self, name: &str, value: &str, warn: bool) {
        let colour = if warn { AMBER } else { GREEN };
        self.sheet.text([BAR_X[0], self.y], SMALL, value, Anchor::Left, colour);
        self.texts(name, "", colour);
    }

    fn texts(&mut self, name: &str, value: &str, colour: [f32; 4]) {
        self.sheet.text([NAME_X, self.y], SMALL, name, Anchor::Left, DIM);
        self.sheet.text([VALUE_X, self.y], SMALL, value, Anchor::Left, colour);
        self.y += ROW;
    }
}
