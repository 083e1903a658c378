//! Which moving and turning target a step's path strikes first.
//!
//! Frame: the world's (X east, Y up, Z south), metres, seconds; a shape has its own (see [`super::shape`]). During a
//! step a target moves straight and turns evenly about one axis, by the shortest turn from its first attitude to its
//! last: less than half a turn a step.
//!
//! The path is swept in the target's frame. Seen from the target's first attitude it is a cubic `w(s)` again, and in the
//! target `r(s) = turned back by s theta (w(s))`. A piece of it is off its chord by at most an eighth of
//! `|r''| <= |w''| + 2 theta |w'| + theta^2 |w|`, all over the piece; each is at its largest at an end or within the hull
//! of Bezier's points. Turning keeps lengths, so `w` alone tells which pieces come near the target at all.
//!
//! Invariant others rely on: the answer depends neither on the order of the targets nor on a velocity that all share.

use super::chords::{self, Piece};
use super::path::StepPath;
use super::shape::{Entry, Shape};
use crate::snapshot::StableId;
use glam::{DQuat, DVec3};

/// Where a target is, and how it is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Place of the shape's reference point in the world.
    pub position_m: DVec3,
    /// From the shape's frame to the world's.
    pub attitude: DQuat,
}

/// A target during one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Its name.
    pub id: StableId,
    /// Its shape.
    pub shape: Shape,
    /// Where it is at the step's start.
    pub from: Pose,
    /// Where it is at the step's end.
    pub to: Pose,
}

/// Where a path strikes a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetImpact {
    /// The target's name.
    pub id: StableId,
    /// Fraction of the step, 0..=1; 0 if the path starts inside.
    pub fraction: f64,
    /// Time since the step's start, seconds.
    pub time_s: f64,
    /// The point in the world.
    pub point_m: DVec3,
    /// The point in the shape's frame.
    pub point_in_target_m: DVec3,
    /// Outward unit normal in the world; against the motion where the path starts inside (zero at relative rest).
    pub normal: DVec3,
    /// Velocity in world axes relative to the target's own material at the point: its turn counts.
    pub velocity_mps: DVec3,
}

impl Pose {
    /// Upright at a place.
    pub fn at(position_m: DVec3) -> Self {
        Self { position_m, attitude: DQuat::IDENTITY }
    }
}

/// A piece of the path seen from a target.
struct Span<'a> {
    /// Relative to the target's reference point, in the frame of its first attitude.
    path: StepPath,
    /// Turn of the target over the whole step, about an axis in its own frame, radians.
    turn: DVec3,
    shape: &'a Shape,
    from: f64,
    to: f64,
}

impl Span<'_> {
    /// A vector of the first attitude's frame in the frame that the target has at a fraction.
    fn turned_back(&self, v: DVec3, fraction: f64) -> DVec3 {
        if self.turn == DVec3::ZERO { v } else { DQuat::from_scaled_axis(self.turn * -fraction) * v }
    }

    /// Start and end of the chord, in the target.
    fn chord_m(&self) -> (DVec3, DVec3) {
        (self.turned_back(self.path.from_m, self.from), self.turned_back(self.path.to_m, self.to))
    }

    fn enter(&self) -> Option<Entry> {
        let (from_m, to_m) = self.chord_m();
        self.shape.enter(from_m, to_m)
    }
}

impl Piece for Span<'_> {
    fn chord_error_m(&self) -> f64 {
        let path_m = self.path.deviation_m();
        if self.turn == DVec3::ZERO {
            return path_m;
        }
        let turn = self.turn.length() * (self.to - self.from);
        let hull = self.path.hull_points_m();
        let reach_m = hull.iter().map(|p| p.length()).fold(0.0, f64::max);
        let rate_m = hull.windows(2).map(|p| 3.0 * p[0].distance(p[1])).fold(0.0, f64::max);
        path_m + turn * (2.0 * rate_m + turn * reach_m) / 8.0
    }

    fn halves(&self) -> [Self; 2] {
        let [first, second] = self.path.split(0.5);
        let middle = 0.5 * (self.from + self.to);
        [Self { path: first, to: middle, ..*self }, Self { path: second, from: middle, ..*self }]
    }

    fn may_touch(&self) -> bool {
        near(self.path.from_m, self.path.to_m, self.path.bulge_m(), self.shape.radius_m())
    }
}

/// Whether a path with this chord, and never farther from it than `off_m`, may come within a radius of the origin.
/// A millionth more hides the roundings.
#[inline]
fn near(from_m: DVec3, to_m: DVec3, off_m: f64, radius_m: f64) -> bool {
    let along = to_m - from_m;
    let squared = along.length_squared();
    let nearest = if squared > 0.0 { (-from_m.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    let reach_m = (radius_m + off_m) * (1.0 + 1e-6);
    (from_m + along * nearest).length_squared() <= reach_m * reach_m
}

/// The first target that the path strikes; of several at the same instant the one with the lowest id. `own` is left out.
///
/// A path that starts inside a target strikes it at fraction 0. A path or a target with a number that is not finite, or
/// an attitude of length 0, is none. A graze shallower than 0.1 mm may be missed.
pub fn target_impact(path: &StepPath, targets: &[Target], own: Option<StableId>) -> Option<TargetImpact> {
    if !path.is_sound() {
        return None;
    }
    // A target's own motion is straight, so the relative path is off its chord by the same, whatever the target.
    let off_m = path.deviation_m();
    let others = targets.iter().filter(|target| Some(target.id) != own);
    let close = others.filter(|target| {
        let (from_m, to_m) = (path.from_m - target.from.position_m, path.to_m - target.to.position_m);
        near(from_m, to_m, off_m, target.shape.radius_m())
    });
    let strikes = close.filter_map(|target| strike(path, target));
    strikes.reduce(|first, other| {
        let earlier = (other.fraction, other.id) < (first.fraction, first.id);
        if earlier { other } else { first }
    })
}

/// Where the path strikes this target.
fn strike(path: &StepPath, target: &Target) -> Option<TargetImpact> {
    let (from, to) = (&target.from, &target.to);
    let velocity = (to.position_m - from.position_m) / path.step_s;
    let relative = StepPath {
        from_m: path.from_m - from.position_m,
        from_mps: path.from_mps - velocity,
        to_m: path.to_m - to.position_m,
        to_mps: path.to_mps - velocity,
        step_s: path.step_s,
    };
    let first = from.attitude.normalize();
    let back = first.conjugate();
    let last = back * to.attitude.normalize();
    if !first.is_normalized() || !last.is_normalized() {
        return None;
    }
    let turn = if last.w < 0.0 { -last } else { last }.to_scaled_axis();
    let seen = StepPath {
        from_m: back * relative.from_m,
        from_mps: back * relative.from_mps,
        to_m: back * relative.to_m,
        to_mps: back * relative.to_mps,
        step_s: path.step_s,
    };
    if !seen.is_sound() {
        return None;
    }
    let whole = Span { path: seen, turn, shape: &target.shape, from: 0.0, to: 1.0 };
    let (span, entry) = chords::first_touch(whole, &Span::enter)?;

    let (chord_from_m, chord_to_m) = span.chord_m();
    let point_in_target_m = chord_from_m.lerp(chord_to_m, entry.fraction);
    let fraction = span.from + (span.to - span.from) * entry.fraction;
    let attitude = first * DQuat::from_scaled_axis(turn * fraction);
    // r' = turned back (w') - omega x r: the target's own turn carries its material to the path.
    let velocity_in_target =
        span.turned_back(seen.velocity_mps(fraction), fraction) - (turn / path.step_s).cross(point_in_target_m);
    let velocity_mps = attitude * velocity_in_target;
    Some(TargetImpact {
        id: target.id,
        fraction,
        time_s: fraction * path.step_s,
        point_m: from.position_m.lerp(to.position_m, fraction) + attitude * point_in_target_m,
        point_in_target_m,
        normal: entry.normal.map_or_else(|| -velocity_mps.normalize_or_zero(), |normal| attitude * normal),
        velocity_mps,
    })
}

#[cfg(test)]
mod tests;
