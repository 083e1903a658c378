//! Paints, and the round and square parts that shapes are put together from.
//!
//! Frame: see [`super`].

use super::mesh::{Mesh, Paint};
use glam::Vec3;
use std::f32::consts::TAU;

pub(super) const SHEET: Paint = Paint::matt(0.36, 0.37, 0.37);
pub(super) const GREY: Paint = Paint::matt(0.30, 0.30, 0.31);
pub(super) const DARK: Paint = Paint::matt(0.05, 0.05, 0.055);
pub(super) const WHITE: Paint = Paint::matt(0.56, 0.56, 0.54);
pub(super) const CONCRETE: Paint = Paint::matt(0.34, 0.33, 0.31);
pub(super) const OLIVE: Paint = Paint::matt(0.125, 0.13, 0.08);
pub(super) const CANVAS: Paint = Paint::matt(0.17, 0.165, 0.115);
pub(super) const RED: Paint = Paint::matt(0.42, 0.07, 0.05);
pub(super) const GLASS: Paint = Paint::matt(0.04, 0.05, 0.06).of_kind(3);
pub(super) const STEEL: Paint = Paint::matt(0.33, 0.34, 0.35);
pub(super) const LAMP: Paint = Paint::matt(0.55, 0.10, 0.08).of_kind(4);

/// An upright ring of points about a middle, in the plane across z, counter-clockwise seen from +z.
pub(super) fn ring(middle: Vec3, half: [f32; 2], sides: u32) -> Vec<Vec3> {
    (0..sides)
        .map(|side| {
            let (sin, cos) = (TAU * (side as f32 + 0.5) / sides as f32).sin_cos();
            middle + Vec3::new(half[0] * cos, half[1] * sin, 0.0)
        })
        .collect()
}

/// A body along z through rings (z, middle height, half width, half height), from the front (least z) backward.
pub(super) fn body(mesh: &mut Mesh, sections: &[[f32; 4]], sides: u32, paint: Paint) {
    let rings: Vec<Vec<Vec3>> =
        sections.iter().map(|[z, y, w, h]| ring(Vec3::new(0.0, *y, *z), [*w, *h], sides)).collect();
    mesh.loft(&rings, paint);
}

pub(super) fn cuboid(mesh: &mut Mesh, low: [f32; 3], high: [f32; 3], paint: Paint) {
    mesh.cuboid(low.into(), high.into(), paint, paint);
}
