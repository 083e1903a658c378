//! What a world has of its own to be looked at: photographs of its ground and shapes of things, from outside, end to end.
//!
//! Where there is no Vulkan adapter the pictures are skipped, and that is said.

use image::{ImageFormat, RgbImage};
use serde_json::Value;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use terrain::store::World;

fn poligon(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_poligon"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let output = poligon(folder, &[arguments, &["--json"]].concat());
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {told}");
    serde_json::from_slice(&output.stdout).expect("stdout is one JSON object")
}

/// A folder of this test's own with an SRTM tile of 1,000 m, 42 to 43 N and 7 to 8 E.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("own_look").join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let samples = (0..1201 * 1201).flat_map(|_| 1000_u16.to_be_bytes());
    std::fs::write(folder.join("N42E007.hgt"), samples.collect::<Vec<u8>>()).unwrap();
    folder
}

const BAKE: [&str; 9] = ["bake", "--dem", "N42E007.hgt", "--step", "50", "--centre", "42.5,7.5", "--size-km", "6x6"];

fn bake(folder: &Path, more: &[&str]) -> Value {
    json(folder, &[&BAKE[..], more].concat())
}

/// 400 x 400 pixels over 0.08 degrees about 42.5 N 7.5 E: red in the west, green in the east.
fn photo() -> RgbImage {
    RgbImage::from_fn(400, 400, |x, _| image::Rgb(if x < 200 { [200, 30, 30] } else { [30, 200, 30] }))
}

/// Of its first pixel's middle.
const WORLD_FILE: &str = "0.0002\n0\n0\n-0.0002\n7.4601\n42.5399\n";

fn encoded(format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    photo().write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// The same as an uncompressed GeoTIFF in geographic coordinates on WGS84.
fn geotiff() -> Vec<u8> {
    let pixels = photo().into_raw();
    let mut bytes = b"II*\0".to_vec();
    bytes.extend((8 + pixels.len() as u32).to_le_bytes());
    bytes.extend(&pixels);
    let shorts = |values: &[u16]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let doubles = |values: &[f64]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    // Geographic, pixels are areas, WGS84.
    let keys = shorts(&[1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326]);
    let one = |value: u16| shorts(&[value]);
    let entries: [(u16, u16, Vec<u8>); 12] = [
        (256, 3, one(400)),
        (257, 3, one(400)),
        (258, 3, shorts(&[8, 8, 8])),
        (259, 3, one(1)),
        (262, 3, one(2)),
        (273, 4, 8_u32.to_le_bytes().to_vec()),
        (277, 3, one(3)),
        (278, 3, one(400)),
        (279, 4, (pixels.len() as u32).to_le_bytes().to_vec()),
        (33_550, 12, doubles(&[0.0002, 0.0002, 0.0])),
        (33_922, 12, doubles(&[0.0, 0.0, 0.0, 7.46, 42.54, 0.0])),
        (34_735, 3, keys),
    ];
    let mut beyond = bytes.len() + 2 + 12 * entries.len() + 4;
    let (mut table, mut rest) = ((entries.len() as u16).to_le_bytes().to_vec(), Vec::new());
    for (tag, kind, mut value) in entries {
        let size = match kind {
            3 => 2,
            4 => 4,
            _ => 8,
        };
        table.extend(tag.to_le_bytes());
        table.extend(kind.to_le_bytes());
        table.extend((value.len() as u32 / size).to_le_bytes());
        if value.len() <= 4 {
            value.resize(4, 0);
            table.extend(value);
        } else {
            table.extend((beyond as u32).to_le_bytes());
            beyond += value.len();
            rest.extend(value);
        }
    }
    table.extend([0; 4]);
    bytes.extend(table);
    bytes.extend(rest);
    bytes
}

#[test]
fn photographs_lie_on_the_ground_where_they_belong_and_are_named() {
    let folder = &folder("imagery");
    std::fs::write(folder.join("a.png"), encoded(ImageFormat::Png)).unwrap();
    std::fs::write(folder.join("a.pgw"), WORLD_FILE).unwrap();
    std::fs::write(folder.join("b.jpg"), encoded(ImageFormat::Jpeg)).unwrap();
    std::fs::write(folder.join("b.jgw"), WORLD_FILE).unwrap();
    std::fs::write(folder.join("c.tif"), geotiff()).unwrap();
    for (file, format) in [("a.png", "PNG"), ("b.jpg", "JPEG"), ("c.tif", "GeoTIFF")] {
        let baked = bake(folder, &["--imagery", file, "--out", "photo.world"]);
        let described = &json(folder, &["info", "photo.world"])["imagery"];
        assert_eq!((described, described.as_array().map(Vec::len)), (&baked["imagery"], Some(1)));
        let described = &described[0];
        assert_eq!((described["name"].as_str(), described["size_px"].to_string()), (Some(file), "[400,400]".into()));
        assert!(described["format"].as_str().is_some_and(|found| found.starts_with(format)), "{described}");
        // 0.0002 degrees: 22.2 m along a column, 16.4 m along a row.
        let pixel_m = described["pixel_m"].as_array().unwrap();
        assert!(pixel_m.iter().zip([16.4, 22.2]).all(|(a, b)| (a.as_f64().unwrap() - b).abs() < 0.2), "{described}");

        let world = World::read(&folder.join("photo.world")).unwrap();
        let (grid, imagery) = (*world.field.grid(), world.imagery.as_ref().expect("imagery"));
        let texels = imagery.texels(&grid, terrain::BlockIndex { x: 1, z: 1 }).expect("texels");
        assert_eq!((grid.blocks_x, texels.len()), (4, 64 * 64 * 4));
        // Block 1 ends at the middle: all of it is red but for its last column, of which a half is.
        for texel in texels.as_chunks::<4>().0.iter().enumerate().filter(|(at, _)| at % 64 < 62).map(|(_, texel)| texel)
        {
            assert!(texel[0] > 2 * texel[1] && texel[3] == 255, "{file}: {texel:?}");
        }
    }
    let shot = ["shot", "photo.world", "--eye", "42.5,7.5,1500:agl", "--look", "0,-89", "--out", "down.png"];
    let shot = [&shot[..], &["--size", "320x180", "--time", "2026-06-21T11:30:00Z"]].concat();
    let output = poligon(folder, &shot);
    if String::from_utf8_lossy(&output.stderr).contains("expected a Vulkan adapter") {
        println!("skipped: no Vulkan adapter");
        return;
    }
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let seen = image::open(folder.join("down.png")).unwrap().into_rgb8();
    let (west, east) = (seen.get_pixel(60, 90).0, seen.get_pixel(260, 90).0);
    assert!(west[0] > west[1] + 30 && east[1] > east[0] + 30, "{west:?} {east:?}");
}

#[test]
fn hostile_photographs_are_refused_with_what_was_expected_and_found() {
    let folder = &folder("hostile");
    let png = encoded(ImageFormat::Png);
    std::fs::write(folder.join("text.png"), "a picture").unwrap();
    std::fs::write(folder.join("alone.png"), &png).unwrap();
    std::fs::write(folder.join("cut.png"), &png[..png.len() / 2]).unwrap();
    std::fs::write(folder.join("cut.pgw"), WORLD_FILE).unwrap();
    std::fs::write(folder.join("words.png"), &png).unwrap();
    std::fs::write(folder.join("words.pgw"), "one\ntwo\n").unwrap();
    std::fs::write(folder.join("cut.tif"), &geotiff()[..5_000]).unwrap();
    for file in ["text.png", "alone.png", "cut.png", "words.png", "cut.tif", "none.jpg"] {
        let output = poligon(folder, &[&BAKE[..], &["--imagery", file, "--out", "no.world"]].concat());
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{file}: {told}");
        assert!([file, "expected", "found"].iter().all(|word| told.contains(word)), "{file}: {told}");
        assert!(!folder.join("no.world").exists(), "{file}");
    }
}

/// A board of 8 x 12 m that stands across the north, in one colour (linear), as a binary glTF file.
fn board(colour: [f32; 3]) -> Vec<u8> {
    let corners: [[f32; 3]; 4] = [[-4.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 12.0, 0.0], [-4.0, 12.0, 0.0]];
    // Seen from both sides.
    let indices: [u16; 12] = [0, 1, 2, 0, 2, 3, 0, 2, 1, 0, 3, 2];
    let mut data: Vec<u8> = corners.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    data.extend(indices.iter().flat_map(|v| v.to_le_bytes()));
    let [red, green, blue] = colour;
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
        "materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[{red},{green},{blue},1]}}}}],
        "buffers":[{{"byteLength":{}}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-4,0,0],"max":[4,12,0]}},
        {{"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}}]}}"#,
        data.len()
    );
    let mut text = text.into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + text.len() as u32 + data.len() as u32).to_le_bytes());
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(text);
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes
}

#[test]
fn a_shape_of_the_worlds_own_is_seen_and_outlives_a_new_bake() {
    let folder = &folder("models");
    // A mast, 40 m by default, at 42.5 N 7.5 E.
    let mast = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"man_made":"mast"},
        "geometry":{"type":"Point","coordinates":[7.5,42.5]}}]}"#;
    std::fs::write(folder.join("mast.geojson"), mast).unwrap();
    let with = ["--features", "mast.geojson", "--out", "m.world"];
    bake(folder, &with);
    let shot = |out: &str| {
        let eye = ["shot", "m.world", "--eye", "42.4994,7.5,20:agl", "--look", "0,0", "--out", out, "--json"];
        let arguments = [&eye[..], &["--size", "320x180", "--time", "2026-06-21T11:30:00Z"]].concat();
        let output = poligon(folder, &arguments);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        if told.contains("expected a Vulkan adapter") {
            return Err("skipped: no Vulkan adapter");
        }
        assert!(output.status.success(), "{told}");
        let report: Value = serde_json::from_slice(&output.stdout).unwrap();
        let seen = image::open(folder.join(out)).unwrap().into_rgb8();
        // Magenta, as nothing of the landscape is.
        let magenta = seen.pixels().filter(|p| p.0[0] > p.0[1] + 40 && p.0[2] > p.0[1] + 40).count();
        Ok((magenta, report["objects_drawn"].as_u64().unwrap()))
    };
    let generated = match shot("generated.png") {
        Ok(seen) => seen,
        Err(told) => return println!("{told}"),
    };
    assert_eq!(generated, (0, 1));
    let models = folder.join("m.world/models");
    std::fs::create_dir(&models).unwrap();
    std::fs::write(models.join("mast.glb"), board([0.8, 0.02, 0.8])).unwrap();
    let own = shot("own.png").unwrap();
    assert!(own.0 > 300 && own.1 == 1, "{own:?}");

    bake(folder, &with);
    assert_eq!(shot("again.png"), Ok(own));
    // A file of that name is not the folder, and is not lost.
    std::fs::remove_dir_all(&models).unwrap();
    std::fs::write(&models, "notes").unwrap();
    let output = poligon(folder, &[&BAKE[..], &with].concat());
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && told.contains("`models`") && told.contains("not replaced"), "{told}");
    assert_eq!(std::fs::read_to_string(&models).unwrap(), "notes");
    // A shape that is none is named.
    std::fs::remove_file(&models).unwrap();
    std::fs::create_dir(&models).unwrap();
    std::fs::write(models.join("mast.glb"), "no shape").unwrap();
    let output =
        poligon(folder, &["shot", "m.world", "--eye", "42.4994,7.5,20:agl", "--look", "0,0", "--out", "x.png"]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && told.contains("mast.glb") && told.contains("expected"), "{told}");
}
