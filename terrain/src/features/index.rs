//! All that stands on the ground and has a solid, in one tree: asked by the picture and by physics alike.
//!
//! Frame: the world's, metres. A thing's base is the ground query: of a building the lowest height under its corners, of
//! everything else the height under its middle. What stands over void is not there. The tree holds boxes only; a thing's
//! exact solid ([`super::solid`], [`super::shape`]) is made from its features when its box is met.
//!
//! Invariant others rely on: an answer depends on the features and the ground alone.

use super::model::Features;
use super::shape::{self, LocalBox, Stand};
use super::solid::{BuildingSolid, FOOT_M};
use crate::edit::Changed;
use crate::ground::Area;
use glam::{DVec2, DVec3};
use rstar::{AABB, RTree, RTreeObject, SelectionFunction};
use std::fmt;
use std::sync::Arc;

/// A thing's name: its place in the features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ObjectId {
    /// Of the buildings.
    Building(u32),
    /// Of the placed things.
    Placed(u32),
    /// Of the masts.
    Mast(u32),
    /// A point of a power line.
    PowerTower {
        /// Which line.
        line: u32,
        /// Which of its points.
        point: u32,
    },
}

impl fmt::Display for ObjectId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Building(number) => write!(f, "building {number}"),
            Self::Placed(number) => write!(f, "placed thing {number}"),
            Self::Mast(number) => write!(f, "mast {number}"),
            Self::PowerTower { line, point } => write!(f, "tower {point} of power line {line}"),
        }
    }
}

/// A thing in the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Object {
    /// Its name.
    pub id: ObjectId,
    /// The ground that it stands on, metres above sea level.
    pub base_m: f64,
    /// Highest ground under it: under a corner of a building, else the same.
    pub highest_m: f64,
    /// Least corner of its box, world metres.
    pub low: DVec3,
    /// Greatest corner.
    pub high: DVec3,
}

/// Where a segment meets a thing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObjectHit {
    /// Fraction of the segment, 0..=1; 0 if it starts inside.
    pub fraction: f64,
    /// The point.
    pub point: DVec3,
    /// Outward unit normal there.
    pub normal: DVec3,
    /// Which thing.
    pub which: ObjectId,
}

/// See the module.
pub struct ObjectIndex {
    features: Arc<Features>,
    tree: RTree<Object>,
}

impl RTreeObject for Object {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        AABB::from_corners(self.low.to_array(), self.high.to_array())
    }
}

impl Object {
    /// Middle of its plan: what decides which tile it belongs to.
    pub fn plan_middle(&self) -> DVec2 {
        0.5 * DVec2::new(self.low.x + self.high.x, self.low.z + self.high.z)
    }

    fn over(id: ObjectId, stand: &Stand, boxes: &[LocalBox]) -> Self {
        let around = shape::bounds(boxes);
        let (low, high) = stand.plan(&around);
        Self {
            id,
            base_m: stand.at_m.y,
            highest_m: stand.at_m.y,
            low: DVec3::new(low.x, stand.at_m.y + around.low.y, low.y),
            high: DVec3::new(high.x, stand.at_m.y + around.high.y, high.y),
        }
    }
}

impl fmt::Debug for ObjectIndex {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ObjectIndex({} things)", self.len())
    }
}

/// Lowest and highest ground under the corners of an outline; `None` where one stands over void.
fn ground_m(outline: &[DVec2], area: &Area) -> Option<[f64; 2]> {
    let around = [f64::INFINITY, f64::NEG_INFINITY];
    let found = outline.iter().try_fold(around, |[low, high], at| {
        let height_m = area.height_m(at.x, at.y)?;
        Some([low.min(height_m), high.max(height_m)])
    });
    found.filter(|found| found.iter().all(|height_m| height_m.is_finite()))
}

/// Heading of a power line's tower: half way between the ways before and after it.
fn tower_heading_rad(line: &[DVec2], point: usize) -> f64 {
    let (before, after) = (line[point.saturating_sub(1)], line[(point + 1).min(line.len() - 1)]);
    let way = after - before;
    way.x.atan2(-way.y)
}

impl ObjectIndex {
    /// The index of a world's features over its ground.
    pub fn new(features: Arc<Features>, area: &Area) -> Self {
        let buildings = (0..).zip(&features.buildings).map(|(number, _)| ObjectId::Building(number));
        let placed = (0..).zip(&features.placed).map(|(number, _)| ObjectId::Placed(number));
        let masts = (0..).zip(&features.masts).map(|(number, _)| ObjectId::Mast(number));
        let towers = (0..).zip(&features.power_lines).flat_map(|(line, power)| {
            (0..).zip(&power.line).map(move |(point, _)| ObjectId::PowerTower { line, point })
        });
        let ids = buildings.chain(placed).chain(masts).chain(towers);
        let all = ids.filter_map(|id| standing(&features, id, area)).collect();
        Self { features, tree: RTree::bulk_load(all) }
    }

    /// The index over a new version of the ground, and where in plan (x, z) the things lie that stand anew. Cost: a copy of
    /// the tree; where a void was filled, a new one.
    pub fn edited(&self, area: &Area, changed: &Changed) -> (Self, Vec<DVec2>) {
        if changed.fills_void() {
            let all = Self::new(self.features.clone(), area);
            let moved = all.iter().map(Object::plan_middle).collect();
            return (all, moved);
        }
        let mut tree = self.tree.clone();
        let mut moved = Vec::new();
        for (low, high) in changed.plans(area.grid()) {
            for object in self.in_rectangle(low, high) {
                let now = standing(&self.features, object.id, area);
                if now.as_ref() != Some(object) && tree.remove(object).is_some() {
                    if let Some(now) = now {
                        tree.insert(now);
                    }
                    moved.push(object.plan_middle());
                }
            }
        }
        (Self { features: self.features.clone(), tree }, moved)
    }

    /// How many things there are.
    pub fn len(&self) -> usize {
        self.tree.size()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.tree.size() == 0
    }

    /// What they were made from.
    pub fn features(&self) -> &Arc<Features> {
        &self.features
    }

    /// All things, in no order that means anything.
    pub fn iter(&self) -> impl Iterator<Item = &Object> {
        self.tree.iter()
    }

    /// Things whose box meets a plan rectangle (x, z).
    pub fn in_rectangle(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = &Object> {
        let all = AABB::from_corners([low.x, f64::NEG_INFINITY, low.y], [high.x, f64::INFINITY, high.y]);
        self.tree.locate_in_envelope_intersecting(all)
    }

    /// The stand of a thing that is no building.
    pub fn stand(&self, object: &Object) -> Option<Stand> {
        let (at, grid_heading_rad) = match object.id {
            ObjectId::Building(_) => return None,
            ObjectId::Placed(number) => {
                let placed = self.features.placed.get(number as usize)?;
                (placed.at, f64::from(placed.grid_heading_rad))
            }
            ObjectId::Mast(number) => (self.features.masts.get(number as usize)?.at, 0.0),
            ObjectId::PowerTower { line, point } => {
                let line = &self.features.power_lines.get(line as usize)?.line;
                (*line.get(point as usize)?, tower_heading_rad(line, point as usize))
            }
        };
        Some(Stand { at_m: DVec3::new(at.x, object.base_m, at.y), grid_heading_rad })
    }

    /// The solid of a building in the tree.
    pub fn building(&self, object: &Object) -> Option<BuildingSolid> {
        let ObjectId::Building(number) = object.id else { return None };
        Some(BuildingSolid::new(self.features.buildings.get(number as usize)?, [object.base_m, object.highest_m]))
    }

    /// Where a segment first meets a thing; of several at the same place the one with the least name.
    pub fn segment(&self, from: DVec3, to: DVec3) -> Option<ObjectHit> {
        if !(from.is_finite() && to.is_finite()) {
            return None;
        }
        let met = self.tree.locate_with_selection_function(Crossed { from, to });
        first(met.filter_map(|object| self.enter(object, from, to)))
    }

    /// Where a segment enters one thing.
    pub fn enter(&self, object: &Object, from: DVec3, to: DVec3) -> Option<ObjectHit> {
        let (fraction, normal) = match object.id {
            ObjectId::Building(_) => self.building(object)?.enter(from, to)?,
            ObjectId::Placed(number) => {
                let boxes = shape::placed(self.features.placed.get(number as usize)?.class);
                self.stand(object)?.enter(boxes, from, to)?
            }
            ObjectId::Mast(number) => {
                let mast = self.features.masts.get(number as usize)?;
                self.stand(object)?.enter(&shape::mast(mast.class, f64::from(mast.height_m)), from, to)?
            }
            ObjectId::PowerTower { line, .. } => {
                let height_m = f64::from(self.features.power_lines.get(line as usize)?.height_m);
                self.stand(object)?.enter(&[shape::power_tower(height_m)], from, to)?
            }
        };
        Some(ObjectHit { fraction, point: from.lerp(to, fraction), normal, which: object.id })
    }
}

/// How a thing stands on the ground; `None` over void.
fn standing(features: &Features, id: ObjectId, area: &Area) -> Option<Object> {
    let over = |at: DVec2, grid_heading_rad: f64, boxes: &[LocalBox]| {
        let base_m = area.height_m(at.x, at.y)?;
        let stand = Stand { at_m: DVec3::new(at.x, base_m, at.y), grid_heading_rad };
        Some(Object::over(id, &stand, boxes))
    };
    match id {
        ObjectId::Building(number) => {
            let building = features.buildings.get(number as usize)?;
            let [base_m, highest_m] = ground_m(&building.outline, area)?;
            let solid = BuildingSolid::new(building, [base_m, highest_m]);
            if solid.outline.len() < 3 {
                return None;
            }
            let around = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            let (low, high) = solid.outline.iter().fold(around, |(low, high), at| (low.min(*at), high.max(*at)));
            let (low, high) = (DVec3::new(low.x, base_m - FOOT_M, low.y), DVec3::new(high.x, solid.top_m(), high.y));
            Some(Object { id, base_m, highest_m, low, high })
        }
        ObjectId::Placed(number) => {
            let placed = features.placed.get(number as usize)?;
            over(placed.at, f64::from(placed.grid_heading_rad), shape::placed(placed.class))
        }
        ObjectId::Mast(number) => {
            let mast = features.masts.get(number as usize)?;
            over(mast.at, 0.0, &shape::mast(mast.class, f64::from(mast.height_m)))
        }
        ObjectId::PowerTower { line, point } => {
            let power = features.power_lines.get(line as usize)?;
            let at = power.line.get(point as usize)?;
            let heading_rad = tower_heading_rad(&power.line, point as usize);
            over(*at, heading_rad, &[shape::power_tower(f64::from(power.height_m))])
        }
    }
}

fn first(hits: impl Iterator<Item = ObjectHit>) -> Option<ObjectHit> {
    hits.reduce(|first, other| {
        let earlier =
            other.fraction < first.fraction || (other.fraction == first.fraction && other.which < first.which);
        if earlier { other } else { first }
    })
}

/// Selects boxes that a segment crosses.
struct Crossed {
    from: DVec3,
    to: DVec3,
}

impl Crossed {
    fn crosses(&self, envelope: &AABB<[f64; 3]>) -> bool {
        // A hair wider: the exact test decides, this one must not lose what it would find.
        let hair = DVec3::splat(1e-6);
        let (low, high) = (DVec3::from(envelope.lower()) - hair, DVec3::from(envelope.upper()) + hair);
        LocalBox { low, high }.enter(self.from, self.to).is_some()
    }
}

impl SelectionFunction<Object> for Crossed {
    fn should_unpack_parent(&self, envelope: &AABB<[f64; 3]>) -> bool {
        self.crosses(envelope)
    }

    fn should_unpack_leaf(&self, leaf: &Object) -> bool {
        self.crosses(&leaf.envelope())
    }
}

#[cfg(test)]
mod tests;
