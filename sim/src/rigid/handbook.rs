//! Figures of a handbook that a model is held to: `[handbook]` of `M.toml`.
//!
//! SI. All at the model's mass with full tanks, in standard air.

use serde::Deserialize;

/// See the module. What is left out is not compared.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Handbook {
    /// Where it is from.
    pub source: String,
    /// Stalls without power: flaps in the unit of `flaps_control`, calibrated speed, m/s.
    #[serde(default, deserialize_with = "crate::file::rows")]
    pub stall_mps: Vec<[f64; 2]>,
    /// Cruises: altitude (m), share of rated power, true speed (m/s).
    #[serde(default, deserialize_with = "crate::file::rows")]
    pub cruise: Vec<[f64; 3]>,
    /// Level speed at full throttle at sea level, m/s.
    pub fastest_mps: Option<f64>,
    /// Rate of climb at sea level and full throttle, m/s, and the speed it is flown at, m/s.
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    pub climb: Option<[f64; 2]>,
    /// Take-off at sea level, on a paved runway, no wind: speed at which it leaves the ground (m/s), ground roll (m).
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    pub takeoff: Option<[f64; 2]>,
    /// Landing the same: speed at touch-down (m/s), ground roll with full brakes (m).
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    pub landing: Option<[f64; 2]>,
}
