//! The sheet that the display is drawn on: design pixels about the middle, clipped to the viewport as they come.
//!
//! Invariant others rely on: what leaves here lies within the viewport; NaN is inside nothing.

use super::{Anchor, HudLine, HudText, text_width};

pub(super) const GREEN: [f32; 4] = [0.10, 1.0, 0.25, 0.95];
pub(super) const DIM: [f32; 4] = [0.10, 1.0, 0.25, 0.75];
pub(super) const AMBER: [f32; 4] = [1.0, 0.55, 0.05, 1.0];
/// Letter heights at 720 rows, pixels.
pub(super) const LARGE: f64 = 18.0;
pub(super) const MEDIUM: f64 = 14.0;
pub(super) const SMALL: f64 = 11.0;
/// A text lower than this cannot be read and is left out, pixels.
const LEAST_TEXT_PX: f64 = 5.0;

/// See the module.
pub(super) struct Sheet {
    pub lines: Vec<HudLine>,
    pub texts: Vec<HudText>,
    pub scale: f64,
    pub size: (f64, f64),
    /// What colours are multiplied with: the display is dimmed at night.
    brightness: f32,
}

impl Sheet {
    pub fn new(viewport_px: (u32, u32), brightness: f64) -> Self {
        let size = (f64::from(viewport_px.0), f64::from(viewport_px.1));
        let brightness = if brightness.is_finite() { brightness.clamp(0.05, 1.0) as f32 } else { 1.0 };
        Self { lines: Vec::new(), texts: Vec::new(), scale: (size.0 / 1280.0).min(size.1 / 720.0), size, brightness }
    }

    fn shade(&self, colour: [f32; 4]) -> [f32; 4] {
        let [red, green, blue, alpha] = colour;
        [red * self.brightness, green * self.brightness, blue * self.brightness, alpha]
    }

    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        [0.5 * self.size.0 + at[0] * self.scale, 0.5 * self.size.1 + at[1] * self.scale]
    }

    /// A polyline; what leaves the viewport is left out piece by piece.
    pub fn line(&mut self, points: &[[f64; 2]], width: f64, colour: [f32; 4]) {
        let points: Vec<[f64; 2]> = points.iter().map(|&p| self.place(p)).collect();
        let inside = |p: &[f64; 2]| (0.0..=self.size.0).contains(&p[0]) && (0.0..=self.size.1).contains(&p[1]);
        // NaN is inside nothing.
        if self.size.0 < 1.0 || self.size.1 < 1.0 || points.len() < 2 || !points.iter().all(inside) {
            return;
        }
        let points_px = points.iter().map(|p| [p[0] as f32, p[1] as f32]).collect();
        self.lines.push(HudLine {
            points_px,
            width_px: (width * self.scale).max(1.0) as f32,
            colour: self.shade(colour),
        });
    }

    pub fn text(&mut self, at: [f64; 2], height: f64, text: &str, anchor: Anchor, colour: [f32; 4]) {
        let height_px = height * self.scale;
        let text: String = text.chars().map(|c| if c == ' ' || c.is_ascii_graphic() { c } else { '?' }).collect();
        let at = self.place(at);
        let width_px = f64::from(text_width(&text)) * height_px;
        let left = match anchor {
            Anchor::Left => at[0],
            Anchor::Centre => at[0] - 0.5 * width_px,
            Anchor::Right => at[0] - width_px,
        };
        let (top, bottom) = (at[1] - 0.5 * height_px, at[1] + 0.5 * height_px);
        let fits = left >= 0.0 && left + width_px <= self.size.0 && top >= 0.0 && bottom <= self.size.1;
        if fits && height_px >= LEAST_TEXT_PX && !text.is_empty() {
            self.texts.push(HudText {
                at_px: [at[0] as f32, at[1] as f32],
                height_px: height_px as f32,
                text,
                anchor,
                colour: self.shade(colour),
            });
        }
    }

    pub fn frame(&mut self, left: f64, right: f64, middle: f64, half_height: f64) {
        let (top, bottom) = (middle - half_height, middle + half_height);
        let corners = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        self.line(&corners, 1.8, GREEN);
    }
}
