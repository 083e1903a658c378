//! Where a baked world lies: its centre, its size in whole blocks, its limits.

use super::error::BakeError;
use super::mosaic::bounds_m;
use super::raster::Raster;
use crate::grid::{CELLS, Grid};
use crate::projection::{Geodetic, Projection, wrapped_rad};

/// Smallest step, metres.
pub const MIN_STEP_M: f64 = 25.0;
/// Largest step, metres.
pub const MAX_STEP_M: f64 = 400.0;
/// Most posts of a world: 256 MiB of heights.
pub const MAX_POSTS: u64 = 1 << 26;
/// Longest side that may be asked for, kilometres: further out the map's scale is off by more than 0.3 %.
pub const MAX_SIDE_KM: f64 = 1_000.0;
/// Longest side when none is asked for, metres.
const DEFAULT_SIDE_M: f64 = 400_000.0;

/// The world's map and posts for sources, a step and what else was asked for.
pub fn extent(
    sources: &[Raster],
    step_m: f64,
    centre: Option<Geodetic>,
    size_km: Option<[f64; 2]>,
) -> Result<(Projection, Grid), BakeError> {
    if !(MIN_STEP_M..=MAX_STEP_M).contains(&step_m) {
        return Err(BakeError::Step(step_m));
    }
    let centre = centre.unwrap_or_else(|| middle(sources));
    let centre = Geodetic::from_degrees(written_deg(centre.lat_rad), written_deg(centre.lon_rad));
    let projection = Projection::new(centre).map_err(BakeError::Centre)?;
    let block_m = step_m * f64::from(CELLS);
    // A side that is whole blocks but for rounding is not rounded up.
    let blocks = |side_m: f64| (side_m / block_m - 1e-6).ceil().max(1.0) as u32;
    let [blocks_x, blocks_z] = match size_km {
        Some(size) => {
            if !size.iter().all(|side| *side > 0.0 && *side <= MAX_SIDE_KM) {
                return Err(BakeError::Size(size));
            }
            size.map(|side_km| blocks(side_km * 1000.0))
        }
        None => {
            // The square root of the posts that a world may have bounds fine steps.
            let most_m = DEFAULT_SIDE_M.min(((MAX_POSTS as f64).sqrt() - 1.0 - f64::from(CELLS)) * step_m);
            let (mut half_x, mut half_z) = (0.0_f64, 0.0_f64);
            for raster in sources {
                let (low, high) = bounds_m(&projection, raster);
                half_x = half_x.max(-low.x).max(high.x);
                half_z = half_z.max(-low.y).max(high.y);
            }
            [half_x, half_z].map(|half_m| blocks((2.0 * half_m).min(most_m)))
        }
    };
    let posts = (u64::from(blocks_x) * u64::from(CELLS) + 1) * (u64::from(blocks_z) * u64::from(CELLS) + 1);
    if posts > MAX_POSTS {
        return Err(BakeError::Posts(posts));
    }
    let grid = Grid::centred(step_m, blocks_x, blocks_z).map_err(|_| BakeError::Posts(posts))?;
    Ok((projection, grid))
}

/// An angle in degrees with so few digits (0.1 mm on the ground) that writing and reading it changes nothing.
pub fn written_deg(angle_rad: f64) -> f64 {
    (angle_rad.to_degrees() * 1e9).round() / 1e9
}

/// The middle of the sources' bounding box in latitude and longitude, also across the date line.
pub fn middle(sources: &[Raster]) -> Geodetic {
    let outlines: Vec<Geodetic> = sources.iter().flat_map(Raster::outline).collect();
    let Some(first) = outlines.first().copied() else { return Geodetic::from_degrees(0.0, 0.0) };
    let (mut south, mut north, mut west, mut east) = (f64::INFINITY, f64::NEG_INFINITY, 0.0_f64, 0.0_f64);
    for place in outlines {
        south = south.min(place.lat_rad);
        north = north.max(place.lat_rad);
        let from_first = wrapped_rad(place.lon_rad - first.lon_rad);
        west = west.min(from_first);
        east = east.max(from_first);
    }
    Geodetic { lat_rad: 0.5 * (south + north), lon_rad: wrapped_rad(first.lon_rad + 0.5 * (west + east)) }
}
