//! A shape from a binary glTF 2.0 file: triangles, flat normals or its own, colours baked into the corners.
//!
//! Colour of a corner: base colour factor times the base colour texture at its coordinates. Textures are read from the file
//! or, by name, through the caller: what a file names is never opened here. Materials' other properties, skins and
//! animations are left out. Everything is bounded before it is believed. Source: Khronos glTF 2.0 specification.

use super::mesh::{Mesh, Paint};
use glam::{Mat4, Vec2, Vec3};
use image::RgbaImage;
use std::fmt;

/// Largest file read.
pub const MAX_BYTES: usize = 64 << 20;
/// Most corners of a shape.
pub const MAX_CORNERS: usize = 1_000_000;
/// Most nodes, and how deep they may nest.
const MAX_NODES: usize = 10_000;
const MAX_DEPTH: u32 = 32;
/// Largest side of a texture, pixels.
const MAX_TEXTURE_PX: u32 = 8_192;

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
    for view in file.views() {
        let end = view.offset().checked_add(view.length());
        if !matches!(view.buffer().source(), gltf::buffer::Source::Bin) || end.is_none_or(|end| end > blob.len()) {
            return Err(wrong("views inside the file's own buffer", format_args!("view {} beyond it", view.index())));
        }
    }
    for accessor in file.accessors() {
        check(&accessor)?;
    }
    if file.nodes().len() > MAX_NODES {
        return Err(wrong(&format!("at most {MAX_NODES} nodes"), file.nodes().len()));
    }
    let mut reading = Reading { blob, textures: textures(&file, blob, &texture)?, mesh: Mesh::default(), visited: 0 };
    let scene = file.default_scene().or_else(|| file.scenes().next());
    let scene = scene.ok_or_else(|| wrong("a scene", "none"))?;
    for node in scene.nodes() {
        reading.node(&node, Mat4::IDENTITY, 0)?;
    }
    if reading.mesh.indices.is_empty() { Err(wrong("triangles", "none")) } else { Ok(reading.mesh) }
}

/// Whether all of an accessor's elements lie in its view.
fn check(accessor: &gltf::Accessor<'_>) -> Result<(), GlbError> {
    let number = accessor.index();
    if accessor.count() > MAX_CORNERS {
        return Err(wrong(&format!("at most {MAX_CORNERS} elements"), accessor.count()));
    }
    if accessor.sparse().is_some() {
        return Err(wrong("plain accessors", format_args!("accessor {number} is sparse")));
    }
    let view = accessor.view().ok_or_else(|| wrong("accessors with a view", format_args!("{number} without")))?;
    let stride = view.stride().unwrap_or(accessor.size());
    let end = accessor
        .count()
        .saturating_sub(1)
        .checked_mul(stride)
        .and_then(|last| last.checked_add(accessor.offset())?.checked_add(accessor.size()));
    match end {
        Some(end) if accessor.count() == 0 || end <= view.length() => Ok(()),
        _ => Err(wrong(&format!("{} bytes of accessor {number}", view.length()), format_args!("a need of {end:?}"))),
    }
}

fn textures(
    file: &gltf::Gltf,
    blob: &[u8],
    texture: &impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<Vec<Option<RgbaImage>>, GlbError> {
    file.images()
        .map(|picture| {
            let bytes = match picture.source() {
                gltf::image::Source::View { view, .. } => {
                    Some(blob[view.offset()..view.offset() + view.length()].to_vec())
                }
                gltf::image::Source::Uri { uri, .. } => texture(uri),
            };
            // A picture that is not there leaves the factor's colour.
            bytes.map(|bytes| decoded(&bytes)).transpose()
        })
        .collect()
}

fn decoded(bytes: &[u8]) -> Result<RgbaImage, GlbError> {
    let mut reader = image::ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|error| wrong("a PNG texture", error))?;
    let mut limits = image::Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MAX_TEXTURE_PX), Some(MAX_TEXTURE_PX));
    reader.limits(limits);
    reader.decode().map(|picture| picture.into_rgba8()).map_err(|error| wrong("a PNG texture", error))
}

struct Reading<'a> {
    blob: &'a [u8],
    textures: Vec<Option<RgbaImage>>,
    mesh: Mesh,
    visited: usize,
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
        let blob = self.blob;
        let reader = primitive.reader(|buffer| (buffer.index() == 0).then_some(blob));
        let positions = reader.read_positions().ok_or_else(|| wrong("positions", "none"))?;
        let positions: Vec<Vec3> = positions.map(|at| turn.transform_point3(Vec3::from(at))).collect();
        let normals: Vec<Vec3> = reader
            .read_normals()
            .map(|normals| normals.map(|n| turn.transform_vector3(Vec3::from(n)).normalize_or_zero()).collect())
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
        let picture = set.and_then(|set| self.textures.get(set.texture().source().index())?.as_ref());
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        if self.mesh.vertices.len() + indices.len() > MAX_CORNERS {
            return Err(wrong(&format!("at most {MAX_CORNERS} corners"), "more"));
        }
        let mut corners = Vec::new();
        for triangle in indices.chunks_exact(3) {
            let at = [0, 1, 2].map(|n| positions.get(triangle[n] as usize).copied().filter(|at| at.is_finite()));
            let [Some(a), Some(b), Some(c)] = at else {
                return Err(wrong("indices of finite positions", format_args!("{triangle:?}")));
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

/// Scales and moves a shape so that it stands on its middle, as long as a thing really is along its longer side.
pub fn fitted(mut mesh: Mesh, length_m: f32) -> Mesh {
    let (low, high) = mesh.bounds_m();
    let size = high - low;
    let longest = size.x.max(size.z);
    let scale = if longest > 1e-6 && length_m.is_finite() { length_m / longest } else { 1.0 };
    let foot = Vec3::new(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z));
    for vertex in &mut mesh.vertices {
        vertex.position_m = ((Vec3::from(vertex.position_m) - foot) * scale).to_array();
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    const CITY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/terrain/tests/models/kenney_city");

    fn read(name: &str) -> Option<Vec<u8>> {
        std::fs::read(Path::new(CITY).join(name)).ok()
    }

    #[test]
    fn houses_of_a_kit_are_read_with_their_colours() {
        let names = ["building-small-a.glb", "building-garage.glb", "grass-trees.glb", "road-straight.glb"];
        for name in names {
            let Some(bytes) = read(name) else {
                println!("skipped: {CITY}/{name} is not there");
                return;
            };
            let mesh = from_glb(&bytes, read).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(mesh.indices.len() % 3 == 0 && mesh.indices.len() > 30, "{name}");
            let mut colours: Vec<_> = mesh.vertices.iter().map(|vertex| vertex.colour).collect();
            colours.sort_unstable();
            colours.dedup();
            assert!(colours.len() > 2, "{name}: {colours:?}");
            let (low, high) = fitted(mesh, 12.0).bounds_m();
            assert!(((high - low).x.max((high - low).z) - 12.0).abs() < 1e-4 && low.y.abs() < 1e-5);
        }
    }

    #[test]
    fn damaged_files_are_refused_or_read_and_never_panic() {
        let Some(bytes) = read("building-small-a.glb") else {
            println!("skipped: {CITY} is not there");
            return;
        };
        for cut in (0..bytes.len()).step_by(bytes.len() / 60 + 1) {
            assert!(from_glb(&bytes[..cut], |_| None).is_err(), "cut at {cut}");
        }
        let mut seed = 9_u64;
        for _ in 0..300 {
            let mut broken = bytes.clone();
            for _ in 0..4 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let at = (seed >> 33) as usize % broken.len().min(4_000);
                broken[at] = (seed >> 24) as u8;
            }
            let _ = from_glb(&broken, |_| None);
        }
        assert!(from_glb(b"", |_| None).is_err());
        assert_eq!(from_glb(b"PNG", |_| None).unwrap_err().expected, "a binary glTF file");
    }
}
