//! The kernel: what one source says at one post.
//!
//! A post stands for the square of the world's plane, one step a side, about it. Where that square is larger than a
//! source's pixels, the post is the mean of the samples weighted by the area of their pixels inside the square's image;
//! where it is smaller, the image is widened to one pixel about the post's exact place, and the same sum is bilinear
//! interpolation. It is one kernel for both, each axis of the source on its own: a box of `max(1, image)` pixels.
//!
//! The image of a square is the upright rectangle in pixel coordinates between the images of its north-west and
//! south-east corners, as `gdalwarp -r average` takes it; a post's own image, and those corners, are projected exactly,
//! none interpolated. Void samples and what lies beyond the source carry no weight and the rest is renormalised; a
//! source is silent at a post if less than half of the weight inside it is data, or if the post is beyond its area.

use super::raster::{Inverse, Raster};
use crate::projection::Geodetic;
use glam::DVec2;

/// What sources say at a post, summed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Share {
    /// Heights times weight.
    pub sum_m: f64,
    /// Weight of samples that are heights.
    pub valid: f64,
    /// Weight of all samples, voids too.
    pub inside: f64,
}

/// The places that a post's answer needs.
#[derive(Debug, Clone, Copy)]
pub struct Footprint {
    /// The post itself.
    pub post: Geodetic,
    /// North-west corner of its square, and the south-eastern.
    pub corners: Option<[Geodetic; 2]>,
}

/// A source made ready to be asked.
pub struct Sampler<'a> {
    raster: &'a Raster,
    inverse: Inverse,
    /// Size of a pixel in the world at the raster's middle, metres: along rows, along columns.
    pub pixel_m: DVec2,
    /// Least side of any pixel, metres.
    pub least_pixel_m: f64,
}

impl Share {
    /// The height, if at least half of the weight is data.
    pub fn height_m(&self) -> Option<f32> {
        (self.valid > 0.0 && self.valid >= 0.5 * self.inside).then(|| (self.sum_m / self.valid) as f32)
    }

    /// Adds what a neighbouring piece of the same grid says. One piece's void does not outvote the other's data, so
    /// the weight inside is that of the piece that has most.
    pub fn merge(&mut self, other: Self) {
        self.sum_m += other.sum_m;
        self.valid += other.valid;
        self.inside = self.inside.max(other.inside);
    }
}

impl<'a> Sampler<'a> {
    /// A raster whose pixels have that size in the world.
    pub fn new(raster: &'a Raster, pixel_m: DVec2, least_pixel_m: f64) -> Self {
        Self { raster, inverse: raster.inverse(), pixel_m, least_pixel_m }
    }

    /// Whether posts that far apart are coarser than the source along either axis, so that corners are needed.
    pub fn needs_corners(&self, step_m: f64) -> bool {
        // A tenth for the turn between the two grids, which makes the image's rectangle wider: 5.7 degrees.
        step_m > 0.9 * self.least_pixel_m
    }

    /// Adds what the source says; `false` and nothing added if the post is beyond its area.
    pub fn add(&self, at: &Footprint, share: &mut Share) -> bool {
        let post = self.raster.pixel(&self.inverse, at.post);
        let size = DVec2::new(self.raster.columns as f64, self.raster.rows as f64);
        // Written so that NaN is outside.
        let inside = post.x >= 0.0 && post.y >= 0.0 && post.x <= size.x && post.y <= size.y;
        let (mut low, mut high) = (post - 0.5, post + 0.5);
        if let Some(corners) = at.corners {
            let [a, b] = corners.map(|corner| self.raster.pixel(&self.inverse, corner));
            let (min, max) = (a.min(b), a.max(b));
            for axis in 0..2 {
                if max[axis] - min[axis] > 1.0 {
                    (low[axis], high[axis]) = (min[axis], max[axis]);
                }
            }
        }
        self.add_box(low, high, share);
        inside
    }

    fn add_box(&self, low: DVec2, high: DVec2, share: &mut Share) {
        let (columns, rows) = (self.raster.columns, self.raster.rows);
        let (Some((i0, i1)), Some((j0, j1))) = (span(low.x, high.x, columns), span(low.y, high.y, rows)) else {
            return;
        };
        for j in j0..j1 {
            let weight_j = overlap(low.y, high.y, j);
            let row = &self.raster.samples_m[j * columns + i0..j * columns + i1];
            for (i, &height_m) in (i0..i1).zip(row) {
                let weight = weight_j * overlap(low.x, high.x, i);
                share.inside += weight;
                if !height_m.is_nan() {
                    share.valid += weight;
                    share.sum_m += weight * f64::from(height_m);
                }
            }
        }
    }
}

/// The pixels that an interval touches, cut to those there are.
fn span(low: f64, high: f64, count: usize) -> Option<(usize, usize)> {
    if !(low < count as f64 && high > 0.0) {
        return None;
    }
    Some((low.max(0.0) as usize, (high.ceil() as usize).min(count)))
}

/// Length of the interval inside pixel `i`.
fn overlap(low: f64, high: f64, i: usize) -> f64 {
    let west = i as f64;
    (high.min(west + 1.0) - low.max(west)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::super::crs::{Crs, DATUM_WGS84};
    use super::super::raster::Affine;
    use super::*;

    fn ramp() -> Raster {
        let samples = (0..16).map(|i| (i % 4) as f32 + 10.0 * (i / 4) as f32).collect();
        let affine = Affine::north_up(10.0, 50.0, DVec2::ONE);
        Raster::new((4, 4), samples, affine, Crs::Geographic(DATUM_WGS84), "test").unwrap()
    }

    fn asked(raster: &Raster, low: DVec2, high: DVec2) -> Share {
        let mut share = Share::default();
        Sampler::new(raster, DVec2::ONE, 1.0).add_box(low, high, &mut share);
        share
    }

    #[test]
    fn a_box_of_one_pixel_is_bilinear_and_a_larger_one_an_area_mean() {
        let raster = ramp();
        // Centres stand at halves: (1.75, 2.25) is 1/4 past column 1 and 3/4 past row 1.
        let at = DVec2::new(1.75, 2.25);
        let share = asked(&raster, at - 0.5, at + 0.5);
        assert_eq!(share.height_m(), Some(1.25 + 17.5));
        // Columns 0.5..3: weights 1/2, 1, 1; rows 1..2.
        let share = asked(&raster, DVec2::new(0.5, 1.0), DVec2::new(3.0, 2.0));
        assert_eq!(share.height_m(), Some(10.0 + 3.0 / 2.5));
    }

    #[test]
    fn half_the_weight_decides_and_the_edge_is_no_void() {
        let mut raster = ramp();
        raster.samples_m[5] = f32::NAN;
        let at = DVec2::new(1.75, 1.5);
        // 3/4 of the weight is void.
        assert_eq!(asked(&raster, at - 0.5, at + 0.5).height_m(), None);
        let at = DVec2::new(2.25, 1.5);
        assert_eq!(asked(&raster, at - 0.5, at + 0.5).height_m(), Some(12.0));
        let corner = asked(&raster, DVec2::splat(-0.5), DVec2::splat(0.5));
        assert_eq!((corner.height_m(), corner.inside), (Some(0.0), 0.25));
        for far in [DVec2::splat(9.0), DVec2::splat(-9.0), DVec2::NAN] {
            assert_eq!(asked(&raster, far - 0.5, far + 0.5), Share::default());
        }
    }
}
