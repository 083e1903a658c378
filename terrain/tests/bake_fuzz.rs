//! Readers against hostile bytes: every format's valid file, cut short and changed, thousands of times.
//!
//! What is asked: an answer or an error, no panic, nothing that takes long or much memory. Places of the changes come
//! from fixed seeds, so a failure comes back. Structures that are worth a liar's while (TIFF directories, DEM heads,
//! PNG and zip headers) lie in the first and last kilobyte, where half of the changes go.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use terrain::bake::open::{self, MAX_UNPACKED_BYTES};
use tiff::encoder::{Compression, Predictor, TiffEncoder, colortype};
use tiff::tags::Tag;

/// A small GeoTIFF of strips.
fn geotiff(compression: Compression, predictor: Predictor) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(compression).with_predictor(predictor);
    let mut image = encoder.new_image::<colortype::GrayI16>(40, 30).unwrap();
    image.rows_per_strip(8).unwrap();
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[0.01_f64, 0.01, 0.0][..]).unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0_f64, 0.0, 0.0, 10.0, 50.0, 0.0][..]).unwrap();
    let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
    tags.write_tag(Tag::GeoKeyDirectoryTag, &keys[..]).unwrap();
    tags.write_tag(Tag::GdalNodata, "-9999").unwrap();
    let samples: Vec<i16> = (0..1200).map(|i| i as i16).collect();
    image.write_data(&samples).unwrap();
    bytes.into_inner()
}

fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::ImageBuffer::<image::Luma<u16>, _>::from_fn(30, 20, |x, y| image::Luma([(x * y) as u16]));
    image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

fn zip(name: &str, content: &[u8]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    writer.start_file(name, options).unwrap();
    writer.write_all(content).unwrap();
    writer.finish().unwrap().into_inner()
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    writer.write_all(content).unwrap();
    writer.finish().unwrap()
}

/// Two profiles of 200 posts, so that a profile goes into a second block.
fn dem() -> Vec<u8> {
    let mut head = vec![b' '; 1024];
    let mut put = |at: usize, text: &str| head[at..at + text.len()].copy_from_slice(text.as_bytes());
    put(144, "     1     1     1    10");
    put(528, "     2     2     4");
    put(816, "0.300000E+020.300000E+020.100000E+01     1     2");
    let mut bytes = head;
    for column in 1..=2 {
        let mut profile = format!("     1{column:6}   200     1{:24}{:24}", 557_820 + 30 * column, 5_108_100);
        profile += &format!("{:24}{:24}{:24}", 0.0, 100.0, 500.0);
        (0..146).for_each(|i| profile += &format!("{i:6}"));
        profile += "    ";
        (146..200).for_each(|i| profile += &format!("{i:6}"));
        bytes.extend_from_slice(format!("{profile:<2048}").as_bytes());
    }
    bytes
}

/// The bytes with a few changes: bits, bytes, runs, numbers that are large, a cut.
fn changed(bytes: &[u8], rng: &mut StdRng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..rng.random_range(1..6) {
        let length = bytes.len();
        if length < 8 {
            break;
        }
        let near = length.min(1024);
        let at = match rng.random_range(0..4) {
            0 => rng.random_range(0..near),
            1 => length - 1 - rng.random_range(0..near),
            _ => rng.random_range(0..length),
        };
        match rng.random_range(0..7) {
            0 => bytes[at] ^= 1 << rng.random_range(0..8),
            1 => bytes[at] = rng.random(),
            2 => bytes[at] = [0, 0xff, 0x7f, 0x80, b'9', b'-', b' '][rng.random_range(0..7)],
            3 => bytes[at..(at + 4).min(length)].fill(0xff),
            4 => bytes.truncate(at),
            5 => bytes[at..(at + 6).min(length)].fill(b'9'),
            _ => {
                let from = rng.random_range(0..length);
                let piece: Vec<u8> = bytes[from..(from + 16).min(length)].to_vec();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

fn fuzz(what: &str, valid: &[u8], name: &str, cases: u32) {
    let world_file = "0.01\n0\n0\n-0.01\n10\n50\n";
    open::read(valid, name, Some(world_file)).unwrap_or_else(|e| panic!("{what}: {e}"));
    let mut read = 0;
    let mut check = |bytes: &[u8], case: &str| {
        let started = Instant::now();
        let answer = catch_unwind(AssertUnwindSafe(|| open::read(bytes, name, Some(world_file))));
        match answer {
            Ok(Ok(raster)) => {
                read += 1;
                assert_eq!(raster.samples_m.len(), raster.columns * raster.rows, "{what} {case}");
                assert!(raster.samples_m.iter().all(|h| !h.is_infinite()), "{what} {case}");
            }
            Ok(Err(error)) => assert!(!error.to_string().is_empty()),
            Err(_) => panic!("{what}, {case}: the reader panicked"),
        }
        // Unpacking 256 MiB, the most allowed, takes about a second; nothing may take ten.
        assert!(started.elapsed() < Duration::from_secs(10), "{what} {case} took {:?}", started.elapsed());
    };
    for cut in 0..valid.len().min(600) {
        check(&valid[..cut], &format!("cut at {cut}"));
        check(&valid[..valid.len() - cut], &format!("cut by {cut}"));
    }
    for seed in 0..cases {
        let bytes = changed(valid, &mut StdRng::seed_from_u64(u64::from(seed)));
        check(&bytes, &format!("seed {seed}"));
    }
    println!("{what}: {cases} changed files, {read} still read");
}

#[test]
fn geotiff_uncompressed() {
    fuzz("plain GeoTIFF", &geotiff(Compression::Uncompressed, Predictor::None), "a.tif", 6000);
}

#[test]
fn geotiff_packed() {
    use tiff::encoder::DeflateLevel;
    fuzz("deflate GeoTIFF", &geotiff(Compression::Deflate(DeflateLevel::Fast), Predictor::Horizontal), "a.tif", 4000);
    fuzz("LZW GeoTIFF", &geotiff(Compression::Lzw, Predictor::Horizontal), "a.tif", 4000);
}

#[test]
fn world_png() {
    fuzz("PNG", &png(), "a.png", 4000);
}

#[test]
fn usgs_dem() {
    fuzz("DEM", &dem(), "a.dem", 6000);
    fuzz("DEM in gzip", &gzip(&dem()), "a.dem.gz", 2000);
}

#[test]
fn srtm() {
    let tile: Vec<u8> = (0..1201 * 1201 * 2).map(|i| (i / 4096) as u8).collect();
    fuzz("hgt in zip", &zip("N43E007.hgt", &tile), "x.zip", 300);
    fuzz("zip", &zip("a.tif", &geotiff(Compression::Uncompressed, Predictor::None)), "x.zip", 4000);
}

#[test]
fn world_files() {
    let image = png();
    for text in [
        "",
        "0",
        "nan nan nan nan nan nan",
        "inf 0 0 1 0 0",
        "1e308 0 0 -1e308 0 0",
        "0 0 0 0 10 50",
        "a b c d e f",
        "1 0 0 -1 1e9 50",
        "0.01 0 0 -0.01 10 95",
        "0.01\n0\n0\n-0.01\n10",
        "1 1 1 1 10 50",
    ] {
        assert!(open::read(&image, "a.png", Some(text)).is_err(), "{text}");
    }
}

#[test]
fn bombs_are_refused_before_they_go_off() {
    let started = Instant::now();
    // A gzip and a zip of a little more than is allowed, all zero.
    let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    let mut packed = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    packed.start_file("N43E007.hgt", options).unwrap();
    let zeros = vec![0_u8; 1 << 20];
    for _ in 0..=MAX_UNPACKED_BYTES >> 20 {
        writer.write_all(&zeros).unwrap();
        packed.write_all(&zeros).unwrap();
    }
    let (gzip, zip) = (writer.finish().unwrap(), packed.finish().unwrap().into_inner());
    for (bomb, name) in [(gzip, "a.dem.gz"), (zip, "a.hgt.zip")] {
        let error = open::read(&bomb, name, None).unwrap_err().to_string();
        assert!(error.contains("at most 268435456 bytes"), "{error}");
    }
    // A TIFF of a kilobyte that claims 65,535 x 65,535 samples.
    let valid = geotiff(Compression::Deflate(tiff::encoder::DeflateLevel::Fast), Predictor::None);
    let entry = |tag: u16| {
        let at = (0..valid.len() - 12).find(|&i| {
            valid[i..i + 2] == tag.to_le_bytes() && matches!(valid[i + 2], 3 | 4) && valid[i + 4..i + 8] == [1, 0, 0, 0]
        });
        at.unwrap() + 8
    };
    let mut bomb = valid.clone();
    for tag in [256, 257] {
        bomb[entry(tag)..entry(tag) + 2].fill(0xff);
    }
    assert!(open::read(&bomb, "a.tif", None).is_err());
    // A PNG of a few bytes that claims as much.
    let mut bomb = png();
    bomb[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    let crc = crc32fast::hash(&bomb[12..29]).to_be_bytes();
    bomb[29..33].copy_from_slice(&crc);
    assert!(open::read(&bomb, "a.png", Some("1 0 0 -1 0 0")).is_err());
    assert!(started.elapsed() < Duration::from_secs(60));
}

#[test]
fn lakes_and_worlds() {
    use terrain::bake::{BakeRequest, Input, bake};
    use terrain::store::World;
    let folder = std::env::temp_dir().join(format!("poligon-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (tif, lakes) = (folder.join("a.tif"), folder.join("lakes.geojson"));
    std::fs::write(&tif, geotiff(Compression::Uncompressed, Predictor::None)).unwrap();
    let text = r#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a","level_m":9.5},
        "geometry":{"type":"Polygon","coordinates":[[[10.1,49.8],[10.2,49.8],[10.2,49.9],[10.1,49.8]]]}}]}"#;
    let request = BakeRequest {
        name: "fuzz".into(),
        sources: vec![(Input::File(tif), 1.0)],
        features: vec![Input::File(lakes.clone())],
        imagery: Vec::new(),
        step_m: 400.0,
        centre: None,
        size_km: None,
    };
    let mut read = 0;
    for seed in 0..400 {
        let mut rng = StdRng::seed_from_u64(seed);
        std::fs::write(&lakes, if seed == 0 { text.into() } else { changed(text.as_bytes(), &mut rng) }).unwrap();
        let Ok(world) = bake(&request, &mut |_, _| ()) else { continue };
        assert!(world.field.heights_m().iter().all(|h| !h.is_infinite()));
        read += 1;
    }
    println!("lakes: 400 changed files, {read} still baked");
    assert!(read > 0);

    std::fs::write(&lakes, text).unwrap();
    let path = folder.join("a.world");
    bake(&request, &mut |_, _| ()).unwrap().write(&path).unwrap();
    for file in ["world.toml", "lakes.json", "heights.bin"] {
        let whole = std::fs::read(path.join(file)).unwrap();
        for seed in 0..600 {
            let bytes = changed(&whole, &mut StdRng::seed_from_u64(seed));
            std::fs::write(path.join(file), &bytes).unwrap();
            let answer = World::read(&path);
            // All bytes but the description's are under a sum.
            assert!(file == "world.toml" || bytes == whole || answer.is_err(), "{file} seed {seed}");
        }
        std::fs::write(path.join(file), &whole).unwrap();
    }
    World::read(&path).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
}
