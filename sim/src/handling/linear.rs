//! A linear system fitted to a free response, and its eigenvalues.
//!
//! Rows of a response at equal times are fitted by x(k+1) = M x(k) in the sense of least squares; an eigenvalue m of M
//! is the mode ln(m) / dt. Eigenvalues are the roots of the characteristic polynomial (Faddeev and LeVerrier), found all
//! at once (Durand and Kerner): for the two to four states of a flight's modes.
//!
//! Source: D. K. Faddeev, V. N. Faddeeva, Computational Methods of Linear Algebra, 1963; I. O. Kerner, Numerische
//! Mathematik 8, 1966.

/// A mode: its rate, 1/s, negative where it dies out, and its frequency, rad/s, 0 where it does not swing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Real part.
    pub rate_radps: f64,
    /// Imaginary part, not negative.
    pub swing_radps: f64,
}

impl Mode {
    /// Natural frequency, rad/s.
    pub fn natural_radps(&self) -> f64 {
        self.rate_radps.hypot(self.swing_radps)
    }

    /// Damping ratio.
    pub fn damping(&self) -> f64 {
        -self.rate_radps / self.natural_radps()
    }

    /// Time constant, seconds; negative where it grows.
    pub fn time_s(&self) -> f64 {
        -1.0 / self.rate_radps
    }
}

/// The modes of a response of `N` states at equal times; `None` if it has none, as where nothing moves.
pub fn modes<const N: usize>(rows: &[[f64; N]], dt_s: f64) -> Option<Vec<Mode>> {
    // States of one size, so that none drowns the others.
    let scale: [f64; N] = std::array::from_fn(|i| rows.iter().map(|row| row[i].abs()).fold(0.0, f64::max));
    if scale.iter().any(|s| *s <= 0.0) {
        return None;
    }
    let scaled = |row: &[f64; N]| -> [f64; N] { std::array::from_fn(|i| row[i] / scale[i]) };
    let (mut gram, mut cross) = ([[0.0; N]; N], [[0.0; N]; N]);
    for pair in rows.windows(2) {
        let (now, next) = (scaled(&pair[0]), scaled(&pair[1]));
        for i in 0..N {
            for j in 0..N {
                gram[i][j] += now[i] * now[j];
                cross[i][j] += now[i] * next[j];
            }
        }
    }
    let step = solved(gram, cross)?;
    // The transpose of M: it has the same eigenvalues.
    let roots = roots(&characteristic(&step));
    let mode =
        |(re, im): (f64, f64)| Mode { rate_radps: re.hypot(im).ln() / dt_s, swing_radps: im.atan2(re).abs() / dt_s };
    let mut all: Vec<Mode> = roots.into_iter().filter(|(_, im)| *im >= -1e-12).map(mode).collect();
    all.sort_by(|a, b| a.rate_radps.total_cmp(&b.rate_radps));
    all.iter().all(|one| one.rate_radps.is_finite()).then_some(all)
}

/// Solves A X = B by elimination.
fn solved<const N: usize>(mut a: [[f64; N]; N], mut b: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    for i in 0..N {
        let best = (i..N).max_by(|p, q| a[*p][i].abs().total_cmp(&a[*q][i].abs()))?;
        a.swap(i, best);
        b.swap(i, best);
        if a[i][i] == 0.0 {
            return None;
        }
        for row in 0..N {
            if row == i {
                continue;
            }
            let by = a[row][i] / a[i][i];
            for j in 0..N {
                a[row][j] -= by * a[i][j];
                b[row][j] -= by * b[i][j];
            }
        }
    }
    Some(std::array::from_fn(|i| b[i].map(|x| x / a[i][i])))
}

/// Coefficients of det(x - M), from x^N down.
fn characteristic<const N: usize>(m: &[[f64; N]; N]) -> Vec<f64> {
    let mut all = vec![1.0];
    let mut power = [[0.0; N]; N];
    for k in 1..=N {
        let last = all[k - 1];
        let mut next = [[0.0; N]; N];
        for (i, row) in next.iter_mut().enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                let before = |l: usize| power[l][j] + if l == j { last } else { 0.0 };
                *x = (0..N).map(|l| m[i][l] * before(l)).sum();
            }
        }
        let trace: f64 = (0..N).map(|i| next[i][i]).sum();
        all.push(-trace / k as f64);
        power = next;
    }
    all
}

/// All roots of a polynomial with a first coefficient of 1.
fn roots(coefficients: &[f64]) -> Vec<(f64, f64)> {
    let n = coefficients.len() - 1;
    let times = |(a, b): (f64, f64), (c, d): (f64, f64)| (a * c - b * d, a * d + b * c);
    let over = |(a, b): (f64, f64), (c, d): (f64, f64)| {
        let size = c * c + d * d;
        ((a * c + b * d) / size, (b * c - a * d) / size)
    };
    let value = |x| {
        coefficients.iter().fold((0.0, 0.0), |sum, c| {
            let (re, im) = times(sum, x);
            (re + c, im)
        })
    };
    let mut all = Vec::with_capacity(n);
    let mut start = (1.0, 0.0);
    for _ in 0..n {
        start = times(start, (0.4, 0.9));
        all.push(start);
    }
    for _ in 0..500 {
        for i in 0..n {
            let apart = (0..n)
                .filter(|j| *j != i)
                .fold((1.0, 0.0), |product, j| times(product, (all[i].0 - all[j].0, all[i].1 - all[j].1)));
            let step = over(value(all[i]), apart);
            if step.0.is_finite() && step.1.is_finite() {
                all[i] = (all[i].0 - step.0, all[i].1 - step.1);
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_response_made_of_known_modes_gives_them_back() {
        // Two real modes and a swinging pair, mixed.
        let dt_s = 0.02;
        let rows: Vec<[f64; 4]> = (0..400)
            .map(|k| {
                let t = f64::from(k) * dt_s;
                let (a, b) = ((-4.0 * t).exp(), (-0.02 * t).exp());
                let (c, d) = ((-0.5 * t).exp() * (3.0 * t).cos(), (-0.5 * t).exp() * (3.0 * t).sin());
                [a + c, 10.0 * b - d, a + b + 0.3 * c, 0.01 * (d - a)]
            })
            .collect();
        let found = modes(&rows, dt_s).unwrap();
        let expected = [(-4.0, 0.0), (-0.5, 3.0), (-0.02, 0.0)];
        assert_eq!(found.len(), expected.len());
        for (mode, (rate, swing)) in found.iter().zip(expected) {
            // Noise-free: what is left is the condition of the normal equations, squared, times 2^-52.
            assert!((mode.rate_radps - rate).abs() < 1e-4 && (mode.swing_radps - swing).abs() < 1e-4, "{found:?}");
        }
        assert_eq!(modes(&[[0.0, 0.0]; 5], 0.1), None);
    }
}
