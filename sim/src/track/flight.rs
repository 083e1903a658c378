//! A flight as a person writes it: places in TOML.

use super::{TrackError, check};
use serde::Deserialize;

/// The scenic flight over the default world, as data.
pub const ISSYK_KUL_FLIGHT: &str = include_str!("../../../assets/flights/issyk_kul.toml");

/// A flight as a person writes it.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flight {
    /// Its name.
    pub name: String,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// Places in order.
    pub waypoint: Vec<Waypoint>,
}

/// A place of a flight.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waypoint {
    /// Geodetic latitude, degrees north.
    pub lat_deg: f64,
    /// Longitude, degrees east.
    pub lon_deg: f64,
    /// Above mean sea level, metres.
    pub alt_m: f64,
    /// Name of a picture worth taking here.
    pub picture: Option<String>,
}

impl Flight {
    /// Reads a flight.
    ///
    /// # Errors
    /// [`TrackError`] names what is wrong.
    pub fn parse(text: &str) -> Result<Self, TrackError> {
        let flight: Self = toml::from_str(text).map_err(|error| TrackError::Syntax(error.to_string()))?;
        check("speed_mps", "0..=12000", flight.speed_mps, 0.0, 12_000.0)?;
        for place in &flight.waypoint {
            check("lat_deg", "-90..=90", place.lat_deg, -90.0, 90.0)?;
            check("lon_deg", "-180..=180", place.lon_deg, -180.0, 180.0)?;
            check("alt_m", "-500..=100000", place.alt_m, -500.0, 100_000.0)?;
        }
        Ok(flight)
    }
}
