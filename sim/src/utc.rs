//! Date and time of day: UTC, as whole nanoseconds, and as a person writes it (ISO 8601).
//!
//! The calendar is the proleptic Gregorian one, without leap seconds. The simulation owns the clock, so it owns this
//! too; the command line reads its `--time` with the same [`UtcTime::parse`].
//!
//! Source of the day count: H. Hinnant, chrono-Compatible Low-Level Date Algorithms, 2021 (`days_from_civil`,
//! `civil_from_days`).

use std::fmt;

const SECOND_NS: i64 = 1_000_000_000;

/// A moment in UTC, without leap seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct UtcTime {
    /// Nanoseconds since 1970-01-01T00:00:00Z; years 1678 to 2261.
    pub unix_ns: i64,
}

/// Why a text is not a time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TimeError {
    found: String,
}

impl UtcTime {
    /// A moment from its calendar parts; `None` if there is no such day or hour, or the year is not in 1700..=2200.
    pub fn new(year: i32, month: u32, day: u32, hour: u32, minute: u32, second: u32) -> Option<Self> {
        let in_range =
            (1700..=2200).contains(&year) && (1..=12).contains(&month) && hour < 24 && minute < 60 && second < 60;
        if !in_range || day < 1 || day > days_in_month(year, month) {
            return None;
        }
        let seconds = days_from_civil(year, month, day) * 86_400 + i64::from(hour * 3_600 + minute * 60 + second);
        Some(Self { unix_ns: seconds * SECOND_NS })
    }

    /// Reads `YYYY-MM-DD` or `YYYY-MM-DDThh:mm[:ss[.fff]][Z|+hh:mm|-hh:mm]`, a space for the `T` too.
    ///
    /// Without an offset it is UTC, without a time midnight. The year written must be within 1700..=2200.
    ///
    /// # Errors
    /// [`TimeError`] says what was expected and what was found.
    pub fn parse(text: &str) -> Result<Self, TimeError> {
        read(text).ok_or_else(|| TimeError { found: text.chars().take(60).flat_map(char::escape_debug).collect() })
    }

    /// The moment some seconds later or, if negative, earlier; saturates at the ends of the range.
    pub fn plus_s(self, seconds: f64) -> Self {
        // A float cast saturates and takes NaN as 0.
        Self { unix_ns: self.unix_ns.saturating_add((seconds * 1e9).round() as i64) }
    }

    /// Seconds since 1970-01-01T00:00:00Z.
    pub fn unix_s(self) -> f64 {
        self.unix_ns as f64 / 1e9
    }

    /// (year, month, day, hour, minute, second), the second cut to a whole one.
    pub fn parts(self) -> (i32, u32, u32, u32, u32, u32) {
        let seconds = self.unix_ns.div_euclid(SECOND_NS);
        let (year, month, day) = civil_from_days(seconds.div_euclid(86_400));
        let of_day = seconds.rem_euclid(86_400) as u32;
        (year, month, day, of_day / 3_600, of_day / 60 % 60, of_day % 60)
    }
}

impl fmt::Display for UtcTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (year, month, day, hour, minute, second) = self.parts();
        write!(f, "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
    }
}

impl fmt::Display for TimeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected a time such as 2026-06-21T09:30:00Z or 2026-06-21T15:30+06:00 (UTC without an offset), ")?;
        write!(f, "year 1700..=2200, found `{}`", self.found)
    }
}

impl std::error::Error for TimeError {}

fn read(text: &str) -> Option<UtcTime> {
    let (date, rest) = text.split_once(['T', ' ']).unwrap_or((text, "00:00"));
    let (time, ahead_minutes) = split_offset(rest)?;
    let mut date = date.split('-');
    let (year, month, day) = (digits(date.next()?, 4)?, digits(date.next()?, 2)?, digits(date.next()?, 2)?);
    let mut time = time.split(':');
    let (hour, minute) = (digits(time.next()?, 2)?, digits(time.next()?, 2)?);
    let (second, fraction_ns) = time.next().map_or(Some((0, 0)), seconds)?;
    if date.next().is_some() || time.next().is_some() {
        return None;
    }
    let local = UtcTime::new(year as i32, month, day, hour, minute, second)?;
    // At most 14 hours off a year within 1700..=2200: far from the ends of i64.
    Some(UtcTime { unix_ns: local.unix_ns + fraction_ns - ahead_minutes * 60 * SECOND_NS })
}

fn digits(text: &str, count: usize) -> Option<u32> {
    (text.len() == count && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
}

/// Whole seconds and the nanoseconds of one to nine decimals.
fn seconds(text: &str) -> Option<(u32, i64)> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let count = fraction.len();
    let fraction_ns = i64::from(digits(fraction, count.clamp(1, 9))?) * 10_i64.pow(9 - count as u32);
    Some((digits(whole, 2)?, fraction_ns))
}

/// The time of day and the minutes that local time is ahead of UTC.
fn split_offset(text: &str) -> Option<(&str, i64)> {
    if let Some(time) = text.strip_suffix('Z') {
        return Some((time, 0));
    }
    let Some(at) = text.find(['+', '-']) else { return Some((text, 0)) };
    let (hours, minutes) = text[at + 1..].split_once(':')?;
    let (hours, minutes) = (digits(hours, 2)?, digits(minutes, 2)?);
    if hours > 14 || minutes > 59 {
        return None;
    }
    let ahead = i64::from(hours * 60 + minutes);
    Some((&text[..at], if text[at..].starts_with('-') { -ahead } else { ahead }))
}

fn days_in_month(year: i32, month: u32) -> u32 {
    match month {
        2 if year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Days since 1970-01-01 in the Gregorian calendar.
fn days_from_civil(year: i32, month: u32, day: u32) -> i64 {
    // The year is taken to begin in March, so that the leap day is its last.
    let year = i64::from(year) - i64::from(month <= 2);
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * (i64::from(month) + if month > 2 { -3 } else { 9 }) + 2) / 5 + i64::from(day) - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// The inverse of [`days_from_civil`].
fn civil_from_days(days: i64) -> (i32, u32, u32) {
    let days = days + 719_468;
    let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let march_month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * march_month + 2) / 5 + 1;
    let month = if march_month < 10 { march_month + 3 } else { march_month - 9 };
    ((year_of_era + era * 400 + i64::from(month <= 2)) as i32, month as u32, day as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_moments_have_their_unix_seconds() {
        // From `date -u -d TEXT +%s` of GNU coreutils 9.1.
        for (text, unix_s) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2001-09-09T01:46:40Z", 1e9),
            ("2024-02-29", 1_709_164_800.0),
            ("2026-06-21T09:30:00Z", 1_782_034_200.0),
            ("2026-06-21 09:30", 1_782_034_200.0),
            ("2000-02-29T23:59:59Z", 951_868_799.0),
            ("1900-03-01T00:00Z", -2_203_891_200.0),
            ("2199-12-31T12:00:00.5", 7_258_075_200.5),
            ("2026-06-21T15:30+06:00", 1_782_034_200.0),
            ("2026-06-21T04:00:00-05:30", 1_782_034_200.0),
        ] {
            assert_eq!(UtcTime::parse(text).map(UtcTime::unix_s), Ok(unix_s), "{text}");
        }
        assert_eq!(UtcTime::parse("1970-01-01T00:00:00.000000001Z").unwrap().unix_ns, 1);
        assert_eq!(UtcTime::parse("1970-01-01T00:00:00.25+00:01").unwrap().unix_ns, -59_750_000_000);
        assert_eq!(UtcTime::parse("2026-06-21T15:30+06:00").unwrap().to_string(), "2026-06-21T09:30:00Z");
    }

    #[test]
    fn what_is_not_a_moment_is_refused() {
        for text in [
            "",
            "T",
            "Z",
            "now",
            "2026",
            "2026-06-21Z",
            "2026-06-21T",
            "2026-06-21T12",
            "2026-13-01T00:00Z",
            "2026-00-01T00:00Z",
            "2026-02-29T00:00Z",
            "1900-02-29T00:00Z",
            "2026-04-31T00:00Z",
            "2026-06-21T24:00Z",
            "2026-06-21T23:60Z",
            "2026-06-21T23:59:60Z",
            "2026-06-21T23:59:NaN",
            "2026-06-21T23:59:1e",
            "2026-06-21T1:2:3",
            "+026-06-21T00:00Z",
            "-026-01-01",
            "2026-6-21T00:00Z",
            "0000-01-01T00:00Z",
            "1699-12-31",
            "2201-01-01",
            "9999-01-01T00:00Z",
            "2026-06-21T00:00+25:00",
            "2026-06-21T00:00+6",
            "2026-06-21T00:00:00:00Z",
            "2026-06-21T00:00ZZ",
            "2026-06-21-01T00:00Z",
            "２026-06-21T00:00Z",
            "٢٠٢٦-01-01",
            "2026-06-21T00:00é",
            "2026-06-21T00:00:00.Z",
            "2026-06-21T00:00:00.0123456789Z",
            "2026-06-21T0é:00",
        ] {
            let said = UtcTime::parse(text).expect_err(text).to_string();
            assert!(said.contains("2026-06-21T09:30:00Z") && said.ends_with(&format!("found `{text}`")), "{said}");
        }
    }

    #[test]
    fn every_day_comes_back_as_it_was() {
        let mut expected = (1700, 1, 1);
        for days in days_from_civil(1700, 1, 1)..=days_from_civil(2200, 12, 31) {
            let moment = UtcTime { unix_ns: (days * 86_400 + 45_296) * SECOND_NS + 999_999_999 };
            let (year, month, day) = expected;
            assert_eq!(moment.parts(), (year, month, day, 12, 34, 56));
            assert_eq!(
                UtcTime::new(year, month, day, 12, 34, 56).map(|t| t.unix_ns + 999_999_999),
                Some(moment.unix_ns)
            );
            expected = match (month, day) {
                (12, 31) => (year + 1, 1, 1),
                _ if day == days_in_month(year, month) => (year, month + 1, 1),
                _ => (year, month, day + 1),
            };
        }
        assert_eq!(expected, (2201, 1, 1));
    }
}
