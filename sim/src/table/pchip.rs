//! The monotone cubic along one axis: slopes at the nodes and the cubic between two.
//!
//! Invariant: between two nodes the cubic stays within their values, so it has no overshoot and monotone data stay
//! monotone.
//!
//! Source: Fritsch and Butland 1984 (weighted harmonic mean of the neighbouring secants); C. Moler. Numerical Computing
//! with MATLAB. 2004, `pchiptx` (one-sided end slopes that keep the shape), which is what SciPy does.

use super::axis::Axis;
use super::error::TableError;

/// Slopes at all nodes of one row of values.
pub fn slopes(points: &[f64], values: &[f64]) -> Vec<f64> {
    (0..points.len()).map(|node| slope(points, values, node)).collect()
}

/// Slope at one node.
///
/// It depends on the nearest neighbours only: a piece of the axis that has both neighbours of an inner node, or at an
/// end the next two, gives the same.
pub fn slope(points: &[f64], values: &[f64], node: usize) -> f64 {
    let step = |at: usize| points[at + 1] - points[at];
    let secant = |at: usize| (values[at + 1] - values[at]) / step(at);
    let last = points.len() - 1;
    match (points.len(), node) {
        (1, _) => 0.0,
        (2, _) => secant(0),
        (_, 0) => end_slope(step(0), step(1), secant(0), secant(1)),
        (_, node) if node == last => end_slope(step(last - 1), step(last - 2), secant(last - 1), secant(last - 2)),
        _ => {
            let (before, after) = (secant(node - 1), secant(node));
            // A flat or turning place is an extreme: level, or the cubic would pass it.
            if sign(before) * sign(after) <= 0.0 {
                return 0.0;
            }
            let weight_before = 2.0 * step(node) + step(node - 1);
            let weight_after = step(node) + 2.0 * step(node - 1);
            1.0 / ((weight_before / before + weight_after / after) / (weight_before + weight_after))
        }
    }
}

/// Three-point slope at an end: `near` and `far` are the secants of the end's cell and of the next.
fn end_slope(step_near: f64, step_far: f64, near: f64, far: f64) -> f64 {
    let slope = ((2.0 * step_near + step_far) * near - step_near * far) / (step_near + step_far);
    if sign(slope) != sign(near) {
        0.0
    } else if sign(near) != sign(far) && slope.abs() > 3.0 * near.abs() {
        3.0 * near
    } else {
        slope
    }
}

/// -1, 0 or 1; `f64::signum` has no 0.
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

/// The cubic with the given end values and slopes, at a fraction of the step, evaluated from the nearer end.
///
/// NaN for a fraction of NaN.
#[inline]
pub fn hermite(low: f64, high: f64, slope_low: f64, slope_high: f64, step: f64, fraction: f64) -> f64 {
    let (rise, run_low, run_high) = (high - low, slope_low * step, slope_high * step);
    let cube = run_low + run_high - 2.0 * rise;
    let value = if fraction < 0.5 {
        let square = 3.0 * rise - 2.0 * run_low - run_high;
        low + fraction * (run_low + fraction * (square + fraction * cube))
    } else {
        let back = 1.0 - fraction;
        let square = 3.0 * rise - 2.0 * run_high - run_low;
        high - back * (run_high + back * (square + back * cube))
    };
    // Rounding alone can leave the range.
    if value.is_nan() { value } else { value.max(low.min(high)).min(low.max(high)) }
}

/// Refuses values so far apart over breakpoints so close that a secant, or a few times it, is infinite.
pub fn refuse_steep(axes: &[Axis], values: &[f64]) -> Result<(), TableError> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let steep = |axis: &Axis| {
        let span = axis.high() - axis.low();
        axis.breakpoints().windows(2).any(|pair| {
            let step = pair[1] - pair[0];
            // The largest product and the largest quotient that slopes are made of.
            !(8.0 * (high - low) / step * span.max(1.0)).is_finite() || !(8.0 * span / step).is_finite()
        })
    };
    axes.iter().position(steep).map_or(Ok(()), |axis| Err(TableError::Steep { axis }))
}
