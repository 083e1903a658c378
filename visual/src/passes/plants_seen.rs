//! Which plants a view sees, and as what: a mesh, a card or a triangle.
//!
//! Every plant that may be in sight is looked at once a frame, by the processor: what is gone, beside the view or too
//! small is never sent, and what remains lies in one list for each way to draw it, parts of tiles nearest first. So each way
//! is a draw call or few, however many tiles there are. Metres relative to the eye.
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

/// A part of a tile that may be in sight.
pub struct Part<'a> {
    nearest_m: f32,
    tier: &'a Tier,
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
    tier: &'a Tier,
    planted: &'a Planted,
    origin_m: DVec2,
    eye_height_m: f64,
    frustum: &Frustum,
    found: &mut Vec<Part<'a>>,
) {
    let side_m = tier.side_m / f64::from(SQUARES);
    let mut start = 0;
    for (number, square) in (0..).zip(&planted.squares) {
        let (first, conifers_end, end) = (start, square.conifers_end as usize, square.end as usize);
        start = end;
        if first == end {
            continue;
        }
        let [least_m, most_m] = square.feet_m;
        let west = origin_m.x + f64::from(number % SQUARES) * side_m;
        let north = origin_m.y + f64::from(number / SQUARES) * side_m;
        let low = DVec3::new(west, f64::from(least_m) - eye_height_m, north).as_vec3();
        let high = DVec3::new(west + side_m, f64::from(most_m + MOST_TALL_M) - eye_height_m, north + side_m).as_vec3();
        let margin = Vec3::new(15.0, 1.0, 15.0);
        let nearest_m = Vec3::ZERO.clamp(low, high).length();
        if f64::from(nearest_m) > tier.reach_m || !frustum.may_see_box(low - margin, high + margin) {
            continue;
        }
        // What is gone by now stands at a list's end.
        let standing = |list: Range<usize>| {
            let count = planted.plants[list.clone()].partition_point(|plant| plant.reach_m(tier) >= nearest_m);
            list.start..list.start + count
        };
        let lists = [standing(first..conifers_end), standing(conifers_end..end)];
        found.push(Part { nearest_m, tier, planted, origin_m, lists });
    }
}

impl Seen {
    /// Looks at the plants of some parts, the nearest part first.
    pub fn of(mut parts: Vec<Part<'_>>, view: &View, frustum: &Frustum) -> Self {
        parts.sort_by(|a, b| a.nearest_m.total_cmp(&b.nearest_m));
        let mut seen = Self::default();
        let focal_px = view.focal_px() as f32;
        for part in &parts {
            let origin_m = part.origin_m.as_vec2();
            let part_m = (part.tier.side_m / PARTS) as f32;
            for list in &part.lists {
                for plant in &part.planted.plants[list.clone()] {
                    let foot_m = Vec3::new(
                        origin_m.x + f32::from(plant.at[0]) * part_m,
                        (f64::from(plant.height_m) - view.eye_m.y) as f32,
                        origin_m.y + f32::from(plant.at[1]) * part_m,
                    );
                    seen.add(plant, foot_m, part.tier, focal_px, frustum);
                }
            }
        }
        seen
    }

    fn add(&mut self, plant: &Plant, foot_m: Vec3, tier: &Tier, focal_px: f32, frustum: &Frustum) {
        let distance_m = foot_m.length();
        let reach_m = plant.reach_m(tier);
        if distance_m >= reach_m {
            return;
        }
        let species = &SPECIES[usize::from(plant.species) % SPECIES.len()];
        let whole_m = plant.tall_m();
        // A ball around it: the crown is at most 1.15 of its mean width.
        let around_m = 0.6 * whole_m * (1.0 + 1.15 * species.width);
        let middle_m = foot_m + Vec3::new(0.0, 0.5 * whole_m, 0.0);
        if frustum.planes.iter().any(|plane| plane.normal.dot(middle_m) + plane.offset_m < -around_m) {
            return;
        }
        let looks = u32::from_le_bytes([plant.species, plant.size, plant.turn, plant.tint]);
        let mesh_m = mesh_reach_m(whole_m);
        if distance_m < mesh_m {
            self.near[species.shape as usize].push(Near { foot_m: foot_m.to_array(), looks });
            self.plants += 1;
            if distance_m <= 0.85 * mesh_m {
                return;
            }
        }
        // One by one the plants of a tier leave, each shrinking over the last of its own way.
        let grown = ((reach_m - distance_m) / (LEAVES_OVER * reach_m)).clamp(0.0, 1.0);
        let pixels = whole_m * focal_px / distance_m.max(1.0);
        let part = ((pixels - SHRINK_PX[0]) / (SHRINK_PX[1] - SHRINK_PX[0])).clamp(0.0, 1.0);
        let share = grown * part * part * (3.0 - 2.0 * part);
        if share * pixels < LEAST_PX {
            return;
        }
        self.plants += usize::from(distance_m >= mesh_m);
        let stand = Stand { foot_m: foot_m.to_array(), tall_m: whole_m * share, looks };
        let early = if matches!(species.shape, Shape::Spire | Shape::Conifer) { CONIFER_FAR } else { 1.0 };
        let far_m = FAR_M * early * (FAR_SPREAD + (1.0 - FAR_SPREAD) * f32::from(plant.turn) / 255.0);
        if distance_m < far_m { self.cards.push(stand) } else { self.far.push(stand) }
    }
}
