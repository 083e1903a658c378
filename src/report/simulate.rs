//! What `simulate` reports of a flight: how it ended, how stiff it was, what trim found.

use serde::Serialize;
use std::collections::BTreeMap;

/// `simulate`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Simulated {
    /// How it ended: `end`, `stop: ..` or `failed`.
    pub event: String,
    /// When, seconds.
    pub time_s: f64,
    /// Rows given.
    pub rows: u64,
    /// Steps taken, pieces counted.
    pub steps: u64,
    /// How short the steps had to be.
    pub stiffness: Stiffness,
    /// What trim found.
    pub trim: Option<TrimFound>,
    /// The last row, by column, in the order of the file.
    pub last: serde_json::Map<String, serde_json::Value>,
    /// The file of the rows.
    pub out: Option<String>,
}

/// The fastest mode of a body, and what a step makes of it.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Stiffness {
    /// Speed that it was taken at.
    pub speed_mps: f64,
    /// Its greatest eigenvalue, 1/s.
    pub lambda_radps: f64,
    /// The same times the step.
    pub lambda_h: f64,
    /// The integrator's limit for it.
    pub limit: f64,
    /// Most pieces that a step was cut into.
    pub pieces: u32,
}

/// What trim found.
#[derive(Debug, Clone, Default, Serialize)]
pub struct TrimFound {
    /// The names that were varied, with their values.
    pub values: BTreeMap<String, f64>,
    /// What is left of each acceleration.
    pub residuals: BTreeMap<String, f64>,
}
