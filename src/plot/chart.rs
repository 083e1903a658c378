//! Curves over a common quantity: what flights and tests did in time or along their way.
//!
//! Values have any unit; a chart says which. What is not finite is left out of a curve.

use super::axis::{Axis, shown};
use super::drawing::{Drawing, FAINT, GREY, INK};
use visual::passes::lines::Align;

/// Width and height of a chart; at two pixels a unit two side by side are 2,560 pixels wide.
pub const SIZE: [f64; 2] = [640.0, 240.0];
const LEFT: f64 = 64.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 40.0;
const TEXT: f64 = 11.0;
/// Room for a sheet's own heading.
const HEADING: f64 = 34.0;
/// Blue, orange, green, purple, told apart by the colour-blind.
const COLOURS: [u32; 4] = [0x1f_5f_a8, 0xd5_5e_00, 0x00_8f_6a, 0x8a_3f_9e];
/// Most points of a curve that are drawn: two a pixel.
const MOST_POINTS: usize = 2_400;

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// What it is; may be empty where there is one only.
    pub name: String,
    /// Across and up.
    pub points: Vec<[f64; 2]>,
    /// Whether it is a line to compare with.
    pub dashed: bool,
}

impl Curve {
    /// A curve of what was found.
    pub fn new(name: impl Into<String>, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self { name: name.into(), points: points.into_iter().collect(), dashed: false }
    }

    /// A line to compare with.
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }
}

/// Curves in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Its heading.
    pub name: String,
    /// What is up, with its unit.
    pub up: String,
    /// What is across, with its unit.
    pub across: String,
    /// At most four have colours of their own.
    pub curves: Vec<Curve>,
}

impl Chart {
    /// The chart as a drawing.
    pub fn drawing(&self) -> Drawing {
        let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
        let all = |part: usize| -> Vec<f64> {
            self.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| point[part])).collect()
        };
        let (x, y) = (Axis::along(&all(0)), Axis::around(&all(1)));
        let (right, floor) = (SIZE[0] - RIGHT, SIZE[1] - BOTTOM);
        let at =
            |point: [f64; 2]| [LEFT + x.place(point[0]) * (right - LEFT), floor - y.place(point[1]) * (floor - TOP)];
        drawing.heading([LEFT, 16.0], 13.0, &self.name);
        drawing.text([LEFT, 32.0], TEXT, Align::Left, GREY, &self.up);
        for &mark in &x.marks {
            let [place, _] = at([mark, y.low]);
            drawing.line(&[[place, TOP], [place, floor]], 1.0, FAINT, false);
            drawing.text([place, floor + 14.0], TEXT, Align::Middle, INK, &shown(mark));
        }
        for &mark in &y.marks {
            let [_, place] = at([x.low, mark]);
            drawing.line(&[[LEFT, place], [right, place]], 1.0, FAINT, false);
            drawing.text([LEFT - 6.0, place + 4.0], TEXT, Align::Right, INK, &shown(mark));
        }
        drawing.line(&[[LEFT, TOP], [LEFT, floor], [right, floor]], 1.2, INK, false);
        drawing.text([0.5 * (LEFT + right), SIZE[1] - 8.0], TEXT, Align::Middle, INK, &self.across);
        let mut legend = right;
        for (curve, colour) in self.curves.iter().zip(COLOURS.iter().cycle()) {
            let every = curve.points.len().div_ceil(MOST_POINTS).max(1);
            let points: Vec<[f64; 2]> = curve.points.iter().step_by(every).map(|point| at(*point)).collect();
            drawing.line(&points, 1.8, *colour, curve.dashed);
            if !curve.name.is_empty() {
                drawing.text([legend, 32.0], TEXT, Align::Right, *colour, &curve.name);
                legend -= 7.5 * curve.name.chars().count() as f64 + 18.0;
            }
        }
        drawing
    }
}

/// Charts side by side under a heading.
pub fn sheet(name: &str, charts: &[Chart], columns: usize) -> Drawing {
    let columns = columns.max(1);
    let rows = charts.len().div_ceil(columns).max(1);
    let mut all = Drawing::new(SIZE[0] * columns as f64, HEADING + SIZE[1] * rows as f64);
    all.heading([LEFT, 24.0], 16.0, name);
    for (place, chart) in charts.iter().enumerate() {
        let at = [(place % columns) as f64 * SIZE[0], HEADING + (place / columns) as f64 * SIZE[1]];
        all.place(&chart.drawing(), at);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chart_holds_its_curves_and_leaves_out_what_is_no_number() {
        let wave = Curve::new("wave", (0..50).map(|i| [f64::from(i), f64::from(i).sin()]));
        let odd = Curve::new("odd", [[0.0, f64::NAN], [f64::INFINITY, 1.0], [3.0, 0.5]]).dashed();
        let chart =
            Chart { name: "A <test>".into(), up: "m".into(), across: "time, s".into(), curves: vec![wave, odd] };
        let svg = sheet("sheet", &[chart.clone(), Chart { curves: Vec::new(), ..chart }], 2).svg();
        assert!(svg.contains("A &lt;test&gt;") && svg.contains("wave") && !svg.contains("NaN") && !svg.contains("inf"));
        let places = svg.split("points=\"").skip(1).flat_map(|rest| rest.split('"').next().unwrap().split(' '));
        for place in places.filter(|place| !place.is_empty()) {
            let (x, y) = place.split_once(',').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!((0.0..=2.0 * SIZE[0]).contains(&x) && (0.0..=HEADING + SIZE[1]).contains(&y), "{place}");
        }
    }
}
