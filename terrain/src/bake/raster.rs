//! A rectangle of height samples and where it lies: what every reader makes and the resampler reads.
//!
//! Pixel-centre rule: pixel coordinates (u, v) run east and south over the raster's *area*, (0, 0) at the outer corner
//! of the first pixel, and sample (i, j) stands at the pixel's centre (i + 0.5, j + 0.5). Formats that place samples
//! on points (SRTM, USGS, pixel-is-point GeoTIFF) are given half a pixel of area around them.
//!
//! Heights in metres above mean sea level, as the source has them. A void is NaN. Invariant: a sample is finite and
//! within the bounds of a [`Field`](crate::Field), or NaN.

use super::crs::Crs;
use crate::field::MAX_HEIGHT_M;
use crate::projection::Geodetic;
use glam::{DMat2, DVec2};
use std::fmt;

/// Samples and their georeference.
#[derive(Debug, Clone)]
pub struct Raster {
    /// Samples along a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// Row by row.
    pub samples_m: Vec<f32>,
    /// Where they lie.
    pub affine: Affine,
    /// In which system.
    pub crs: Crs,
    /// Which format it was read from.
    pub format: &'static str,
    /// Who must be credited, if the file says so.
    pub credit: Option<String>,
}

/// From pixel coordinates to those of the coordinate system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// The outer corner of the first pixel.
    pub origin: DVec2,
    /// From one pixel to the next in a row.
    pub right: DVec2,
    /// From one row to the next.
    pub down: DVec2,
}

/// Why bytes are not a raster.
#[derive(Debug, Clone, PartialEq)]
pub struct Unreadable {
    /// What should have been there.
    pub expected: String,
    /// What was there.
    pub found: String,
}

/// Most samples of one file: 23,000 x 23,000, 2 GiB in memory.
pub const MAX_SAMPLES: u64 = 1 << 29;

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected {}, found {}", self.expected, self.found)
    }
}

impl Unreadable {
    /// From what was expected and found.
    pub fn new(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self { expected: expected.into(), found: found.into() }
    }
}

impl Raster {
    /// A raster; samples that are not heights become void.
    ///
    /// # Errors
    /// [`Unreadable`] if it is empty, the samples do not fill it, or the georeference maps it to a line or to no place.
    pub fn new(
        (columns, rows): (usize, usize),
        mut samples_m: Vec<f32>,
        affine: Affine,
        crs: Crs,
        format: &'static str,
    ) -> Result<Self, Unreadable> {
        if columns == 0 || rows == 0 || columns.checked_mul(rows) != Some(samples_m.len()) {
            let found = format!("{} for {columns} x {rows}", samples_m.len());
            return Err(Unreadable::new("as many samples as the size needs, at least one", found));
        }
        for sample in &mut samples_m {
            // Also true of the infinities; NaN stays what it is.
            if sample.abs() > MAX_HEIGHT_M {
                *sample = f32::NAN;
            }
        }
        let raster = Self { columns, rows, samples_m, affine, crs, format, credit: None };
        raster.checked()
    }

    pub(super) fn checked(self) -> Result<Self, Unreadable> {
        let Affine { origin, right, down } = self.affine;
        let area = right.perp_dot(down);
        if !(origin.is_finite() && right.is_finite() && down.is_finite() && area.is_finite() && area != 0.0) {
            return Err(Unreadable::new("a georeference that spans an area", format!("{:?}", self.affine)));
        }
        let (width, height) = (self.columns as f64, self.rows as f64);
        for (u, v) in [(0.0, 0.0), (width, 0.0), (0.0, height), (width, height)] {
            let at = self.affine.at(DVec2::new(u, v));
            let in_range = match self.crs {
                // Half a pixel beyond the pole is a habit of global grids.
                Crs::Geographic(_) => at.y.abs() <= 91.0 && at.x.abs() <= 541.0,
                Crs::TransverseMercator { .. } => at.x.abs() <= 4.0e6 && at.y.abs() <= 2.1e7,
            };
            if !in_range {
                let found = format!("a corner at {:.6}, {:.6}", at.x, at.y);
                return Err(Unreadable::new(format!("corners on the Earth ({})", self.crs.name()), found));
            }
        }
        Ok(self)
    }

    /// Sample in column `i` of row `j`; both must be inside.
    pub fn sample_m(&self, i: usize, j: usize) -> f32 {
        self.samples_m[j * self.columns + i]
    }

    /// The place on WGS84 of pixel coordinates.
    pub fn place(&self, pixel: DVec2) -> Geodetic {
        self.crs.to_wgs84(self.affine.at(pixel))
    }

    /// Pixel coordinates of a place on WGS84; outside the area if it lies there.
    pub fn pixel(&self, inverse: &Inverse, place: Geodetic) -> DVec2 {
        let at = self.crs.from_wgs84(place);
        if let Crs::Geographic(_) = self.crs {
            // The turn of the Earth that brings the longitude next to the raster.
            let turns = ((at.x - inverse.mid_lon_deg) / 360.0).round();
            return inverse.apply(DVec2::new(at.x - 360.0 * turns, at.y));
        }
        inverse.apply(at)
    }

    /// What [`Raster::pixel`] needs, worked out once.
    pub fn inverse(&self) -> Inverse {
        let middle = self.affine.at(DVec2::new(0.5 * self.columns as f64, 0.5 * self.rows as f64));
        Inverse {
            origin: self.affine.origin,
            matrix: DMat2::from_cols(self.affine.right, self.affine.down).inverse(),
            mid_lon_deg: middle.x,
        }
    }

    /// Number of void samples.
    pub fn voids(&self) -> usize {
        self.samples_m.iter().filter(|h| h.is_nan()).count()
    }

    /// Places along the area's outline, closed, so dense that what lies between them is straight enough.
    pub fn outline(&self) -> Vec<Geodetic> {
        const PER_SIDE: usize = 32;
        let (width, height) = (self.columns as f64, self.rows as f64);
        let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)].map(|(u, v)| DVec2::new(u, v));
        let mut places = Vec::with_capacity(4 * PER_SIDE);
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            places.extend((0..PER_SIDE).map(|i| self.place(from.lerp(to, i as f64 / PER_SIDE as f64))));
        }
        places
    }
}

impl Affine {
    /// Coordinates at pixel coordinates.
    pub fn at(&self, pixel: DVec2) -> DVec2 {
        self.origin + pixel.x * self.right + pixel.y * self.down
    }

    /// North up, no shear: the north-west corner of the *area*, and a pixel's size, positive.
    pub fn north_up(west: f64, north: f64, size: DVec2) -> Self {
        Self { origin: DVec2::new(west, north), right: DVec2::new(size.x, 0.0), down: DVec2::new(0.0, -size.y) }
    }

    /// The same grid when `origin` was the centre of the first pixel.
    pub fn from_centre(mut self) -> Self {
        self.origin -= 0.5 * (self.right + self.down);
        self
    }
}

/// From coordinates to pixel coordinates.
#[derive(Debug, Clone, Copy)]
pub struct Inverse {
    origin: DVec2,
    matrix: DMat2,
    mid_lon_deg: f64,
}

impl Inverse {
    fn apply(&self, at: DVec2) -> DVec2 {
        self.matrix * (at - self.origin)
    }
}
