//! Tests of tables: slow twins, SciPy, nodes, monotony, refusals.

use super::*;
use proptest::prelude::*;

/// The obvious way: multiply out the corners of the cell with their weights.
fn slow_linear(axes: &[Vec<f64>], values: &[f64], point: &[f64]) -> f64 {
    let Some((axis, rest)) = axes.split_first() else { return values[0] };
    let row = values.len() / axis.len();
    let sub = |node: usize| slow_linear(rest, &values[node * row..(node + 1) * row], &point[1..]);
    let x = point[0].max(axis[0]).min(axis[axis.len() - 1]);
    for node in 0..axis.len() - 1 {
        if x < axis[node + 1] {
            let weight = (x - axis[node]) / (axis[node + 1] - axis[node]);
            return (1.0 - weight) * sub(node) + weight * sub(node + 1);
        }
    }
    sub(axis.len() - 1)
}

/// The obvious way: interpolate whole rows, the last axis first, with slopes of the whole axis.
fn slow_pchip(axes: &[Vec<f64>], values: &[f64], point: &[f64]) -> f64 {
    let Some((axis, rest)) = axes.split_first() else { return values[0] };
    let row = values.len() / axis.len();
    let nodes: Vec<f64> = values.chunks_exact(row).map(|chunk| slow_pchip(rest, chunk, &point[1..])).collect();
    let x = point[0].max(axis[0]).min(axis[axis.len() - 1]);
    let slopes = pchip::slopes(axis, &nodes);
    for node in 0..axis.len() - 1 {
        if x < axis[node + 1] {
            let (h, t) = (axis[node + 1] - axis[node], (x - axis[node]) / (axis[node + 1] - axis[node]));
            let (t2, t3) = (t * t, t * t * t);
            return nodes[node] * (2.0 * t3 - 3.0 * t2 + 1.0)
                + h * slopes[node] * (t3 - 2.0 * t2 + t)
                + nodes[node + 1] * (3.0 * t2 - 2.0 * t3)
                + h * slopes[node + 1] * (t3 - t2);
        }
    }
    nodes[axis.len() - 1]
}

fn axis() -> impl Strategy<Value = Vec<f64>> {
    (-50.0f64..50.0, prop::collection::vec(0.01f64..20.0, 0..5)).prop_map(|(start, steps)| {
        let mut points = vec![start];
        points.extend(steps.iter().scan(start, |at, step| {
            *at += step;
            Some(*at)
        }));
        points
    })
}

/// Axes, values of about 1, and a point in and around the grid.
fn grid() -> impl Strategy<Value = (Vec<Vec<f64>>, Vec<f64>, Vec<f64>)> {
    prop::collection::vec(axis(), 1..5).prop_flat_map(|axes| {
        let nodes: usize = axes.iter().map(Vec::len).product();
        let dimensions = axes.len();
        (Just(axes), prop::collection::vec(-1.0f64..1.0, nodes), prop::collection::vec(-60.0f64..160.0, dimensions))
    })
}

proptest! {
    /// Values are of 1 and each axis adds a few roundings: 1e-14 an axis is 45 units in the last place.
    #[test]
    fn linear_equals_its_slow_twin((axes, values, point) in grid()) {
        let table = Table::new(axes.clone(), values.clone(), Interpolation::Linear).unwrap();
        let slow = slow_linear(&axes, &values, &point);
        prop_assert!((table.at(&point) - slow).abs() <= 1e-14 * axes.len() as f64, "{} {slow}", table.at(&point));
    }

    /// A cubic's slopes times steps can reach 3 x the ratio of steps (2000) before they cancel.
    #[test]
    fn pchip_equals_its_slow_twin((axes, values, point) in grid()) {
        let table = Table::new(axes.clone(), values.clone(), Interpolation::Pchip).unwrap();
        let slow = slow_pchip(&axes, &values, &point);
        prop_assert!((table.at(&point) - slow).abs() <= 1e-11, "{} {slow}", table.at(&point));
    }

    #[test]
    fn nodes_are_exact_to_the_bit((axes, values, _) in grid(), cubic in any::<bool>()) {
        let kind = if cubic { Interpolation::Pchip } else { Interpolation::Linear };
        let table = Table::new(axes.clone(), values.clone(), kind).unwrap();
        for (number, value) in values.iter().enumerate() {
            let mut rest = number;
            let mut point = vec![0.0; axes.len()];
            for (at, axis) in axes.iter().enumerate().rev() {
                point[at] = axis[rest % axis.len()];
                rest /= axis.len();
            }
            prop_assert_eq!(table.at(&point).to_bits(), value.to_bits());
        }
    }

    #[test]
    fn monotone_data_stay_monotone(points in axis(), rises in prop::collection::vec(0.0f64..3.0, 6), cubic in any::<bool>()) {
        let values: Vec<f64> = rises.iter().scan(0.0, |at, rise| { *at += rise.floor(); Some(*at) }).take(points.len()).collect();
        let kind = if cubic { Interpolation::Pchip } else { Interpolation::Linear };
        let table = Table::new(vec![points.clone()], values.clone(), kind).unwrap();
        let (low, high) = (table.axes()[0].low(), table.axes()[0].high());
        let at = |step: i32| table.at(&[low + (high - low) * f64::from(step) / 500.0]);
        // Values reach 12, a few units in the last place of which are 1e-14.
        prop_assert!((-3..503).all(|step| at(step + 1) >= at(step) - 1e-14));
    }

    #[test]
    fn any_finite_point_has_a_finite_value_inside_the_hull((axes, values, _) in grid(), x in any::<f64>(), cubic in any::<bool>()) {
        let kind = if cubic { Interpolation::Pchip } else { Interpolation::Linear };
        let table = Table::new(axes.clone(), values.clone(), kind).unwrap();
        let value = table.at(&vec![x; axes.len()]);
        let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), &v| (l.min(v), h.max(v)));
        prop_assert!(x.is_nan() || (low - 1e-15..=high + 1e-15).contains(&value), "{x}: {value}");
    }
}

/// scipy 1.17.1: `PchipInterpolator(x, y)(t)`, printed with `repr`.
#[test]
fn one_axis_agrees_with_scipy() {
    let table = |x: &[f64], y: &[f64]| Table::new(vec![x.to_vec()], y.to_vec(), Interpolation::Pchip).unwrap();
    let wild = table(&[0.0, 0.5, 0.7, 2.0, 2.25, 5.0], &[1.0, 1.5, 0.25, 0.25, 3.0, 2.5]);
    for (t, scipy) in [
        (0.1, 1.244),
        (0.25, 1.4375),
        (0.6, 0.875),
        (0.69, 0.259_062_500_000_000_2),
        (1.3, 0.25),
        (2.1, 1.218_000_000_000_001_3),
        (2.24, 2.987_152),
        (3.0, 2.989_857_250_187_829),
        (4.9, 2.552_586_025_544_703),
    ] {
        assert!((wild.at(&[t]) - scipy).abs() < 1e-14, "{t}: {} {scipy}", wild.at(&[t]));
    }
    let rising = table(&[-1.0, 0.0, 3.0], &[2.0, 2.5, 7.0]);
    for (t, scipy) in [
        (-0.7, 2.101_134_615_384_615_8),
        (-0.1, 2.432_173_076_923_077),
        (0.4, 2.822_666_666_666_666),
        (2.9, 6.777_314_102_564_103),
    ] {
        assert!((rising.at(&[t]) - scipy).abs() < 1e-14, "{t}: {} {scipy}", rising.at(&[t]));
    }
}

/// scipy 1.17.1: each row by `PchipInterpolator` along the last axis, then one through the four results.
#[test]
fn two_axes_agree_with_scipy_taken_twice() {
    let axes = vec![vec![0.0, 1.0, 2.5, 4.0], vec![-2.0, -1.0, 1.0, 1.5, 3.0]];
    #[rustfmt::skip]
    let values = vec![
        0.0, -3.0, -6.0, -9.0, -12.0,
        1.0, -1.0, -3.0, -8.0, -10.0,
        4.0, 3.0, -1.0, -5.0, -6.0,
        9.0, 6.0, 3.0, 0.0, -3.0,
    ];
    let table = Table::new(axes, values, Interpolation::Pchip).unwrap();
    for (s, t, scipy) in [
        (0.3, -1.5, -1.283_604_072_389_969),
        (1.7, 0.2, -0.423_681_837_496_632_6),
        (3.9, 2.7, -3.027_235_967_731_091_4),
        (2.5, 1.2, -2.601_042_062_415_196),
        (0.9, 1.5, -8.128_252_173_913_044),
    ] {
        assert!((table.at(&[s, t]) - scipy).abs() < 2e-14, "{s} {t}: {} {scipy}", table.at(&[s, t]));
    }
}

#[test]
fn outside_is_told_and_held() {
    let table = Table::new(vec![vec![1.0, 2.0], vec![5.0]], vec![10.0, 20.0], Interpolation::Linear).unwrap();
    assert_eq!(table.at(&[-7.0, 99.0]), 10.0);
    assert_eq!(table.at(&[f64::INFINITY, f64::NEG_INFINITY]), 20.0);
    assert!(table.at(&[f64::NAN, 5.0]).is_nan());
    assert_eq!(table.outside(&[1.5, 5.0]), None);
    assert_eq!(table.outside(&[1.5, 5.5]), Some(Outside { axis: 1, value: 5.5, low: 5.0, high: 5.0 }));
    assert!(table.outside(&[f64::NAN, 5.0]).is_some_and(|outside| outside.axis == 0));
}

#[test]
fn numbers_that_are_no_table_are_refused_with_their_place() {
    let table = |axes: &[&[f64]], values: &[f64]| {
        Table::new(axes.iter().map(|a| a.to_vec()).collect(), values.to_vec(), Interpolation::Pchip).unwrap_err()
    };
    assert_eq!(table(&[], &[1.0]), TableError::Axes { found: 0 });
    assert_eq!(table(&[&[0.0][..]; 17], &[1.0]), TableError::Axes { found: 17 });
    assert_eq!(table(&[&[0.0], &[]], &[]), TableError::Points { axis: 1, found: 0 });
    let falling = TableError::NotRising { axis: 1, index: 2, before: 4.0, value: 4.0 };
    assert_eq!(table(&[&[0.0], &[1.0, 4.0, 4.0]], &[0.0; 3]), falling);
    assert_eq!(table(&[&[0.0, 1.0], &[0.0, 1.0]], &[0.0; 3]), TableError::Count { expected: 4, found: 3 });
    let infinite = TableError::Number { place: Place::Value(1), value: f64::INFINITY };
    assert_eq!(table(&[&[0.0, 1.0]], &[0.0, f64::INFINITY]), infinite);
    assert!(matches!(table(&[&[0.0, f64::NAN]], &[0.0; 2]), TableError::Number { .. }));
    assert_eq!(table(&[&[0.0, 5e-324]], &[0.0, 1.0]), TableError::Steep { axis: 0 });
    assert_eq!(falling.to_string(), "axis 1: breakpoint 2 must be above 4, the one before, found 4");
}
