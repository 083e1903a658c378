//! The path of a point within one step: the cubic with the step's own places and velocities at both ends (Hermite's).
//!
//! Frame: the world's (X east, Y up, Z south) or any other in which the ends are given; metres, seconds. A *fraction* is
//! the part of the step, 0..=1.
//!
//! Invariant others rely on: both ends are met to the bit, and the halves of a path share their common end to the bit,
//! so a chain of steps, or of pieces of a step, has no gap.

use glam::DVec3;

/// Where a point goes within one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepPath {
    /// Place at the start.
    pub from_m: DVec3,
    /// Velocity at the start.
    pub from_mps: DVec3,
    /// Place at the end.
    pub to_m: DVec3,
    /// Velocity at the end.
    pub to_mps: DVec3,
    /// Length of the step, above 0.
    pub step_s: f64,
}

impl StepPath {
    /// The path that runs from one place to another at constant velocity.
    pub fn straight(from_m: DVec3, to_m: DVec3, step_s: f64) -> Self {
        let velocity = (to_m - from_m) / step_s;
        Self { from_m, from_mps: velocity, to_m, to_mps: velocity, step_s }
    }

    /// Whether every number is finite and the step is longer than 0.
    pub fn is_sound(&self) -> bool {
        let Self { from_m, from_mps, to_m, to_mps, step_s } = self;
        [from_m, from_mps, to_m, to_mps].iter().all(|v| v.is_finite()) && step_s.is_finite() && *step_s > 0.0
    }

    /// Place at a fraction of the step.
    pub fn position_m(&self, fraction: f64) -> DVec3 {
        let (along, start, end) = self.chord_and_bends();
        let (s, rest) = (fraction, 1.0 - fraction);
        let bulge = (start * rest - end * s) * (s * rest);
        // From the nearer end, so that both are met exactly.
        if s <= 0.5 { self.from_m + (along * s + bulge) } else { self.to_m - (along * rest - bulge) }
    }

    /// Velocity at a fraction of the step.
    pub fn velocity_mps(&self, fraction: f64) -> DVec3 {
        let (s, rest) = (fraction, 1.0 - fraction);
        let mean = (self.to_m - self.from_m) / self.step_s;
        self.from_mps * (rest * (rest - 2.0 * s)) + self.to_mps * (s * (s - 2.0 * rest)) + mean * (6.0 * s * rest)
    }

    /// The chord, and by how much the tangent at the start and at the end differs from it, all for the whole step.
    ///
    /// The path is `from + s chord + s (1 - s) ((1 - s) start - s end)`.
    fn chord_and_bends(&self) -> (DVec3, DVec3, DVec3) {
        let along = self.to_m - self.from_m;
        (along, self.from_mps * self.step_s - along, self.to_mps * self.step_s - along)
    }

    /// Most that the path is away from the point of its chord *at the same fraction*, metres.
    ///
    /// The second derivative of a cubic is linear, so it is largest at an end; a chord's error is at most an eighth of it.
    pub fn deviation_m(&self) -> f64 {
        let (_, start, end) = self.chord_and_bends();
        let (first, last) = (start * 4.0 + end * 2.0, start * 2.0 + end * 4.0);
        first.length_squared().max(last.length_squared()).sqrt() / 8.0
    }

    /// Most that the path is away from its chord, and the chord from it, metres; never above [`Self::deviation_m`].
    ///
    /// A point that only speeds up or slows down along its chord stays on it. That is so while both end velocities
    /// along the chord are within 0 and 3 times the mean: then the way along the chord only grows (F. Fritsch,
    /// R. Carlson, Monotone piecewise cubic interpolation, 1980), and only the bend across the chord counts.
    pub fn bulge_m(&self) -> f64 {
        let (along, start, end) = self.chord_and_bends();
        let squared = along.length_squared();
        let (mut first, mut last) = (start * 4.0 + end * 2.0, start * 2.0 + end * 4.0);
        let forward = |bend: DVec3| {
            let excess = bend.dot(along);
            excess >= -squared && excess <= 2.0 * squared
        };
        if squared > 0.0 && forward(start) && forward(end) {
            first -= along * (first.dot(along) / squared);
            last -= along * (last.dot(along) / squared);
        }
        first.length_squared().max(last.length_squared()).sqrt() / 8.0
    }

    /// The path up to a fraction of the step, and from there on; together they are the path.
    pub fn split(&self, fraction: f64) -> [Self; 2] {
        let (middle_m, middle_mps) = (self.position_m(fraction), self.velocity_mps(fraction));
        [
            Self { to_m: middle_m, to_mps: middle_mps, step_s: self.step_s * fraction, ..*self },
            Self { from_m: middle_m, from_mps: middle_mps, step_s: self.step_s * (1.0 - fraction), ..*self },
        ]
    }

    /// Bezier's four points of the path: it lies within their hull, its derivative within that of 3 times their differences.
    pub(super) fn hull_points_m(&self) -> [DVec3; 4] {
        let third_s = self.step_s / 3.0;
        [self.from_m, self.from_m + self.from_mps * third_s, self.to_m - self.to_mps * third_s, self.to_m]
    }

    /// The fraction at which the path passes a point of its chord, for a path that only goes forward along it.
    ///
    /// Newton's steps, each halved into the bracket where it leaves it, until one is below 0.1 nm along the chord: they
    /// double the digits, and far from the origin places have no more. 60 of them end in any case.
    pub(super) fn fraction_abreast(&self, point_m: DVec3) -> f64 {
        let (along, ..) = self.chord_and_bends();
        let squared = along.length_squared();
        if squared == 0.0 {
            return 0.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut s = ((point_m - self.from_m).dot(along) / squared).clamp(0.0, 1.0);
        for _ in 0..60 {
            let behind = (point_m - self.position_m(s)).dot(along);
            if behind > 0.0 {
                low = s;
            } else {
                high = s;
            }
            let newton = s + behind / (self.velocity_mps(s).dot(along) * self.step_s);
            let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
            let moved_squared = (next - s) * (next - s) * squared;
            s = next;
            if moved_squared <= 1e-20 {
                break;
            }
        }
        s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    const SEED_PATHS: u64 = 20_261_124;

    fn vector(random: &mut StdRng, size: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| random.random_range(-size..size)))
    }

    fn any(random: &mut StdRng) -> StepPath {
        let step_s = random.random_range(0.001..0.5);
        let from_m = vector(random, 1e4);
        let from_mps = vector(random, 1e3);
        let bend = 10f64.powf(random.random_range(-2.0..4.0));
        StepPath {
            from_m,
            from_mps,
            to_m: from_m + from_mps * step_s + vector(random, bend * step_s),
            to_mps: from_mps + vector(random, bend),
            step_s,
        }
    }

    fn distance_to_chord_m(path: &StepPath, point: DVec3) -> f64 {
        let along = path.to_m - path.from_m;
        let s = ((point - path.from_m).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(path.from_m + along * s)
    }

    #[test]
    fn a_fall_is_met_everywhere() {
        let g = DVec3::new(0.0, -9.81, 0.0);
        let (start, launch, step_s) = (DVec3::new(5.0, 900.0, -7.0), DVec3::new(800.0, 30.0, 1.0), 0.5);
        let at = |t: f64| start + launch * t + g * (0.5 * t * t);
        let path = StepPath { from_m: start, from_mps: launch, to_m: at(0.5), to_mps: launch + g * 0.5, step_s };
        for i in 0..=64 {
            let s = f64::from(i) / 64.0;
            // Some ten roundings of numbers below 1,024: 2^-44 m each.
            assert!(path.position_m(s).distance(at(s * step_s)) < 10.0 * 2f64.powi(-44));
            assert!(path.velocity_mps(s).distance(launch + g * (s * step_s)) < 10.0 * 2f64.powi(-44) / step_s);
        }
        // A parabola's sagitta: an eighth of g h^2, across the chord.
        let sagitta = 9.81 * step_s * step_s / 8.0;
        assert!((path.deviation_m() - sagitta).abs() < 1e-12 && path.bulge_m() <= path.deviation_m());
    }

    #[test]
    fn both_ends_are_met_to_the_bit_and_halves_share_theirs() {
        let mut random = StdRng::seed_from_u64(SEED_PATHS);
        for _ in 0..2_000 {
            let path = any(&mut random);
            assert_eq!((path.position_m(0.0), path.position_m(1.0)), (path.from_m, path.to_m));
            assert_eq!((path.velocity_mps(0.0), path.velocity_mps(1.0)), (path.from_mps, path.to_mps));
            let cut = random.random_range(0.1..0.9);
            let [first, second] = path.split(cut);
            assert_eq!((first.to_m, first.to_mps), (second.from_m, second.from_mps));
            assert_eq!((first.from_m, second.to_m), (path.from_m, path.to_m));
            // Roundings of numbers below 2^15 m, ten of each: 2^-38 m.
            for i in 0..=8 {
                let s = f64::from(i) / 8.0;
                assert!(first.position_m(s).distance(path.position_m(cut * s)) < 10.0 * 2f64.powi(-38));
                assert!(second.position_m(s).distance(path.position_m(cut + (1.0 - cut) * s)) < 10.0 * 2f64.powi(-38));
            }
        }
    }

    #[test]
    fn the_bounds_hold_and_are_met_by_a_parabola() {
        let mut random = StdRng::seed_from_u64(SEED_PATHS);
        for _ in 0..2_000 {
            let path = any(&mut random);
            let (deviation, bulge) = (path.deviation_m(), path.bulge_m());
            assert!(bulge <= deviation * (1.0 + 1e-12));
            for i in 0..=64 {
                let s = f64::from(i) / 64.0;
                let point = path.position_m(s);
                let rounding = 10.0 * 2f64.powi(-38);
                assert!(point.distance(path.from_m.lerp(path.to_m, s)) <= deviation + rounding);
                assert!(distance_to_chord_m(&path, point) <= bulge + rounding, "{path:?} at {s}");
            }
        }
    }

    #[test]
    fn braking_along_the_chord_does_not_bend_it_and_turning_back_does() {
        let along = DVec3::X;
        let brakes = StepPath {
            from_m: DVec3::ZERO,
            from_mps: along * 900.0,
            to_m: along * 8.0,
            to_mps: along * 700.0,
            step_s: 0.01,
        };
        assert!(brakes.bulge_m() < 1e-15 && brakes.deviation_m() > 0.2);
        let turns_back = StepPath { to_m: along, to_mps: along * -700.0, ..brakes };
        assert!(turns_back.bulge_m() > 1.0, "overshoots its end by metres");
        // Always forward by both end velocities, and yet 60 % beyond its end halfway.
        let overshoots = StepPath { from_mps: along * 9.0, to_mps: DVec3::ZERO, to_m: along, step_s: 1.0, ..brakes };
        let beyond = overshoots.position_m(0.5).distance(along);
        assert!(beyond > 0.6 && overshoots.bulge_m() >= beyond);
        let middle = DVec3::new(3.0, 0.0, 0.0);
        assert!(brakes.position_m(brakes.fraction_abreast(middle)).distance(middle) < 1e-14);
    }
}
