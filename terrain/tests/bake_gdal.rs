//! Posts against `gdalwarp -et 0` (Debian's gdal-bin) with the same kernel, on the real files of `../shared`.
//!
//! GDAL's grid is laid so that its pixel centres are our posts. Compared are the posts as sampled, before voids are
//! filled, that have no void and no edge of the data within three posts. 0.05 m is what was promised; both programs
//! sum in double precision and round to single, so 1 mm (two units in the last place at 8 km) is what is held.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use terrain::bake::mosaic::mosaic;
use terrain::bake::open::open;
use terrain::bake::{BakeRequest, Input, bake};
use terrain::store::World;

/// The reason why this cannot run here, if there is one.
fn missing(file: &Path) -> Option<String> {
    if !file.exists() {
        return Some(format!("{} is not there", file.display()));
    }
    match Command::new("gdalwarp").arg("--version").output() {
        Ok(output) if output.status.success() => None,
        _ => Some("gdalwarp (Debian's gdal-bin) is not installed".into()),
    }
}

fn data(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/terrain").join(file)
}

fn baked(file: &Path, step_m: f64) -> World {
    let request = BakeRequest {
        name: "compared".into(),
        sources: vec![(Input::File(file.into()), 1.0)],
        features: Vec::new(),
        imagery: Vec::new(),
        step_m,
        centre: None,
        size_km: None,
    };
    bake(&request, &mut |_, _| ()).unwrap()
}

/// GDAL's heights at our posts; -99999 where it has none.
fn warped(source: &str, source_srs: Option<&str>, kernel: &str, world: &World, to: &Path) -> Vec<f32> {
    let grid = world.field.grid();
    let half = 0.5 * grid.step_m;
    let centre = world.projection.centre();
    let srs = format!("+proj=tmerc +lat_0={} +lon_0={} +k=1 +datum=WGS84 +units=m", centre.lat_deg(), centre.lon_deg());
    let numbers = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>();
    let mut command = Command::new("gdalwarp");
    command.args(["-q", "-overwrite", "-et", "0", "-r", kernel, "-ot", "Float32", "-of", "ENVI"]);
    command.args(["-wo", "NUM_THREADS=2", "-dstnodata", "-99999", "-t_srs", &srs, "-te"]);
    let edges = [grid.west_m - half, -grid.south_m() - half, grid.east_m() + half, -grid.north_m + half];
    command.args(numbers(&edges)).arg("-tr").args(numbers(&[grid.step_m, grid.step_m]));
    if let Some(source_srs) = source_srs {
        command.args(["-s_srs", source_srs]);
    }
    let output = command.arg(source).arg(to).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = std::fs::read(to).unwrap();
    assert_eq!(bytes.len(), 4 * grid.posts());
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Whether all posts within three of it are GDAL's too.
fn off_voids(ours: &[f32], gdal: &[f32], columns: usize, at: usize) -> bool {
    (0..49)
        .map(|i| at + i / 7 * columns + i % 7 - 3 * columns - 3)
        .all(|at| ours[at].is_finite() && gdal[at] != -99_999.0)
}

/// Compares one file; `inside` turns its path into GDAL's name for what is in it.
fn compare(file: &str, inside: &str, source_srs: Option<&str>, kernel: &str, step_m: f64, tolerance_m: f32) {
    let path = data(file);
    if let Some(reason) = missing(&path) {
        println!("skipped: {reason}");
        return;
    }
    let started = Instant::now();
    let world = baked(&path, step_m);
    let ours_s = started.elapsed().as_secs_f64();
    let folder = std::env::temp_dir().join(format!(
        "poligon-gdal-{}-{kernel}-{step_m}-{}",
        path.file_name().unwrap().display(),
        std::process::id()
    ));
    std::fs::create_dir_all(&folder).unwrap();
    let to = folder.join("warped.bin");
    let started = Instant::now();
    let source = inside.replace("{}", &path.to_string_lossy());
    let gdal = warped(&source, source_srs, kernel, &world, &to);
    let gdal_s = started.elapsed().as_secs_f64();

    let grid = world.field.grid();
    let raster = open(&path).unwrap();
    let ours = mosaic(grid, &world.projection, &[raster], &mut |_| ()).heights_m;
    let columns = grid.columns() as usize;
    let (mut largest, mut compared, mut sum) = (0.0_f32, 0_usize, 0.0_f64);
    for row in 3..grid.rows() as usize - 3 {
        for at in row * columns + 3..(row + 1) * columns - 3 {
            if off_voids(&ours, &gdal, columns, at) {
                let apart = (ours[at] - gdal[at]).abs();
                largest = largest.max(apart);
                sum += f64::from(apart);
                compared += 1;
            }
        }
    }
    println!(
        "{file} {kernel} {step_m} m: {compared} of {} posts, at most {largest:.4} m apart, {:.5} m on average; \
         {ours_s:.2} s, gdalwarp {gdal_s:.2} s",
        grid.posts(),
        sum / compared as f64
    );
    std::fs::remove_dir_all(&folder).ok();
    assert!(compared > 1000, "{compared} posts");
    assert!(largest <= tolerance_m, "{largest} m");
}

const HELD_M: f32 = 0.001;

#[test]
fn issyk_kul_bilinear() {
    compare("committable/dem/gebco2023_15s_tianshan_400km.tif", "{}", None, "bilinear", 200.0, HELD_M);
}

#[test]
fn pyrenees_averaged() {
    let inside = "/vsizip/{}/N42E001.hgt";
    compare("tests/dem/srtm3_pyrenees/N42E001.hgt.zip", inside, None, "average", 200.0, HELD_M);
}

#[test]
fn pyrenees_bilinear() {
    let inside = "/vsizip/{}/N42E001.hgt";
    compare("tests/dem/srtm3_pyrenees/N42E001.hgt.zip", inside, None, "bilinear", 40.0, HELD_M);
}

#[test]
fn denali_bilinear_from_utm() {
    compare("tests/dem/windninja/denali.tif", "{}", None, "bilinear", 100.0, HELD_M);
}

#[test]
fn mauna_kea_averaged_from_utm() {
    compare("tests/dem/windninja/hi.tif", "{}", None, "average", 200.0, HELD_M);
}

#[test]
fn big_tujunga_both_ways_from_utm_tiles() {
    compare("tests/dem/srtm1_bigtujunga_30m_utm11.tif", "{}", None, "average", 100.0, HELD_M);
    compare("tests/dem/srtm1_bigtujunga_30m_utm11.tif", "{}", None, "bilinear", 25.0, HELD_M);
}

#[test]
fn mackay_averaged_pixel_is_point() {
    compare("tests/dem/windninja/mackay.tif", "{}", None, "average", 200.0, HELD_M);
}

#[test]
fn st_helens_averaged_from_nad27_by_the_same_mean_shift() {
    let srs = "+proj=utm +zone=10 +ellps=clrk66 +towgs84=-8,160,176 +units=m";
    compare("tests/dem/usgs_sthelens1980_30m.dem.gz", "/vsigzip/{}", Some(srs), "average", 100.0, HELD_M);
}
