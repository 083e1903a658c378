//! The bake itself, from a request to a world in memory.

use super::error::BakeError;
use super::extent::{extent, middle, written_deg};
use super::features::{self, AirfieldRow, Content, Placed, Site};
use super::imagery::imagery;
use super::mosaic::{mosaic, pixel_m};
use super::open;
use super::photo;
use super::raster::{Raster, Unreadable};
use super::void_fill;
use crate::features::cover_bake::{self, bake_cover};
use crate::features::cover_rules::Climate;
use crate::features::lakes::Lakes;
use crate::features::model::Airfield;
use crate::features::placing;
use crate::field::Field;
use crate::grid::Grid;
use crate::ground::Ground;
use crate::projection::{Geodetic, Projection};
use crate::store::{Extent, FORMAT_VERSION, Source, Statistics, Voids, World, WorldInfo};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What the kernel is called in a world's description.
const KERNEL: &str = "area-weighted where posts are coarser than samples, else bilinear; samples at pixel centres";

/// Bytes that are there without a file.
#[derive(Debug, Clone, Copy)]
pub struct Bytes {
    /// What a file with them would be called.
    pub name: &'static str,
    /// Its content.
    pub content: &'static [u8],
}

/// Where a source or a file of features is.
#[derive(Debug, Clone)]
pub enum Input {
    /// On disk.
    File(PathBuf),
    /// In the program.
    Embedded(Bytes),
}

/// What to bake.
#[derive(Debug, Clone)]
pub struct BakeRequest {
    /// The world's name.
    pub name: String,
    /// Files of heights, each with the factor that turns its numbers into metres (1 for metres).
    pub sources: Vec<(Input, f64)>,
    /// Files of features: OSM PBF and XML, GeoJSON, shapefiles, tables of airfields.
    pub features: Vec<Input>,
    /// Photographs of the ground.
    pub imagery: Vec<PathBuf>,
    /// Distance between posts, metres, 25..=400.
    pub step_m: f64,
    /// The world's centre; the middle of the data if not given.
    pub centre: Option<Geodetic>,
    /// Width and height in kilometres, rounded outward to whole blocks; what holds the data, at most 400 km, if not
    /// given.
    pub size_km: Option<[f64; 2]>,
}

impl Input {
    /// A file's path with an optional factor for its heights after an `@`: `dem.png@0.1` is in decimetres.
    pub fn parse(text: &str) -> (Self, f64) {
        if let Some((path, factor)) = text.rsplit_once('@')
            && let Ok(factor) = factor.parse::<f64>()
            && !Path::new(text).exists()
        {
            return (Self::File(path.into()), factor);
        }
        (Self::File(text.into()), 1.0)
    }

    /// What a person would call it: the file's name without its folder.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            Self::Embedded(bytes) => bytes.name.to_owned(),
        }
    }

    fn shown(&self) -> String {
        match self {
            Self::File(path) => path.display().to_string(),
            Self::Embedded(bytes) => bytes.name.to_owned(),
        }
    }

    fn raster(&self) -> Result<Raster, Unreadable> {
        match self {
            Self::File(path) => open::open(path),
            Self::Embedded(bytes) => open::read(bytes.content, bytes.name, None),
        }
    }
}

/// Bakes a world. `progress` is told the stage and how much of it is done, 0..=1.
///
/// # Errors
/// [`BakeError`] names the file or the number that is wrong, what was expected and what was found.
pub fn bake(request: &BakeRequest, progress: &mut dyn FnMut(&str, f32)) -> Result<World, BakeError> {
    if request.sources.is_empty() {
        return Err(BakeError::NoSource);
    }
    let mut rasters = Vec::with_capacity(request.sources.len());
    for (number, (input, height_scale)) in request.sources.iter().enumerate() {
        progress("reading", number as f32 / request.sources.len() as f32);
        rasters.push(scaled(input, *height_scale)?);
    }
    progress("reading", 1.0);
    let (projection, grid) = extent(&rasters, request.step_m, request.centre, request.size_km)?;

    let mut photos = Vec::new();
    for path in &request.imagery {
        let failed = |problem| BakeError::Source { file: path.display().to_string(), problem };
        photos.push(photo::open(path).map_err(failed)?);
    }
    let mut sampled = mosaic(&grid, &projection, &rasters, &mut |done| progress("resampling", done));
    let inside = sampled.covered.iter().filter(|c| **c).count();
    if sampled.heights_m.iter().all(|h| h.is_nan()) {
        let at = middle(&rasters);
        let data = format!("about {:.3}, {:.3} (latitude, longitude)", at.lat_deg(), at.lon_deg());
        return Err(if inside == 0 { BakeError::NoOverlap { data } } else { BakeError::AllVoid });
    }
    progress("filling voids", 0.0);
    let filled = void_fill::fill(&mut sampled.heights_m, &sampled.covered, grid.columns() as usize);
    let voids = Voids {
        posts: filled.posts,
        share: filled.posts as f64 / inside as f64,
        largest_posts: filled.largest_posts,
        beyond_posts: grid.posts() - inside,
    };
    progress("filling voids", 1.0);
    progress("features", 0.0);
    let read = read_features(request)?;
    let mut placed = features::place(&read.features, &projection, &grid);
    progress("lakes", 0.0);
    let (lakes, lake_infos, mut ponds) =
        features::set_lakes(std::mem::take(&mut placed.waters), &grid, &mut sampled.heights_m, &mut placed.counts);
    placed.features.areas.append(&mut ponds);
    progress("lakes", 1.0);
    placed.features.airfields =
        set_airfields(&read.airfields, &mut placed, &projection, &lakes, &grid, &mut sampled.heights_m)?;
    let statistics = statistics(&sampled.heights_m);
    // Samples are within the field's bounds and means do not leave them; a lake's level was checked when read.
    let field = Arc::new(Field::new(grid, sampled.heights_m).map_err(|_| BakeError::AllVoid)?);
    if !placed.features.waterways.is_empty() {
        let ground = Ground::new(field.clone()).whole();
        features::turn_downstream(&mut placed.features.waterways, &ground, &mut placed.counts);
    }

    let mut info = WorldInfo {
        format_version: FORMAT_VERSION,
        name: request.name.clone(),
        projection: "transverse Mercator on WGS84 about the centre, scale 1; x east, z south, metres".into(),
        centre_lat_deg: written_deg(projection.centre().lat_rad),
        centre_lon_deg: written_deg(projection.centre().lon_rad),
        step_m: grid.step_m,
        blocks_x: grid.blocks_x,
        blocks_z: grid.blocks_z,
        kernel: KERNEL.into(),
        extent: Extent { west_m: grid.west_m, north_m: grid.north_m, east_m: grid.east_m(), south_m: grid.south_m() },
        statistics,
        voids,
        sources: described(request, &projection, &rasters),
        features: placed.counts.described(),
        cover: None,
        imagery: request.imagery.iter().zip(&photos).map(|(path, photo)| photo.described(&projection, path)).collect(),
        lakes: lake_infos,
        files: Vec::new(),
    };
    let name = request.name.clone();
    let mut features = placed.features;
    features.placed = placing::placed(&features, &lakes, &field);
    let features = Arc::new(features);
    progress("cover", 0.0);
    let climate = Climate::of(projection.centre(), info.statistics.mean_m);
    let cover = Arc::new(bake_cover(&field, &lakes, &features, &climate));
    info.cover = cover_bake::described(&cover);
    progress("cover", 1.0);
    let mut world = World { name, projection, field, lakes, features, cover, imagery: None, masks: Vec::new(), info };
    progress("imagery", 0.0);
    world.imagery = imagery(&world, &climate, &photos).map(Arc::new);
    progress("masks", 0.0);
    world.make_ring_masks();
    Ok(world)
}

fn scaled(input: &Input, height_scale: f64) -> Result<Raster, BakeError> {
    if !(height_scale.is_finite() && height_scale != 0.0) {
        return Err(BakeError::HeightScale { file: input.shown(), scale: height_scale });
    }
    let mut raster = input.raster().map_err(|problem| BakeError::Source { file: input.shown(), problem })?;
    if height_scale != 1.0 {
        for sample in &mut raster.samples_m {
            let scaled = (f64::from(*sample) * height_scale) as f32;
            *sample = if scaled.abs() <= crate::field::MAX_HEIGHT_M { scaled } else { f32::NAN };
        }
    }
    Ok(raster)
}

/// All features of all files.
fn read_features(request: &BakeRequest) -> Result<Content, BakeError> {
    let mut all = Content::default();
    for input in &request.features {
        let read = features::open(input);
        let mut read = read.map_err(|problem| BakeError::Features { file: input.shown(), problem })?;
        all.features.append(&mut read.features);
        all.airfields.append(&mut read.airfields);
    }
    Ok(all)
}

/// Airfields in the ground, if any file has some.
fn set_airfields(
    rows: &[AirfieldRow],
    placed: &mut Placed,
    projection: &Projection,
    lakes: &Lakes,
    grid: &Grid,
    heights_m: &mut [f32],
) -> Result<Vec<Airfield>, BakeError> {
    let drawn = std::mem::take(&mut placed.aeroways);
    if rows.is_empty() && drawn.is_empty() {
        return Ok(Vec::new());
    }
    let before = Field::new(*grid, heights_m.to_vec()).map_err(|_| BakeError::AllVoid)?;
    let ground = Ground::new(Arc::new(before)).whole();
    let site = Site { projection, ground: &ground, lakes };
    Ok(features::set_airfields(rows, drawn, &site, heights_m, &mut placed.counts))
}

fn statistics(heights_m: &[f32]) -> Statistics {
    let (mut min_m, mut max_m, mut sum, mut number) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
    for height in heights_m.iter().filter(|h| !h.is_nan()).map(|h| f64::from(*h)) {
        min_m = min_m.min(height);
        max_m = max_m.max(height);
        sum += height;
        number += 1.0;
    }
    Statistics { posts: heights_m.len(), min_m, max_m, mean_m: sum / number }
}

/// The sources as a world's description has them, finest first.
fn described(request: &BakeRequest, projection: &Projection, rasters: &[Raster]) -> Vec<Source> {
    let mut sources: Vec<Source> = request
        .sources
        .iter()
        .zip(rasters)
        .map(|((input, height_scale), raster)| Source {
            file: input.name(),
            format: raster.format.into(),
            system: raster.crs.name(),
            columns: raster.columns,
            rows: raster.rows,
            void_samples: raster.voids(),
            pixel_m: pixel_m(projection, raster).to_array(),
            height_scale: *height_scale,
            credit: raster.credit.clone().unwrap_or_default(),
            note: raster.crs.note().unwrap_or_default().into(),
        })
        .collect();
    sources.sort_by(|a, b| (a.pixel_m[0] * a.pixel_m[1]).total_cmp(&(b.pixel_m[0] * b.pixel_m[1])));
    sources
}
