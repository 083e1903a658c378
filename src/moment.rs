//! A moment in time as a person writes it: ISO 8601, read to UTC.
//!
//! The calendar is the proleptic Gregorian one, without leap seconds. Source of the day count: H. Hinnant,
//! chrono-Compatible Low-Level Date Algorithms, 2013 (`days_from_civil`, `civil_from_days`).

use std::fmt;

const DAY_S: f64 = 86_400.0;

/// A moment. Invariant: its UTC year is within 1899..=2200, so the seconds are finite and exact to 0.1 us.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Moment {
    /// Seconds since 1970-01-01T00:00:00Z.
    pub unix_s: f64,
}

/// A moment's date and time of day, UTC.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Civil {
    /// Year.
    pub year: i32,
    /// Month, 1..=12.
    pub month: u32,
    /// Day of the month, 1..=31.
    pub day: u32,
    /// Hour, 0..=23.
    pub hour: u32,
    /// Minute, 0..=59.
    pub minute: u32,
    /// Second, 0 <= s < 60.
    pub second_s: f64,
}

/// Why a text is not a moment; the text that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NotAMoment(String);

impl fmt::Display for NotAMoment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown: String = self.0.chars().take(60).flat_map(char::escape_debug).collect();
        write!(f, "expected a time such as 2026-06-21T09:30:00Z or 2026-06-21T15:30+06:00 (UTC without an offset), ")?;
        write!(f, "year 1900..=2199, found `{shown}`")
    }
}

impl std::error::Error for NotAMoment {}

/// Reads `YYYY-MM-DDThh:mm[:ss[.fff]][Z|+hh:mm|-hh:mm]`; without an offset it is UTC.
///
/// # Errors
/// [`NotAMoment`] if the form, a number's range or the calendar is not kept.
pub fn parse(text: &str) -> Result<Moment, NotAMoment> {
    read(text).ok_or_else(|| NotAMoment(text.to_owned()))
}

fn read(text: &str) -> Option<Moment> {
    let (date, rest) = text.split_once('T')?;
    let mut date = date.split('-');
    let year = digits(date.next()?, 4)? as i32;
    let month = digits(date.next()?, 2)?;
    let day = digits(date.next()?, 2)?;
    let (time, offset_minutes) = split_offset(rest)?;
    let mut time = time.split(':');
    let hour = digits(time.next()?, 2)?;
    let minute = digits(time.next()?, 2)?;
    let second_s = time.next().map_or(Some(0.0), seconds)?;
    let whole = date.next().is_none() && time.next().is_none();
    let in_range = (1900..=2199).contains(&year) && (1..=12).contains(&month) && hour < 24 && minute < 60;
    if !whole || !in_range || day < 1 || day > days_of_month(year, month) {
        return None;
    }
    let minutes = i64::from(hour) * 60 + i64::from(minute) - offset_minutes;
    Some(Moment { unix_s: days_since_1970(year, month, day) as f64 * DAY_S + minutes as f64 * 60.0 + second_s })
}

fn digits(text: &str, count: usize) -> Option<u32> {
    (text.len() == count && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
}

fn seconds(text: &str) -> Option<f64> {
    let (whole, fraction) = text.split_once('.').unwrap_or((text, "0"));
    let plain = (1..=9).contains(&fraction.len()) && fraction.bytes().all(|b| b.is_ascii_digit());
    (digits(whole, 2)? < 60 && plain).then(|| text.parse().ok())?
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

fn days_of_month(year: i32, month: u32) -> u32 {
    match month {
        2 if year % 4 == 0 && (year % 100 != 0 || year % 400 == 0) => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    }
}

fn days_since_1970(year: i32, month: u32, day: u32) -> i64 {
    // Years begin in March here, so that the leap day is the last.
    let year = i64::from(year) - i64::from(month <= 2);
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * (i64::from(month) + if month > 2 { -3 } else { 9 }) + 2) / 5 + i64::from(day) - 1;
    era * 146_097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719_468
}

impl Moment {
    /// Its date and time of day, UTC.
    pub fn civil(self) -> Civil {
        let days = (self.unix_s / DAY_S).floor();
        let within_s = self.unix_s - days * DAY_S;
        let shifted = days as i64 + 719_468;
        let era = shifted.div_euclid(146_097);
        let day_of_era = shifted.rem_euclid(146_097);
        let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
        let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let shifted_month = (5 * day_of_year + 2) / 153;
        let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
        let minutes = (within_s / 60.0).floor();
        Civil {
            year: (year_of_era + era * 400 + i64::from(month <= 2)) as i32,
            month: month as u32,
            day: (day_of_year - (153 * shifted_month + 2) / 5 + 1) as u32,
            hour: (minutes / 60.0) as u32,
            minute: (minutes % 60.0) as u32,
            second_s: within_s - minutes * 60.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_moments_have_their_unix_seconds() {
        // From `date -u -d TEXT +%s` of GNU coreutils 9.1.
        for (text, unix_s) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2026-06-21T09:30:00Z", 1_782_034_200.0),
            ("2000-02-29T23:59:59Z", 951_868_799.0),
            ("1900-03-01T00:00Z", -2_203_891_200.0),
            ("2199-12-31T12:00:00.5", 7_258_075_200.5),
            ("2026-06-21T15:30+06:00", 1_782_034_200.0),
            ("2026-06-21T04:00:00-05:30", 1_782_034_200.0),
        ] {
            assert_eq!(parse(text).map(|m| m.unix_s), Ok(unix_s), "{text}");
        }
    }

    #[test]
    fn what_is_not_a_moment_is_refused() {
        for text in [
            "",
            "T",
            "now",
            "2026-06-21",
            "2026-06-21 09:30",
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
            "+026-06-21T00:00Z",
            "2026-6-21T00:00Z",
            "0000-01-01T00:00Z",
            "9999-01-01T00:00Z",
            "2026-06-21T00:00+25:00",
            "2026-06-21T00:00+6",
            "2026-06-21T00:00:00:00Z",
            "2026-06-21T00:00ZZ",
            "2026-06-21-01T00:00Z",
            "２026-06-21T00:00Z",
            "2026-06-21T00:00é",
            "2026-06-21T00:00:00.Z",
            "2026-06-21T0é:00",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
        assert!(parse("now").unwrap_err().to_string().ends_with("found `now`"));
    }

    #[test]
    fn every_day_comes_back_as_it_was() {
        let mut expected = (1900, 1, 1);
        for days in days_since_1970(1900, 1, 1)..=days_since_1970(2199, 12, 31) {
            let civil = Moment { unix_s: days as f64 * DAY_S + 45_296.25 }.civil();
            assert_eq!((civil.year, civil.month, civil.day), expected);
            assert_eq!((civil.hour, civil.minute, civil.second_s), (12, 34, 56.25));
            let (year, month, day) = expected;
            expected = match (month, day) {
                (12, 31) => (year + 1, 1, 1),
                _ if day == days_of_month(year, month) => (year, month + 1, 1),
                _ => (year, month, day + 1),
            };
        }
        assert_eq!(expected, (2200, 1, 1));
    }
}
