//! The shape of a way: a smooth line through places, equal distances along it, and heights over what lies below.

use super::{LONGEST_M, MOST_SAMPLES, TrackError, check};
use glam::DVec3;

/// A centripetal Catmull-Rom spline through the places, some 50 points a piece; which point each place became.
///
/// Source: P. Barry, R. Goldman, A Recursive Evaluation Algorithm for a Class of Catmull-Rom Splines, 1988, with the
/// knots of C. Yuksel et al., On the Parameterization of Catmull-Rom Curves, 2009: no loops, no overshoot.
pub(super) fn spline(places: &[DVec3]) -> Result<(Vec<DVec3>, Vec<usize>), TrackError> {
    const A_PIECE: usize = 64;
    let apart = places.windows(2).all(|pair| (pair[1] - pair[0]).length() > 1.0);
    let (&[first, second, ..], &[.., before_last, last]) = (places, places) else {
        return Err(TrackError::TooShort(places.len()));
    };
    if !apart || places.iter().any(|p| !p.is_finite()) {
        return Err(TrackError::TooShort(places.len()));
    }
    // A place beyond each end, mirrored, gives the ends a direction.
    let mut all = vec![2.0 * first - second];
    all.extend_from_slice(places);
    all.push(2.0 * last - before_last);
    let mut dense = Vec::with_capacity(places.len() * A_PIECE);
    let mut starts = Vec::with_capacity(places.len());
    for p in all.windows(4) {
        let knot = |i: usize| (p[i + 1] - p[i]).length().sqrt();
        let k1 = knot(0);
        let k2 = k1 + knot(1);
        let k3 = k2 + knot(2);
        starts.push(dense.len());
        for step in 0..A_PIECE {
            let k = k1 + (k2 - k1) * step as f64 / A_PIECE as f64;
            let a1 = p[0] * ((k1 - k) / k1) + p[1] * (k / k1);
            let a2 = p[1].lerp(p[2], (k - k1) / (k2 - k1));
            let a3 = p[2].lerp(p[3], (k - k2) / (k3 - k2));
            let b1 = a1 * ((k2 - k) / k2) + a2 * (k / k2);
            let b2 = a2 * ((k3 - k) / (k3 - k1)) + a3 * ((k - k1) / (k3 - k1));
            dense.push(b1.lerp(b2, (k - k1) / (k2 - k1)));
        }
    }
    starts.push(dense.len());
    dense.push(last);
    Ok((dense, starts))
}

/// Points at equal distances along a polyline, their spacing, and the distance of every given point.
pub(super) fn evenly(dense: &[DVec3]) -> Result<(Vec<DVec3>, f64, Vec<f64>), TrackError> {
    let mut lengths = vec![0.0];
    for pair in dense.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).length());
    }
    let total_m = lengths[lengths.len() - 1];
    check("a track's length", "1..=4e7", total_m, 1.0, LONGEST_M)?;
    let pieces = (total_m / 100.0).ceil().clamp(1.0, MOST_SAMPLES);
    let spacing_m = total_m / pieces;
    let mut samples = Vec::with_capacity(pieces as usize + 1);
    let mut at = 0;
    for i in 0..=pieces as usize {
        let distance_m = i as f64 * spacing_m;
        while at + 2 < lengths.len() && lengths[at + 1] < distance_m {
            at += 1;
        }
        let t = (distance_m - lengths[at]) / (lengths[at + 1] - lengths[at]).max(1e-9);
        samples.push(dense[at].lerp(dense[at + 1], t.clamp(0.0, 1.0)));
    }
    Ok((samples, spacing_m, lengths))
}

/// Largest value within `reach` places before and behind; where there is none at all, the largest of everything, else 0.
pub(super) fn highest(values: &[f64], reach: usize) -> Vec<f64> {
    let fallback = values.iter().copied().filter(|v| *v > f64::MIN).fold(f64::MIN, f64::max);
    let fallback = if fallback > f64::MIN { fallback } else { 0.0 };
    // Candidates with falling values: the first is the largest of the window (Lemire, 2006).
    let mut queue = std::collections::VecDeque::new();
    let mut next = 0;
    (0..values.len())
        .map(|i| {
            while next < values.len() && next <= i + reach {
                while queue.back().is_some_and(|&last: &usize| values[last] <= values[next]) {
                    queue.pop_back();
                }
                queue.push_back(next);
                next += 1;
            }
            while queue.front().is_some_and(|&first| first + reach < i) {
                queue.pop_front();
            }
            queue.front().map_or(fallback, |&first| if values[first] > f64::MIN { values[first] } else { fallback })
        })
        .collect()
}

/// Mean within `reach` places before and behind. Of the highest over twice the reach it is at least the highest over one.
pub(super) fn smoothed(values: &[f64], reach: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    (0..values.len())
        .map(|i| {
            let (from, to) = (i.saturating_sub(reach), (i + reach + 1).min(values.len()));
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_of_a_window_is_that_of_a_plain_search() {
        let values: Vec<f64> = (0..200).map(|i| f64::from((i * 7919) % 101)).collect();
        for reach in [1, 5, 50, 400] {
            for (i, got) in highest(&values, reach).into_iter().enumerate() {
                let slow =
                    values[i.saturating_sub(reach)..(i + reach + 1).min(200)].iter().copied().fold(f64::MIN, f64::max);
                assert_eq!(got, slow);
            }
        }
    }
}
