//! Time: the fixed step, how many steps a stretch of wall time is worth, and the date of the scene.
//!
//! A step always has the same length. Wall time beyond [`MAX_FRAME_S`] in one go is dropped and counted as *slowed*: a
//! slow machine slows the simulation and says so, it never takes a larger step and never runs after lost time. The date
//! is kept in whole nanoseconds and counted from where it was last set, so it does not drift with the number of steps.

use std::fmt;

/// Steps a second unless told otherwise.
pub const DEFAULT_STEP_HZ: u32 = 120;
/// Most wall time that one call to [`Clock::advance`] makes up for, seconds.
pub const MAX_FRAME_S: f64 = 0.1;
/// Bounds of the simulation's rate against wall time, and of the date's against the simulation.
pub const RATES: (f64, f64) = (0.01, 10.0);
/// Fastest run of the date against the simulation: a day in a bit more than a minute.
pub const MAX_DAY_RATE: f64 = 1_200.0;

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

/// Fixed steps, wall time and date.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    step_hz: u32,
    step: u64,
    owed_s: f64,
    slowed_s: f64,
    rate: f64,
    paused: bool,
    day_rate: f64,
    date_base: UtcTime,
    date_base_step: u64,
}

impl Clock {
    /// A clock at step 0; `step_hz` is held within 1..=10,000.
    pub fn new(step_hz: u32, date: UtcTime) -> Self {
        Self {
            step_hz: step_hz.clamp(1, 10_000),
            step: 0,
            owed_s: 0.0,
            slowed_s: 0.0,
            rate: 1.0,
            paused: false,
            day_rate: 1.0,
            date_base: date,
            date_base_step: 0,
        }
    }

    /// Length of a step, seconds.
    pub fn step_s(&self) -> f64 {
        1.0 / f64::from(self.step_hz)
    }

    /// Steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Simulated time since the start, seconds.
    pub fn time_s(&self) -> f64 {
        self.step as f64 / f64::from(self.step_hz)
    }

    /// Wall time that was dropped because the machine was too slow, seconds.
    pub fn slowed_s(&self) -> f64 {
        self.slowed_s
    }

    /// Part of a step that wall time is ahead of the last one, in 0..1.
    pub fn fraction(&self) -> f64 {
        (self.owed_s / self.step_s()).clamp(0.0, 1.0)
    }

    /// Takes in wall time and gives the steps now due. A backward or NaN stretch counts as none.
    #[must_use]
    pub fn advance(&mut self, wall_s: f64) -> u32 {
        if self.paused || wall_s.is_nan() || wall_s <= 0.0 {
            return 0;
        }
        let taken_s = wall_s.min(MAX_FRAME_S);
        self.slowed_s += wall_s - taken_s;
        self.owed_s += taken_s * self.rate;
        let due = (self.owed_s * f64::from(self.step_hz)).floor();
        self.owed_s = (self.owed_s - due * self.step_s()).max(0.0);
        due as u32
    }

    /// Counts one step as taken. A paused clock still counts: who steps decides, as lockstep does.
    pub fn tick(&mut self) {
        self.step += 1;
    }

    /// Whether time stands still.
    pub fn paused(&self) -> bool {
        self.paused
    }

    /// Stops or continues time.
    pub fn set_paused(&mut self, paused: bool) {
        self.paused = paused;
    }

    /// Simulated seconds a wall second.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Sets simulated seconds a wall second, held within [`RATES`]; NaN is ignored.
    pub fn set_rate(&mut self, rate: f64) {
        if !rate.is_nan() {
            self.rate = rate.clamp(RATES.0, RATES.1);
        }
    }

    /// Date and time of day in the scene.
    pub fn date(&self) -> UtcTime {
        let since_s = (self.step - self.date_base_step) as f64 / f64::from(self.step_hz) * self.day_rate;
        self.date_base.plus_s(since_s)
    }

    /// Sets date and time of day.
    pub fn set_date(&mut self, date: UtcTime) {
        (self.date_base, self.date_base_step) = (date, self.step);
    }

    /// Sets how fast the date runs against the simulation, 0..=[`MAX_DAY_RATE`]; NaN is ignored.
    pub fn set_day_rate(&mut self, day_rate: f64) {
        if !day_rate.is_nan() {
            self.set_date(self.date());
            self.day_rate = day_rate.clamp(0.0, MAX_DAY_RATE);
        }
    }
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

    fn noon() -> UtcTime {
        UtcTime::new(2026, 6, 21, 12, 0, 0).unwrap()
    }

    #[test]
    fn a_ten_second_stall_slows_the_simulation_and_says_so() {
        let mut clock = Clock::new(120, noon());
        assert_eq!(clock.advance(10.0), 12);
        assert!((clock.slowed_s() - 9.9).abs() < 1e-12);
        // Nothing of the stall is left to be made up for.
        assert!(clock.advance(1.0 / 120.0) <= 2);
    }

    #[test]
    fn steps_follow_wall_time_to_one_step() {
        let mut clock = Clock::new(120, noon());
        let mut steps = 0;
        for frame in 0..6_000 {
            let wall_s = if frame % 3 == 0 { 0.021 } else { 0.0145 };
            steps += clock.advance(wall_s);
        }
        // 2,000 frames of 21 ms and 4,000 of 14.5 ms are 100 s.
        assert!((i64::from(steps) - 12_000).abs() <= 1, "{steps}");
        assert_eq!(clock.slowed_s(), 0.0);
    }

    #[test]
    fn bad_stretches_of_time_count_as_none() {
        let mut clock = Clock::new(0, noon());
        assert_eq!(clock.step_s(), 1.0);
        for wall_s in [f64::NAN, -1.0, 0.0, f64::NEG_INFINITY] {
            assert_eq!(clock.advance(wall_s), 0);
        }
        let mut clock = Clock::new(120, noon());
        assert_eq!(clock.advance(f64::INFINITY), 12);
        clock.set_paused(true);
        assert_eq!(clock.advance(0.05), 0);
        clock.set_rate(f64::NAN);
        assert_eq!(clock.rate(), 1.0);
    }

    #[test]
    fn the_date_runs_at_its_own_rate_and_does_not_drift() {
        let mut clock = Clock::new(120, noon());
        for _ in 0..120 * 3_600 {
            clock.tick();
        }
        assert_eq!(clock.date(), UtcTime::new(2026, 6, 21, 13, 0, 0).unwrap());
        clock.set_day_rate(60.0);
        for _ in 0..120 * 60 {
            clock.tick();
        }
        assert_eq!(clock.date(), UtcTime::new(2026, 6, 21, 14, 0, 0).unwrap());
    }

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
