//! What `height` reports of points of the ground.

use serde::Serialize;

/// `height`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Heights {
    /// In the order they were asked.
    pub points: Vec<HeightPoint>,
}

/// The ground at one point.
#[derive(Debug, Clone, Default, Serialize)]
pub struct HeightPoint {
    /// Latitude.
    pub lat_deg: f64,
    /// Longitude.
    pub lon_deg: f64,
    /// X in the world.
    pub x_m: f64,
    /// Z in the world.
    pub z_m: f64,
    /// Above mean sea level; null where there is no data.
    pub height_m: Option<f64>,
    /// Upward, unit length, world axes; null where there is no data.
    pub normal: Option<[f64; 3]>,
    /// `ground`, or `water` inside a lake's outline; null where there is no data.
    pub surface: Option<&'static str>,
}
