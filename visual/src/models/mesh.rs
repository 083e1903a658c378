//! A triangle list and the few ways to add faces to it.

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// A corner of a face; mirror of the vertex inputs of `shaders/objects.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// Metres.
    pub position_m: [f32; 3],
    /// Unit normal, -127..=127; the last is unused.
    pub normal: [i8; 4],
    /// Square root of the albedo; the last is what it is made of, see [`Paint`].
    pub colour: [u8; 4],
    /// Windows along the wall and storeys above its foot.
    pub facade: [f32; 2],
    /// Low 8 bits: size of the whole thing by [`size_code`]; the rest a hash that its windows are lit by.
    pub seed: u32,
}

/// What a face is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Albedo, linear.
    pub albedo: Vec3,
    /// 0 matt, 1 a wall with windows of homes, 2 with bands of office windows, 3 glass, 4 a light that is on at night.
    pub kind: u8,
}

/// Triangles; indices count from the first vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Three for each triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// What the next vertices carry.
    pub seed: u32,
}

impl Paint {
    /// A matt colour.
    pub const fn matt(red: f32, green: f32, blue: f32) -> Self {
        Self { albedo: Vec3::new(red, green, blue), kind: 0 }
    }

    /// The same as another kind of material.
    pub const fn of_kind(self, kind: u8) -> Self {
        Self { kind, ..self }
    }

    /// Brighter or darker.
    pub fn shaded(self, by: f32) -> Self {
        Self { albedo: self.albedo * by, ..self }
    }

    fn bytes(self) -> [u8; 4] {
        let root = |albedo: f32| (albedo.clamp(0.0, 1.0).sqrt() * 255.0).round() as u8;
        [root(self.albedo.x), root(self.albedo.y), root(self.albedo.z), self.kind]
    }
}

/// The size of a thing in eight bits: 16 steps an octave from 1 m, so at most 4.4 % too large.
pub fn size_code(size_m: f32) -> u32 {
    (16.0 * size_m.max(1.0).log2()).ceil().clamp(0.0, 255.0) as u32
}

impl Mesh {
    /// Adds a flat convex polygon, counter-clockwise seen from outside, with facade coordinates for each corner.
    pub fn facade(&mut self, corners: &[Vec3], facade: &[Vec2], paint: Paint) {
        let normal = normal(corners);
        self.face_with_normal(corners, facade, normal, paint);
    }

    /// Adds a flat convex polygon, counter-clockwise seen from outside.
    pub fn face(&mut self, corners: &[Vec3], paint: Paint) {
        self.face_with_normal(corners, &[], normal(corners), paint);
    }

    /// Adds a triangle list that lies in one plane.
    pub fn triangles(&mut self, corners: &[Vec3], indices: &[u32], normal: Vec3, paint: Paint) {
        let first = self.vertices.len() as u32;
        for at in corners {
            self.vertices.push(self.vertex(*at, Vec2::ZERO, normal, paint));
        }
        self.indices.extend(indices.iter().map(|index| first + index));
    }

    fn vertex(&self, at: Vec3, facade: Vec2, normal: Vec3, paint: Paint) -> Vertex {
        let n = normal * 127.0;
        let normal = [n.x.round() as i8, n.y.round() as i8, n.z.round() as i8, 0];
        let facade = facade.to_array();
        Vertex { position_m: at.to_array(), normal, colour: paint.bytes(), facade, seed: self.seed }
    }

    fn face_with_normal(&mut self, corners: &[Vec3], facade: &[Vec2], normal: Vec3, paint: Paint) {
        if corners.len() < 3 {
            return;
        }
        let first = self.vertices.len() as u32;
        for (number, at) in corners.iter().enumerate() {
            let facade = facade.get(number).copied().unwrap_or_default();
            self.vertices.push(self.vertex(*at, facade, normal, paint));
        }
        for last in 2..corners.len() as u32 {
            self.indices.extend([first, first + last - 1, first + last]);
        }
    }

    /// Adds a box without its bottom.
    pub fn cuboid(&mut self, low: Vec3, high: Vec3, sides: Paint, top: Paint) {
        let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
        let (l, h) = (low, high);
        self.face(&[at(l.x, h.y, l.z), at(l.x, h.y, h.z), at(h.x, h.y, h.z), at(h.x, h.y, l.z)], top);
        self.face(&[at(l.x, l.y, h.z), at(h.x, l.y, h.z), at(h.x, h.y, h.z), at(l.x, h.y, h.z)], sides);
        self.face(&[at(h.x, l.y, l.z), at(l.x, l.y, l.z), at(l.x, h.y, l.z), at(h.x, h.y, l.z)], sides);
        self.face(&[at(h.x, l.y, h.z), at(h.x, l.y, l.z), at(h.x, h.y, l.z), at(h.x, h.y, h.z)], sides);
        self.face(&[at(l.x, l.y, l.z), at(l.x, l.y, h.z), at(l.x, h.y, h.z), at(l.x, h.y, l.z)], sides);
    }

    /// Adds the sides of a box with windows: so many along the x sides, the z sides and so many storeys.
    pub fn windowed(&mut self, low: Vec3, high: Vec3, windows: Vec3, walls: Paint) {
        let (l, h) = (low, high);
        let ring = [Vec2::new(l.x, h.z), Vec2::new(h.x, h.z), Vec2::new(h.x, l.z), Vec2::new(l.x, l.z)];
        for side in 0..4 {
            let (a, b) = (ring[side], ring[(side + 1) % 4]);
            let along = if side % 2 == 0 { windows.x } else { windows.z };
            let corners = [
                Vec3::new(a.x, l.y, a.y),
                Vec3::new(b.x, l.y, b.y),
                Vec3::new(b.x, h.y, b.y),
                Vec3::new(a.x, h.y, a.y),
            ];
            let facade = [Vec2::ZERO, Vec2::new(along, 0.0), Vec2::new(along, windows.y), Vec2::new(0.0, windows.y)];
            self.facade(&corners, &facade, walls);
        }
    }

    /// Adds rings joined to a skin, closed at both ends: cross sections of a hull, a fuselage, a tank. Each ring has as
    /// many points in the same order; which way round does not matter.
    pub fn loft(&mut self, rings: &[Vec<Vec3>], paint: Paint) {
        let (Some(first), Some(last)) = (rings.first(), rings.last()) else { return };
        let mut faces = vec![first.iter().rev().copied().collect::<Vec<_>>(), last.clone()];
        for pair in rings.windows(2) {
            let count = pair[0].len().min(pair[1].len());
            for at in 0..count {
                let next = (at + 1) % count;
                faces.push(vec![pair[0][at], pair[0][next], pair[1][next], pair[1][at]]);
            }
        }
        // A closed skin that looks inward encloses a negative volume.
        let from = first.first().copied().unwrap_or_default();
        let volume = |face: &Vec<Vec3>| -> f32 {
            face.windows(2).skip(1).map(|pair| (face[0] - from).dot((pair[0] - from).cross(pair[1] - from))).sum()
        };
        let inward = faces.iter().map(volume).sum::<f32>() < 0.0;
        for face in &mut faces {
            if inward {
                face.reverse();
            }
            self.face(face, paint);
        }
    }

    /// Adds an upright cylinder or cone.
    pub fn column(&mut self, foot: Vec3, height_m: f32, radius_m: [f32; 2], sides: u32, paint: Paint) {
        let ring = |radius_m: f32, up_m: f32| {
            (0..sides)
                .map(|side| {
                    // Clockwise on a map is counter-clockwise seen from above in x and z.
                    let (sin, cos) = (-std::f32::consts::TAU * side as f32 / sides as f32).sin_cos();
                    foot + Vec3::new(radius_m * cos, up_m, radius_m * sin)
                })
                .collect::<Vec<_>>()
        };
        self.loft(&[ring(radius_m[0], 0.0), ring(radius_m[1], height_m)], paint);
    }

    /// Gives the whole mesh a size and a hash.
    pub fn seal(&mut self, size_m: f32, hash: u32) {
        let seed = (hash << 8) | size_code(size_m);
        self.vertices.iter_mut().for_each(|vertex| vertex.seed = seed);
    }

    /// Least and greatest corner; zero without vertices.
    pub fn bounds_m(&self) -> (Vec3, Vec3) {
        let mut points = self.vertices.iter().map(|vertex| Vec3::from(vertex.position_m));
        let Some(first) = points.next() else { return (Vec3::ZERO, Vec3::ZERO) };
        points.fold((first, first), |(low, high), at| (low.min(at), high.max(at)))
    }
}

/// Newell's normal of a polygon: right for corners that lie in one plane or nearly.
fn normal(corners: &[Vec3]) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (at, a) in corners.iter().enumerate() {
        let b = corners[(at + 1) % corners.len()];
        // About the first corner, so that absolute heights do not round it away.
        sum += (*a - corners[0]).cross(b - corners[0]);
    }
    sum.try_normalize().unwrap_or(Vec3::Y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_of_boxes_and_columns_look_outward() {
        let grey = Paint::matt(0.5, 0.5, 0.5);
        let mut cuboid = Mesh::default();
        cuboid.cuboid(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 3.0, 2.0), grey, grey);
        cuboid.windowed(Vec3::new(-1.0, 0.0, -2.0), Vec3::new(1.0, 3.0, 2.0), Vec3::ONE, grey);
        let mut column = Mesh::default();
        column.column(Vec3::ZERO, 5.0, [1.0, 0.5], 8, grey);
        for mesh in [cuboid, column] {
            let (low, high) = mesh.bounds_m();
            let middle = 0.5 * (low + high);
            for triangle in mesh.indices.chunks_exact(3) {
                let at = [0, 1, 2].map(|n| Vec3::from(mesh.vertices[triangle[n] as usize].position_m));
                let normal = (at[1] - at[0]).cross(at[2] - at[0]);
                assert!(normal.dot(at[0] - middle) > 0.0, "{at:?}");
                let stored = mesh.vertices[triangle[0] as usize].normal.map(f32::from);
                assert!(normal.normalize().dot(Vec3::new(stored[0], stored[1], stored[2]) / 127.0) > 0.98);
            }
        }
    }

    #[test]
    fn sizes_are_rounded_up_by_less_than_a_twentieth() {
        for size_m in [1.0, 2.7, 10.0, 333.0, 9_000.0] {
            let decoded = (size_code(size_m) as f32 / 16.0).exp2();
            assert!(decoded >= size_m * 0.999 && decoded < size_m * 1.05, "{size_m} {decoded}");
        }
    }
}
