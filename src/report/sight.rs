//! What `sight` reports of a line: whether the ground is in its way, and how near it comes.

use serde::Serialize;

/// `sight`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Sight {
    /// Whether nothing is between.
    pub visible: bool,
    /// The first point of the ground that is in the way.
    pub hit: Option<Hit>,
    /// Least height of the line above the ground; negative where it is cut, null where there is no data under it.
    pub clearance_min_m: Option<f64>,
    /// Where along the line that is, from its beginning.
    pub clearance_min_at_m: Option<f64>,
    /// Length of the line.
    pub distance_m: f64,
    /// Share of the line that has ground under it, 0..=1; the rest is void or beyond the world, and hides nothing.
    pub ground_share: f64,
}

/// Where a line meets the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Hit {
    /// Latitude.
    pub lat_deg: f64,
    /// Longitude.
    pub lon_deg: f64,
    /// X in the world.
    pub x_m: f64,
    /// Z in the world.
    pub z_m: f64,
    /// Above mean sea level.
    pub height_m: f64,
    /// From the line's beginning.
    pub distance_m: f64,
}
