//! The integrators of every own equation of motion, behind one function: [`step`].
//!
//! A state is an array `y`; a [`Motion`] gives `y' = rate(t, y)`. Time in seconds, everything else in the motion's own
//! units. Written for any float, so that the price of single precision can be measured with the very same code.
//!
//! | integrator | order | rates a step | stable for a damped mode while abs(lambda) h < |
//! |---|---|---|---|
//! | [`Integrator::Rk4`] | 4 | 4 | 2.785 |
//! | [`Integrator::Rk2`] (midpoint) | 2 | 2 | 2 |
//! | [`Integrator::SemiEuler`] | 1 | 1, and the drift once more | 2 |
//! | [`Integrator::Ab2`] | 2 | 1 | 1 |
//!
//! Ab2 needs the rate of the step before. Where there is none, at the start and after a jump of a control, it takes one
//! midpoint step, so that a jump does not cost it an order.
//!
//! Source: W. Kutta, Beitrag zur näherungsweisen Integration totaler Differentialgleichungen, 1901; E. Hairer, S.
//! Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 1993, sections II.1, III.1, III.5 (variable steps).

use num_traits::Float;
use serde::Deserialize;

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Classical Runge-Kutta of fourth order.
    #[default]
    Rk4,
    /// Midpoint rule.
    Rk2,
    /// Velocities first, then positions with the new velocities.
    SemiEuler,
    /// Adams-Bashforth of second order.
    Ab2,
}

/// What is integrated.
pub trait Motion<T, const N: usize> {
    /// The rate of change of the whole state.
    fn rate(&self, t_s: T, y: &[T; N]) -> [T; N];

    /// The part of [`Self::rate`] that velocities alone give: the rates of position-like entries, 0 for the others.
    fn drift(&self, y: &[T; N]) -> [T; N];
}

/// The rate at the start of the step before and that step's length: the memory of [`Integrator::Ab2`].
pub type Before<T, const N: usize> = Option<([T; N], T)>;

impl Integrator {
    /// All of them, cheapest first.
    pub const ALL: [Self; 4] = [Self::SemiEuler, Self::Ab2, Self::Rk2, Self::Rk4];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rk4 => "rk4",
            Self::Rk2 => "rk2",
            Self::SemiEuler => "semi_euler",
            Self::Ab2 => "ab2",
        }
    }

    /// Greatest `abs(lambda) h` at which a mode that decays with `exp(lambda t)` still decays.
    pub fn damping_limit(self) -> f64 {
        match self {
            Self::Rk4 => 2.785,
            Self::Rk2 | Self::SemiEuler => 2.0,
            Self::Ab2 => 1.0,
        }
    }
}

/// The state after `dt_s`. `before` is read and written by [`Integrator::Ab2`] only; make it `None` after a jump.
pub fn step<T: Float, const N: usize>(
    integrator: Integrator,
    motion: &impl Motion<T, N>,
    t_s: T,
    y: &[T; N],
    dt_s: T,
    before: &mut Before<T, N>,
) -> [T; N] {
    let rate = |t, y: &[T; N]| motion.rate(t, y);
    match integrator {
        Integrator::Rk4 => rk4(t_s, y, dt_s, rate),
        Integrator::Rk2 => rk2(t_s, y, dt_s, rate),
        Integrator::SemiEuler => {
            let (all, drift) = (motion.rate(t_s, y), motion.drift(y));
            let kicked = std::array::from_fn(|i| y[i] + dt_s * (all[i] - drift[i]));
            let drift = motion.drift(&kicked);
            std::array::from_fn(|i| kicked[i] + dt_s * drift[i])
        }
        Integrator::Ab2 => {
            let now = motion.rate(t_s, y);
            let after = match *before {
                None => {
                    let half = dt_s * T::from(0.5).unwrap_or_else(T::one);
                    let middle = motion.rate(t_s + half, &along(y, &now, half));
                    along(y, &middle, dt_s)
                }
                Some((last, last_s)) => {
                    let r = dt_s / (last_s + last_s);
                    std::array::from_fn(|i| y[i] + dt_s * ((T::one() + r) * now[i] - r * last[i]))
                }
            };
            *before = Some((now, dt_s));
            after
        }
    }
}

/// One step of the classical Runge-Kutta rule of `y' = rate(t, y)`.
#[inline]
pub fn rk4<T: Float, const N: usize>(t: T, y: &[T; N], dt: T, rate: impl Fn(T, &[T; N]) -> [T; N]) -> [T; N] {
    let two = T::one() + T::one();
    let half = dt / two;
    let k1 = rate(t, y);
    let k2 = rate(t + half, &along(y, &k1, half));
    let k3 = rate(t + half, &along(y, &k2, half));
    let k4 = rate(t + dt, &along(y, &k3, dt));
    let sixth = dt / (two + two + two);
    std::array::from_fn(|i| y[i] + sixth * (k1[i] + two * (k2[i] + k3[i]) + k4[i]))
}

/// One step of the midpoint rule of `y' = rate(t, y)`.
#[inline]
fn rk2<T: Float, const N: usize>(t: T, y: &[T; N], dt: T, rate: impl Fn(T, &[T; N]) -> [T; N]) -> [T; N] {
    let half = dt / (T::one() + T::one());
    let middle = along(y, &rate(t, y), half);
    along(y, &rate(t + half, &middle), dt)
}

#[inline]
fn along<T: Float, const N: usize>(y: &[T; N], k: &[T; N], h: T) -> [T; N] {
    std::array::from_fn(|i| y[i] + h * k[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x'' = -x: the exact state is (cos t, -sin t).
    struct Oscillator;

    impl Motion<f64, 2> for Oscillator {
        fn rate(&self, _: f64, y: &[f64; 2]) -> [f64; 2] {
            [y[1], -y[0]]
        }

        fn drift(&self, y: &[f64; 2]) -> [f64; 2] {
            [y[1], 0.0]
        }
    }

    /// y' = t^3: tells whether the stages take their times right.
    struct Cubic;

    impl Motion<f64, 1> for Cubic {
        fn rate(&self, t: f64, _: &[f64; 1]) -> [f64; 1] {
            [t * t * t]
        }

        fn drift(&self, _: &[f64; 1]) -> [f64; 1] {
            [0.0]
        }
    }

    fn oscillator_error(integrator: Integrator, steps: u32) -> f64 {
        let dt = 8.0 / f64::from(steps);
        let (mut y, mut before) = ([1.0, 0.0], None);
        for i in 0..steps {
            y = step(integrator, &Oscillator, f64::from(i) * dt, &y, dt, &mut before);
        }
        (y[0] - 8f64.cos()).hypot(y[1] + 8f64.sin())
    }

    #[test]
    fn the_error_falls_with_the_power_of_the_step_that_each_rule_has() {
        for (integrator, expected) in
            [(Integrator::Rk4, 4.0), (Integrator::Rk2, 2.0), (Integrator::SemiEuler, 1.0), (Integrator::Ab2, 2.0)]
        {
            let (coarse, fine) = (oscillator_error(integrator, 400), oscillator_error(integrator, 800));
            let order = (coarse / fine).log2();
            assert!((order - expected).abs() < 0.1, "{integrator:?}: order {order}");
        }
    }

    #[test]
    fn stages_take_their_own_times() {
        // Simpson's rule is exact for cubics; three roundings of numbers below 1.
        let rk4 = step(Integrator::Rk4, &Cubic, 0.0, &[0.0], 1.0, &mut None);
        assert!((rk4[0] - 0.25).abs() < 3.0 * f64::EPSILON);
        assert_eq!(step(Integrator::Rk2, &Cubic, 0.0, &[0.0], 1.0, &mut None), [0.125]);
        assert_eq!(step(Integrator::SemiEuler, &Cubic, 2.0, &[0.0], 1.0, &mut None), [8.0]);
    }

    #[test]
    fn ab2_keeps_its_order_over_uneven_steps() {
        let error = |steps: u32| {
            let (mut y, mut before, mut t) = ([1.0, 0.0], None, 0.0);
            for i in 0..steps {
                let dt = 8.0 / f64::from(steps) * if i % 2 == 0 { 0.7 } else { 1.3 };
                y = step(Integrator::Ab2, &Oscillator, t, &y, dt, &mut before);
                t += dt;
            }
            (y[0] - t.cos()).hypot(y[1] + t.sin())
        };
        let order = (error(400) / error(800)).log2();
        assert!((order - 2.0).abs() < 0.1, "order {order}");
    }

    #[test]
    fn a_decaying_mode_decays_up_to_the_stated_limit_and_grows_beyond() {
        struct Decay(f64);
        impl Motion<f64, 1> for Decay {
            fn rate(&self, _: f64, y: &[f64; 1]) -> [f64; 1] {
                [-self.0 * y[0]]
            }
            fn drift(&self, _: &[f64; 1]) -> [f64; 1] {
                [0.0]
            }
        }
        let after = |integrator, lambda_h| {
            let (mut y, mut before) = ([1.0], None);
            for _ in 0..2_000 {
                y = step(integrator, &Decay(lambda_h), 0.0, &y, 1.0, &mut before);
            }
            f64::abs(y[0])
        };
        for integrator in Integrator::ALL {
            let limit = integrator.damping_limit();
            assert!(after(integrator, limit * 0.99) < 1.0, "{integrator:?}");
            assert!(after(integrator, limit * 1.01) > 1.0, "{integrator:?}");
        }
    }
}
