//! What `bench` reports: measurements beside their yardsticks, and what could not be measured.

use serde::Serialize;

/// `bench`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Bench {
    /// What was measured.
    pub results: Vec<BenchResult>,
    /// What could not be.
    pub skipped: Vec<Skipped>,
}

/// A measurement beside its yardstick.
#[derive(Debug, Clone, Default, Serialize)]
pub struct BenchResult {
    /// What was measured.
    pub name: String,
    /// Unit of `ours` and of the yardstick's value.
    pub unit: String,
    /// Median over the rounds.
    pub ours: f64,
    /// What it is compared with; null where there is none.
    pub yardstick: Option<Yardstick>,
    /// How many times better than the yardstick.
    pub ratio: Option<f64>,
    /// 95 % confidence interval of the ratio, over the rounds.
    pub ratio_ci: Option<[f64; 2]>,
    /// Rounds, each with both.
    pub rounds: u32,
    /// First and third quartile of `ours` over the rounds.
    pub quartiles: Option<[f64; 2]>,
    /// What one must know to read the figure.
    pub note: Option<String>,
}

/// What is compared with.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Yardstick {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Median over the rounds.
    pub value: f64,
}

/// What was not measured, and why.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Skipped {
    /// The measurement.
    pub name: String,
    /// The reason.
    pub reason: String,
}
