//! Readers against values read by GDAL 3.6.2 (`gdallocationinfo`, `gdaltransform`) and against files written here.

use glam::DVec2;
use std::path::{Path, PathBuf};
use std::process::Command;
use terrain::bake::{open, usgs_dem};

/// File, column, row, first band's value, latitude and longitude of the sample on WGS84, degrees. The shift of the
/// St Helens sheet is the same mean shift in both programs.
const BY_GDAL: [(&str, usize, usize, f64, f64, f64); 42] = [
    ("committable/dem/gebco2023_15s_tianshan_400km.tif", 152, 183, 683.0, 43.4854167, 76.5354167),
    ("committable/dem/gebco2023_15s_tianshan_400km.tif", 588, 525, 3653.0, 42.0604167, 78.3520833),
    ("committable/dem/gebco2023_15s_tianshan_400km.tif", 1174, 292, 1961.0, 43.0312500, 80.7937500),
    ("tests/dem/gebco2023_15s_kyrgyzstan_pamir_tianshan.tif", 571, 422, 190.0, 42.9520833, 68.5187500),
    ("tests/dem/gebco2023_15s_kyrgyzstan_pamir_tianshan.tif", 2199, 1208, 2197.0, 39.6770833, 75.3020833),
    ("tests/dem/gebco2023_15s_kyrgyzstan_pamir_tianshan.tif", 4396, 671, 988.0, 41.9145833, 84.4562500),
    ("tests/dem/srtm1_bigtujunga_30m_utm11.tif", 155, 135, 1142.0, 34.3692036, -118.2944244),
    ("tests/dem/srtm1_bigtujunga_30m_utm11.tif", 598, 385, 1006.0, 34.3030222, -118.1489928),
    ("tests/dem/srtm1_bigtujunga_30m_utm11.tif", 1195, 214, 1887.0, 34.3509512, -117.9549132),
    ("tests/dem/windninja/big_butte.tif", 80, 141, 1553.31079101562, 43.4376286, -113.1114927),
    ("tests/dem/windninja/big_butte.tif", 311, 403, 1592.12170410156, 43.3684467, -113.0235588),
    ("tests/dem/windninja/big_butte.tif", 621, 224, 1564.11145019531, 43.4187468, -112.9103557),
    ("tests/dem/windninja/denali.tif", 32, 41, 1207.0, 63.1975527, -151.4170857),
    ("tests/dem/windninja/denali.tif", 125, 118, 3945.0, 63.0319507, -150.9996583),
    ("tests/dem/windninja/denali.tif", 248, 66, 1619.0, 63.1309986, -150.4268469),
    ("tests/dem/windninja/hi.tif", 66, 85, 1193.0, 19.9103709, -155.6209870),
    ("tests/dem/windninja/hi.tif", 254, 243, 3409.0, 19.7804095, -155.4524788),
    ("tests/dem/windninja/hi.tif", 506, 135, 958.0, 19.8738037, -155.2307447),
    ("tests/dem/windninja/mackay.tif", 95, 192, 1890.23962402344, 43.9738199, -113.7116160),
    ("tests/dem/windninja/mackay.tif", 369, 551, 1856.55029296875, 43.8793366, -113.6050088),
    ("tests/dem/windninja/mackay.tif", 736, 306, 2687.07983398438, 43.9484929, -113.4708270),
    ("tests/dem/windninja/missoula_valley.tif", 92, 204, 1504.0, 47.0179619, -114.1367096),
    ("tests/dem/windninja/missoula_valley.tif", 357, 585, 992.0, 46.9093357, -114.0348876),
    ("tests/dem/windninja/missoula_valley.tif", 712, 325, 1870.0, 46.9777588, -113.8867527),
    ("tests/dem/windninja/example_lcp.tif", 65, 108, 1451.0, 46.7341338, -114.2480676),
    ("tests/dem/windninja/example_lcp.tif", 251, 309, 1999.0, 46.6781556, -114.1779487),
    ("tests/dem/windninja/example_lcp.tif", 500, 171, 967.0, 46.7129146, -114.0783945),
    ("tests/dem/craterlake/craterlake-elev-16bit-30m.tif", 55, 58, -32767.0, 42.9636586, -122.1505996),
    ("tests/dem/craterlake/craterlake-elev-16bit-30m.tif", 214, 167, 1546.0, 42.9342323, -122.1076750),
    ("tests/dem/craterlake/craterlake-elev-16bit-30m.tif", 427, 93, -32767.0, 42.9542098, -122.0501722),
    ("tests/dem/srtm3_pyrenees/N42E001.hgt.zip", 156, 252, 1659.0, 42.7900000, 1.1300000),
    ("tests/dem/srtm3_pyrenees/N42E001.hgt.zip", 600, 720, 1577.0, 42.4000000, 1.5000000),
    ("tests/dem/srtm3_pyrenees/N42E001.hgt.zip", 1199, 400, 2230.0, 42.6666667, 1.9991667),
    ("tests/dem/srtm/N48W125.hgt.zip", 468, 756, -32768.0, 48.7900000, -124.8700000),
    ("tests/dem/srtm/N48W125.hgt.zip", 1800, 2160, 0.0, 48.4000000, -124.5000000),
    ("tests/dem/srtm/N48W125.hgt.zip", 3599, 1200, -32768.0, 48.6666667, -124.0002778),
    ("tests/dem/srtm/S29W072.hgt.zip", 156, 252, 0.0, -28.2100000, -71.8700000),
    ("tests/dem/srtm/S29W072.hgt.zip", 600, 720, 0.0, -28.6000000, -71.5000000),
    ("tests/dem/srtm/S29W072.hgt.zip", 1199, 400, 523.0, -28.3333333, -71.0008333),
    ("tests/dem/usgs_sthelens1980_30m.dem.gz", 42, 98, 1212.0, 46.2242312, -122.2351240),
    ("tests/dem/usgs_sthelens1980_30m.dem.gz", 163, 280, 1835.0, 46.1747712, -122.1887818),
    ("tests/dem/usgs_sthelens1980_30m.dem.gz", 325, 156, -32767.0, 46.2077835, -122.1252948),
];

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain").join(file)
}

#[test]
fn real_files_read_as_gdal_reads_them() {
    let mut last = None;
    for (file, i, j, value, lat, lon) in BY_GDAL {
        let path = data(file);
        if !path.exists() {
            println!("skipped: {file} is not there");
            continue;
        }
        if last.as_ref().is_none_or(|(name, _)| *name != file) {
            last = Some((file, open::open(&path).unwrap_or_else(|e| panic!("{file}: {e}"))));
        }
        let Some((_, raster)) = &last else { continue };
        // GDAL gives the sheet a row without samples in the north and in the south.
        let j = if file.contains(".dem") { j - 1 } else { j };
        let sample = raster.sample_m(i, j);
        if value < -32_000.0 {
            assert!(sample.is_nan(), "{file} {i} {j}: {sample}");
        } else {
            // GDAL prints 15 digits of a single-precision number.
            assert_eq!(sample, value as f32, "{file} {i} {j}");
        }
        let place = raster.place(DVec2::new(i as f64 + 0.5, j as f64 + 0.5));
        let apart = (place.lat_deg() - lat).hypot(place.lon_deg() - lon);
        // Printed to 1e-7 degrees. A datum shift at height 0 of one ellipsoid or the other adds 2 cm.
        let tolerance = if file.contains(".dem") { 2e-7 } else { 1e-7 };
        assert!(apart < tolerance, "{file} {i} {j}: {:.8} {:.8}", place.lat_deg(), place.lon_deg());
    }
}

#[test]
fn credits_come_out_of_the_file() {
    let bytes = include_bytes!("../../assets/worlds/issyk_kul/gebco2023_15s_tianshan_400km.tif");
    let raster = open::read(bytes, "x.png", None).unwrap();
    assert!(raster.credit.unwrap().starts_with("GEBCO_2023 Grid"));
}

/// GDAL writes one raster in many ways; all must read the same.
#[test]
fn every_flavour_of_geotiff_is_the_same_raster() {
    let source =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/worlds/issyk_kul/gebco2023_15s_tianshan_400km.tif");
    if !Command::new("gdal_translate").arg("--version").output().is_ok_and(|o| o.status.success()) {
        println!("skipped: gdal_translate (Debian's gdal-bin) is not installed");
        return;
    }
    let folder = std::env::temp_dir().join(format!("poligon-flavours-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let whole = open::open(&source).unwrap();
    let flavours = [
        "",
        "-co BIGTIFF=YES -co TILED=YES",
        "-co ENDIANNESS=BIG -ot UInt16",
        "-co TILED=YES -co BLOCKXSIZE=64 -co BLOCKYSIZE=128 -co COMPRESS=LZW -co PREDICTOR=2",
        "-co COMPRESS=LZW -ot UInt16",
        "-co COMPRESS=DEFLATE -co PREDICTOR=3 -ot Float32",
        "-co COMPRESS=DEFLATE -co PREDICTOR=2 -ot Int32 -co ENDIANNESS=BIG",
        "-co BLOCKYSIZE=7 -ot Float64",
        "-co TILED=YES -co COMPRESS=DEFLATE -co PREDICTOR=3 -ot Float32 -co ENDIANNESS=BIG",
        "-b 1 -b 1 -b 1 -co INTERLEAVE=PIXEL -co COMPRESS=DEFLATE -co PREDICTOR=2",
        "-b 1 -b 1 -co INTERLEAVE=BAND -co TILED=YES",
        "-mo AREA_OR_POINT=Point",
    ];
    for flavour in flavours {
        let to = folder.join("flavour.tif");
        let output = Command::new("gdal_translate")
            .args(["-q", "-srcwin", "301", "200", "333", "270"])
            .args(flavour.split_whitespace())
            .args([&source, &to])
            .output()
            .unwrap();
        assert!(output.status.success(), "{flavour}: {}", String::from_utf8_lossy(&output.stderr));
        let part = open::open(&to).unwrap_or_else(|e| panic!("{flavour}: {e}"));
        assert_eq!((part.columns, part.rows), (333, 270), "{flavour}");
        for j in 0..part.rows {
            for i in 0..part.columns {
                assert_eq!(part.sample_m(i, j), whole.sample_m(i + 301, j + 200), "{flavour} {i} {j}");
            }
        }
        let (corner, same) = (part.place(DVec2::ZERO), whole.place(DVec2::new(301.0, 200.0)));
        assert!((corner.lat_rad - same.lat_rad).hypot(corner.lon_rad - same.lon_rad) < 1e-12, "{flavour}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_png_with_a_world_file_lies_where_it_says() {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::ImageBuffer::<image::Luma<u16>, _>::from_fn(5, 4, |x, y| image::Luma([(100 * y + x) as u16]));
    image.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let world_file = "0.01\n0\n0\n-0.02\n10.005\n49.99\n";
    let raster = open::read(png.get_ref(), "heights.tif", Some(world_file)).unwrap();
    assert_eq!((raster.columns, raster.rows, raster.sample_m(3, 2)), (5, 4, 203.0));
    let corner = raster.place(DVec2::ZERO);
    assert!((corner.lat_deg() - 50.0).abs() < 1e-12 && (corner.lon_deg() - 10.0).abs() < 1e-12);
    let error = open::read(png.get_ref(), "heights.png", None).unwrap_err().to_string();
    assert!(error.contains("world file"), "{error}");
    let error = open::read(png.get_ref(), "heights.png", Some("1 2 3")).unwrap_err().to_string();
    assert!(error.contains("six numbers"), "{error}");
}

/// A sheet of two profiles, the second one post further north, in feet, with a void.
fn small_dem() -> Vec<u8> {
    let mut head = vec![b' '; 1024];
    let mut put = |at: usize, text: &str| head[at..at + text.len()].copy_from_slice(text.as_bytes());
    put(0, "SMALL SHEET");
    put(144, "     1     1     1    10");
    put(528, "     2     1     4");
    put(816, "0.300000E+020.300000E+020.100000E+01");
    put(852, "     1     2");
    let mut bytes = head;
    for (column, y, heights) in [(1, 5_108_100.0, [100, 200, -32_767]), (2, 5_108_130.0, [300, 400, 500])] {
        let mut profile = format!("     1{column:6}     3     1{:24}{y:24.15}", 557_820.0 + 30.0 * (column - 1) as f64);
        profile += &format!("{:24}{:24}{:24}", 0.0, 100.0, 500.0);
        for height in heights {
            profile += &format!("{height:6}");
        }
        bytes.extend_from_slice(format!("{profile:<1024}").as_bytes());
    }
    bytes
}

#[test]
fn profiles_of_a_dem_are_laid_side_by_side() {
    let bytes = small_dem();
    assert!(usgs_dem::looks_like(&bytes));
    let raster = open::read(&bytes, "sheet.dem", None).unwrap();
    assert_eq!((raster.columns, raster.rows), (2, 4));
    let feet = |i: usize, j: usize| (raster.sample_m(i, j) / 0.3048).round();
    assert!(feet(0, 0).is_nan() && feet(0, 1).is_nan() && feet(1, 3).is_nan());
    assert_eq!((feet(0, 3), feet(0, 2), feet(1, 2), feet(1, 0)), (100.0, 200.0, 300.0, 500.0));
    assert!(raster.crs.note().unwrap().contains("+-10 m"));
    let first = raster.affine.at(DVec2::new(0.5, 3.5));
    assert!((first - DVec2::new(557_820.0, 5_108_100.0)).length() < 1e-6);
}

/// Depths of the Dead Sea and of the Mariana Trench, a spike, and what is no height at all.
#[test]
fn floats_keep_every_height_and_lose_what_is_none() {
    use tiff::encoder::{TiffEncoder, colortype};
    use tiff::tags::Tag;
    let heights = [-430.5, -11_000.0, 9_000.25, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3.4e38, -3.4e38, 0.0];
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<colortype::Gray32Float>(3, 3).unwrap();
    // A full transformation: columns run north, rows run east.
    let m = [0.0, 30.0, 0.0, 500_000.0, 30.0, 0.0, 0.0, 4_000_000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    image.encoder().write_tag(Tag::ModelTransformationTag, &m[..]).unwrap();
    let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, 32_644];
    image.encoder().write_tag(Tag::GeoKeyDirectoryTag, &keys[..]).unwrap();
    image.write_data(&heights).unwrap();
    let raster = open::read(bytes.get_ref(), "a.tif", None).unwrap();
    for (at, height) in heights.into_iter().enumerate() {
        let sample = raster.sample_m(at % 3, at / 3);
        assert!(if height.abs() < 1e5 { sample == height } else { sample.is_nan() }, "{height} became {sample}");
    }
    let (first, along, down) =
        (raster.place(DVec2::ZERO), raster.place(DVec2::new(1.0, 0.0)), raster.place(DVec2::new(0.0, 1.0)));
    // 500 km east of the false origin is zone 44's meridian.
    assert!((first.lon_deg() - 81.0).abs() < 1e-9 && along.lat_rad > first.lat_rad && down.lon_rad > first.lon_rad);
}

#[test]
fn what_a_file_is_not_is_said() {
    let tile = vec![0_u8; 1201 * 1201 * 2];
    for (bytes, name, said) in [
        (&b"hello"[..], "a.tif", "GeoTIFF, SRTM"),
        (b"", "a.tif", "0 bytes"),
        (b"", "N43E007.hgt", "2884802 or 25934402 bytes"),
        (&tile, "tile.hgt", "N43E007.hgt"),
        (b"II*\0\x08\0\0\0", "a.tif", "undamaged TIFF"),
        (b"PK\x03\x04", "a.zip", "undamaged zip"),
        (b"\x1f\x8b\x08", "a.gz", "undamaged archive"),
        (b"\x89PNG\r\n\x1a\n", "a.png", "world file"),
    ] {
        let error = open::read(bytes, name, None).unwrap_err().to_string();
        assert!(error.contains(said), "{name}: {error}");
    }
    let raster = open::read(&tile, "anything/s29w072.hgt", None).unwrap();
    assert!((raster.place(DVec2::new(0.5, 1200.5)).lat_deg() + 29.0).abs() < 1e-12);
}
