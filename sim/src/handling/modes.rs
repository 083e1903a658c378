//! The modes of a trimmed flight, measured from its own inputs.
//!
//! From level trim: a pulse of the elevator (short period, then the phugoid), a pulse of the rudder and one of the aileron
//! (Dutch roll, roll and spiral). Each response is that of the whole model, with the shaft of its engine; what is fitted
//! is its free part, small enough to be linear.
//!
//! Limits: MIL-F-8785C, 1980, level 1, class I, flight phase category B: short period damping 0.30..2.0 (here the
//! narrower 0.35..1.3 of category A), phugoid damping above 0.04, Dutch roll damping above 0.08, roll mode below 1.4 s,
//! spiral no faster than doubling in 20 s.

use super::linear::{self, Mode};
use super::{Held, needed};
use crate::integrate;
use crate::integrate::Motion as _;
use crate::rigid::motion::{self, State};
use crate::rigid::quantity::Quantity;

/// Step of the measurement, seconds.
pub const DT_S: f64 = 0.005;

/// The modes of a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modes {
    /// Short period.
    pub short_period: Mode,
    /// Phugoid.
    pub phugoid: Mode,
    /// Dutch roll.
    pub dutch_roll: Mode,
    /// Roll.
    pub roll: Mode,
    /// Spiral.
    pub spiral: Mode,
}

/// A limit of level 1 and what was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// What it is.
    pub name: &'static str,
    /// What was found.
    pub found: f64,
    /// Least that is good.
    pub least: f64,
    /// Most that is good.
    pub most: f64,
}

impl Judged {
    /// Whether it is within.
    pub fn passes(&self) -> bool {
        self.found >= self.least && self.found <= self.most
    }
}

impl Modes {
    /// Each beside its limit.
    pub fn judged(&self) -> [Judged; 5] {
        let judged = |name, found, least, most| Judged { name, found, least, most };
        [
            judged("short_period_damping", self.short_period.damping(), 0.35, 1.3),
            judged("phugoid_damping", self.phugoid.damping(), 0.04, f64::INFINITY),
            judged("dutch_roll_damping", self.dutch_roll.damping(), 0.08, f64::INFINITY),
            judged("roll_mode_s", self.roll.time_s(), 0.0, 1.4),
            // Doubling in 20 s is growth of ln 2 / 20.
            judged("spiral_growth_radps", self.spiral.rate_radps, f64::NEG_INFINITY, std::f64::consts::LN_2 / 20.0),
        ]
    }
}

/// What a trimmed flight does when controls are moved for a while and brought back.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Which controls are moved.
    pub name: &'static str,
    /// What is looked at, with units.
    pub signals: &'static [&'static str],
    /// How far each was from trim, a row every [`DT_S`].
    pub rows: Vec<Vec<f64>>,
    /// From where on a linear system is fitted, seconds: the controls are back.
    pub free_s: f64,
}

impl Response {
    /// Rows of the free part.
    fn free<const N: usize>(&self) -> Vec<[f64; N]> {
        let from = (self.free_s / DT_S).round() as usize;
        self.rows.iter().skip(from).map(|row| std::array::from_fn(|at| row.get(at).copied().unwrap_or(0.0))).collect()
    }
}

/// A control, by how much it is moved, and until when, seconds.
type Pulse = (usize, f64, f64);

/// Flies on with controls moved for a while; the free part begins a while after the last is back.
fn pulsed(
    held: &Held,
    (name, signals): (&'static str, &'static [&'static str]),
    pulses: &[Pulse],
    wait_s: f64,
    seconds: f64,
    row: impl Fn(&Held) -> Vec<f64>,
) -> Response {
    let mut now = held.clone();
    let first = row(&now);
    let last_s = pulses.iter().map(|pulse| pulse.2).fold(0.0, f64::max);
    let mut rows = Vec::new();
    let steps = ((last_s + wait_s + seconds) / DT_S).round() as u32;
    for step in 0..steps {
        let t_s = f64::from(step) * DT_S;
        for &(place, by, until_s) in pulses {
            now.motion.controls[place] = held.motion.controls[place] + if t_s < until_s { by } else { 0.0 };
        }
        rows.push(row(&now).iter().zip(&first).map(|(at, first)| at - first).collect());
        let y = motion::normalised(integrate::rk4(t_s, &now.y, DT_S, |t, y: &State| now.motion.rate(t, y)));
        now.y = y;
        now.motion.turn_shaft(&y, DT_S);
    }
    Response { name, signals, rows, free_s: last_s + wait_s }
}

/// Part of a control's whole way.
fn share(held: &Held, place: usize, part: f64) -> f64 {
    let of = &held.motion.model.controls[place];
    part * 0.5 * (of.max - of.min)
}

/// Flies the tests: short period, phugoid, and the lateral modes.
///
/// # Errors
/// A sentence: a control is missing.
pub fn responses(held: &Held) -> Result<[Response; 3], String> {
    let model = &held.motion.model;
    let [elevator, aileron, rudder] = [needed(model, "elevator")?, needed(model, "aileron")?, needed(model, "rudder")?];
    let slots = |now: &Held, of: &[Quantity]| -> Vec<f64> {
        let sample = now.motion.sample(&now.y, true);
        of.iter().map(|quantity| sample.slots[quantity.slot()]).collect()
    };

    let nod = (elevator, share(held, elevator, 0.02), 0.25);
    let signals: (_, &[_]) = ("a short pulse of the elevator", &["angle of attack, rad", "pitch rate, rad/s"]);
    let fast = pulsed(held, signals, &[nod], 0.0, 1.2, |now| slots(now, &[Quantity::AlphaRad, Quantity::QRadps]));

    let push = (elevator, share(held, elevator, 0.02), 2.0);
    let climb = |now: &Held| {
        let velocity = motion::velocity(&now.y);
        vec![velocity.length(), (-velocity.z).atan2(velocity.x.hypot(velocity.y))]
    };
    let signals: (_, &[_]) = ("a long pulse of the elevator", &["speed, m/s", "angle of climb, rad"]);
    let slow = pulsed(held, signals, &[push], 8.0, 80.0, climb);

    let (kick, bank) = ((rudder, share(held, rudder, 0.05), 0.5), (aileron, share(held, aileron, 0.02), 0.25));
    let signals: (_, &[_]) =
        ("pulses of rudder and aileron", &["sideslip, rad", "roll rate, rad/s", "yaw rate, rad/s", "bank, rad"]);
    let of = [Quantity::BetaRad, Quantity::PRadps, Quantity::RRadps, Quantity::RollRad];
    let aside = pulsed(held, signals, &[kick, bank], 0.0, 12.0, |now| slots(now, &of));
    Ok([fast, slow, aside])
}

/// The modes that responses show.
///
/// # Errors
/// A sentence: a mode is not to be found.
pub fn found_in([fast, slow, aside]: &[Response; 3]) -> Result<Modes, String> {
    let missing = |what: &str| format!("expected a {what}, found none in the response");
    let short = linear::modes(&fast.free::<2>(), DT_S).and_then(|all| all.first().copied());
    let phugoid =
        linear::modes(&slow.free::<2>(), DT_S).and_then(|all| all.into_iter().find(|one| one.swing_radps > 0.0));
    let lateral = linear::modes(&aside.free::<4>(), DT_S).unwrap_or_default();
    let swings: Vec<Mode> = lateral.iter().copied().filter(|one| one.swing_radps > 1e-6).collect();
    let straight: Vec<Mode> = lateral.iter().copied().filter(|one| one.swing_radps <= 1e-6).collect();
    Ok(Modes {
        short_period: short.ok_or_else(|| missing("short period"))?,
        phugoid: phugoid.ok_or_else(|| missing("phugoid"))?,
        dutch_roll: swings.first().copied().ok_or_else(|| missing("Dutch roll"))?,
        roll: straight.first().copied().ok_or_else(|| missing("roll mode"))?,
        spiral: straight.get(1).copied().ok_or_else(|| missing("spiral"))?,
    })
}

/// Measures the modes of a trimmed flight.
///
/// # Errors
/// A sentence: a control is missing, or a mode is not to be found.
pub fn measure(held: &Held) -> Result<Modes, String> {
    found_in(&responses(held)?)
}
