//! Which plants a view sees, and as what: a mesh, a card or a triangle.
//!
//! Every plant that may be in sight is looked at once a frame, by the processor: what is gone, beside the view or too
//! small is never sent, and what remains lies in one list for each way to draw it, parts of tiles nearest first. So each way
//! is a draw call or few, however many tiles there are. Metres relative to the eye.
//!
//! What all plants of a part share is asked once: whether any can be in sight, and whether all are, so that none need be asked. A
//! part's plants lie in the order in which they leave, so the first that is gone ends its list.
//!
//! Invariant: a plant is in exactly one of cards and triangles, or is a mesh, or, while it dissolves, a mesh and a card.

use crate::camera::{Frustum, View};
use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3};
use std::ops::Range;
use vegetation::place::{PARTS, Plant, Planted, SQUARES, Tier};
use vegetation::species::{SHAPES, SPECIES, Shape};

/// Up to where tall plants are meshes, metres; low ones change sooner.
pub const MESH_M: f64 = 200.0;
/// From where plants are single triangles, metres.
pub const FAR_M: f32 = 1_400.0;
/// Conifers look like one early: from this share of [`FAR_M`].
const CONIFER_FAR: f32 = 0.6;
/// Each plant changes somewhere between this share of that and all of it.
const FAR_SPREAD: f32 = 0.8;
/// A plant so tall is a mesh up to [`MESH_M`].
const TALL_M: f32 = 20.0;
/// Most that a plant may stand above its foot, metres.
const MOST_TALL_M: f32 = 45.0;
/// Most that the ball around a plant may reach from its middle, metres.
const MOST_AROUND_M: f32 = 40.0;
/// What stands fewer pixels high is not drawn.
const LEAST_PX: f32 = 0.5;
/// A plant less than about two pixels high would only speckle: between these it shrinks into the ground, which has its colour.
const SHRINK_PX: [f32; 2] = [1.2, 2.6];
/// Share of its reach over which a plant shrinks before it is gone.
const LEAVES_OVER: f32 = 0.12;

/// A plant in sight; mirror of the shader's `Plant`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Stand {
    /// Its foot relative to the eye, metres.
    pub foot_m: [f32; 3],
    /// How tall it stands now, metres.
    pub tall_m: f32,
    /// Species, size, turn and tint, a byte each.
    pub looks: u32,
}

/// A plant drawn as a mesh.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Near {
    /// As [`Stand::foot_m`].
    pub foot_m: [f32; 3],
    /// As [`Stand::looks`].
    pub looks: u32,
}

impl Near {
    /// Of its foot to the eye.
    pub fn distance_squared(&self) -> f32 {
        Vec3::from_array(self.foot_m).length_squared()
    }
}

/// What a view sees.
#[derive(Debug, Default)]
pub struct Seen {
    /// Plants that face the eye as pictures.
    pub cards: Vec<Stand>,
    /// Plants that are single triangles.
    pub far: Vec<Stand>,
    /// Meshes of each shape.
    pub near: [Vec<Near>; SHAPES],
    /// Plants in any of these lists; one that dissolves counts once.
    pub plants: usize,
}

/// Farthest that the plants of a tier are drawn, metres, by their turn.
pub struct Reaches([f32; 256]);

impl Reaches {
    /// Of a tier.
    pub fn of(tier: &Tier) -> Self {
        Self(std::array::from_fn(|turn| Plant { turn: turn as u8, ..Plant::default() }.reach_m(tier)))
    }
}

/// A part of a tile that may be in sight.
pub struct Part<'a> {
    nearest_m: f32,
    /// Whether none of its plants can be out of sight.
    whole: bool,
    /// Metres a part of the tile's side.
    part_m: f32,
    reaches: &'a Reaches,
    planted: &'a Planted,
    origin_m: DVec2,
    /// Conifers, then others.
    lists: [Range<usize>; 2],
}

/// Up to where a plant of a height is a mesh; the shader's `meshless`.
fn mesh_reach_m(tall_m: f32) -> f32 {
    MESH_M as f32 * (tall_m / TALL_M).clamp(0.2, 1.0)
}

/// The parts of a tile that a view may see; `origin_m` is its north-west corner from the eye.
pub fn parts<'a>(
    tier: &Tier,
    reaches: &'a Reaches,
    planted: &'a Planted,
    origin_m: DVec2,
    eye_height_m: f64,
    frustum: &Frustum,
    found: &mut Vec<Part<'a>>,
) {
    // Feet from the eye, in a square with a side.
    let feet = |corner_m: DVec2, side_m: f64, [least_m, most_m]: [f32; 2]| {
        let low = DVec3::new(corner_m.x, f64::from(least_m) - eye_height_m, corner_m.y).as_vec3();
        let high = DVec3::new(corner_m.x + side_m, f64::from(most_m) - eye_height_m, corner_m.y + side_m).as_vec3();
        (low, high)
    };
    // Middles of plants are no higher than half of the tallest above a foot; balls around them decide what is in sight.
    let above = Vec3::new(0.0, 0.5 * MOST_TALL_M, 0.0);
    let seen = |(low, high): (Vec3, Vec3)| frustum.may_see_box(low - MOST_AROUND_M, high + above + MOST_AROUND_M);
    let all = planted.squares.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], square| {
        [low.min(square.feet_m[0]), high.max(square.feet_m[1])]
    });
    if all[0] > all[1] || !seen(feet(origin_m, tier.side_m, all)) {
        return;
    }
    let side_m = tier.side_m / f64::from(SQUARES);
    let mut start = 0;
    for (number, square) in (0..).zip(&planted.squares) {
        let (first, conifers_end, end) = (start, square.conifers_end as usize, square.end as usize);
        start = end;
        if first == end {
            continue;
        }
        let corner_m = origin_m + DVec2::new(f64::from(number % SQUARES), f64::from(number / SQUARES)) * side_m;
        let (low, high) = feet(corner_m, side_m, square.feet_m);
        let nearest_m = Vec3::ZERO.clamp(low, high).length();
        if f64::from(nearest_m) > tier.reach_m || !seen((low, high)) {
            continue;
        }
        found.push(Part {
            nearest_m,
            whole: frustum.holds_box(low, high + above),
            part_m: (tier.side_m / PARTS) as f32,
            reaches,
            planted,
            origin_m,
            lists: [first..conifers_end, conifers_end..end],
        });
    }
}

/// What a species' plants share.
#[derive(Clone, Copy)]
struct Kind {
    /// Least height, metres, and how much more the tallest has.
    least_m: f32,
    more_m: f32,
    /// Of the ball around it over its height: the crown is at most 1.15 of its mean width.
    around: f32,
    /// From where it is a triangle, metres.
    far_m: f32,
    shape: usize,
}

fn kinds() -> [Kind; SPECIES.len()] {
    SPECIES.map(|species| Kind {
        least_m: species.height_m[0],
        more_m: species.height_m[1] - species.height_m[0],
        around: 0.6 * (1.0 + 1.15 * species.width),
        far_m: FAR_M * if matches!(species.shape, Shape::Spire | Shape::Conifer) { CONIFER_FAR } else { 1.0 },
        shape: species.shape as usize,
    })
}

impl Seen {
    /// Looks at the plants of some parts, the nearest part first; what was seen before is forgotten.
    pub fn look(&mut self, mut parts: Vec<Part<'_>>, view: &View, frustum: &Frustum) {
        parts.sort_by(|a, b| a.nearest_m.total_cmp(&b.nearest_m));
        self.cards.clear();
        self.far.clear();
        self.near.iter_mut().for_each(Vec::clear);
        self.plants = 0;
        let focal_px = view.focal_px() as f32;
        let kinds = kinds();
        for part in &parts {
            let origin_m = part.origin_m.as_vec2();
            for list in &part.lists {
                for plant in &part.planted.plants[list.clone()] {
                    let reach_m = part.reaches.0[usize::from(plant.turn)];
                    // Those behind it in the list leave no later.
                    if reach_m < part.nearest_m {
                        break;
                    }
                    let foot_m = Vec3::new(
                        origin_m.x + f32::from(plant.at[0]) * part.part_m,
                        (f64::from(plant.height_m) - view.eye_m.y) as f32,
                        origin_m.y + f32::from(plant.at[1]) * part.part_m,
                    );
                    let distance_m = foot_m.length();
                    if distance_m >= reach_m {
                        continue;
                    }
                    let kind = &kinds[usize::from(plant.species) % SPECIES.len()];
                    let whole_m = kind.least_m + kind.more_m * f32::from(plant.size) / 255.0;
                    if part.whole || !out_of_sight(foot_m, whole_m, kind, frustum) {
                        self.add(plant, kind, whole_m, foot_m, distance_m, reach_m, focal_px);
                    }
                }
            }
        }
    }

    #[inline]
    fn add(
        &mut self,
        plant: &Plant,
        kind: &Kind,
        whole_m: f32,
        foot_m: Vec3,
        distance_m: f32,
        reach_m: f32,
        focal_px: f32,
    ) {
        let looks = u32::from_le_bytes([plant.species, plant.size, plant.turn, plant.tint]);
        let mesh_m = mesh_reach_m(whole_m);
        if distance_m < mesh_m {
            self.near[kind.shape].push(Near { foot_m: foot_m.to_array(), looks });
            self.plants += 1;
            if distance_m <= 0.85 * mesh_m {
                return;
            }
        }
        let pixels = whole_m * focal_px / distance_m.max(1.0);
        let share = grown(distance_m, reach_m) * shrunk(pixels);
        if share * pixels < LEAST_PX {
            return;
        }
        self.plants += usize::from(distance_m >= mesh_m);
        let stand = Stand { foot_m: foot_m.to_array(), tall_m: whole_m * share, looks };
        let far_m = kind.far_m * (FAR_SPREAD + (1.0 - FAR_SPREAD) * f32::from(plant.turn) / 255.0);
        if distance_m < far_m { self.cards.push(stand) } else { self.far.push(stand) }
    }
}

fn out_of_sight(foot_m: Vec3, whole_m: f32, kind: &Kind, frustum: &Frustum) -> bool {
    let middle_m = foot_m + Vec3::new(0.0, 0.5 * whole_m, 0.0);
    let around_m = kind.around * whole_m;
    frustum.planes.iter().any(|plane| plane.normal.dot(middle_m) + plane.offset_m < -around_m)
}

/// One by one the plants of a tier leave, each shrinking over the last of its own way: the share that still stands.
fn grown(distance_m: f32, reach_m: f32) -> f32 {
    ((reach_m - distance_m) / (LEAVES_OVER * reach_m)).clamp(0.0, 1.0)
}

/// Share that stands of a plant so many pixels high.
fn shrunk(pixels: f32) -> f32 {
    let part = ((pixels - SHRINK_PX[0]) / (SHRINK_PX[1] - SHRINK_PX[0])).clamp(0.0, 1.0);
    part * part * (3.0 - 2.0 * part)
}

#[cfg(test)]
#[path = "plants_seen_tests.rs"]
mod tests;
