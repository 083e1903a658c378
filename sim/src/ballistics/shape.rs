//! Shapes of targets, and where a segment enters one.
//!
//! Frame: the shape's own, metres; its reference point is the origin and the axis of capsules and cylinders is Y, as in
//! the physics engine. Shapes are solid and closed: a point on the surface is in the shape.
//!
//! Casts are closed forms of ours, not the engine's: its casts of cylinders and hulls iterate until a tolerance, and a
//! chain of segments would leak at their ends. The engine makes the hulls. Here every convex body is an intersection of
//! stretches of the line (between planes, in a ball, in a tube), so a segment that ends inside always enters.

use glam::DVec3;
use rapier3d::parry::math::Vector;
use rapier3d::parry::shape::SharedShape;
use rapier3d::parry::transformation::try_convex_hull;
use std::fmt;
use std::sync::Arc;

/// Largest extent of a shape from its reference point, metres; squares of it keep a millimetre's digits.
pub const MAX_EXTENT_M: f64 = 100_000.0;

/// A solid, convex, checked shape; cheap to clone.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    form: Form,
    radius_m: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Form {
    Sphere { radius_m: f64 },
    Block { half_m: DVec3 },
    Capsule { half_height_m: f64, radius_m: f64 },
    Cylinder { half_height_m: f64, radius_m: f64 },
    Hull { planes: Arc<[Plane]>, corners: Arc<[DVec3]> },
}

/// The half-space `normal . point <= offset_m`, its normal of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Plane {
    normal: DVec3,
    offset_m: f64,
}

/// Where a segment enters a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Fraction of the segment, 0..=1; 0 if it starts inside.
    pub fraction: f64,
    /// Outward unit normal there; `None` if the segment starts inside, where there is no surface.
    pub normal: Option<DVec3>,
}

/// Why a shape cannot be made.
#[derive(Debug, Clone, PartialEq)]
pub enum ShapeError {
    /// A size is not above 0 and up to [`MAX_EXTENT_M`].
    Size {
        /// Which.
        name: &'static str,
        /// What was found.
        found: f64,
    },
    /// A hull's point has a coordinate that is not finite or beyond [`MAX_EXTENT_M`].
    Point {
        /// Its place in the list.
        index: usize,
        /// What was found.
        found: DVec3,
    },
    /// A hull's points do not enclose a volume.
    Flat {
        /// How many points were given.
        points: usize,
    },
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size { name, found } => {
                write!(f, "{name} must be above 0 and at most {MAX_EXTENT_M} m, found {found}")
            }
            Self::Point { index, found } => {
                write!(f, "point {index} of a hull must be finite and within +-{MAX_EXTENT_M} m, found {found}")
            }
            Self::Flat { points } => write!(f, "a hull's points must enclose a volume, the {points} found do not"),
        }
    }
}

impl std::error::Error for ShapeError {}

/// The size itself if it is one.
fn size(name: &'static str, found: f64) -> Result<f64, ShapeError> {
    if found > 0.0 && found <= MAX_EXTENT_M { Ok(found) } else { Err(ShapeError::Size { name, found }) }
}

impl Shape {
    /// A ball about the reference point.
    ///
    /// # Errors
    /// [`ShapeError::Size`] if the radius is not above 0.
    pub fn sphere(radius_m: f64) -> Result<Self, ShapeError> {
        let radius_m = size("radius_m", radius_m)?;
        Ok(Self { form: Form::Sphere { radius_m }, radius_m })
    }

    /// A box about the reference point, by the halves of its sides.
    ///
    /// # Errors
    /// [`ShapeError::Size`] names the half that is not above 0.
    pub fn block(half_m: DVec3) -> Result<Self, ShapeError> {
        let half_m = DVec3::new(size("half_m.x", half_m.x)?, size("half_m.y", half_m.y)?, size("half_m.z", half_m.z)?);
        Ok(Self { form: Form::Block { half_m }, radius_m: half_m.length() })
    }

    /// All points within `radius_m` of the axis from -`half_height_m` to +`half_height_m`.
    ///
    /// # Errors
    /// [`ShapeError::Size`] names the size that is not above 0.
    pub fn capsule(half_height_m: f64, radius_m: f64) -> Result<Self, ShapeError> {
        let half_height_m = size("half_height_m", half_height_m)?;
        let radius_m = size("radius_m", radius_m)?;
        Ok(Self { form: Form::Capsule { half_height_m, radius_m }, radius_m: half_height_m + radius_m })
    }

    /// An upright cylinder with flat ends.
    ///
    /// # Errors
    /// [`ShapeError::Size`] names the size that is not above 0.
    pub fn cylinder(half_height_m: f64, radius_m: f64) -> Result<Self, ShapeError> {
        let half_height_m = size("half_height_m", half_height_m)?;
        let radius_m = size("radius_m", radius_m)?;
        Ok(Self { form: Form::Cylinder { half_height_m, radius_m }, radius_m: half_height_m.hypot(radius_m) })
    }

    /// The convex hull of points.
    ///
    /// Each face is moved out, by a rounding, to where it has all points behind it.
    ///
    /// # Errors
    /// [`ShapeError::Point`] names a point out of range; [`ShapeError::Flat`] if there is no volume between them.
    pub fn hull(points_m: &[DVec3]) -> Result<Self, ShapeError> {
        let out_of_range = |p: &DVec3| !(p.abs().max_element() <= MAX_EXTENT_M && p.is_finite());
        if let Some(index) = points_m.iter().position(out_of_range) {
            return Err(ShapeError::Point { index, found: points_m[index] });
        }
        let flat = || ShapeError::Flat { points: points_m.len() };
        let theirs: Vec<Vector> = points_m.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
        let (corners, triangles) = try_convex_hull(&theirs).map_err(|_| flat())?;
        let corners: Vec<DVec3> = corners.iter().map(|p| DVec3::new(p.x, p.y, p.z)).collect();
        let mut planes: Vec<Plane> = Vec::new();
        for [a, b, c] in triangles.iter().map(|t| t.map(|corner| corners[corner as usize])) {
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let offset_m = points_m.iter().map(|p| normal.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
            // The triangles of one flat face differ by roundings.
            let known = planes.iter_mut().find(|p| p.normal.distance_squared(normal) < 1e-24);
            match known {
                Some(plane) => plane.offset_m = plane.offset_m.max(offset_m),
                None => planes.push(Plane { normal, offset_m }),
            }
        }
        let radius_m = points_m.iter().map(|p| p.length()).fold(0.0, f64::max);
        // Without a volume some face has all points on it: how deep the farthest one lies is then a rounding.
        let thinnest =
            |plane: &Plane| points_m.iter().map(|p| plane.offset_m - plane.normal.dot(*p)).fold(0.0f64, f64::max);
        if planes.len() < 4 || planes.iter().any(|plane| thinnest(plane) <= 1e-9 * radius_m) {
            return Err(flat());
        }
        Ok(Self { form: Form::Hull { planes: planes.into(), corners: corners.into() }, radius_m })
    }

    /// Radius of the ball about the reference point that holds the shape, metres.
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// The same shape for the physics engine.
    pub(crate) fn collider(&self) -> SharedShape {
        match &self.form {
            Form::Sphere { radius_m } => SharedShape::ball(*radius_m),
            Form::Block { half_m } => SharedShape::cuboid(half_m.x, half_m.y, half_m.z),
            Form::Capsule { half_height_m, radius_m } => SharedShape::capsule_y(*half_height_m, *radius_m),
            Form::Cylinder { half_height_m, radius_m } => SharedShape::cylinder(*half_height_m, *radius_m),
            // Corners that the engine made a hull of it makes one of again; were it not to, a ball stands for it.
            Form::Hull { corners, .. } => {
                SharedShape::convex_hull(corners).unwrap_or_else(|| SharedShape::ball(self.radius_m))
            }
        }
    }

    /// Signed distance of a point from the surface, metres, below 0 inside. Outside a hull it is the distance to the
    /// farthest of the planes that the point is in front of: exact before a face, less than the true one beside edges.
    pub fn distance_m(&self, p: DVec3) -> f64 {
        let rect = |x: f64, y: f64| x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0);
        match &self.form {
            Form::Sphere { radius_m } => p.length() - radius_m,
            Form::Block { half_m } => {
                let q = p.abs() - *half_m;
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
            }
            Form::Capsule { half_height_m, radius_m } => {
                p.distance(DVec3::Y * p.y.clamp(-half_height_m, *half_height_m)) - radius_m
            }
            Form::Cylinder { half_height_m, radius_m } => rect(p.x.hypot(p.z) - radius_m, p.y.abs() - half_height_m),
            Form::Hull { planes, .. } => {
                planes.iter().map(|plane| plane.normal.dot(p) - plane.offset_m).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// Where the segment first is in the shape; `None` if it misses it.
    pub fn enter(&self, from_m: DVec3, to_m: DVec3) -> Option<Entry> {
        let line = Line { start: from_m, along: to_m - from_m };
        let stretch = match &self.form {
            Form::Sphere { radius_m } => line.in_ball(DVec3::ZERO, *radius_m),
            Form::Block { half_m } => line
                .between(DVec3::X, half_m.x)
                .and_then(|x| x.meet(line.between(DVec3::Y, half_m.y)?))
                .and_then(|xy| xy.meet(line.between(DVec3::Z, half_m.z)?)),
            Form::Cylinder { half_height_m, radius_m } => line.in_cylinder(*half_height_m, *radius_m),
            Form::Capsule { half_height_m, radius_m } => {
                let end = DVec3::Y * *half_height_m;
                let parts = [
                    line.in_cylinder(*half_height_m, *radius_m),
                    line.in_ball(end, *radius_m),
                    line.in_ball(-end, *radius_m),
                ];
                // Of the parts that the segment meets, the one it is in first.
                let entries = parts.into_iter().flatten().filter_map(Stretch::entry);
                return entries.reduce(|first, other| if other.fraction < first.fraction { other } else { first });
            }
            Form::Hull { planes, .. } => planes
                .iter()
                .try_fold(Stretch::ALL, |inside, plane| inside.meet(line.behind(plane.normal, plane.offset_m)?)),
        };
        stretch?.entry()
    }
}

/// A straight line by a point and the way from it at parameter 1; the way may be zero.
#[derive(Clone, Copy)]
struct Line {
    start: DVec3,
    along: DVec3,
}

/// The parameters of a line within a convex body, and the body's normal where the line goes in.
#[derive(Clone, Copy)]
struct Stretch {
    enter: f64,
    exit: f64,
    normal: DVec3,
}

impl Stretch {
    const ALL: Self = Self { enter: f64::NEG_INFINITY, exit: f64::INFINITY, normal: DVec3::ZERO };

    /// What two bodies have in common.
    fn meet(self, other: Self) -> Option<Self> {
        let (enter, normal) =
            if self.enter >= other.enter { (self.enter, self.normal) } else { (other.enter, other.normal) };
        let exit = self.exit.min(other.exit);
        (enter <= exit).then_some(Self { enter, exit, normal })
    }

    /// The part of it from parameter 0 to 1.
    fn entry(self) -> Option<Entry> {
        if self.enter > 1.0 || self.exit < 0.0 {
            None
        } else if self.enter <= 0.0 {
            Some(Entry { fraction: 0.0, normal: None })
        } else {
            Some(Entry { fraction: self.enter, normal: Some(self.normal) })
        }
    }
}

impl Line {
    /// Where the line is behind a plane. Ends decide by the sign of their own distance: no rounding loses one.
    fn behind(&self, normal: DVec3, offset_m: f64) -> Option<Stretch> {
        let (first, last) = (normal.dot(self.start) - offset_m, normal.dot(self.start + self.along) - offset_m);
        let crossing = first / (first - last);
        match (first <= 0.0, last <= 0.0) {
            (true, true) => Some(Stretch::ALL),
            (false, false) => None,
            (false, true) => Some(Stretch { enter: crossing, exit: f64::INFINITY, normal }),
            (true, false) => Some(Stretch { enter: f64::NEG_INFINITY, exit: crossing, normal: DVec3::ZERO }),
        }
    }

    /// Where the line is at most `half_m` from the origin along an axis.
    fn between(&self, axis: DVec3, half_m: f64) -> Option<Stretch> {
        self.behind(axis, half_m)?.meet(self.behind(-axis, half_m)?)
    }

    /// Where the line is in a ball.
    fn in_ball(&self, centre: DVec3, radius_m: f64) -> Option<Stretch> {
        let (enter, exit) = in_round(self.start - centre, self.along, radius_m)?;
        Some(Stretch { enter, exit, normal: (self.start - centre + self.along * enter).normalize_or_zero() })
    }

    /// Where the line is in a cylinder with flat ends.
    fn in_cylinder(&self, half_height_m: f64, radius_m: f64) -> Option<Stretch> {
        let flat = DVec3::new(1.0, 0.0, 1.0);
        let (enter, exit) = in_round(self.start * flat, self.along * flat, radius_m)?;
        let normal = (self.start * flat + self.along * flat * enter).normalize_or_zero();
        Stretch { enter, exit, normal }.meet(self.between(DVec3::Y, half_height_m)?)
    }
}

/// The parameters at which `start + parameter along` is within the radius of the origin.
///
/// About the nearest point, so that a far start does not cancel out the radius; an end that is within the radius is
/// so by its own distance, whatever the roundings of the roots.
fn in_round(start: DVec3, along: DVec3, radius_m: f64) -> Option<(f64, f64)> {
    let squared = along.length_squared();
    let (radius, end) = (radius_m * radius_m, start + along);
    let (starts_inside, ends_inside) = (start.length_squared() <= radius, end.length_squared() <= radius);
    if squared == 0.0 {
        return starts_inside.then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let nearest = -start.dot(along) / squared;
    let half = ((radius - (start + along * nearest).length_squared()) / squared).sqrt();
    let (mut enter, mut exit) = (nearest - half, nearest + half);
    if half.is_nan() {
        // Past it, unless an end touches.
        (enter, exit) = (f64::INFINITY, f64::NEG_INFINITY);
    }
    if starts_inside {
        (enter, exit) = (enter.min(0.0), exit.max(0.0));
    }
    if ends_inside {
        (enter, exit) = (enter.min(1.0), exit.max(1.0));
    }
    (enter <= exit).then_some((enter, exit))
}

#[cfg(test)]
pub(super) mod tests;
