//! Where a step's path first strikes: the ground, a thing that stands on it, or a target before it.
//!
//! Frame: the world's (X east, Y up, Z south), metres, seconds. The ground is the level-0 triangles of an
//! [`terrain::Area`]; over void and beyond the world there is none.
//!
//! Invariant others rely on: a path that starts above the ground and ends on or under it has an impact, whatever its
//! speed, its bend or the ground's edges; each chord of it goes through [`terrain::Area::segment`], which is watertight,
//! and chords share their ends. The point is the segment's own, so it is on its triangle; the path passes it within
//! a nanometre. A path with a number that is not finite strikes nothing.

use super::chords::{self, Piece};
use super::path::StepPath;
use super::targets::{Target, TargetImpact, target_impact};
use crate::snapshot::StableId;
use glam::DVec3;
use terrain::Area;
use terrain::features::index::{ObjectId, ObjectIndex};

/// Where a path meets the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Fraction of the step, 0..=1.
    pub fraction: f64,
    /// Time since the step's start, seconds.
    pub time_s: f64,
    /// The point; on the ground, except where the path starts under it.
    pub point_m: DVec3,
    /// Upward unit normal of the triangle; outward of a thing.
    pub normal: DVec3,
    /// Velocity there.
    pub velocity_mps: DVec3,
    /// Angle between velocity and triangle, 0 (grazing, or at rest) to a right angle.
    pub grazing_rad: f64,
    /// The thing that stands on the ground and was met; `None` is the ground.
    pub object: Option<ObjectId>,
}

/// What a path strikes first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FirstImpact {
    /// The ground.
    Ground(Impact),
    /// A target.
    Target(TargetImpact),
}

/// A piece of a step, and which fractions of the step it spans.
struct Span {
    path: StepPath,
    from: f64,
    to: f64,
}

impl Piece for Span {
    fn chord_error_m(&self) -> f64 {
        self.path.bulge_m()
    }

    fn halves(&self) -> [Self; 2] {
        let [first, second] = self.path.split(0.5);
        let middle = 0.5 * (self.from + self.to);
        [Self { path: first, from: self.from, to: middle }, Self { path: second, from: middle, to: self.to }]
    }
}

/// The first point of the path on or under the ground; `None` if it stays above it, or where there is none.
///
/// A path that starts on or under the ground meets it at fraction 0. One that dips under it by less than 0.1 mm and
/// comes out again within the step may be taken as clear.
pub fn ground_impact(path: &StepPath, area: &Area) -> Option<Impact> {
    if !path.is_sound() {
        return None;
    }
    let whole = Span { path: *path, from: 0.0, to: 1.0 };
    let (span, hit) = chords::first_touch(whole, &|span| area.segment(span.path.from_m, span.path.to_m))?;
    let fraction = span.from + (span.to - span.from) * span.path.fraction_abreast(hit.point);
    let velocity_mps = path.velocity_mps(fraction);
    Some(Impact {
        fraction,
        time_s: fraction * path.step_s,
        point_m: hit.point,
        normal: hit.normal,
        velocity_mps,
        grazing_rad: velocity_mps.dot(hit.normal).abs().atan2(velocity_mps.cross(hit.normal).length()),
        object: None,
    })
}

/// The first point of the path on a thing that stands on the ground; swept as the ground is.
pub fn object_impact(path: &StepPath, objects: &ObjectIndex) -> Option<Impact> {
    if !path.is_sound() || objects.is_empty() {
        return None;
    }
    let whole = Span { path: *path, from: 0.0, to: 1.0 };
    let (span, hit) = chords::first_touch(whole, &|span| objects.segment(span.path.from_m, span.path.to_m))?;
    let fraction = span.from + (span.to - span.from) * span.path.fraction_abreast(hit.point);
    let velocity_mps = path.velocity_mps(fraction);
    Some(Impact {
        fraction,
        time_s: fraction * path.step_s,
        point_m: hit.point,
        normal: hit.normal,
        velocity_mps,
        grazing_rad: velocity_mps.dot(hit.normal).abs().atan2(velocity_mps.cross(hit.normal).length()),
        object: Some(hit.which),
    })
}

/// The earlier of ground and things; at the same instant the thing.
pub fn standing_impact(path: &StepPath, area: &Area, objects: Option<&ObjectIndex>) -> Option<Impact> {
    let ground = ground_impact(path, area);
    let thing = objects.and_then(|objects| object_impact(path, objects));
    match (ground, thing) {
        (Some(ground), Some(thing)) if ground.fraction < thing.fraction => Some(ground),
        (ground, thing) => thing.or(ground),
    }
}

/// The earlier of ground and targets; at the same instant the target. `own` is left out.
pub fn first_impact(path: &StepPath, area: &Area, targets: &[Target], own: Option<StableId>) -> Option<FirstImpact> {
    let ground = ground_impact(path, area);
    match (ground, target_impact(path, targets, own)) {
        (Some(ground), Some(target)) if ground.fraction < target.fraction => Some(FirstImpact::Ground(ground)),
        (_, Some(target)) => Some(FirstImpact::Target(target)),
        (ground, None) => ground.map(FirstImpact::Ground),
    }
}

#[cfg(test)]
mod tests;
