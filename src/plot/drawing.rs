//! A plot as plain lines, dots and texts, and its two forms: SVG, and a picture for a PNG file.
//!
//! Places are in plot units, x right, y down; SVG shows a unit as a pixel, a picture as so many as it is asked for. Letters
//! of a picture are the strokes of the display's own font, so no font file is needed; they are capitals.
//!
//! Invariant others rely on: what is not finite is left out of both forms.

use glam::Vec2;
use std::fmt::Write as _;
use visual::capture::Picture;
use visual::passes::lines::{self, Align, Stroke};

/// Ink of frames and texts.
pub const INK: u32 = 0x22_22_22;
/// Lines that only help the eye.
pub const FAINT: u32 = 0xe2_e2_e2;
/// Remarks.
pub const GREY: u32 = 0x55_55_55;

/// Height of a stroke letter over the size of an SVG font: both then take about as much room.
const CAP: f64 = 0.62;
/// Length of a dash and of the gap after it.
const DASH: f64 = 5.0;

/// Something drawn.
#[derive(Debug, Clone, PartialEq)]
enum Item {
    Line { points: Vec<[f64; 2]>, width: f64, colour: u32, dashed: bool },
    Dot { at: [f64; 2], radius: f64, colour: u32 },
    Text { at: [f64; 2], size: f64, align: Align, colour: u32, bold: bool, text: String },
}

/// A sheet with what is on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width and height.
    pub size: [f64; 2],
    items: Vec<Item>,
}

impl Drawing {
    /// An empty sheet.
    pub fn new(width: f64, height: f64) -> Self {
        Self { size: [width, height], items: Vec::new() }
    }

    /// A line through points; those that are not finite are left out.
    pub fn line(&mut self, points: &[[f64; 2]], width: f64, colour: u32, dashed: bool) {
        let points = points.iter().copied().filter(|p| p.iter().all(|c| c.is_finite())).collect();
        self.items.push(Item::Line { points, width, colour, dashed });
    }

    /// A full circle.
    pub fn dot(&mut self, at: [f64; 2], radius: f64, colour: u32) {
        if at.iter().all(|c| c.is_finite()) {
            self.items.push(Item::Dot { at, radius, colour });
        }
    }

    /// A text on one line; `at` is on its base line.
    pub fn text(&mut self, at: [f64; 2], size: f64, align: Align, colour: u32, text: &str) {
        if at.iter().all(|c| c.is_finite()) {
            self.items.push(Item::Text { at, size, align, colour, bold: false, text: text.into() });
        }
    }

    /// A heading.
    pub fn heading(&mut self, at: [f64; 2], size: f64, text: &str) {
        self.items.push(Item::Text { at, size, align: Align::Left, colour: INK, bold: true, text: text.into() });
    }

    /// Puts another drawing on this one.
    pub fn place(&mut self, other: &Self, [x, y]: [f64; 2]) {
        let moved = |at: [f64; 2]| [at[0] + x, at[1] + y];
        self.items.extend(other.items.iter().cloned().map(|item| match item {
            Item::Line { points, width, colour, dashed } => {
                Item::Line { points: points.into_iter().map(moved).collect(), width, colour, dashed }
            }
            Item::Dot { at, radius, colour } => Item::Dot { at: moved(at), radius, colour },
            Item::Text { at, size, align, colour, bold, text } => {
                Item::Text { at: moved(at), size, align, colour, bold, text }
            }
        }));
    }

    /// As SVG.
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        for item in &self.items {
            // Writing to a String cannot fail.
            let _ = match item {
                Item::Line { points, width, colour, dashed } => {
                    let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
                    let dashes = if *dashed { format!(" stroke-dasharray=\"{DASH}\"") } else { String::new() };
                    writeln!(
                        text,
                        "<polyline points=\"{}\" fill=\"none\" stroke=\"#{colour:06x}\" stroke-width=\"{width}\"{dashes}/>",
                        points.join(" ")
                    )
                }
                Item::Dot { at: [x, y], radius, colour } => {
                    writeln!(text, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"#{colour:06x}\"/>")
                }
                Item::Text { at: [x, y], size, align, colour, bold, text: words } => {
                    let anchor = match align {
                        Align::Left => "start",
                        Align::Middle => "middle",
                        Align::Right => "end",
                    };
                    let weight = if *bold { " font-weight=\"bold\"" } else { "" };
                    writeln!(
                        text,
                        "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
                         fill=\"#{colour:06x}\"{weight}>{}</text>",
                        escaped(words)
                    )
                }
            };
        }
        text + "</svg>\n"
    }

    /// As a picture with so many pixels to a unit. A text that would leave the sheet is set smaller.
    pub fn picture(&self, scale: f64) -> Picture {
        let mut sheet = Sheet::new(self.size.map(|side| (side * scale).round() as u32));
        let to_px = |at: [f64; 2]| Vec2::new((at[0] * scale) as f32, (at[1] * scale) as f32);
        for item in &self.items {
            match item {
                Item::Line { points, width, colour, dashed } => {
                    let points_px: Vec<Vec2> = points.iter().copied().map(to_px).collect();
                    let width_px = (width * scale) as f32;
                    if *dashed {
                        for dash in dashes(&points_px, (DASH * scale) as f32) {
                            sheet.stroke(&dash, width_px, *colour);
                        }
                    } else {
                        sheet.stroke(&points_px, width_px, *colour);
                    }
                }
                // A line of no length with round ends.
                Item::Dot { at, radius, colour } => {
                    sheet.stroke(&[to_px(*at); 2], (2.0 * radius * scale) as f32, *colour);
                }
                Item::Text { at, size, align, colour, bold, text } => {
                    let room = match align {
                        Align::Left => self.size[0] - at[0],
                        Align::Right => at[0],
                        Align::Middle => 2.0 * at[0].min(self.size[0] - at[0]),
                    };
                    let cap_px = (size * CAP * scale) as f32;
                    let fits = (room * scale) as f32 * 0.98 / lines::text_width_px(text, cap_px).max(1.0);
                    let cap_px = cap_px * fits.min(1.0);
                    for Stroke { points_px, .. } in lines::text(text, to_px(*at), cap_px, *align, [0.0; 4]) {
                        sheet.stroke(&points_px, cap_px * if *bold { 0.17 } else { 0.12 }, *colour);
                    }
                }
            }
        }
        sheet.into_picture()
    }
}

/// A polyline's dashes, each as long as the gap after it.
fn dashes(points: &[Vec2], length: f32) -> Vec<Vec<Vec2>> {
    let mut all = Vec::new();
    let mut open: Vec<Vec2> = points.first().copied().into_iter().collect();
    let (mut left, mut drawn) = (length, true);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        while from.distance(to) > left {
            from += (to - from).normalize_or_zero() * left;
            if drawn {
                open.push(from);
                all.push(std::mem::take(&mut open));
            } else {
                open = vec![from];
            }
            (drawn, left) = (!drawn, length);
        }
        left -= from.distance(to);
        if drawn {
            open.push(to);
        }
    }
    if drawn && open.len() > 1 {
        all.push(open);
    }
    all
}

/// White paper, as sRGB bytes of coverage.
struct Sheet {
    size_px: [u32; 2],
    rgb: Vec<[f32; 3]>,
}

impl Sheet {
    fn new(size_px: [u32; 2]) -> Self {
        Self { size_px, rgb: vec![[255.0; 3]; (size_px[0] * size_px[1]) as usize] }
    }

    /// A line with round ends and joints: each pixel is covered by its distance from the nearest piece, once.
    fn stroke(&mut self, points: &[Vec2], width_px: f32, colour: u32) {
        let half = 0.5 * width_px.max(1.0);
        let reach = half + 1.0;
        let (low, high) = points.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
        if points.is_empty() {
            return;
        }
        let [wide, tall] = self.size_px.map(|side| side as f32);
        let (low, high) = ((low - reach).max(Vec2::ZERO), (high + reach).min(Vec2::new(wide - 1.0, tall - 1.0)));
        let (left, across) = (low.x as usize, (high.x - low.x).max(0.0) as usize + 2);
        let (top, down) = (low.y as usize, (high.y - low.y).max(0.0) as usize + 2);
        let mut covered = vec![0f32; across * down];
        for pair in points.windows(2) {
            let box_low = (pair[0].min(pair[1]) - reach).max(low);
            let box_high = (pair[0].max(pair[1]) + reach).min(high);
            for row in box_low.y as usize..=box_high.y.max(0.0) as usize {
                for column in box_low.x as usize..=box_high.x.max(0.0) as usize {
                    let (i, j) = (column.wrapping_sub(left), row.wrapping_sub(top));
                    if i < across && j < down {
                        let at = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
                        let cover = (half + 0.5 - distance(at, pair[0], pair[1])).clamp(0.0, 1.0);
                        let here = &mut covered[j * across + i];
                        *here = here.max(cover);
                    }
                }
            }
        }
        let ink = [16, 8, 0].map(|shift| (colour >> shift & 0xff) as f32);
        for (at, cover) in covered.iter().enumerate().filter(|(_, cover)| **cover > 0.0) {
            let (column, row) = (left + at % across, top + at / across);
            if column < self.size_px[0] as usize && row < self.size_px[1] as usize {
                let pixel = &mut self.rgb[row * self.size_px[0] as usize + column];
                *pixel = std::array::from_fn(|i| pixel[i] + (ink[i] - pixel[i]) * cover);
            }
        }
    }

    fn into_picture(self) -> Picture {
        let bytes = |[r, g, b]: [f32; 3]| [r.round() as u8, g.round() as u8, b.round() as u8, 255];
        Picture { size_px: self.size_px, rgba: self.rgb.into_iter().flat_map(bytes).collect() }
    }
}

/// Distance of a point from a segment.
fn distance(at: Vec2, from: Vec2, to: Vec2) -> f32 {
    let along = to - from;
    let squared = along.length_squared();
    let share = if squared > 0.0 { ((at - from).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    at.distance(from + along * share)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_show_the_same_line() {
        let mut drawing = Drawing::new(40.0, 20.0);
        drawing.line(&[[5.0, 10.0], [f64::NAN, 3.0], [35.0, 10.0]], 2.0, 0xff_00_00, false);
        drawing.dot([f64::INFINITY, 1.0], 3.0, INK);
        assert!(drawing.svg().contains("5.0,10.0 35.0,10.0") && !drawing.svg().contains("circle"));
        let picture = drawing.picture(2.0);
        assert_eq!(picture.size_px, [80, 40]);
        let pixel = |x: usize, y: usize| &picture.rgba[4 * (y * 80 + x)..][..3];
        assert_eq!((pixel(40, 20), pixel(40, 10), pixel(2, 20)), (&[255, 0, 0][..], &[255; 3][..], &[255; 3][..]));
    }

    #[test]
    fn dashes_are_as_long_as_their_gaps() {
        let found = dashes(&[Vec2::ZERO, Vec2::new(7.0, 0.0), Vec2::new(12.5, 0.0)], 3.0);
        let ends: Vec<_> = found.iter().map(|dash| (dash[0].x, dash[dash.len() - 1].x)).collect();
        assert_eq!(ends, [(0.0, 3.0), (6.0, 9.0), (12.0, 12.5)]);
    }

    #[test]
    fn what_lies_outside_the_sheet_is_cut_off() {
        let mut drawing = Drawing::new(10.0, 10.0);
        drawing.line(&[[-50.0, -70.0], [300.0, 900.0]], 4.0, INK, true);
        drawing.dot([-20.0, 5.0], 3.0, INK);
        drawing.text([9.0, 9.0], 12.0, Align::Left, INK, "a text far too long for its sheet");
        assert_eq!(drawing.picture(1.0).rgba.len(), 400);
    }
}
