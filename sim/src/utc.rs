//! Date and time of day, UTC, as whole nanoseconds.

use std::fmt;

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
        Some(Self { unix_ns: seconds * 1_000_000_000 })
    }

    /// Reads `YYYY-MM-DD`, optionally with `THH:MM` or `THH:MM:SS` and an optional `Z`: always UTC.
    ///
    /// # Errors
    /// [`TimeError`] says what was expected and what was found.
    pub fn parse(text: &str) -> Result<Self, TimeError> {
        let error = || TimeError { found: text.chars().take(40).collect() };
        let body = text.strip_suffix('Z').unwrap_or(text);
        let (date, time) = body.split_once(['T', ' ']).unwrap_or((body, "00:00"));
        let numbers = |part: &str, separator: char| -> Option<Vec<u32>> {
            let number = |n: &str| (n.len() <= 4 && n.bytes().all(|b| b.is_ascii_digit())).then(|| n.parse().ok())?;
            part.split(separator).map(number).collect()
        };
        let date = numbers(date, '-').ok_or_else(error)?;
        let time = numbers(time, ':').ok_or_else(error)?;
        let (&[year, month, day], &[hour, minute, ref second @ ..]) = (&date[..], &time[..]) else {
            return Err(error());
        };
        let second = match second {
            [] => 0,
            [second] => *second,
            _ => return Err(error()),
        };
        Self::new(year as i32, month, day, hour, minute, second).ok_or_else(error)
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
        let seconds = self.unix_ns.div_euclid(1_000_000_000);
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
        write!(f, "a time must read like 2026-06-21T06:30:00Z (UTC, years 1700 to 2200), found {:?}", self.found)
    }
}

impl std::error::Error for TimeError {}

fn days_in_month(year: i32, month: u32) -> u32 {
    match month {
        2 if year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

/// Days since 1970-01-01 in the Gregorian calendar. Source: H. Hinnant, chrono-Compatible Low-Level Date Algorithms, 2021.
fn days_from_civil(year: i32, month: u32, day: u32) -> i64 {
    // The year is taken to begin in March, so that the leap day is its last.
    let year = i64::from(year) - i64::from(month <= 2);
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let of_year = (153 * (i64::from(month) + if month > 2 { -3 } else { 9 }) + 2) / 5 + i64::from(day) - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

/// The inverse of [`days_from_civil`], from the same source.
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
    fn calendar_dates_are_those_of_the_unix_epoch() {
        assert_eq!(UtcTime::new(1970, 1, 1, 0, 0, 0).unwrap().unix_ns, 0);
        // `date -u -d @1000000000`: 2001-09-09 01:46:40; `date -u -d @1709164800`: 2024-02-29.
        assert_eq!(UtcTime::parse("2001-09-09T01:46:40Z").unwrap().unix_s(), 1e9);
        assert_eq!(UtcTime::parse("2024-02-29").unwrap().unix_s(), 1_709_164_800.0);
        for days in (-98_000..84_000).step_by(7) {
            let (year, month, day) = civil_from_days(days);
            assert_eq!(days_from_civil(year, month, day), days);
        }
    }

    #[test]
    fn texts_that_are_no_time_are_refused() {
        let good = UtcTime::parse("2026-06-21 06:30").unwrap();
        assert_eq!(good.to_string(), "2026-06-21T06:30:00Z");
        for text in [
            "",
            "Z",
            "2026",
            "2026-13-01",
            "2025-02-29",
            "2026-06-21T24:00",
            "2026-06-21T1:2:3:4",
            "٢٠٢٦-01-01",
            "-026-01-01",
            "9999-01-01",
            "2026-06-21T12",
        ] {
            let error = UtcTime::parse(text).expect_err(text).to_string();
            assert!(error.contains("2026-06-21T06:30:00Z"));
        }
    }
}
