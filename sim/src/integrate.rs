//! The integrator of every own equation of motion: classical Runge-Kutta of fourth order, f64.
//!
//! Source: W. Kutta, Beitrag zur näherungsweisen Integration totaler Differentialgleichungen, 1901.

/// One step of `dt` of `y' = rate(y)`; the error of a step is of fifth order in `dt`, of a fixed time of fourth.
pub fn rk4<const N: usize>(y: &[f64; N], dt: f64, rate: impl Fn(&[f64; N]) -> [f64; N]) -> [f64; N] {
    let along = |k: &[f64; N], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let k1 = rate(y);
    let k2 = rate(&along(&k1, 0.5 * dt));
    let k3 = rate(&along(&k2, 0.5 * dt));
    let k4 = rate(&along(&k3, dt));
    std::array::from_fn(|i| y[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error of an oscillator (1 rad/s) after 8 s; its exact state is (cos t, -sin t).
    fn oscillator_error(steps: u32) -> f64 {
        let dt = 8.0 / f64::from(steps);
        let mut y = [1.0, 0.0];
        for _ in 0..steps {
            y = rk4(&y, dt, |y| [y[1], -y[0]]);
        }
        (y[0] - 8f64.cos()).hypot(y[1] + 8f64.sin())
    }

    #[test]
    fn the_error_falls_with_the_fourth_power_of_the_step() {
        let (coarse, fine) = (oscillator_error(100), oscillator_error(200));
        let order = (coarse / fine).log2();
        assert!((order - 4.0).abs() < 0.1, "order {order}");
        assert!(fine < 1e-6);
    }
}
