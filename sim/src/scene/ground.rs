//! The ground of a scene: its heights, and where a swept path meets it.
//!
//! Frame: the world's (X east, Y up, Z south), metres. Made of an [`Area`] the ground is its level-0 triangles, and a
//! path meets it exactly ([`ground_impact`]). Made of a closure, as tests and simple callers do, there are only heights:
//! a path is then looked at every [`LOOK_M`] of its way, and a ridge narrower than that may be missed.
//!
//! What stands on it may come with it ([`SceneGround::with_objects`]): the same index that the picture draws from.
//!
//! Invariant others rely on: heights and impacts are those of one surface, and void is no ground to either.

use crate::HeightAt;
use crate::ballistics::impact::{Impact, ground_impact, object_impact};
use crate::ballistics::path::StepPath;
use crate::frame::ned_from_world;
use crate::rigid::gear::{Footing, Surface};
use glam::DVec3;
use std::fmt;
use std::sync::Arc;
use terrain::Area;
use terrain::edit::{Edit, EditError};
use terrain::features::cover::{Cover, CoverClass};
use terrain::features::index::{ObjectId, ObjectIndex};

/// Way between two looks at a ground that is a closure, metres: posts stand at least 25 m apart.
pub const LOOK_M: f64 = 25.0;
/// Most looks at one path.
const MOST_LOOKS: f64 = 4_096.0;

/// The ground; cheap to clone.
#[derive(Clone)]
pub struct SceneGround {
    heights: Arc<HeightAt>,
    area: Option<Area>,
    objects: Option<Arc<ObjectIndex>>,
    cover: Option<Arc<Cover>>,
}

/// Where a path meets the ground, or a thing that stands on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundTouch {
    /// Fraction of the path, 0..=1.
    pub fraction: f64,
    /// The point.
    pub point_m: DVec3,
    /// Upward unit normal of the ground there; outward of a thing.
    pub normal: DVec3,
    /// Velocity of what meets it, m/s.
    pub velocity_mps: DVec3,
    /// The thing that was met; `None` is the ground itself.
    pub object: Option<ObjectId>,
}

impl fmt::Debug for SceneGround {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.area.is_some() { "SceneGround(area)" } else { "SceneGround(heights)" })
    }
}

impl From<Area> for SceneGround {
    fn from(area: Area) -> Self {
        let of = area.clone();
        Self { heights: Arc::new(move |x_m, z_m| of.height_m(x_m, z_m)), area: Some(area), objects: None, cover: None }
    }
}

impl From<Arc<HeightAt>> for SceneGround {
    fn from(heights: Arc<HeightAt>) -> Self {
        Self { heights, area: None, objects: None, cover: None }
    }
}

impl SceneGround {
    /// The ground of a function of plan position (x, z).
    pub fn heights(height_m: impl Fn(f64, f64) -> Option<f64> + Send + Sync + 'static) -> Self {
        Self { heights: Arc::new(height_m), area: None, objects: None, cover: None }
    }

    /// The same ground with what stands on it; without a thing it costs nothing.
    #[must_use]
    pub fn with_objects(mut self, objects: Arc<ObjectIndex>) -> Self {
        self.objects = (!objects.is_empty()).then_some(objects);
        self
    }

    /// The same ground with what covers it: how wheels hold and roll. Without it the ground is paved.
    #[must_use]
    pub fn with_cover(mut self, cover: Arc<Cover>) -> Self {
        self.cover = Some(cover);
        self
    }

    /// The ground under a point as wheels see it, north, east, down from the world's origin; `None` over void.
    pub(super) fn footing(&self, north_m: f64, east_m: f64) -> Option<Footing> {
        let (x_m, z_m) = (east_m, -north_m);
        let (height_m, normal) = match &self.area {
            Some(area) => area.height_and_normal(x_m, z_m)?,
            None => {
                let height_m = self.height_m(x_m, z_m)?;
                (height_m, self.slope(DVec3::new(x_m, height_m, z_m)))
            }
        };
        let surface = self.cover.as_ref().map_or(Surface::PAVED, |cover| Surface::of(cover.class_at(x_m, z_m)));
        Some(Footing { point_m: DVec3::new(north_m, east_m, -height_m), normal: ned_from_world(normal), surface })
    }

    /// What covers a plan point, if that is known.
    pub fn cover_at(&self, x_m: f64, z_m: f64) -> Option<CoverClass> {
        self.cover.as_ref().map(|cover| cover.class_at(x_m, z_m))
    }

    /// Whether water covers a plan point, as far as the cover says.
    pub fn is_water(&self, x_m: f64, z_m: f64) -> bool {
        self.cover.as_ref().is_some_and(|cover| Surface::of(cover.class_at(x_m, z_m)).is_water)
    }

    /// Upward unit normal of the ground at a plan point; `None` over void.
    pub(crate) fn normal(&self, x_m: f64, z_m: f64) -> Option<DVec3> {
        match &self.area {
            Some(area) => area.height_and_normal(x_m, z_m).map(|(_, normal)| normal),
            None => self.height_m(x_m, z_m).map(|height_m| self.slope(DVec3::new(x_m, height_m, z_m))),
        }
    }

    /// The posts that it is made of; `None` of a function.
    pub(crate) fn area(&self) -> Option<&Area> {
        self.area.as_ref()
    }

    /// Whether both have the very same heights, by where they are kept: two copies of the same heights are not.
    pub(crate) fn is_same_surface(&self, other: &Self) -> bool {
        match (&self.area, &other.area) {
            (Some(one), Some(other)) => std::ptr::eq(one.field(), other.field()),
            (None, None) => Arc::ptr_eq(&self.heights, &other.heights),
            _ => false,
        }
    }

    /// No ground anywhere.
    pub fn void() -> Self {
        Self::heights(|_, _| None)
    }

    /// Counts the edits that made it, from 0; 0 of a function.
    pub fn version(&self) -> u32 {
        self.area.as_ref().map_or(0, |area| area.field().version())
    }

    /// The next version of the ground: edits made, and what stands on it standing anew where it changed. A ground that is a
    /// function has no posts and stays as it is. Cost: see [`Area::edited`] and [`ObjectIndex::edited`].
    ///
    /// # Errors
    /// [`EditError`] says which edit cannot be made; none is then.
    pub fn edited(&self, edits: &[Edit]) -> Result<Self, EditError> {
        let Some(area) = &self.area else { return Ok(self.clone()) };
        let (area, changed) = area.edited(edits)?;
        let objects = self.objects.as_ref().map(|objects| Arc::new(objects.edited(&area, &changed).0));
        Ok(Self { objects, cover: self.cover.clone(), ..Self::from(area) })
    }

    /// Heights as a function.
    pub fn height_at(&self) -> &HeightAt {
        &*self.heights
    }

    /// Ground height over a plan point; `None` over void.
    pub fn height_m(&self, x_m: f64, z_m: f64) -> Option<f64> {
        match &self.area {
            Some(area) => area.height_m(x_m, z_m),
            None => (self.heights)(x_m, z_m).filter(|height| height.is_finite()),
        }
    }

    /// The first point of a path on or under the ground.
    pub fn touch(&self, path: &StepPath) -> Option<GroundTouch> {
        let Some(area) = &self.area else { return self.looked_at(path) };
        ground_impact(path, area).map(|impact| touched(&impact))
    }

    /// The first point of a path on the ground or on a thing that stands on it; at the same instant the thing.
    pub fn touch_all(&self, path: &StepPath) -> Option<GroundTouch> {
        let ground = self.touch(path);
        let thing = self.objects.as_ref().and_then(|objects| object_impact(path, objects));
        match (ground, thing) {
            (Some(ground), Some(thing)) if ground.fraction < thing.fraction => Some(ground),
            (ground, None) => ground,
            (_, Some(thing)) => Some(touched(&thing)),
        }
    }

    /// Whether anything stands on it.
    pub(super) fn has_things(&self) -> bool {
        self.objects.is_some()
    }

    /// The first point of a path on a thing that stands on the ground.
    pub(super) fn touch_thing(&self, path: &StepPath) -> Option<GroundTouch> {
        self.objects.as_ref().and_then(|objects| object_impact(path, objects)).map(|impact| touched(&impact))
    }

    /// `false` only if a path meets neither the ground nor a thing, or no deeper than its own bend; cheaper than a sweep,
    /// as it asks about one segment: the chord lowered by twice the bend.
    pub fn may_touch(&self, path: &StepPath) -> bool {
        let Some(area) = &self.area else { return true };
        let down = DVec3::Y * (2.0 * path.bulge_m());
        let (from_m, to_m) = (path.from_m - down, path.to_m - down);
        area.segment(from_m, to_m).is_some()
            || self.objects.as_ref().is_some_and(|objects| objects.segment(from_m, to_m).is_some())
    }

    /// Distance between the posts, metres; `None` of a ground that has none.
    pub fn step_m(&self) -> Option<f64> {
        self.area.as_ref().map(|area| area.grid().step_m)
    }

    fn looked_at(&self, path: &StepPath) -> Option<GroundTouch> {
        if !path.is_sound() {
            return None;
        }
        let under = |fraction: f64| {
            let at = path.position_m(fraction);
            self.height_m(at.x, at.z).is_some_and(|height_m| at.y <= height_m)
        };
        let looks = (path.from_m.distance(path.to_m) / LOOK_M).ceil().clamp(1.0, MOST_LOOKS);
        let first = (0..=looks as u32).map(|look| f64::from(look) / looks).find(|fraction| under(*fraction))?;
        let (mut low, mut high) = ((first - 1.0 / looks).max(0.0), first);
        // Each look halves the bracket: 60 of them leave a rounding.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if under(middle) { high = middle } else { low = middle }
        }
        let point_m = path.position_m(high);
        Some(GroundTouch {
            fraction: high,
            point_m,
            normal: self.slope(point_m),
            velocity_mps: path.velocity_mps(high),
            object: None,
        })
    }

    /// The normal by differences over a metre; up where there are no neighbours.
    fn slope(&self, at: DVec3) -> DVec3 {
        let side = |x_m: f64, z_m: f64| {
            let (ahead, behind) = (self.height_m(at.x + x_m, at.z + z_m)?, self.height_m(at.x - x_m, at.z - z_m)?);
            Some(ahead - behind)
        };
        let (east, south) = (side(0.5, 0.0).unwrap_or(0.0), side(0.0, 0.5).unwrap_or(0.0));
        DVec3::new(-east, 1.0, -south).normalize()
    }
}

fn touched(impact: &Impact) -> GroundTouch {
    let Impact { fraction, point_m, normal, velocity_mps, object, .. } = *impact;
    GroundTouch { fraction, point_m, normal, velocity_mps, object }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::{Grid, Ground, synthetic};

    #[test]
    fn a_closure_and_its_area_agree_where_the_ground_is_smooth() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        // A plane: the closure's looks and the exact cast must find the same point.
        let field = synthetic::from_fn(grid, |column, row| 10.0 * column as f32 - 4.0 * row as f32 + 300.0);
        let area = Ground::new(Arc::new(field)).whole();
        let of = area.clone();
        let (exact, looked) = (SceneGround::from(area), SceneGround::heights(move |x_m, z_m| of.height_m(x_m, z_m)));
        let path = StepPath::straight(DVec3::new(-900.0, 900.0, 700.0), DVec3::new(500.0, 100.0, -650.0), 1.0);
        let (a, b) = (exact.touch(&path).unwrap(), looked.touch(&path).unwrap());
        // Coordinates below 2^10 m: roundings of 2^-43 m, some ten of them, over the sine of the grazing angle (> 0.1).
        assert!(a.point_m.distance(b.point_m) < 100.0 * 2f64.powi(-43), "{} {}", a.point_m, b.point_m);
        assert!(a.normal.distance(b.normal) < 1e-9 && (a.fraction - b.fraction).abs() < 1e-13);
    }

    #[test]
    fn void_stops_nothing_and_under_ground_is_met_at_once() {
        let down = StepPath::straight(DVec3::Y * 50.0, DVec3::Y * -50.0, 0.1);
        assert_eq!(SceneGround::void().touch(&down), None);
        assert_eq!(SceneGround::heights(|_, _| Some(f64::NAN)).touch(&down), None);
        let buried = SceneGround::heights(|_, _| Some(60.0)).touch(&down).unwrap();
        assert_eq!((buried.fraction, buried.normal), (0.0, DVec3::Y));
        let broken = StepPath { to_m: DVec3::NAN, ..down };
        assert_eq!(SceneGround::heights(|_, _| Some(60.0)).touch(&broken), None);
    }
}
