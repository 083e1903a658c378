//! Dryden turbulence: a gust along each body axis, with the spectra of MIL-F-8785C.
//!
//! The longitudinal filter has one pole, the lateral and the vertical one two; their time is scale length over airspeed.
//! They are stepped exactly, so that the variance is sigma squared at any step length. One scale length of 1,750 ft
//! serves all axes (the specification's for medium and high altitudes); gusts of rotation are left out.
//!
//! m/s, seconds. Source: MIL-F-8785C, 1980, section 3.7.2; the noise of a step by the covariance integrals below.

use crate::random::Stream;
use glam::DVec3;

/// Scale length, metres.
const SCALE_M: f64 = 1_750.0 * 0.3048;
/// Slowest airspeed that the filters run at, m/s: at rest the air would otherwise stand still for ever.
const SLOWEST_MPS: f64 = 1.0;

/// Turbulence along a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Dryden {
    pub(crate) sigma_mps: f64,
    pub(crate) stream: Stream,
    pub(crate) along: f64,
    /// Of the lateral and the vertical axis: the filter's two states, in units of sigma.
    pub(crate) across: [[f64; 2]; 2],
}

impl Dryden {
    /// Turbulence of a standard deviation; starts within its stationary distribution.
    pub fn new(sigma_mps: f64, keys: &[u64]) -> Self {
        let mut stream = Stream::new(keys);
        let along = stream.normal();
        // Stationary covariance of the two states: 1/2, 1/4, 1/4.
        let mut pair = || {
            let (a, b) = (stream.normal(), stream.normal());
            [0.5f64.sqrt() * a, (0.125f64).sqrt() * (a + b)]
        };
        let across = [pair(), pair()];
        Self { sigma_mps, stream, along, across }
    }

    /// The gust of now, forward, right, down.
    pub fn gust_mps(&self) -> DVec3 {
        let root = 3f64.sqrt();
        let of = |[first, second]: [f64; 2]| root * first + (1.0 - root) * second;
        DVec3::new(self.along, of(self.across[0]), of(self.across[1])) * self.sigma_mps
    }

    /// Goes on by a step at an airspeed.
    pub fn step(&mut self, dt_s: f64, airspeed_mps: f64) {
        let tau = dt_s * airspeed_mps.max(SLOWEST_MPS) / SCALE_M;
        let a = (-tau).exp();
        self.along = a * self.along + (1.0 - a * a).sqrt() * self.stream.normal();
        // Two poles at 1/T: first' = -first/T + n/T, second' = (first - second)/T. Covariance of a step's noise.
        let a2 = a * a;
        let q11 = 0.5 * (1.0 - a2);
        let q12 = 0.25 - a2 * (0.5 * tau + 0.25);
        let q22 = 0.25 - a2 * (0.5 * tau * tau + 0.5 * tau + 0.25);
        let l11 = q11.max(0.0).sqrt();
        let l21 = if l11 > 0.0 { q12 / l11 } else { 0.0 };
        let l22 = (q22 - l21 * l21).max(0.0).sqrt();
        for [first, second] in &mut self.across {
            let (n1, n2) = (self.stream.normal(), self.stream.normal());
            (*first, *second) = (a * *first + l11 * n1, a * (tau * *first + *second) + l21 * n1 + l22 * n2);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sigma_is_that_asked_for_at_any_step() {
        for hz in [1.0, 30.0, 60.0, 120.0, 240.0] {
            // Mean over many flights at 300 m/s, so that samples are independent: 4 standard errors of 8,000 are 3.2 %.
            let flights = 8_000u64;
            let (mut start, mut end) = (DVec3::ZERO, DVec3::ZERO);
            for flight in 0..flights {
                let mut air = Dryden::new(2.0, &[5, flight]);
                start += air.gust_mps() * air.gust_mps();
                for _ in 0..30 {
                    air.step(1.0 / hz, 300.0);
                }
                end += air.gust_mps() * air.gust_mps();
            }
            for variance in [start, end] {
                let sigma = (variance / flights as f64).to_array().map(f64::sqrt);
                assert!(sigma.iter().all(|s| (s / 2.0 - 1.0).abs() < 0.032), "{hz} Hz: {sigma:?}");
            }
        }
    }

    #[test]
    fn neighbouring_steps_are_as_alike_as_the_spectra_say() {
        // Autocorrelation after tau = t V / L: exp(-tau) along, exp(-tau) (1 - tau / 2) across.
        let (steps, hz, speed) = (400_000, 30.0, 150.0);
        let lag = 60;
        let mut air = Dryden::new(1.0, &[9]);
        let mut all = Vec::with_capacity(steps);
        for _ in 0..steps {
            air.step(1.0 / hz, speed);
            all.push(air.gust_mps());
        }
        let mean = |f: &dyn Fn(usize) -> f64| (0..steps - lag).map(f).sum::<f64>() / (steps - lag) as f64;
        let tau: f64 = lag as f64 / hz * speed / SCALE_M;
        let expected = [(-tau).exp(), (-tau).exp() * (1.0 - 0.5 * tau), (-tau).exp() * (1.0 - 0.5 * tau)];
        for (axis, expected) in expected.into_iter().enumerate() {
            let product = mean(&|i| all[i][axis] * all[i + lag][axis]) / mean(&|i| all[i][axis] * all[i][axis]);
            // 400,000 steps are some 3,700 time constants: 4 / sqrt(3,700 / 2).
            assert!((product - expected).abs() < 0.093, "axis {axis}: {product} against {expected}");
        }
    }

    #[test]
    fn still_air_at_rest_and_wild_steps_are_finite() {
        let mut air = Dryden::new(3.0, &[1]);
        for (dt_s, speed) in [(1e-6, 0.0), (1e3, 1e5), (0.0, 0.0), (1e-9, 1e-9)] {
            air.step(dt_s, speed);
            assert!(air.gust_mps().is_finite());
        }
    }
}
