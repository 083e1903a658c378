//! Plots of knobs: error over cost, one curve a knob, as SVG written by hand.
//!
//! Error is upward, logarithmic where it spans more than a decade; cost is to the right, from 0. Every point carries
//! its setting. Sizes are in SVG user units, which a browser shows as pixels.

use crate::report::{Knob, KnobPoint};
use std::fmt::Write as _;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 28.0;
const TOP: f64 = 62.0;
const BOTTOM: f64 = 58.0;
const COLUMNS: usize = 2;

/// One knob's plot as a file.
pub fn one(knob: &Knob) -> String {
    document(WIDTH, HEIGHT, &body(knob))
}

/// All plots on one sheet.
pub fn sheet(knobs: &[Knob]) -> String {
    let mut all = String::new();
    for (at, knob) in knobs.iter().enumerate() {
        let (x, y) = ((at % COLUMNS) as f64 * WIDTH, (at / COLUMNS) as f64 * HEIGHT);
        let _ = write!(all, "<g transform=\"translate({x} {y})\">\n{}</g>\n", body(knob));
    }
    let rows = knobs.len().div_ceil(COLUMNS).max(1);
    document(WIDTH * COLUMNS as f64, HEIGHT * rows as f64, &all)
}

fn document(width: f64, height: f64, body: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n{body}</svg>\n"
    )
}

/// An axis: from values to places, with its marks.
struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
    marks: Vec<f64>,
}

impl Axis {
    /// From 0 to somewhat beyond the largest value.
    fn linear(values: &[f64]) -> Self {
        let most = values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f64::max);
        let most = if most > 0.0 { most } else { 1.0 };
        let step = round_step(most / 5.0);
        let high = (most * 1.08 / step).ceil() * step;
        let marks = (0..=(high / step).round() as usize).map(|i| i as f64 * step).collect();
        Self { low: 0.0, high, logarithmic: false, marks }
    }

    /// Whole decades and 2 and 5 of each where values span more than one, else linear.
    fn of_errors(values: &[f64]) -> Self {
        let positive = values.iter().copied().filter(|v| v.is_finite() && *v > 0.0);
        let (least, most) = positive.fold((f64::INFINITY, 0.0f64), |(least, most), v| (least.min(v), most.max(v)));
        if values.iter().any(|v| *v <= 0.0) || most <= 10.0 * least {
            return Self::linear(values);
        }
        let decades = least.log10().floor() as i32..=most.log10().ceil() as i32;
        let all: Vec<f64> = decades.flat_map(|d| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(d))).collect();
        let low = all.iter().copied().filter(|m| *m <= least).fold(all[0], f64::max);
        let high = all.iter().copied().filter(|m| *m >= most).fold(all[all.len() - 1], f64::min);
        let marks = all.into_iter().filter(|m| (low..=high).contains(m)).collect();
        Self { low, high, logarithmic: true, marks }
    }

    /// Share of the way along the axis, 0..=1.
    fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }
}

/// 1, 2 or 5 times a power of ten, not below a positive number.
fn round_step(least: f64) -> f64 {
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0].map(|m| m * power).into_iter().find(|step| *step >= least * 0.999).unwrap_or(10.0 * power)
}

fn body(knob: &Knob) -> String {
    let points: Vec<&KnobPoint> =
        knob.points.iter().filter(|point| point.error.is_finite() && point.cost.is_finite()).collect();
    let x_axis = Axis::linear(&points.iter().map(|point| point.cost).collect::<Vec<_>>());
    let y_axis = Axis::of_errors(&points.iter().map(|point| point.error).collect::<Vec<_>>());
    let x = |cost: f64| LEFT + x_axis.place(cost) * (WIDTH - LEFT - RIGHT);
    let y = |error: f64| HEIGHT - BOTTOM - y_axis.place(error) * (HEIGHT - TOP - BOTTOM);
    let mut text = String::new();
    let mut put = |line: String| {
        text.push_str(&line);
        text.push('\n');
    };
    put(format!("<text x=\"{LEFT}\" y=\"24\" font-size=\"16\" font-weight=\"bold\">{}</text>", escaped(&knob.name)));
    put(format!(
        "<text x=\"{LEFT}\" y=\"44\" fill=\"#555\" font-size=\"11\">up: error, {}</text>",
        escaped(&knob.error_unit)
    ));
    for &mark in &x_axis.marks {
        let at = x(mark);
        put(format!("<path d=\"M{at:.1} {TOP}V{:.1}\" stroke=\"#e4e4e4\"/>", HEIGHT - BOTTOM));
        let label = shown(mark);
        put(format!("<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>", HEIGHT - BOTTOM + 18.0));
    }
    for &mark in &y_axis.marks {
        let at = y(mark);
        put(format!("<path d=\"M{LEFT} {at:.1}H{:.1}\" stroke=\"#e4e4e4\"/>", WIDTH - RIGHT));
        let label = shown(mark);
        put(format!("<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>", LEFT - 8.0, at + 4.0));
    }
    put(format!(
        "<path d=\"M{LEFT} {TOP}V{:.1}H{:.1}\" fill=\"none\" stroke=\"#222\"/>",
        HEIGHT - BOTTOM,
        WIDTH - RIGHT
    ));
    let middle = (LEFT + WIDTH - RIGHT) / 2.0;
    let cost = escaped(&knob.cost_unit);
    put(format!("<text x=\"{middle:.1}\" y=\"{:.1}\" text-anchor=\"middle\">cost, {cost}</text>", HEIGHT - 16.0));
    let line: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", x(p.cost), y(p.error))).collect();
    put(format!("<polyline points=\"{}\" fill=\"none\" stroke=\"#1f5fa8\" stroke-width=\"2\"/>", line.join(" ")));
    for (at, point) in points.iter().enumerate() {
        let (px, py) = (x(point.cost), y(point.error));
        put(format!("<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4\" fill=\"#1f5fa8\"/>"));
        // Labels stand to the right of their points, to the left where another point is in the way or the edge is near.
        let in_the_way = |other: &&KnobPoint| {
            let (dx, dy) = (x(other.cost) - px, y(other.error) - py);
            dx > 0.0 && dx < 60.0 && dy.abs() < 14.0
        };
        let left = px > WIDTH - RIGHT - 60.0 || points.iter().any(in_the_way);
        let (label_x, anchor) = if left { (px - 9.0, "end") } else { (px + 9.0, "start") };
        let label_y = py + 4.0;
        let label =
            if at == 0 { format!("{} {}", shown(point.setting), escaped(&knob.unit)) } else { shown(point.setting) };
        put(format!(
            "<text x=\"{label_x:.1}\" y=\"{label_y:.1}\" text-anchor=\"{anchor}\" fill=\"#1f5fa8\">{label}</text>"
        ));
    }
    text
}

/// At most four digits that count, no trailing zeros.
fn shown(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knob(points: &[(f64, f64, f64)]) -> Knob {
        let points =
            points.iter().map(|&(setting, error, cost)| KnobPoint { setting, error, cost, ..KnobPoint::default() });
        Knob { name: "a < b & c".into(), unit: "m".into(), points: points.collect(), ..Knob::default() }
    }

    #[test]
    fn axes_hold_their_values_between_round_marks() {
        let axis = Axis::linear(&[13.0, 47.0]);
        assert_eq!((axis.low, axis.high, axis.marks.len()), (0.0, 60.0, 7));
        let axis = Axis::of_errors(&[0.013, 0.4]);
        assert!(axis.logarithmic);
        assert!((axis.low - 0.01).abs() < 1e-12 && (axis.high - 0.5).abs() < 1e-12, "{} {}", axis.low, axis.high);
        for (value, place) in [(axis.low, 0.0), (axis.high, 1.0)] {
            assert!((axis.place(value) - place).abs() < 1e-12);
        }
        assert!(!Axis::of_errors(&[3.0, 4.0]).logarithmic && !Axis::of_errors(&[0.0, 4.0]).logarithmic);
        assert_eq!([0.25, 13.0, 1e6, 0.0].map(shown), ["0.25", "13", "1000000", "0"]);
    }

    #[test]
    fn any_knob_makes_a_plot_without_numbers_that_are_none() {
        let odd = [(1.0, f64::NAN, 2.0), (2.0, 0.0, f64::INFINITY), (3.0, 0.0, 0.0)];
        for points in [&[][..], &odd, &[(12.0, 5.0, 30.0)], &[(12.0, 5.0, 30.0), (24.0, 0.05, 60.0)]] {
            let text = one(&knob(points));
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            assert!(text.contains("a &lt; b &amp; c") && text.ends_with("</svg>\n"));
        }
        let text = sheet(&[knob(&[(12.0, 5.0, 30.0)]), knob(&[]), knob(&[])]);
        assert!(text.contains("width=\"1280\" height=\"840\"") && text.matches("<g ").count() == 3);
    }
}
