//! Firing: bursts in time, and where a round leaves its owner, how fast and in which direction.
//!
//! Rounds of a burst leave at equal times (of a ripple so many together), also between two steps: the owner is then between
//! its two poses, and the shell flies the rest of the step. A burst of a weapon takes its rounds from its owner's stations. Direction and speed are spread by normal numbers of the stream (seed of the
//! scenario, owner, round), so no other owner's firing changes a shot; two bursts of
//! one owner share its rounds, in the order in which they leave.
//!
//! Body axes for muzzles (forward, right, down; of a target, its shape's axes), world axes outside; metres, seconds.

use super::arms::Load;
use super::codec::coded;
use super::{MOST_SPEED_MPS, Refused};
use crate::random::Stream;
use crate::snapshot::StableId;
use glam::{DQuat, DVec3};

/// Highest rate of fire, rounds a minute.
pub const MOST_PER_MINUTE: f64 = 100_000.0;
/// Widest spread of directions, radians.
const MOST_SIGMA_RAD: f64 = 1.0;
/// Farthest muzzle from the owner's reference point, metres.
const MOST_OFFSET_M: f64 = 1_000.0;
/// Most rounds that leave together.
const MOST_TOGETHER: u32 = 1_000;

/// Where and how rounds leave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Muzzle {
    /// From the owner's reference point (of a rigid body its centre of gravity), metres, its axes.
    pub offset_m: DVec3,
    /// Direction of the bore, its axes; taken at length 1.
    pub direction: DVec3,
    /// Speed against the muzzle, m/s.
    pub speed_mps: f64,
    /// Standard deviation of the direction, about each of two axes across the bore, radians.
    pub sigma_rad: f64,
    /// Standard deviation of the speed, m/s.
    pub speed_sigma_mps: f64,
}
coded!(Muzzle { offset_m, direction, speed_mps, sigma_rad, speed_sigma_mps });

/// What carries a gun, at a moment: world frame, rates in its own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Carriage {
    pub position_m: DVec3,
    pub attitude: DQuat,
    pub velocity_mps: DVec3,
    pub rates_radps: DVec3,
}

/// Rounds on their way out.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Burst {
    pub owner: StableId,
    pub projectile: u32,
    pub muzzle: Muzzle,
    /// The weapon whose rounds they are.
    pub load: Option<Load>,
    /// When the first left, scene time, seconds.
    first_s: f64,
    interval_s: f64,
    fired: u32,
    rounds: u32,
    /// Rounds that leave together.
    together: u32,
}
coded!(Burst { owner, projectile, muzzle, load, first_s, interval_s, fired, rounds, together });

/// A round as it leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shot {
    pub position_m: DVec3,
    pub velocity_mps: DVec3,
    pub bore: DVec3,
}

impl Muzzle {
    /// A bore straight ahead at the reference point, without spread.
    pub fn ahead(speed_mps: f64) -> Self {
        Self { offset_m: DVec3::ZERO, direction: DVec3::X, speed_mps, sigma_rad: 0.0, speed_sigma_mps: 0.0 }
    }

    pub(super) fn check(&self) -> Result<(), Refused> {
        let Self { offset_m, direction, speed_mps, sigma_rad, speed_sigma_mps } = *self;
        let refuse = |key: &str, range: &str, found: &dyn std::fmt::Display| {
            Err(Refused::new(format_args!("muzzle.{key}: expected {range}, found {found}")))
        };
        if !(offset_m.is_finite() && offset_m.length() <= MOST_OFFSET_M) {
            return refuse("offset_m", "at most 1000 m", &offset_m);
        }
        if !(direction.is_finite() && direction.try_normalize().is_some()) {
            return refuse("direction", "a direction", &direction);
        }
        if !(0.0..=MOST_SPEED_MPS).contains(&speed_mps) {
            return refuse("speed_mps", "0..=12000 m/s", &speed_mps);
        }
        if !(0.0..=MOST_SIGMA_RAD).contains(&sigma_rad) {
            return refuse("sigma_rad", "0..=1", &sigma_rad);
        }
        if !(0.0..=MOST_SPEED_MPS).contains(&speed_sigma_mps) {
            return refuse("speed_sigma_mps", "0..=12000 m/s", &speed_sigma_mps);
        }
        Ok(())
    }
}

impl Muzzle {
    /// A round without spread.
    pub(super) fn aimed(&self, at: &Carriage) -> Shot {
        self.shot(at, self.direction.normalize_or(DVec3::X), self.speed_mps)
    }

    fn shot(&self, at: &Carriage, straight: DVec3, speed_mps: f64) -> Shot {
        let direction = at.attitude * straight;
        let turning_mps = at.attitude * at.rates_radps.cross(self.offset_m);
        Shot {
            position_m: at.position_m + at.attitude * self.offset_m,
            velocity_mps: at.velocity_mps + turning_mps + direction * speed_mps,
            bore: direction,
        }
    }
}

impl Carriage {
    /// Between two poses of a step.
    fn between(&self, to: &Self, fraction: f64) -> Self {
        let end = if self.attitude.dot(to.attitude) < 0.0 { -to.attitude } else { to.attitude };
        Self {
            position_m: self.position_m.lerp(to.position_m, fraction),
            attitude: self.attitude.lerp(end, fraction).normalize(),
            velocity_mps: self.velocity_mps.lerp(to.velocity_mps, fraction),
            rates_radps: self.rates_radps.lerp(to.rates_radps, fraction),
        }
    }
}

impl Burst {
    pub fn new(
        owner: StableId,
        projectile: u32,
        muzzle: Muzzle,
        rounds: u32,
        per_minute: f64,
        now_s: f64,
    ) -> Result<Self, Refused> {
        muzzle.check()?;
        if rounds == 0 {
            return Err(Refused::new("fire.rounds: expected at least 1, found 0"));
        }
        let single = rounds == 1 && per_minute == 0.0;
        let rated = per_minute > 0.0 && per_minute <= MOST_PER_MINUTE;
        if !(single || rated) {
            return Err(Refused::new(format_args!(
                "fire.per_minute: expected a rate above 0 up to {MOST_PER_MINUTE}, found {per_minute}"
            )));
        }
        let interval_s = if rounds == 1 { 0.0 } else { 60.0 / per_minute };
        Ok(Self { owner, projectile, muzzle, load: None, first_s: now_s, interval_s, fired: 0, rounds, together: 1 })
    }

    /// Rounds of a weapon, so many together every `interval_s`.
    pub fn of_weapon(self, load: Load, together: u32, interval_s: f64) -> Result<Self, Refused> {
        if !(1..=MOST_TOGETHER).contains(&together) {
            return Err(Refused::new(format_args!("release.together: expected 1..={MOST_TOGETHER}, found {together}")));
        }
        let least_s = 60.0 / MOST_PER_MINUTE;
        if !(least_s..=1e4).contains(&interval_s) {
            return Err(Refused::new(format_args!(
                "release.interval_s: expected {least_s}..=10000 s, found {interval_s}"
            )));
        }
        Ok(Self { load: Some(load), together, interval_s, ..self })
    }

    /// What a restored one must be at a time: rounds that were due long ago would all leave at once.
    pub fn check(&self, now_s: f64, step_s: f64) -> Result<(), Refused> {
        self.muzzle.check()?;
        let together = (1..=MOST_TOGETHER).contains(&self.together);
        let fast = self.interval_s < 60.0 / MOST_PER_MINUTE * (1.0 - 1e-9) && self.rounds > 1;
        let late = together && self.due_s() < now_s - step_s;
        if !together || fast || late || self.fired > self.rounds {
            return Err(Refused::new("burst: expected a rate of fire and rounds that can be"));
        }
        Ok(())
    }

    /// Lets time pass without it.
    pub fn wait(&mut self, dt_s: f64) {
        self.first_s += dt_s;
    }

    /// Takes back the rounds that are left.
    pub fn end(&mut self) {
        self.rounds = self.fired;
    }

    pub fn is_over(&self) -> bool {
        self.fired >= self.rounds
    }

    /// When the next round leaves.
    fn due_s(&self) -> f64 {
        self.first_s + f64::from(self.fired / self.together) * self.interval_s
    }

    /// Takes the next round that leaves before `end_s`; says when.
    pub fn next_before(&mut self, end_s: f64) -> Option<f64> {
        let due_s = self.due_s();
        if self.is_over() || due_s >= end_s {
            return None;
        }
        self.fired += 1;
        Some(due_s)
    }

    /// The round as it leaves at a fraction of a step.
    pub fn shot(&self, seed: u64, round: u64, from: &Carriage, to: &Carriage, fraction: f64) -> Shot {
        let at = from.between(to, fraction);
        let mut random = Stream::new(&[seed, self.owner.0, round]);
        let straight = self.muzzle.direction.normalize_or(DVec3::X);
        let (right, down) = straight.any_orthonormal_pair();
        let off = (right * random.normal() + down * random.normal()) * self.muzzle.sigma_rad;
        let speed_mps = (self.muzzle.speed_mps + random.normal() * self.muzzle.speed_sigma_mps).max(0.0);
        self.muzzle.shot(&at, DQuat::from_scaled_axis(off) * straight, speed_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: u64 = 20_261_131;

    fn still() -> Carriage {
        Carriage {
            position_m: DVec3::ZERO,
            attitude: DQuat::IDENTITY,
            velocity_mps: DVec3::ZERO,
            rates_radps: DVec3::ZERO,
        }
    }

    fn burst(muzzle: Muzzle, rounds: u32, per_minute: f64) -> Burst {
        Burst::new(StableId(7), 0, muzzle, rounds, per_minute, 1.0).unwrap()
    }

    #[test]
    fn rounds_leave_at_equal_times_whatever_the_step() {
        for step_s in [1.0 / 120.0, 0.1, 3.0] {
            let (mut burst, mut due, mut end_s) = (burst(Muzzle::ahead(900.0), 100, 6_000.0), Vec::new(), 1.0);
            while !burst.is_over() {
                end_s += step_s;
                while let Some(due_s) = burst.next_before(end_s) {
                    assert!(due_s < end_s && due_s >= end_s - step_s - 1e-12);
                    due.push(due_s);
                }
            }
            assert!(due.iter().enumerate().all(|(i, due_s)| *due_s == 1.0 + i as f64 * 0.01));
        }
    }

    #[test]
    fn spread_has_its_sigma_and_belongs_to_owner_and_round() {
        let muzzle = Muzzle { sigma_rad: 0.002, speed_sigma_mps: 3.0, ..Muzzle::ahead(900.0) };
        let burst = burst(muzzle, 1, 0.0);
        let rounds = 20_000;
        let (mut right, mut down, mut fast) = (0.0, 0.0, 0.0);
        for round in 0..rounds {
            let shot = burst.shot(SEED, round, &still(), &still(), 0.0);
            assert_eq!(shot, burst.shot(SEED, round, &still(), &still(), 1.0));
            right += shot.bore.y.powi(2);
            down += shot.bore.z.powi(2);
            fast += (shot.velocity_mps.length() - 900.0).powi(2);
        }
        let sigma = |sum: f64| (sum / rounds as f64).sqrt();
        // Four standard errors of a deviation, 1 / sqrt(2 n): 2 %.
        for (found, expected) in [(sigma(right), 0.002), (sigma(down), 0.002), (sigma(fast), 3.0)] {
            assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
        }
        let other = Burst { owner: StableId(8), ..burst.clone() };
        assert_ne!(other.shot(SEED, 0, &still(), &still(), 0.0), burst.shot(SEED, 0, &still(), &still(), 0.0));
    }

    #[test]
    fn a_muzzle_moves_and_turns_with_its_owner() {
        let muzzle = Muzzle { offset_m: DVec3::new(2.0, 0.0, 0.0), ..Muzzle::ahead(100.0) };
        let from = Carriage { velocity_mps: DVec3::Z * 50.0, rates_radps: DVec3::Z * 0.5, ..still() };
        let to = Carriage { position_m: DVec3::Z, ..from };
        let shot = burst(muzzle, 1, 0.0).shot(SEED, 0, &from, &to, 0.5);
        assert_eq!(shot.position_m, DVec3::new(2.0, 0.0, 0.5));
        assert_eq!(shot.velocity_mps, DVec3::new(100.0, 1.0, 50.0));
    }

    #[test]
    fn what_is_no_shot_is_refused() {
        let refused = |muzzle: Muzzle, rounds, rate| {
            Burst::new(StableId(1), 0, muzzle, rounds, rate, 0.0).unwrap_err().to_string()
        };
        let good = Muzzle::ahead(900.0);
        assert!(refused(Muzzle { speed_mps: f64::NAN, ..good }, 1, 0.0).contains("speed_mps"));
        assert!(refused(Muzzle { direction: DVec3::ZERO, ..good }, 1, 0.0).contains("direction"));
        assert!(refused(Muzzle { offset_m: DVec3::NAN, ..good }, 1, 0.0).contains("offset_m"));
        assert!(refused(Muzzle { sigma_rad: -1.0, ..good }, 1, 0.0).contains("sigma_rad"));
        assert!(refused(Muzzle { speed_sigma_mps: f64::INFINITY, ..good }, 1, 0.0).contains("speed_sigma"));
        assert!(refused(good, 0, 60.0).contains("rounds"));
        for rate in [0.0, -1.0, f64::NAN, 1e9] {
            assert!(refused(good, 2, rate).contains("per_minute"), "{rate}");
        }
    }
}
