//! Where the sun stands at a moment and a place.
//!
//! Azimuth is clockwise from TRUE north; a world's grid north differs from it by the convergence, which the caller
//! adds. No refraction: the scene's light comes from where the sun is.
//!
//! Source: I. Reda and A. Andreas, Solar position algorithm for solar radiation applications, 2003, through the crate
//! `solar-positioning` (0.0003 degrees).

use solar_positioning::{Location, SolarPositions, delta_t, time::JulianDate};
use std::fmt;

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum SunError {
    /// Latitude or longitude is not a place.
    Place {
        /// Latitude, degrees.
        latitude_deg: f64,
        /// Longitude, degrees.
        longitude_deg: f64,
    },
    /// The method has no answer for the moment.
    Moment {
        /// Seconds since 1970, UTC.
        unix_s: f64,
        /// What the method says.
        reason: String,
    },
}

impl fmt::Display for SunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Place { latitude_deg, longitude_deg } => write!(
                f,
                "expected a latitude of -90 to 90 and a longitude of -180 to 180 degrees, \
                 found {latitude_deg}, {longitude_deg}"
            ),
            Self::Moment { unix_s, reason } => {
                write!(f, "the sun's position {unix_s} seconds after 1970 is not known: {reason}")
            }
        }
    }
}

impl std::error::Error for SunError {}

/// The sun's place in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Clockwise from true north, radians.
    pub true_azimuth_rad: f64,
    /// Above the horizon, radians, without refraction.
    pub elevation_rad: f64,
}

/// The sun's position at `unix_s` seconds since 1970-01-01T00:00Z (UTC), seen from a place, degrees north and east.
///
/// # Errors
/// [`SunError::Place`] for a place that is none, [`SunError::Moment`] where the method refuses.
pub fn position(unix_s: f64, latitude_deg: f64, longitude_deg: f64) -> Result<SunPosition, SunError> {
    let year = checked_year(unix_s, latitude_deg, longitude_deg)?;
    let refused = |reason: String| SunError::Moment { unix_s, reason };
    let delta_t_s = delta_t::estimate(year).map_err(|error| refused(error.to_string()))?;
    let time =
        JulianDate::new(unix_s / 86_400.0 + 2_440_587.5, delta_t_s).map_err(|error| refused(error.to_string()))?;
    let place = Location { latitude: latitude_deg, longitude: longitude_deg };
    let found =
        SolarPositions::new().at_from_julian(time, place, 0.0, None).map_err(|error| refused(error.to_string()))?;
    Ok(SunPosition {
        true_azimuth_rad: found.azimuth().to_radians(),
        elevation_rad: found.elevation_angle().to_radians(),
    })
}

/// The year of a moment, with its fraction, where moment and place are such that one can rely on an answer.
pub(crate) fn checked_year(unix_s: f64, latitude_deg: f64, longitude_deg: f64) -> Result<f64, SunError> {
    if !(-90.0..=90.0).contains(&latitude_deg) || !(-180.0..=180.0).contains(&longitude_deg) {
        return Err(SunError::Place { latitude_deg, longitude_deg });
    }
    // Years beyond these have no difference between universal and terrestrial time that one could rely on.
    let year = 1970.0 + unix_s / 31_556_952.0;
    match (1600.0..3000.0).contains(&year) {
        true => Ok(year),
        false => Err(SunError::Moment { unix_s, reason: "expected a year of 1600 to 2999".into() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worked_example_of_the_spa_report() {
        // Reda and Andreas 2003, table A5.1: Golden, Colorado, 2003-10-17 12:30:30 local = 19:30:30 UTC, 1830.14 m,
        // delta T 67 s, refraction on: zenith 50.11162, azimuth 194.34024 degrees. Ours is at sea level and without
        // refraction: 0.0164 degrees of elevation here, parallax below 0.0001.
        let sun = position(1_066_419_030.0, 39.742_476, -105.178_6).expect("position");
        assert!((sun.true_azimuth_rad.to_degrees() - 194.340_24).abs() < 0.002, "{sun:?}");
        assert!((sun.elevation_rad.to_degrees() - (90.0 - 50.111_62)).abs() < 0.02, "{sun:?}");
    }

    #[test]
    fn no_place_and_no_moment_have_no_sun() {
        assert!(position(0.0, f64::NAN, 0.0).is_err());
        assert!(position(0.0, 91.0, 0.0).is_err());
        for wrong in [f64::NAN, f64::INFINITY, -1e12, 1e12] {
            assert!(matches!(position(wrong, 42.0, 78.0), Err(SunError::Moment { .. })), "{wrong}");
        }
    }
}
