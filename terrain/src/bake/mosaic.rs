//! Several sources laid over the posts, finest first.
//!
//! Sources are ordered by pixel area and, where that is the same, as they were given. At each post the finest source
//! that is not silent there decides; sources of one pixel size in one coordinate system answer together, so that the
//! border between neighbouring tiles is interpolated across. What no source answers inside the union of their areas is
//! a void; beyond it there is no data.

use super::raster::Raster;
use super::resample::{Footprint, Sampler, Share};
use crate::grid::Grid;
use crate::projection::{Geodetic, Projection};
use glam::DVec2;
use rayon::prelude::*;

/// Rows worked on by one task.
const STRIP: usize = 8;
/// Tasks between two reports of progress.
const REPORT: usize = 16;

/// Heights of the posts, and which of them lie on data.
pub struct Mosaic {
    /// Row by row; NaN where no source answers.
    pub heights_m: Vec<f32>,
    /// Whether the post lies in the area of any source.
    pub covered: Vec<bool>,
}

struct Layer<'a> {
    sampler: Sampler<'a>,
    corners: bool,
    /// Plan rectangle that holds the source's area and half a step and a pixel around it, metres.
    low: DVec2,
    high: DVec2,
}

/// Samples every post of the grid.
pub fn mosaic(grid: &Grid, projection: &Projection, sources: &[Raster], progress: &mut dyn FnMut(f32)) -> Mosaic {
    let groups = groups(grid, projection, sources);
    let (columns, rows) = (grid.columns() as usize, grid.rows() as usize);
    let mut heights_m = vec![f32::NAN; columns * rows];
    let mut covered = vec![false; columns * rows];
    let batch = columns * STRIP * REPORT;
    for (number, (heights, covered)) in heights_m.chunks_mut(batch).zip(covered.chunks_mut(batch)).enumerate() {
        progress((number * STRIP * REPORT) as f32 / rows as f32);
        let strips = heights.par_chunks_mut(columns * STRIP).zip(covered.par_chunks_mut(columns * STRIP));
        strips.enumerate().for_each(|(strip, (heights, covered))| {
            let first = (number * REPORT + strip) * STRIP;
            sample_strip(grid, projection, &groups, first, heights, covered);
        });
    }
    progress(1.0);
    Mosaic { heights_m, covered }
}

fn sample_strip(
    grid: &Grid,
    projection: &Projection,
    groups: &[Vec<Layer>],
    first: usize,
    heights_m: &mut [f32],
    covered: &mut [bool],
) {
    let columns = grid.columns() as usize;
    let corners = groups.iter().flatten().any(|layer| layer.corners);
    let corner_row = |row: usize| -> Vec<Geodetic> {
        let z = grid.z_m(row as i64) - 0.5 * grid.step_m;
        let x = |column: usize| grid.x_m(column as i64) - 0.5 * grid.step_m;
        (0..=columns).map(|column| projection.to_geodetic(DVec2::new(x(column), z))).collect()
    };
    let mut north = if corners { corner_row(first) } else { Vec::new() };
    let rows = heights_m.chunks_mut(columns).zip(covered.chunks_mut(columns));
    for (row, (heights_m, covered)) in (first..).zip(rows) {
        let south = if corners { corner_row(row + 1) } else { Vec::new() };
        for column in 0..columns {
            let at = DVec2::new(grid.x_m(column as i64), grid.z_m(row as i64));
            if groups.iter().flatten().any(|layer| layer.may_reach(at)) {
                let square = corners.then(|| [north[column], south[column + 1]]);
                let post = projection.to_geodetic(at);
                (heights_m[column], covered[column]) = answer(groups, at, post, square);
            }
        }
        north = south;
    }
}

/// The height at a post and whether the post lies on data.
fn answer(groups: &[Vec<Layer>], at: DVec2, post: Geodetic, square: Option<[Geodetic; 2]>) -> (f32, bool) {
    let mut covered = false;
    for group in groups {
        let mut share = Share::default();
        let mut on_group = false;
        for layer in group.iter().filter(|layer| layer.may_reach(at)) {
            let footprint = Footprint { post, corners: square.filter(|_| layer.corners) };
            let mut one = Share::default();
            on_group |= layer.sampler.add(&footprint, &mut one);
            share.merge(one);
        }
        covered |= on_group;
        if let Some(height_m) = share.height_m().filter(|_| on_group) {
            return (height_m, true);
        }
    }
    (f32::NAN, covered)
}

impl Layer<'_> {
    fn may_reach(&self, at: DVec2) -> bool {
        at.cmpge(self.low).all() && at.cmple(self.high).all()
    }
}

/// The sources, finest first, those that answer together in one group.
fn groups<'a>(grid: &Grid, projection: &Projection, sources: &'a [Raster]) -> Vec<Vec<Layer<'a>>> {
    let mut layers: Vec<(&Raster, Layer)> = sources
        .iter()
        .map(|raster| {
            let pixel_m = pixel_m(projection, raster);
            let (low, high) = bounds_m(projection, raster);
            // The outline is a polygon of short chords: what bulges beyond them is far less than a step or two pixels.
            let margin = DVec2::splat(grid.step_m + 2.0 * pixel_m.max_element());
            // In longitude a pixel narrows towards the pole: it is least in a corner.
            let (width, height) = (raster.columns as f64, raster.rows as f64);
            let corners = [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)];
            let sizes = corners.map(|(u, v)| size_m(projection, raster, DVec2::new(u, v)).min_element());
            let sampler = Sampler::new(raster, pixel_m, sizes.into_iter().fold(pixel_m.min_element(), f64::min));
            let corners = sampler.needs_corners(grid.step_m);
            (raster, Layer { sampler, corners, low: low - margin, high: high + margin })
        })
        .collect();
    let area = |layer: &Layer| layer.sampler.pixel_m.x * layer.sampler.pixel_m.y;
    layers.sort_by(|a, b| area(&a.1).total_cmp(&area(&b.1)));
    let mut groups: Vec<(&Raster, Vec<Layer>)> = Vec::new();
    for (raster, layer) in layers {
        match groups.last_mut() {
            Some((first, group)) if together(first, raster) => group.push(layer),
            _ => groups.push((raster, vec![layer])),
        }
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Whether two sources are pieces of one grid: the same system and, to a thousandth, the same pixel.
fn together(a: &Raster, b: &Raster) -> bool {
    let near = |p: DVec2, q: DVec2| (p - q).length() <= 1e-3 * p.length();
    a.crs == b.crs && near(a.affine.right, b.affine.right) && near(a.affine.down, b.affine.down)
}

/// Size of a pixel in the world at the raster's middle, metres.
pub fn pixel_m(projection: &Projection, raster: &Raster) -> DVec2 {
    size_m(projection, raster, 0.5 * DVec2::new(raster.columns as f64, raster.rows as f64))
}

/// Size in the world of a pixel with that centre, metres.
fn size_m(projection: &Projection, raster: &Raster, middle: DVec2) -> DVec2 {
    let world = |pixel| projection.to_world(raster.place(pixel));
    let length = |half: DVec2| (world(middle + half) - world(middle - half)).length();
    DVec2::new(length(DVec2::new(0.5, 0.0)), length(DVec2::new(0.0, 0.5)))
}

/// Plan rectangle of the raster's area, metres.
pub fn bounds_m(projection: &Projection, raster: &Raster) -> (DVec2, DVec2) {
    let outline = raster.outline();
    outline
        .iter()
        .map(|&place| projection.to_world(place))
        .filter(|at| at.is_finite())
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
}
