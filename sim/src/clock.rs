//! Time: the fixed step, how many steps a stretch of wall time is worth, and the date of the scene.
//!
//! A step always has the same length. Wall time beyond [`MAX_FRAME_S`] in one go is dropped and counted as *slowed*: a
//! slow machine slows the simulation and says so, it never takes a larger step and never runs after lost time. The date
//! is kept in whole nanoseconds and counted from where it was last set, so it does not drift with the number of steps.

use crate::utc::UtcTime;

/// Steps a second unless told otherwise.
pub const DEFAULT_STEP_HZ: u32 = 120;
/// Most wall time that one call to [`Clock::advance`] makes up for, seconds.
pub const MAX_FRAME_S: f64 = 0.1;
/// Bounds of the simulation's rate against wall time, and of the date's against the simulation.
pub const RATES: (f64, f64) = (0.01, 10.0);
/// Fastest run of the date against the simulation: a day in a bit more than a minute.
pub const MAX_DAY_RATE: f64 = 1_200.0;

/// Fixed steps, wall time and date.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    pub(crate) step_hz: u32,
    pub(crate) step: u64,
    pub(crate) owed_s: f64,
    pub(crate) slowed_s: f64,
    pub(crate) rate: f64,
    pub(crate) paused: bool,
    pub(crate) day_rate: f64,
    pub(crate) date_base: UtcTime,
    pub(crate) date_base_step: u64,
}

impl Clock {
    /// Steps a second.
    pub fn step_hz(&self) -> u32 {
        self.step_hz
    }

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
}
