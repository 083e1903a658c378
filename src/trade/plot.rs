//! Plots of knobs. A plain knob: error over cost, every point with its setting. A row of models: a line each with its
//! error. Knobs of one group: error over setting, a curve each, both axes logarithmic.
//!
//! Error is upward, except in a row of models, where it is to the right. What has no place on an axis (no number, or 0
//! on a logarithmic one) has no point; a row of models says so in words.

use crate::plot::axis::{Axis, shown};
use crate::plot::drawing::{Drawing, FAINT, GREY, INK};
use crate::report::{Knob, KnobPoint};
use visual::passes::lines::Align;

/// Width and height of a plot: at two pixels a unit a picture of 1280 x 720.
pub const SIZE: [f64; 2] = [640.0, 360.0];
/// Plots side by side on a sheet.
const COLUMNS: usize = 2;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 28.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 50.0;
const TEXT: f64 = 12.0;
/// Curves of one colour differ by their dashes; blue, orange, green, purple, told apart by the colour-blind.
const COLOURS: [u32; 4] = [0x1f_5f_a8, 0xd5_5e_00, 0x00_8f_6a, 0x8a_3f_9e];

/// All plots of some knobs, with the names of their files: a knob each, and one for each group.
pub fn all(knobs: &[Knob]) -> Vec<(String, Drawing)> {
    let file = |name: &str| name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "_");
    let mut plots: Vec<(String, Drawing)> = knobs.iter().map(|knob| (file(&knob.name), one(knob))).collect();
    plots.extend(groups(knobs).into_iter().map(|(name, members)| (file(name), group(name, &members))));
    plots
}

/// One sheet: the groups first, then what belongs to none.
pub fn sheet(knobs: &[Knob]) -> Drawing {
    let together = groups(knobs).into_iter().map(|(name, members)| group(name, &members));
    let alone = knobs.iter().filter(|knob| knob.group.is_none()).map(one);
    let plots: Vec<Drawing> = together.chain(alone).collect();
    let rows = plots.len().div_ceil(COLUMNS).max(1);
    let mut all = Drawing::new(SIZE[0] * COLUMNS as f64, SIZE[1] * rows as f64);
    for (at, plot) in plots.iter().enumerate() {
        all.place(plot, [(at % COLUMNS) as f64 * SIZE[0], (at / COLUMNS) as f64 * SIZE[1]]);
    }
    all
}

/// The groups in the order of their first knobs.
fn groups(knobs: &[Knob]) -> Vec<(&str, Vec<&Knob>)> {
    let mut groups: Vec<(&str, Vec<&Knob>)> = Vec::new();
    for knob in knobs {
        let Some(name) = knob.group.as_deref() else { continue };
        match groups.iter_mut().find(|(known, _)| *known == name) {
            Some((_, members)) => members.push(knob),
            None => groups.push((name, vec![knob])),
        }
    }
    groups
}

/// A knob's own plot.
fn one(knob: &Knob) -> Drawing {
    if knob.points.iter().any(|point| point.label.is_some()) { ladder(knob) } else { over_cost(knob) }
}

/// A frame with two axes, and what turns values into places.
struct Frame {
    x: Axis,
    y: Axis,
    right: f64,
}

impl Frame {
    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let across = self.right - LEFT;
        [LEFT + self.x.place(x) * across, SIZE[1] - BOTTOM - self.y.place(y) * (SIZE[1] - TOP - BOTTOM)]
    }

    fn draw(&self, drawing: &mut Drawing, name: &str, above: &str, below: &str) {
        let floor = SIZE[1] - BOTTOM;
        drawing.heading([LEFT, 22.0], 16.0, name);
        drawing.text([LEFT, 42.0], 11.0, Align::Left, GREY, above);
        let widest = |marks: &[f64]| marks.iter().map(|mark| shown(*mark).len()).max().unwrap_or(0);
        // Marks that would touch each other are left without their number.
        let room = (self.right - LEFT) / self.x.marks.len().max(1) as f64;
        let every = (widest(&self.x.marks) as f64 * 8.0 / room).ceil().max(1.0) as usize;
        for (i, &mark) in self.x.marks.iter().enumerate() {
            let [x, _] = self.at(mark, self.y.low);
            drawing.line(&[[x, TOP], [x, floor]], 1.0, FAINT, false);
            if i % every == 0 {
                drawing.text([x, floor + 16.0], TEXT, Align::Middle, INK, &shown(mark));
            }
        }
        for &mark in &self.y.marks {
            let [_, y] = self.at(self.x.low, mark);
            drawing.line(&[[LEFT, y], [self.right, y]], 1.0, FAINT, false);
            drawing.text([LEFT - 8.0, y + 4.0], TEXT, Align::Right, INK, &shown(mark));
        }
        drawing.line(&[[LEFT, TOP], [LEFT, floor], [self.right, floor]], 1.2, INK, false);
        drawing.text([0.5 * (LEFT + self.right), SIZE[1] - 14.0], TEXT, Align::Middle, INK, below);
    }
}

/// Error over cost.
fn over_cost(knob: &Knob) -> Drawing {
    let points: Vec<&KnobPoint> =
        knob.points.iter().filter(|point| point.error.is_finite() && point.cost.is_finite()).collect();
    let costs: Vec<f64> = points.iter().map(|point| point.cost).collect();
    let most = costs.iter().copied().fold(0.0, f64::max);
    let many = costs.iter().any(|cost| *cost > 0.0 && *cost < 0.02 * most);
    let frame = Frame {
        x: if many { Axis::decades(&costs) } else { Axis::linear(&costs) },
        y: Axis::of_errors(&points.iter().map(|point| point.error).collect::<Vec<_>>()),
        right: SIZE[0] - RIGHT,
    };
    let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
    let (above, below) = (format!("up: error, {}", knob.error_unit), format!("cost, {}", knob.cost_unit));
    frame.draw(&mut drawing, &knob.name, &above, &below);
    let places: Vec<[f64; 2]> = points.iter().map(|point| frame.at(point.cost, point.error)).collect();
    drawing.line(&places, 2.0, COLOURS[0], false);
    for (at, (point, &[x, y])) in points.iter().zip(&places).enumerate() {
        drawing.dot([x, y], 4.0, COLOURS[0]);
        // Labels stand to the right of their points, to the left where another point is in the way or the edge is near.
        let in_the_way = |[other_x, other_y]: &[f64; 2]| {
            let (dx, dy) = (other_x - x, other_y - y);
            dx > 0.0 && dx < 60.0 && dy.abs() < 14.0
        };
        // Beside a crowded curve: above it, on the side that it does not go to.
        let rises = places.get(at + 1).is_some_and(|next| next[1] < y + 6.0);
        let left = if many { rises } else { places.iter().any(in_the_way) } || x > SIZE[0] - RIGHT - 60.0;
        let (beside, above) = match many {
            true if y > TOP + 12.0 => (5.0, 7.0),
            true => (5.0, -15.0),
            false => (9.0, -4.0),
        };
        let (label_x, align) = if left { (x - beside, Align::Right) } else { (x + beside, Align::Left) };
        let label = if at == 0 { format!("{} {}", shown(point.setting), knob.unit) } else { shown(point.setting) };
        drawing.text([label_x, y - above], TEXT, align, COLOURS[0], &label);
    }
    drawing
}

/// Error over setting, a curve a knob. Single precision is dashed; the best setting of each stands in the legend.
fn group(name: &str, knobs: &[&Knob]) -> Drawing {
    const LEGEND: f64 = 172.0;
    let points = || knobs.iter().flat_map(|knob| &knob.points);
    let frame = Frame {
        x: Axis::decades(&points().map(|point| point.setting).collect::<Vec<_>>()),
        y: Axis::decades(&points().map(|point| point.error).collect::<Vec<_>>()),
        right: SIZE[0] - LEGEND,
    };
    let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
    let (error, unit) = knobs.first().map_or(("", ""), |knob| (knob.error_unit.as_str(), knob.unit.as_str()));
    frame.draw(&mut drawing, name, &format!("up: error, {error}"), unit);
    let dashed = |knob: &Knob| knob.name.ends_with("f32");
    // Knobs that differ in precision alone share a colour.
    let stem = |knob: &Knob| knob.name.trim_end_matches("f32").trim_end_matches("f64").to_owned();
    let mut stems: Vec<String> = Vec::new();
    for (row, knob) in knobs.iter().enumerate() {
        let colour_at = stems.iter().position(|known| *known == stem(knob)).unwrap_or_else(|| {
            stems.push(stem(knob));
            stems.len() - 1
        });
        let colour = COLOURS[colour_at % COLOURS.len()];
        let seen = knob.points.iter().filter(|point| point.error > 0.0);
        let places: Vec<[f64; 2]> = seen.map(|point| frame.at(point.setting, point.error)).collect();
        drawing.line(&places, 2.0, colour, dashed(knob));
        for &at in &places {
            drawing.dot(at, if dashed(knob) { 2.6 } else { 3.4 }, colour);
        }
        let (x, y) = (frame.right + 14.0, TOP + 8.0 + 30.0 * row as f64);
        drawing.line(&[[x, y], [x + 24.0, y]], 2.0, colour, dashed(knob));
        let label = knob.name.strip_prefix(name).unwrap_or(&knob.name).trim();
        drawing.text([x + 31.0, y + 4.0], TEXT, Align::Left, INK, label);
        let best = knob.best.and_then(|best| knob.points.iter().find(|point| point.setting == best));
        if let Some(best) = best {
            let told = format!("best {} at {}", shown(best.error), shown(best.setting));
            drawing.text([x + 31.0, y + 16.0], 9.0, Align::Left, GREY, &told);
        }
    }
    drawing
}

/// A row of models from the plainest on: a line each, its error to the right, its cost in words.
fn ladder(knob: &Knob) -> Drawing {
    const NAMES: f64 = 190.0;
    const COSTS: f64 = 96.0;
    let errors: Vec<f64> = knob.points.iter().map(|point| point.error).collect();
    let axis = Axis::decades(&errors);
    let (from, to) = (NAMES, SIZE[0] - COSTS);
    let floor = SIZE[1] - BOTTOM;
    let mut drawing = Drawing::new(SIZE[0], SIZE[1]);
    drawing.heading([20.0, 22.0], 16.0, &knob.name);
    drawing.text([20.0, 42.0], 11.0, Align::Left, GREY, &format!("to the right: error, {}", knob.error_unit));
    let x = |error: f64| from + axis.place(error) * (to - from);
    for &mark in &axis.marks {
        drawing.line(&[[x(mark), TOP], [x(mark), floor]], 1.0, FAINT, false);
        drawing.text([x(mark), floor + 16.0], TEXT, Align::Middle, INK, &shown(mark));
    }
    drawing.line(&[[from, TOP], [from, floor], [to, floor]], 1.2, INK, false);
    let step = (floor - TOP) / knob.points.len().max(1) as f64;
    for (row, point) in knob.points.iter().enumerate() {
        let y = TOP + step * (row as f64 + 0.5);
        drawing.text([from - 8.0, y + 4.0], TEXT, Align::Right, INK, point.label.as_deref().unwrap_or(""));
        if point.error > 0.0 {
            drawing.line(&[[from, y], [x(point.error), y]], 5.0, COLOURS[0], false);
            drawing.dot([x(point.error), y], 5.0, COLOURS[0]);
            let near_end = x(point.error) > to - 60.0;
            let (at, align) =
                if near_end { (x(point.error) - 4.0, Align::Right) } else { (x(point.error) + 9.0, Align::Left) };
            let lift = if near_end { -6.0 } else { 4.0 };
            drawing.text([at, y + lift], 11.0, align, COLOURS[0], &shown(point.error));
        } else {
            drawing.text([from + 9.0, y + 4.0], 11.0, Align::Left, GREY, "the reference");
        }
        if point.cost.is_finite() {
            drawing.text([SIZE[0] - 14.0, y + 4.0], TEXT, Align::Right, INK, &format!("{:.0}", point.cost));
        }
    }
    drawing.text([SIZE[0] - 14.0, TOP - 4.0], 10.0, Align::Right, GREY, "cost");
    drawing.text([0.5 * (from + to), SIZE[1] - 14.0], TEXT, Align::Middle, INK, &format!("cost in {}", knob.cost_unit));
    drawing
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
    fn any_knob_makes_a_plot_without_numbers_that_are_none() {
        let odd = [(1.0, f64::NAN, 2.0), (2.0, 0.0, f64::INFINITY), (3.0, 0.0, 0.0)];
        for points in [&[][..], &odd, &[(12.0, 5.0, 30.0)], &[(12.0, 5.0, 30.0), (24.0, 0.05, 60.0)]] {
            let mut labelled = knob(points);
            labelled.points.iter_mut().for_each(|point| point.label = Some("x".into()));
            for drawing in [one(&knob(points)), one(&labelled), group("a", &[&knob(points)])] {
                let text = drawing.svg();
                assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
                assert!(text.ends_with("</svg>\n"));
                assert_eq!(drawing.picture(0.5).size_px, [320, 180]);
            }
            assert!(one(&knob(points)).svg().contains("a &lt; b &amp; c"));
        }
        let text = sheet(&[knob(&[(12.0, 5.0, 30.0)]), knob(&[]), knob(&[])]).svg();
        assert!(text.contains("width=\"1280\" height=\"720\""));
    }

    #[test]
    fn a_group_has_one_plot_and_its_knobs_their_own() {
        let curve = |name: &str| Knob { name: name.into(), group: Some("i".into()), ..knob(&[(1.0, 2.0, 3.0)]) };
        let knobs = [curve("i a f64"), knob(&[]), curve("i a f32")];
        let names: Vec<String> = all(&knobs).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["i_a_f64", "a___b___c", "i_a_f32", "i"]);
        assert_eq!(sheet(&knobs).size, [1280.0, 360.0]);
        assert!(group("i", &[&knobs[0], &knobs[2]]).svg().contains("stroke-dasharray"));
    }
}
