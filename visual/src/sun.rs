//! Where the sun stands at a date, a time and a place.
//!
//! Azimuth is clockwise from TRUE north; a world's grid north differs from it by the convergence, which the caller
//! adds. No refraction: the scene's light comes from where the sun is.
//!
//! Source: I. Reda and A. Andreas, Solar position algorithm for solar radiation applications, 2003, through the crate
//! `solar-positioning` (0.0003 degrees).

use solar_positioning::{Location, SolarPositions, delta_t, time::JulianDate};
use std::fmt;
use std::str::FromStr;

/// A moment in universal time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Utc {
    /// Year, 1600 to 2999.
    pub year: i32,
    /// Month, 1 to 12.
    pub month: u32,
    /// Day of the month, from 1.
    pub day: u32,
    /// Seconds since midnight, 0 to 86,400 (not included).
    pub second_of_day: f64,
}

/// Why a text or a place is not usable.
#[derive(Clone, Debug, PartialEq)]
pub enum SunError {
    /// The text is not a date and time.
    Text {
        /// What stands there.
        found: String,
    },
    /// A field is out of its range.
    Range {
        /// Which field.
        field: &'static str,
        /// The range, both ends included.
        expected: (i64, i64),
        /// The value.
        found: i64,
    },
    /// Latitude or longitude is not a place.
    Place {
        /// Latitude, degrees.
        latitude_deg: f64,
        /// Longitude, degrees.
        longitude_deg: f64,
    },
    /// The method has no answer.
    Method(String),
}

impl fmt::Display for SunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text { found } => {
                write!(f, "expected a UTC time such as 2026-06-21T09:30:00Z, found \"{found}\"")
            }
            Self::Range { field, expected: (low, high), found } => {
                write!(f, "expected the {field} between {low} and {high}, found {found}")
            }
            Self::Place { latitude_deg, longitude_deg } => write!(
                f,
                "expected a latitude of -90 to 90 and a longitude of -180 to 180 degrees, \
                 found {latitude_deg}, {longitude_deg}"
            ),
            Self::Method(reason) => write!(f, "the sun's position is not known there and then: {reason}"),
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

impl FromStr for Utc {
    type Err = SunError;

    /// Reads `YYYY-MM-DDTHH:MM[:SS[.sss]][Z]`; a blank may stand for the `T`. Always UTC, other zones are refused.
    fn from_str(text: &str) -> Result<Self, SunError> {
        let wrong = || SunError::Text { found: text.chars().take(40).collect() };
        let bare = text.trim();
        let bare = bare.strip_suffix(['Z', 'z']).unwrap_or(bare);
        let (date, time) = bare.split_once(['T', 't', ' ']).ok_or_else(wrong)?;
        let number = |part: &str, digits: usize| -> Result<u32, SunError> {
            let plain = part.len() == digits && part.bytes().all(|byte| byte.is_ascii_digit());
            if plain { part.parse().map_err(|_| wrong()) } else { Err(wrong()) }
        };
        let date: Vec<&str> = date.split('-').collect();
        let time: Vec<&str> = time.split(':').collect();
        let (&[year, month, day], &[hour, minute, ref rest @ ..]) = (&date[..], &time[..]) else {
            return Err(wrong());
        };
        let second: f64 = match rest {
            [] => 0.0,
            [second] => {
                let (whole, fraction) = second.split_once('.').unwrap_or((second, "0"));
                let digits = !fraction.is_empty()
                    && fraction.len() <= 9
                    && fraction.bytes().all(|byte| byte.is_ascii_digit());
                if !digits {
                    return Err(wrong());
                }
                f64::from(number(whole, 2)?) + format!("0.{fraction}").parse::<f64>().map_err(|_| wrong())?
            }
            _ => return Err(wrong()),
        };
        let year = i32::try_from(number(year, 4)?).map_err(|_| wrong())?;
        let (month, day) = (number(month, 2)?, number(day, 2)?);
        let (hour, minute) = (number(hour, 2)?, number(minute, 2)?);
        within("year", year.into(), 1600, 2999)?;
        within("month", month.into(), 1, 12)?;
        within("day", day.into(), 1, days(year, month).into())?;
        within("hour", hour.into(), 0, 23)?;
        within("minute", minute.into(), 0, 59)?;
        within("second", second as i64, 0, 59)?;
        Ok(Self { year, month, day, second_of_day: f64::from(hour * 3600 + minute * 60) + second })
    }
}

impl Utc {
    /// The moment some seconds later (or earlier, negative), across days, months and years.
    pub fn plus_s(self, seconds: f64) -> Self {
        let total = self.second_of_day + if seconds.is_finite() { seconds.clamp(-1e9, 1e9) } else { 0.0 };
        let second_of_day = total.rem_euclid(86_400.0);
        let mut later = Self { second_of_day, ..self };
        let mut whole_days = ((total - second_of_day) / 86_400.0).round() as i64;
        while whole_days > 0 {
            later.day += 1;
            if later.day > days(later.year, later.month) {
                (later.day, later.month) = (1, later.month + 1);
                if later.month > 12 {
                    (later.month, later.year) = (1, later.year + 1);
                }
            }
            whole_days -= 1;
        }
        while whole_days < 0 {
            if later.day > 1 {
                later.day -= 1;
            } else {
                (later.month, later.year) =
                    if later.month > 1 { (later.month - 1, later.year) } else { (12, later.year - 1) };
                later.day = days(later.year, later.month);
            }
            whole_days += 1;
        }
        later
    }
}

impl fmt::Display for Utc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let second = self.second_of_day as u32;
        let (hour, minute) = (second / 3600, second / 60 % 60);
        write!(f, "{:04}-{:02}-{:02}T{hour:02}:{minute:02}:{:02}Z", self.year, self.month, self.day, second % 60)
    }
}

/// The sun's position seen from a place, degrees north and east (WGS84 latitude).
///
/// # Errors
/// [`SunError::Place`] for a place that is none, [`SunError::Method`] where the method refuses.
pub fn position(at: Utc, latitude_deg: f64, longitude_deg: f64) -> Result<SunPosition, SunError> {
    if !(-90.0..=90.0).contains(&latitude_deg) || !(-180.0..=180.0).contains(&longitude_deg) {
        return Err(SunError::Place { latitude_deg, longitude_deg });
    }
    let refused = |error: solar_positioning::Error| SunError::Method(error.to_string());
    let delta_t_s = delta_t::estimate_from_date(at.year, at.month).map_err(refused)?;
    let minute_of_day = (at.second_of_day / 60.0).floor().clamp(0.0, 1439.0);
    let second = (at.second_of_day - minute_of_day * 60.0).clamp(0.0, 59.999_999);
    let minutes = minute_of_day as u32;
    let time = JulianDate::from_utc(at.year, at.month, at.day, minutes / 60, minutes % 60, second, delta_t_s)
        .map_err(refused)?;
    let place = Location { latitude: latitude_deg, longitude: longitude_deg };
    let found = SolarPositions::new().at_from_julian(time, place, 0.0, None).map_err(refused)?;
    Ok(SunPosition {
        true_azimuth_rad: found.azimuth().to_radians(),
        elevation_rad: found.elevation_angle().to_radians(),
    })
}

fn within(field: &'static str, found: i64, low: i64, high: i64) -> Result<(), SunError> {
    if (low..=high).contains(&found) { Ok(()) } else { Err(SunError::Range { field, expected: (low, high), found }) }
}

fn days(year: i32, month: u32) -> u32 {
    match month {
        4 | 6 | 9 | 11 => 30,
        2 if year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) => 29,
        2 => 28,
        _ => 31,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utc(text: &str) -> Utc {
        text.parse().expect(text)
    }

    #[test]
    fn the_worked_example_of_the_spa_report() {
        // Reda and Andreas 2003, table A5.1: Golden, Colorado, 2003-10-17 12:30:30 local = 19:30:30 UTC, 1830.14 m,
        // delta T 67 s, refraction on: zenith 50.11162, azimuth 194.34024 degrees. Ours is at sea level and without
        // refraction: 0.0164 degrees of elevation here, parallax below 0.0001.
        let sun = position(utc("2003-10-17T19:30:30Z"), 39.742_476, -105.178_6).expect("position");
        assert!((sun.true_azimuth_rad.to_degrees() - 194.340_24).abs() < 0.002, "{sun:?}");
        assert!((sun.elevation_rad.to_degrees() - (90.0 - 50.111_62)).abs() < 0.02, "{sun:?}");
    }

    #[test]
    fn texts_are_read_or_refused_with_a_reason() {
        assert_eq!(utc("2026-06-21T09:30:15.5Z").second_of_day, 34_215.5);
        assert_eq!(utc("2026-06-21 09:30").to_string(), "2026-06-21T09:30:00Z");
        for wrong in ["", "noon", "2026-6-21T09:30Z", "2026-06-21", "2026-06-21T09:30:00+06:00", "2026-06-21T9:30",
            "2026-06-21T09:30:1e9", "2026-06-21T09:30:00.Z", "+026-06-21T09:30", "2026-06-21T09:30:00:00", "\u{ff12}026-06-21T09:30"]
        {
            assert!(matches!(wrong.parse::<Utc>(), Err(SunError::Text { .. })), "{wrong}");
        }
        for wrong in ["2026-02-29T00:00Z", "2026-13-01T00:00Z", "2026-00-01T00:00Z", "2026-01-01T24:00Z", "2026-01-01T00:60Z",
            "2026-01-01T00:00:60Z", "0000-01-01T00:00Z"]
        {
            assert!(matches!(wrong.parse::<Utc>(), Err(SunError::Range { .. })), "{wrong}");
        }
        assert!(position(utc("2026-06-21T09:30Z"), f64::NAN, 0.0).is_err());
        assert!(position(utc("2026-06-21T09:30Z"), 91.0, 0.0).is_err());
    }

    #[test]
    fn seconds_carry_over_days_and_years() {
        assert_eq!(utc("2027-12-31T23:59:30Z").plus_s(60.0).to_string(), "2028-01-01T00:00:30Z");
        assert_eq!(utc("2028-03-01T00:00:00Z").plus_s(-1.0).to_string(), "2028-02-29T23:59:59Z");
        assert_eq!(utc("2026-01-01T00:00:00Z").plus_s(365.0 * 86_400.0).to_string(), "2027-01-01T00:00:00Z");
        assert_eq!(utc("2026-01-01T00:00:00Z").plus_s(f64::NAN).to_string(), "2026-01-01T00:00:00Z");
    }
}
