//! A shape from a binary glTF 2.0 file: triangles, flat normals or its own, colours baked into the corners.
//!
//! Colour of a corner: base colour factor times the base colour texture at its coordinates. Textures are read from the file
//! or, by name, through the caller: what a file names is never opened here. Materials' other properties, skins and
//! animations are left out. Everything is bounded before it is believed ([`check`]). Source: Khronos glTF 2.0 specification.

mod check;
mod pictures;

use super::mesh::{Mesh, Paint};
use glam::{Mat3, Mat4, Vec2, Vec3};
use image::RgbaImage;
use std::collections::BTreeMap;
use std::fmt;

/// Largest file read.
pub const MAX_BYTES: usize = 64 << 20;
/// Most corners of a shape.
pub const MAX_CORNERS: usize = 1_000_000;
/// Most corners and indices that all nodes together may read.
pub const MAX_READ: usize = 4 * MAX_CORNERS;
/// Farthest corner from the middle, units of the file: metres.
pub const MAX_M: f32 = 1e6;
/// Most nodes, and how deep they may nest.
const MAX_NODES: usize = 10_000;
const MAX_DEPTH: u32 = 32;

/// Why there is no shape in a file.
#[derive(Debug, Clone, PartialEq)]
pub struct GlbError {
    /// What should have been there.
    pub expected: String,
    /// What was there.
    pub found: String,
}

impl fmt::Display for GlbError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

impl std::error::Error for GlbError {}

fn wrong(expected: &str, found: impl fmt::Display) -> GlbError {
    GlbError { expected: expected.into(), found: found.to_string() }
}

/// The shape in a file's bytes; `texture` gives the bytes of a picture that the file names beside itself.
///
/// # Errors
/// [`GlbError`] says what was expected and what was found.
pub fn from_glb(bytes: &[u8], texture: impl Fn(&str) -> Option<Vec<u8>>) -> Result<Mesh, GlbError> {
    if bytes.len() > MAX_BYTES {
        return Err(wrong(&format!("at most {MAX_BYTES} bytes"), bytes.len()));
    }
    if !bytes.starts_with(b"glTF") {
        return Err(wrong("a binary glTF file", "another"));
    }
    let file = gltf::Gltf::from_slice(bytes).map_err(|error| wrong("a binary glTF 2.0 file", error))?;
    let blob = file.blob.as_deref().unwrap_or_default();
    check::layout(&file, blob)?;
    if file.nodes().len() > MAX_NODES {
        return Err(wrong(&format!("at most {MAX_NODES} nodes"), file.nodes().len()));
    }
    let pictures = pictures::of(&file, blob, &texture)?;
    let mut reading = Reading { blob, pictures, mesh: Mesh::default(), visited: 0, read: 0 };
    let scene = file.default_scene().or_else(|| file.scenes().next());
    let scene = scene.ok_or_else(|| wrong("a scene", "none"))?;
    for node in scene.nodes() {
        reading.node(&node, Mat4::IDENTITY, 0)?;
    }
    if reading.mesh.indices.is_empty() { Err(wrong("triangles", "none")) } else { Ok(reading.mesh) }
}

struct Reading<'a> {
    blob: &'a [u8],
    /// By their numbers in the file.
    pictures: BTreeMap<usize, RgbaImage>,
    mesh: Mesh,
    visited: usize,
    /// Corners and indices so far.
    read: usize,
}

impl Reading<'_> {
    fn node(&mut self, node: &gltf::Node<'_>, above: Mat4, depth: u32) -> Result<(), GlbError> {
        self.visited += 1;
        if depth > MAX_DEPTH || self.visited > MAX_NODES {
            return Err(wrong("a tree of nodes", "a loop, or one too deep"));
        }
        let turn = above * Mat4::from_cols_array_2d(&node.transform().matrix());
        if let Some(mesh) = node.mesh() {
            for primitive in mesh.primitives() {
                self.primitive(&primitive, turn)?;
            }
        }
        node.children().try_for_each(|child| self.node(&child, turn, depth + 1))
    }

    fn primitive(&mut self, primitive: &gltf::Primitive<'_>, turn: Mat4) -> Result<(), GlbError> {
        if primitive.mode() != gltf::mesh::Mode::Triangles {
            return Ok(());
        }
        // Counted before they are read: a file of a few bytes may name one mesh from every node.
        let corners = primitive.get(&gltf::Semantic::Positions).map_or(0, |positions| positions.count());
        self.read += corners + primitive.indices().map_or(corners, |indices| indices.count());
        if self.read > MAX_READ {
            return Err(wrong(&format!("at most {MAX_READ} corners and indices in all nodes"), self.read));
        }
        let blob = self.blob;
        let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(blob));
        let positions = reader.read_positions().ok_or_else(|| wrong("positions", "none"))?;
        let positions: Vec<Vec3> = positions.map(|at| turn.transform_point3(Vec3::from(at))).collect();
        if let Some(far) = positions.iter().find(|at| !at.is_finite() || at.abs().max_element() > MAX_M) {
            return Err(wrong(&format!("positions within {MAX_M} m"), far));
        }
        let linear = Mat3::from_mat4(turn);
        // Normals stand upright on faces however a node stretches them; of a flattened node there are none.
        let upright = linear.inverse().transpose();
        let mirrored = linear.determinant() < 0.0;
        let normals: Vec<Vec3> = reader
            .read_normals()
            .map(|normals| normals.map(|n| (upright * Vec3::from(n)).normalize_or_zero()).collect())
            .unwrap_or_default();
        let material = primitive.material();
        let colour = material.pbr_metallic_roughness();
        let factor = Vec3::from_slice(&colour.base_color_factor()[..3]);
        let set = colour.base_color_texture();
        let places: Vec<Vec2> = set
            .as_ref()
            .and_then(|set| reader.read_tex_coords(set.tex_coord()))
            .map(|places| places.into_f32().map(Vec2::from).collect())
            .unwrap_or_default();
        let picture = set.and_then(|set| self.pictures.get(&set.texture().source().index()));
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        if self.mesh.vertices.len() + indices.len() > MAX_CORNERS {
            return Err(wrong(&format!("at most {MAX_CORNERS} corners"), "more"));
        }
        let mut corners = Vec::new();
        for triangle in indices.chunks_exact(3) {
            // A mirror turns outsides in: the other way around they look outward again.
            let triangle = if mirrored { [0, 2, 1] } else { [0, 1, 2] }.map(|n: usize| triangle[n]);
            let [Some(a), Some(b), Some(c)] = triangle.map(|index| positions.get(index as usize).copied()) else {
                return Err(wrong("indices of positions", format_args!("{triangle:?}")));
            };
            let flat = (b - a).cross(c - a).normalize_or(Vec3::Y);
            for (index, at) in triangle.iter().zip([a, b, c]) {
                let normal = normals.get(*index as usize).copied().filter(|n| n.is_finite() && *n != Vec3::ZERO);
                let tint = match (picture, places.get(*index as usize)) {
                    (Some(picture), Some(place)) => sampled(picture, *place),
                    _ => Vec3::ONE,
                };
                let albedo = (factor * tint).clamp(Vec3::ZERO, Vec3::ONE);
                corners.push((at, normal.unwrap_or(flat), Paint { albedo, kind: 0 }));
            }
        }
        for (at, normal, paint) in corners {
            let index = self.mesh.vertices.len() as u32;
            self.mesh.triangles(&[at], &[0], normal, paint);
            debug_assert_eq!(self.mesh.indices.last(), Some(&index));
        }
        Ok(())
    }
}

/// Linear colour of a texture's nearest texel; coordinates repeat.
fn sampled(picture: &RgbaImage, place: Vec2) -> Vec3 {
    let texel = |at: f32, side: u32| ((at.rem_euclid(1.0) * side as f32) as u32).min(side - 1);
    if picture.width() == 0 || picture.height() == 0 || !place.is_finite() {
        return Vec3::ONE;
    }
    let [red, green, blue, _] = picture.get_pixel(texel(place.x, picture.width()), texel(place.y, picture.height())).0;
    // IEC 61966-2-1.
    let linear = |value: u8| {
        let v = f32::from(value) / 255.0;
        if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(linear(red), linear(green), linear(blue))
}

/// What of a shape is made as long as it really is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fit {
    /// Its longer side in plan, metres.
    LengthM(f32),
    /// Its height, metres.
    HeightM(f32),
}

/// Scales and moves a shape so that it stands on its middle and is as large as asked.
pub fn fitted(mut mesh: Mesh, fit: Fit) -> Mesh {
    let (low, high) = mesh.bounds_m();
    let size = high - low;
    let (is, asked) = match fit {
        Fit::LengthM(length_m) => (size.x.max(size.z), length_m),
        Fit::HeightM(height_m) => (size.y, height_m),
    };
    let scale = if is > 1e-6 && asked.is_finite() { asked / is } else { 1.0 };
    let foot = Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    for vertex in &mut mesh.vertices {
        vertex.position_m = ((Vec3::from(vertex.position_m) - foot) * scale).to_array();
    }
    mesh
}

#[cfg(test)]
mod tests;
