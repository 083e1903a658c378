//! An axis of a plot: from values to places, with round marks.

/// Most decades with marks at 2 and 5 too.
const FINE_DECADES: f64 = 3.0;

/// An axis: from values to places, with its marks.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// The value at its start.
    pub low: f64,
    /// The value at its end.
    pub high: f64,
    /// Whether decades are equally long.
    pub logarithmic: bool,
    /// Where it is marked.
    pub marks: Vec<f64>,
}

impl Axis {
    /// From 0 to somewhat beyond the largest value.
    pub fn linear(values: &[f64]) -> Self {
        let most = values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
        let most = if most > 0.0 { most } else { 1.0 };
        let step = round_step(most / 5.0);
        let high = (most * 1.08 / step).ceil() * step;
        let marks = (0..=(high / step).round() as usize).map(|i| i as f64 * step).collect();
        Self { low: 0.0, high, logarithmic: false, marks }
    }

    /// Linear, from somewhat below the least value to somewhat beyond the greatest.
    pub fn around(values: &[f64]) -> Self {
        let sound = values.iter().copied().filter(|v| v.is_finite());
        let (least, most) =
            sound.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (least.min(v), most.max(v)));
        let (least, most) = if least <= most { (least, most) } else { (0.0, 1.0) };
        // A constant is drawn in the middle of a span that it does not vanish in.
        let (span, middle) = ((most - least).max(1e-9 * most.abs()).max(1e-9), 0.5 * (least + most));
        let step = round_step(1.04 * span / 6.0);
        let low = ((middle - 0.52 * span) / step).floor() * step;
        let high = ((middle + 0.52 * span) / step).ceil() * step;
        let count = ((high - low) / step).round().clamp(1.0, 20.0) as usize;
        let mark = |i: usize| low + i as f64 * step;
        // A zero that the sum of steps misses by a rounding is one.
        let marks = (0..=count).map(mark).map(|m| if m.abs() < 1e-6 * step { 0.0 } else { m }).collect();
        Self { low, high, logarithmic: false, marks }
    }

    /// Linear, from the least value to the greatest, with round marks between.
    pub fn along(values: &[f64]) -> Self {
        let wide = Self::around(values);
        let sound = || values.iter().copied().filter(|v| v.is_finite());
        let (low, high) = (sound().fold(f64::INFINITY, f64::min), sound().fold(f64::NEG_INFINITY, f64::max));
        if low >= high || !(high - low).is_finite() {
            return wide;
        }
        let marks = wide.marks.into_iter().filter(|mark| (low..=high).contains(mark)).collect();
        Self { low, high, logarithmic: false, marks }
    }

    /// Logarithmic where values span more than a decade and all are above 0, else linear.
    pub fn of_errors(values: &[f64]) -> Self {
        let (least, most) = span(values);
        if values.iter().any(|v| *v <= 0.0) || most <= 10.0 * least {
            Self::linear(values)
        } else {
            Self::decades(values)
        }
    }

    /// Logarithmic: whole decades, and 2 and 5 of each where there are few. Values that are not above 0 have no place.
    pub fn decades(values: &[f64]) -> Self {
        let (least, most) = span(values);
        if !(least > 0.0 && most.is_finite() && least <= most) {
            return Self { low: 0.1, high: 10.0, logarithmic: true, marks: vec![0.1, 1.0, 10.0] };
        }
        let (first, last) = (least.log10().floor() as i32, most.log10().ceil() as i32);
        let fine = f64::from(last - first) <= FINE_DECADES;
        let steps: &[f64] = if fine { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let all: Vec<f64> = (first..=last).flat_map(|d| steps.iter().map(move |m| m * 10f64.powi(d))).collect();
        let low = all.iter().copied().filter(|m| *m <= least * (1.0 + 1e-9)).fold(all[0], f64::max);
        let high = all.iter().copied().filter(|m| *m >= most * (1.0 - 1e-9)).fold(all[all.len() - 1], f64::min);
        let high = if high > low { high } else { 10.0 * low };
        let marks = all.into_iter().filter(|m| (low..=high).contains(m)).collect();
        Self { low, high, logarithmic: true, marks }
    }

    /// Share of the way along the axis, 0..=1.
    pub fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

/// Least and greatest of the values that a logarithm has.
fn span(values: &[f64]) -> (f64, f64) {
    let positive = values.iter().copied().filter(|v| v.is_finite() && *v > 0.0);
    positive.fold((f64::INFINITY, 0.0f64), |(least, most), v| (least.min(v), most.max(v)))
}

/// 1, 2 or 5 times a power of ten, not below a positive number.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * power).into_iter().find(|step| *step >= least * 0.999).unwrap_or(10.0 * power)
}

/// At most four digits that count, no trailing zeros; very small and very large ones with a power of ten.
pub fn shown(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e7).contains(&value.abs()) {
        let text = format!("{value:.1e}");
        return text.replace(".0e", "e");
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_hold_their_values_between_round_marks() {
        let axis = Axis::linear(&[13.0, 47.0]);
        assert_eq!((axis.low, axis.high, axis.marks.len()), (0.0, 60.0, 7));
        let axis = Axis::around(&[-0.3, 2.2, f64::NAN]);
        assert!(axis.low <= -0.3 && axis.high >= 2.2 && axis.marks.contains(&0.0), "{axis:?}");
        for odd in [&[][..], &[7.0], &[f64::NAN], &[-1e12, -1e12]] {
            let axis = Axis::around(odd);
            assert!(axis.high > axis.low && axis.marks.len() > 1, "{odd:?}: {axis:?}");
        }
        let axis = Axis::of_errors(&[0.013, 0.4]);
        assert!(axis.logarithmic);
        assert!((axis.low - 0.01).abs() < 1e-12 && (axis.high - 0.5).abs() < 1e-12, "{} {}", axis.low, axis.high);
        for (value, place) in [(axis.low, 0.0), (axis.high, 1.0)] {
            assert!((axis.place(value) - place).abs() < 1e-12);
        }
        assert!(!Axis::of_errors(&[3.0, 4.0]).logarithmic && !Axis::of_errors(&[0.0, 4.0]).logarithmic);
        assert_eq!([0.25, 13.0, 1e6, 0.0, 3e-9, 1.5e-4].map(shown), ["0.25", "13", "1000000", "0", "3e-9", "1.5e-4"]);
    }

    #[test]
    fn many_decades_are_marked_by_decades_alone() {
        let axis = Axis::decades(&[3e-9, 40.0, 0.0, f64::NAN]);
        assert_eq!((axis.marks.len(), axis.low, axis.high), (12, 1e-9, 100.0));
        for odd in [&[][..], &[0.0], &[f64::NAN, f64::INFINITY], &[5.0], &[10.0]] {
            let axis = Axis::decades(odd);
            assert!(axis.high > axis.low && axis.low > 0.0, "{odd:?}: {axis:?}");
        }
    }
}
