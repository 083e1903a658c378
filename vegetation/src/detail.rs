//! Models of plants, generated: trunk, and leaves as small cut-out faces.
//!
//! Model frame: y up, the foot at the origin, height 1, crown width 1 (x and z within +-0.5): a species' height and width
//! scale it. A face shows one of three *leaf pictures* ([`crate::pictures`]): a skirt of conifer branches, a clump of leaves, bark.
//! Normals point out of the crown, not out of the faces, so that a crown is shaded as one round thing.

use crate::scatter::uniforms;
use crate::species::{SHAPES, Shape};
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Leaf pictures by number.
pub const SKIRT: u8 = 0;
/// See [`SKIRT`].
pub const CLUMP: u8 = 1;
/// See [`SKIRT`].
pub const BARK: u8 = 2;

/// Crown width over height that a shape's card pictures are made for.
pub const WIDTHS: [f32; SHAPES] = [0.25, 0.30, 0.45, 0.60, 0.20, 1.2];

/// A corner of a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// In the model frame.
    pub position: Vec3,
    /// Unit, out of the crown.
    pub normal: Vec3,
    /// Place in the leaf picture, 0..=1.
    pub uv: Vec2,
    /// Which leaf picture.
    pub leaf: u8,
    /// 1 outside in the light, less within the crown.
    pub open: f32,
}

/// A plant's faces.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Model {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Triangles, counter-clockwise from outside.
    pub indices: Vec<u16>,
}

/// The model of a shape.
pub fn model(shape: Shape) -> Model {
    let mut model = Model::default();
    match shape {
        Shape::Spire => model.whorls(shape as i32, 8, 0.06, 1.35),
        Shape::Conifer => model.whorls(shape as i32, 7, 0.04, 1.0),
        Shape::Pine => {
            model.trunk(0.62, 0.045);
            model.crown(shape as i32, Vec3::new(0.0, 0.74, 0.0), Vec3::new(0.5, 0.26, 0.5), 13, 0.34);
        }
        Shape::Broadleaf => {
            model.trunk(0.45, 0.05);
            model.crown(shape as i32, Vec3::new(0.0, 0.58, 0.0), Vec3::new(0.5, 0.42, 0.5), 16, 0.36);
        }
        Shape::Poplar => {
            model.trunk(0.25, 0.09);
            model.crown(shape as i32, Vec3::new(0.0, 0.54, 0.0), Vec3::new(0.5, 0.46, 0.5), 18, 0.36);
        }
        Shape::Bush => model.crown(shape as i32, Vec3::new(0.0, 0.38, 0.0), Vec3::new(0.5, 0.55, 0.5), 9, 0.42),
    }
    model
}

impl Model {
    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }

    fn quad(&mut self, corners: [Vertex; 4]) {
        let first = self.vertices.len() as u16;
        self.vertices.extend(corners);
        self.indices.extend([0, 1, 2, 2, 1, 3].map(|i| first + i));
    }

    /// A three-sided trunk.
    fn trunk(&mut self, top: f32, half_width: f32) {
        let ring = |at: i32| {
            let (sin, cos) = (TAU * at as f32 / 3.0).sin_cos();
            Vec3::new(cos, 0.0, sin)
        };
        for side in 0..3 {
            let corner = |at: i32, y: f32, half: f32| Vertex {
                position: ring(at) * half + Vec3::Y * y,
                normal: ring(at),
                uv: Vec2::new((at - side) as f32, 1.0 - y),
                leaf: BARK,
                open: 0.8,
            };
            self.quad([
                corner(side, 0.0, half_width),
                corner(side + 1, 0.0, half_width),
                corner(side, top, half_width * 0.5),
                corner(side + 1, top, half_width * 0.5),
            ]);
        }
    }

    /// Skirts of branches from the foot to the tip; `slender` above 1 keeps the crown narrow far down.
    fn whorls(&mut self, seed: i32, whorls: i32, lowest: f32, slender: f32) {
        const SIDES: i32 = 6;
        self.trunk(0.3, 0.06);
        for whorl in 0..whorls {
            let place = |w: f32| lowest + (1.0 - lowest) * (w / whorls as f32);
            let [turn, swell, _] = uniforms(seed, whorl, 11);
            let (bottom, top) = (place(whorl as f32), (place(whorl as f32 + 1.0) + 0.09).min(1.0));
            let radius = |y: f32| 0.5 * (1.0 - y).powf(1.0 / slender) * (0.9 + 0.2 * swell);
            let outer = radius(bottom).max(0.05);
            let inner = if whorl == whorls - 1 { 0.0 } else { 0.25 * radius(top) };
            let corner = |side: i32, v: f32| {
                let [jitter, droop, _] = uniforms(seed * 64 + whorl, side.rem_euclid(SIDES), 12);
                let angle = TAU * (side as f32 + turn + 0.35 * (jitter - 0.5)) / SIDES as f32;
                let out = Vec3::new(angle.cos(), 0.0, angle.sin());
                let far = if v > 0.5 { outer * (0.80 + 0.2 * jitter) } else { inner };
                let y = if v > 0.5 { bottom - 0.035 * (droop - 0.3) } else { top };
                Vertex {
                    position: out * far.min(0.5) + Vec3::Y * y.clamp(0.0, 1.0),
                    normal: (out + Vec3::Y * if v > 0.5 { 0.35 } else { 0.9 }).normalize(),
                    uv: Vec2::new(side.rem_euclid(2) as f32, v),
                    leaf: SKIRT,
                    // Low branches are in the shade of the crown above.
                    open: (if v > 0.5 { 1.0 } else { 0.55 }) * (0.6 + 0.4 * y),
                }
            };
            // An even number of sides and a picture that is mirrored from side to side: neighbours share corners.
            let first = self.vertices.len() as u16;
            self.vertices.extend((0..SIDES).flat_map(|side| [corner(side, 0.0), corner(side, 1.0)]));
            for side in 0..SIDES as u16 {
                let next = (side + 1) % SIDES as u16;
                let corners = [2 * side, 2 * next, 2 * side + 1, 2 * next + 1].map(|corner| first + corner);
                self.indices.extend([0, 1, 2, 2, 1, 3].map(|i: usize| corners[i]));
            }
        }
    }

    /// Clumps spread evenly over an ellipsoid, each two crossed faces.
    fn crown(&mut self, seed: i32, centre: Vec3, radii: Vec3, clumps: i32, half: f32) {
        for clump in 0..clumps {
            let [a, b, c] = uniforms(seed, clump, 13);
            // Fibonacci's spiral: even over the sphere.
            let y = 1.0 - (2.0 * clump as f32 + 1.0) / clumps as f32;
            let angle = clump as f32 * 2.399_963 + 0.6 * a;
            let flat = (1.0 - y * y).max(0.0).sqrt();
            let out = Vec3::new(flat * angle.cos(), y, flat * angle.sin());
            let middle = centre + out * radii * (1.0 - half) * (0.85 + 0.3 * b).min(1.0);
            let side = Vec3::new(-angle.sin(), 0.0, angle.cos());
            let tilt = (out * Vec3::new(0.35, 0.0, 0.35) + Vec3::Y * 0.94).normalize();
            for face in 0..2 {
                let (u, v) = if face == 0 { (side, tilt) } else { ((out + side * (c - 0.5)).normalize(), tilt) };
                let corner = |s: f32, t: f32| {
                    let position = middle + (u * s + v * t) * radii * half * 1.45;
                    let normal = ((position - centre) / radii + Vec3::Y * 0.25).normalize_or(Vec3::Y);
                    let deep = ((position - centre) / radii).length().min(1.0);
                    Vertex {
                        position: position.clamp(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5)),
                        normal,
                        uv: Vec2::new(0.5 + 0.5 * s, 0.5 - 0.5 * t),
                        leaf: CLUMP,
                        open: (0.45 + 0.55 * deep) * (0.75 + 0.25 * out.y),
                    }
                };
                let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)];
                self.quad(corners);
                if face == 1 {
                    // It has no outside.
                    self.quad([corners[1], corners[0], corners[3], corners[2]]);
                }
            }
        }
    }
}

/// All shapes, by number.
pub const ALL: [Shape; SHAPES] =
    [Shape::Spire, Shape::Conifer, Shape::Pine, Shape::Broadleaf, Shape::Poplar, Shape::Bush];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_fit_their_box_and_are_light() {
        for (number, shape) in ALL.into_iter().enumerate() {
            assert_eq!(shape as usize, number);
            let model = model(shape);
            assert!((18..=130).contains(&model.triangles()), "{shape:?}: {} triangles", model.triangles());
            assert!(model.indices.iter().all(|i| usize::from(*i) < model.vertices.len()));
            for vertex in &model.vertices {
                let p = vertex.position;
                assert!(p.x.abs() <= 0.501 && p.z.abs() <= 0.501 && (-0.001..=1.001).contains(&p.y), "{shape:?}: {p}");
                assert!((vertex.normal.length() - 1.0).abs() < 1e-4 && (0.0..=1.001).contains(&vertex.open));
            }
            let top = model.vertices.iter().map(|v| v.position.y).fold(0.0, f32::max);
            assert!(top > 0.85, "{shape:?} reaches {top}");
        }
    }
}
