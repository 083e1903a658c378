//! The depth of pixels against the ground: rays in f64 through a little square about each pixel's centre.
//!
//! Depth is near / distance along the axis, linear over a triangle's picture. A pixel's depth must lie between the least
//! and the greatest depth of the ground over the square of +-1/128 px about its centre, widened by two steps of f32: the
//! square is what a rasteriser may move a vertex by (1/256 px is the coarsest grid that Vulkan allows), the steps are
//! the roundings of the depth itself. The ground over the square is sampled at its corners and centre first; where the
//! pixel lies outside of those, at 17 x 17 points, because a fold within the square has its extreme on the fold.
//!
//! A pixel whose square holds a silhouette is left out: some rays meet nothing, or the depths spread further than the
//! planes that were met explain. Over void there is nothing to compare.

use crate::camera::View;
use glam::DVec3;
use terrain::{Area, SurfaceHit};

/// Half the square's side, pixels.
const REACH_PX: f64 = 1.0 / 128.0;

/// A meeting further below the ground's surface than this, metres, is one with its underside: more than f64 rounds a
/// point of a ray of 1,000 km on a wall of 50 to 1, and less than a square spans a metre away.
const UNDERSIDE_M: f64 = 1e-6;

/// Points along the square's side at the second look.
const FINE: i32 = 16;

/// What was found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Depths {
    /// Pixels compared, without those left out.
    pub pixels_checked: u64,
    /// Pixels outside their bounds.
    pub pixels_outside: u64,
    /// Pixels left out.
    pub pixels_excluded: u64,
    /// How far outside the worst pixel lies, in steps of f32 beyond the two allowed.
    pub worst_steps: f64,
    /// How far outside the worst pixel lies, metres along the axis.
    pub worst_m: f64,
}

impl Depths {
    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self {
            pixels_checked: self.pixels_checked + other.pixels_checked,
            pixels_outside: self.pixels_outside + other.pixels_outside,
            pixels_excluded: self.pixels_excluded + other.pixels_excluded,
            worst_steps: self.worst_steps.max(other.worst_steps),
            worst_m: self.worst_m.max(other.worst_m),
        }
    }
}

/// Compares the pixels (x, y from the top left) of a picture's depth whose ground lies within `radius_m` of the eye in
/// plan, until `wanted` have been compared.
pub fn compare(
    area: &Area,
    view: &View,
    depth: &[f32],
    radius_m: f64,
    wanted: u64,
    pixels: impl Iterator<Item = [u32; 2]>,
) -> Depths {
    let mut found = Depths::default();
    let caster = Caster { area, view, radius_m };
    for [x, y] in pixels {
        if found.pixels_checked >= wanted {
            break;
        }
        let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
        let Some(centre) = caster.hit(at) else { continue };
        let drawn = depth[(y * view.size_px[0] + x) as usize];
        look(&caster, at, centre, drawn, &mut found);
    }
    found
}

struct Caster<'a> {
    area: &'a Area,
    view: &'a View,
    radius_m: f64,
}

/// A ray's meeting with the ground.
#[derive(Clone, Copy)]
struct Met {
    /// Distance along the axis, metres.
    along_m: f64,
    /// How much depth the triangle's plane spreads over the square, as a share of the depth.
    spread: f64,
}

impl Caster<'_> {
    fn hit(&self, [x, y]: [f64; 2]) -> Option<Met> {
        let [width, height] = self.view.size_px.map(f64::from);
        let ray = self.view.ray(x / width, y / height);
        let plan = ray.x.hypot(ray.z);
        // Straight down the radius is never reached; nothing is 1,000 km below.
        let reach_m = (self.radius_m / plan.max(1e-9)).min(1e6);
        let SurfaceHit { fraction, point, normal } =
            self.area.segment(self.view.eye_m, self.view.eye_m + ray * reach_m)?;
        let along_m = fraction * reach_m;
        // A ray through a hole in the data meets the ground's underside at the hole's far rim, where nothing is drawn.
        let below = self.area.height_m(point.x, point.z).is_none_or(|height_m| height_m > point.y + UNDERSIDE_M);
        if along_m <= self.view.near_m || below {
            return None;
        }
        // Over a plane 1 / along is linear in the picture: its gradient against its value, over the square's diagonal.
        let per_px = (self.view.top - self.view.bottom) / height;
        let right = self.view.attitude * DVec3::X;
        let up = self.view.attitude * DVec3::Y;
        let facing = normal.dot(ray).abs().max(1e-12);
        let slope = normal.dot(right).abs() + normal.dot(up).abs();
        Some(Met { along_m, spread: 2.0 * REACH_PX * per_px * slope / facing })
    }

    /// Everything met on a grid of `side + 1` squared rays over the square; `None` if a ray meets nothing.
    fn square(&self, [x, y]: [f64; 2], side: i32) -> Option<Vec<Met>> {
        let place = |step: i32| REACH_PX * (f64::from(2 * step) / f64::from(side) - 1.0);
        (0..(side + 1) * (side + 1))
            .map(|at| self.hit([x + place(at % (side + 1)), y + place(at / (side + 1))]))
            .collect()
    }
}

/// Least and greatest depth, and whether they are further apart than the planes explain.
fn bounds(met: &[Met], near_m: f64) -> (f64, f64, bool) {
    let depths = || met.iter().map(|met| near_m / met.along_m);
    let (least, greatest) = (depths().fold(f64::INFINITY, f64::min), depths().fold(0.0, f64::max));
    let spread = met.iter().map(|met| met.spread).fold(0.0, f64::max);
    // The steepest plane over the whole square, and roundings of f64.
    (least, greatest, greatest - least > greatest * (spread * 1.01 + 1e-12))
}

fn look(caster: &Caster<'_>, at: [f64; 2], centre: Met, drawn: f32, found: &mut Depths) {
    let near_m = caster.view.near_m;
    let Some(mut met) = caster.square(at, 1) else {
        found.pixels_excluded += 1;
        return;
    };
    met.push(centre);
    let (mut least, mut greatest, mut silhouette) = bounds(&met, near_m);
    let outside = |least: f64, greatest: f64| {
        let step = f64::from(drawn.max(f32::MIN_POSITIVE)) * f64::from(f32::EPSILON);
        // A step of f32 is between half and one epsilon of the number; taken from the bound's own neighbours.
        let low = f64::from((least as f32).next_down().next_down());
        let high = f64::from((greatest as f32).next_up().next_up());
        let off = (low - f64::from(drawn)).max(f64::from(drawn) - high);
        (off > 0.0).then_some(off / step)
    };
    if !silhouette && outside(least, greatest).is_some() {
        let Some(fine) = caster.square(at, FINE) else {
            found.pixels_excluded += 1;
            return;
        };
        met.extend(fine);
        (least, greatest, silhouette) = bounds(&met, near_m);
    }
    if silhouette {
        found.pixels_excluded += 1;
        return;
    }
    found.pixels_checked += 1;
    if let Some(steps) = outside(least, greatest) {
        found.pixels_outside += 1;
        found.worst_steps = found.worst_steps.max(steps);
        let off_m = (near_m / f64::from(drawn) - centre.along_m).abs();
        found.worst_m = found.worst_m.max(off_m);
    }
}
