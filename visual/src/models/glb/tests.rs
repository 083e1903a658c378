//! Shapes of a kit, and files made to break a reader.

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
        let (low, high) = fitted(mesh, Fit::LengthM(12.0)).bounds_m();
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

/// A triangle before z = 0, its colour from a picture that is not there.
const TRIANGLE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0,"TEXCOORD_0":2},"indices":1,"material":0}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,1]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6},
{"buffer":0,"byteOffset":44,"byteLength":24}],"buffers":[{"byteLength":68}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
"images":[{"uri":"colours.png"}]}"#;

fn corners(at: [[f32; 3]; 3]) -> Vec<u8> {
    let mut bytes: Vec<u8> = at.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    bytes.extend([0; 24]);
    bytes
}

fn flat() -> Vec<u8> {
    corners([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
}

/// A file of a description and its buffer.
fn file(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut buffer = buffer.to_vec();
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let number = |value: usize| (value as u32).to_le_bytes();
    let mut bytes = b"glTF".to_vec();
    for word in [number(2), number(28 + json.len() + buffer.len()), number(json.len())] {
        bytes.extend(word);
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend(number(buffer.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

/// What is said of a description in which one thing is another.
fn refused(was: &str, is: &str) -> String {
    assert!(TRIANGLE.contains(was), "{was}");
    let read = from_glb(&file(&TRIANGLE.replacen(was, is, 1), &flat()), |_| None);
    read.expect_err(is).to_string()
}

#[test]
fn a_triangle_is_read() {
    let mesh = from_glb(&file(TRIANGLE, &flat()), |_| None).unwrap();
    assert_eq!((mesh.vertices.len(), mesh.indices.len()), (3, 3));
}

#[test]
fn elements_of_another_type_than_their_use_are_refused() {
    for component in [5120, 5122] {
        let said = refused(r#""componentType":5123"#, &format!(r#""componentType":{component}"#));
        assert!(said.starts_with("expected Scalar of [U8, U16, U32], found Scalar of"), "{said}");
    }
    for component in [5120, 5122, 5125] {
        let said = refused(r#"5126,"count":3,"type":"VEC2""#, &format!(r#"{component},"count":3,"type":"VEC2""#));
        assert!(said.starts_with("expected Vec2 of [U8, U16, F32], found Vec2 of"), "{said}");
    }
    for (was, is) in [(r#""VEC3""#, r#""VEC2""#), (r#""VEC2""#, r#""SCALAR""#), (r#""SCALAR""#, r#""VEC2""#)] {
        let said = refused(was, is);
        assert!(said.starts_with("expected "), "{said}");
    }
}

#[test]
fn strides_and_counts_without_sense_are_refused() {
    let said = refused(r#""byteLength":36"#, r#""byteLength":36,"byteStride":4"#);
    assert!(said.contains("a stride of 12 bytes or more, found 4 in accessor 0"), "{said}");
    let said = refused(r#""count":3,"type":"VEC3""#, r#""count":0,"type":"VEC3""#);
    assert!(said.contains("0 in accessor 0"), "{said}");
    let said = refused(r#""count":3,"type":"SCALAR""#, r#""count":0,"type":"SCALAR""#);
    assert!(said.contains("0 in accessor 1"), "{said}");
    refused(r#""count":3,"type":"SCALAR""#, r#""count":4,"type":"SCALAR""#);
}

#[test]
fn a_mesh_named_by_many_nodes_is_read_within_bounds() {
    // 40,000 corners, of which a triangle uses three: few in the shape, many to read.
    let bytes = 40_000 * 12;
    let wide = TRIANGLE
        .replace(r#""count":3,"type":"VEC3""#, r#""count":40000,"type":"VEC3""#)
        .replace(r#""byteLength":36}"#, &format!(r#""byteLength":{bytes}}}"#))
        .replace(r#""byteOffset":36"#, &format!(r#""byteOffset":{bytes}"#))
        .replace(r#""byteOffset":44"#, &format!(r#""byteOffset":{}"#, bytes + 8))
        .replace(r#""byteLength":68"#, &format!(r#""byteLength":{}"#, bytes + 32));
    let mut buffer = flat()[..36].to_vec();
    buffer.resize(bytes, 0);
    buffer.extend(&flat()[36..]);
    let nodes = |count: usize| {
        let numbers: Vec<String> = (0..count).map(|number| number.to_string()).collect();
        wide.replace(r#"[{"nodes":[0]}]"#, &format!(r#"[{{"nodes":[{}]}}]"#, numbers.join(",")))
            .replace(r#""nodes":[{"mesh":0}]"#, &format!(r#""nodes":[{}]"#, vec![r#"{"mesh":0}"#; count].join(",")))
    };
    assert_eq!(from_glb(&file(&nodes(99), &buffer), |_| None).unwrap().indices.len(), 3 * 99);
    let said = from_glb(&file(&nodes(100), &buffer), |_| None).unwrap_err();
    assert_eq!(said.expected, format!("at most {MAX_READ} corners and indices in all nodes"));
}

#[test]
fn pictures_are_few_and_small() {
    let picture = |width, height| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        RgbaImage::from_pixel(width, height, image::Rgba([255, 0, 0, 255]))
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        bytes.into_inner()
    };
    let read = |width, height| from_glb(&file(TRIANGLE, &flat()), |_| Some(picture(width, height)));
    assert_eq!(read(2_048, 1).unwrap().vertices[0].colour, [255, 0, 0, 0]);
    let said = read(1, 2_049).unwrap_err();
    assert_eq!((said.expected, said.found), ("a picture of at most 2048 x 2048 pixels".into(), "1 x 2049".into()));

    let many = |count: usize| {
        let each = |text: &dyn Fn(usize) -> String| (0..count).map(text).collect::<Vec<_>>().join(",");
        let material = each(&|n| format!(r#"{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":{n}}}}}}}"#));
        let (texture, image) = (each(&|n| format!(r#"{{"source":{n}}}"#)), each(&|n| format!(r#"{{"uri":"{n}"}}"#)));
        TRIANGLE
            .replace(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#, &material)
            .replace(r#"{"source":0}"#, &texture)
            .replace(r#"{"uri":"colours.png"}"#, &image)
    };
    let read = |count| from_glb(&file(&many(count), &flat()), |_| Some(picture(1, 1)));
    assert!(read(pictures::MAX_PICTURES).is_ok());
    assert_eq!(read(pictures::MAX_PICTURES + 1).unwrap_err().found, "17");
}

/// Normal of a triangle by its corners' order, and the one that it has.
fn normals(mesh: &Mesh) -> [Vec3; 2] {
    let at = [0, 1, 2].map(|n| Vec3::from(mesh.vertices[mesh.indices[n] as usize].position_m));
    let [x, y, z, _] = mesh.vertices[0].normal.map(f32::from);
    [(at[1] - at[0]).cross(at[2] - at[0]).normalize(), Vec3::new(x, y, z) / 127.0]
}

#[test]
fn mirrored_and_stretched_nodes_look_outward() {
    let plain = TRIANGLE.replace(r#""NORMAL":0,"#, "");
    for (scale, outward) in [([1.0, 1.0, 1.0], 1.0), ([-2.0, 1.0, 1.0], 1.0), ([1.0, 1.0, -1.0], -1.0)] {
        let node = format!(r#""nodes":[{{"mesh":0,"scale":{scale:?}}}]"#);
        let mesh = from_glb(&file(&plain.replace(r#""nodes":[{"mesh":0}]"#, &node), &flat()), |_| None).unwrap();
        assert_eq!(normals(&mesh), [Vec3::Z * outward; 2], "{scale:?}");
    }
    // Corners that are their own normals: a face across (1, 1, 1).
    let ball = corners([[1.0, 0.6, 0.6], [0.6, 1.0, 0.6], [0.6, 0.6, 1.0]]);
    for scale in [[1.0, 4.0, 1.0], [-1.0, 4.0, 1.0], [0.2, 1.0, 3.0]] {
        let node = format!(r#""nodes":[{{"mesh":0,"scale":{scale:?}}}]"#);
        let mesh = from_glb(&file(&TRIANGLE.replace(r#""nodes":[{"mesh":0}]"#, &node), &ball), |_| None).unwrap();
        let mean: Vec3 =
            mesh.vertices.iter().map(|v| Vec3::new(v.normal[0].into(), v.normal[1].into(), v.normal[2].into())).sum();
        let [face, _] = normals(&mesh);
        // The three corners' normals lie evenly around the face's; stretched up to 15-fold only nearly.
        assert!(face.dot(mean.normalize()) > 0.97, "{scale:?}: {face} {mean}");
    }
}

#[test]
fn corners_out_of_this_world_are_refused() {
    for far in [1.1e6, f32::INFINITY, f32::NAN] {
        let said = from_glb(&file(TRIANGLE, &corners([[far, 0.0, 0.0], [1.0; 3], [0.0; 3]])), |_| None).unwrap_err();
        assert_eq!(said.expected, "positions within 1000000 m");
    }
}
