//! What `modes` reports of a model: its modes beside MIL-F-8785C, its figures beside its handbook.

use serde::Serialize;

/// `modes`.
#[derive(Debug, Clone, Serialize)]
pub struct ModesReport {
    /// The model's file.
    pub model: String,
    /// Altitude of the trimmed flight.
    pub altitude_m: f64,
    /// Its speed.
    pub speed_mps: f64,
    /// The modes.
    pub modes: Vec<ModeFound>,
    /// Each beside its limit of level 1.
    pub limits: Vec<LimitFound>,
    /// Where the handbook's figures are from.
    pub handbook_source: Option<String>,
    /// Each figure beside the handbook's.
    pub handbook: Vec<FigureFound>,
    /// Whether all is within.
    pub passes: bool,
}

/// A mode.
#[derive(Debug, Clone, Serialize)]
pub struct ModeFound {
    /// Its name.
    pub name: &'static str,
    /// Rate, negative where it dies out.
    pub rate_radps: f64,
    /// Frequency, 0 where it does not swing.
    pub swing_radps: f64,
    /// Damping ratio, of one that swings.
    pub damping: Option<f64>,
    /// Time constant.
    pub time_s: f64,
}

/// A limit.
#[derive(Debug, Clone, Serialize)]
pub struct LimitFound {
    /// What it is.
    pub name: &'static str,
    /// What was found.
    pub found: f64,
    /// Least that is good; null is no limit.
    pub least: f64,
    /// Most that is good; null is no limit.
    pub most: f64,
    /// Whether it is within.
    pub passes: bool,
}

/// A figure.
#[derive(Debug, Clone, Serialize)]
pub struct FigureFound {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// What the model gives.
    pub found: f64,
    /// What the handbook says.
    pub handbook: f64,
    /// How far it is off, as a part.
    pub off: f64,
    /// How far it may be.
    pub within: f64,
    /// Whether it is within.
    pub passes: bool,
}
