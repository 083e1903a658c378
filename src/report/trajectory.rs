//! What `trajectory` reports of a shot.

use serde::Serialize;

/// `trajectory`: the end of a shot.
#[derive(Debug, Clone, Default, Serialize)]
pub struct TrajectoryReport {
    /// Way over the ground along the azimuth.
    pub range_m: f64,
    /// Time of flight.
    pub time_s: f64,
    /// Speed over the Earth at the end.
    pub speed_mps: f64,
    /// Descent under the horizontal of the place.
    pub fall_deg: f64,
    /// To the right of the azimuth.
    pub aside_m: f64,
    /// Under the line of the bore.
    pub drop_m: f64,
    /// Mach number; 0 where there is no air.
    pub mach: f64,
    /// Where it ended.
    pub lat_deg: f64,
    /// Where it ended.
    pub lon_deg: f64,
    /// Where it ended.
    pub altitude_m: f64,
    /// The greatest altitude.
    pub apex_altitude_m: f64,
    /// What ended it.
    pub event: String,
    /// `vacuum`, `drag table` or `modified point mass` (an estimate of spin drift beside the point mass).
    pub tier: &'static str,
    /// Bore over the horizon, the sight's zero included.
    pub elevation_deg: f64,
    /// Clockwise from north.
    pub azimuth_deg: f64,
    /// Gyroscopic stability at the muzzle; null without spin.
    pub stability: Option<f64>,
    /// `rk4` and so on.
    pub integrator: &'static str,
    /// Length of a step.
    pub dt_s: f64,
    /// Steps taken.
    pub steps: u64,
    /// Rows of the trajectory.
    pub rows: usize,
    /// Where they were written.
    pub out: Option<String>,
}
