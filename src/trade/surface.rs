//! How far the surface drawn is from the ground, as pixels of the reference view.
//!
//! Reference view: 1080 rows over 60 degrees, on axis. The vertical distance between the drawn triangles and the ground
//! is taken at 16 places of every sub-block in view, evenly over the ground; divided by the distance of the place from
//! the eye and multiplied by the focal length it is the error on screen. The largest is that of every sub-block's own
//! exact maximum at its nearest point in plan, as the limit of its ring means it.

use glam::{DVec2, DVec3};
use terrain::POSTS;
use terrain::block::mask::{SUBS, block_posts};
use terrain::block::payload::Landscape;
use terrain::block::rings::REFERENCE_FOCAL_PX;
use terrain::block::template::{self, FINE};
use terrain::block::window::Draw;

/// A sum that a root mean square and a largest value come from.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spread {
    squares: f64,
    count: f64,
    /// Largest absolute value.
    pub largest: f64,
}

impl Spread {
    /// Takes a value in; NaN is left out.
    pub fn add(&mut self, value: f64) {
        if value.is_nan() {
            return;
        }
        self.squares += value * value;
        self.count += 1.0;
        self.largest = self.largest.max(value.abs());
    }

    /// Root mean square; NaN of nothing.
    pub fn rms(&self) -> f64 {
        (self.squares / self.count).sqrt()
    }
}

/// Adds the errors of the blocks drawn for an eye, pixels.
pub fn add_errors_px(landscape: &Landscape, draws: &[Draw], eye_m: DVec3, spread: &mut Spread) {
    let field = landscape.ground.field();
    let grid = *field.grid();
    for draw in draws {
        let mask = landscape.masks.mask(&grid, draw.block, draw.ring);
        let posts = block_posts(field, draw.block);
        for at in 0..SUBS * SUBS {
            let (column, row) = (at % SUBS, at / SUBS);
            let corner = 2 * row * POSTS as usize + 2 * column;
            let nine: [f32; 9] = std::array::from_fn(|post| posts[corner + post / 3 * POSTS as usize + post % 3]);
            let west_m = grid.x_m(draw.block.first_column() + 2 * column as i64);
            let north_m = grid.z_m(draw.block.first_row() + 2 * row as i64);
            let template = mask.template(column, row);
            let px = |at: DVec2, ground_m: f64, error_m: f64| {
                let place = DVec3::new(west_m + at.x * grid.step_m, ground_m, north_m + at.y * grid.step_m);
                error_m / place.distance(eye_m).max(1.0) * REFERENCE_FOCAL_PX
            };
            for sample in 0..16 {
                let at = DVec2::new((sample % 4) as f64 * 0.5 + 0.25, (sample / 4) as f64 * 0.5 + 0.25);
                let ground_m = height_m(FINE, &nine, at);
                spread.add(px(at, ground_m, height_m(template, &nine, at) - ground_m));
            }
            let error_m = template::error_m(template, &nine);
            let side_m = 2.0 * grid.step_m;
            let east_m = (west_m - eye_m.x).max(eye_m.x - (west_m + side_m)).max(0.0);
            let south_m = (north_m - eye_m.z).max(eye_m.z - (north_m + side_m)).max(0.0);
            let most_px = error_m / east_m.hypot(south_m).max(1.0) * REFERENCE_FOCAL_PX;
            // A void is no error: max ignores NaN.
            spread.largest = spread.largest.max(most_px);
        }
    }
}

/// Height of a template's surface at a place in its sub-block, in cells from its north-west corner. NaN over void.
fn height_m(template: usize, nine: &[f32; 9], at: DVec2) -> f64 {
    let corner = |post: u8| DVec2::new(f64::from(post % 3), f64::from(post / 3));
    for triangle in template::triangles(template) {
        let [a, b, c] = triangle.map(corner);
        let area = (b - a).perp_dot(c - a);
        let weights =
            [(c - b).perp_dot(at - b) / area, (a - c).perp_dot(at - c) / area, (b - a).perp_dot(at - a) / area];
        // Places are quarters and corners whole: all of this is exact.
        if weights.iter().all(|weight| *weight >= 0.0) {
            let heights = triangle.map(|post| f64::from(nine[usize::from(post)]));
            return weights.iter().zip(heights).map(|(weight, height_m)| weight * height_m).sum();
        }
    }
    f64::NAN
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_template_is_wrong_by_what_it_leaves_out_and_a_fine_one_by_nothing() {
        let mut nine = [0.0f32; 9];
        nine[4] = 8.0;
        let middle = DVec2::ONE;
        assert_eq!((height_m(FINE, &nine, middle), height_m(0, &nine, middle)), (8.0, 0.0));
        // Every template covers its whole sub-block, with heights from its corners' range.
        for template in 0..=FINE {
            for sample in 0..16 {
                let at = DVec2::new((sample % 4) as f64 * 0.5 + 0.25, (sample / 4) as f64 * 0.5 + 0.25);
                let height = height_m(template, &[5.0; 9], at);
                assert!((height - 5.0).abs() < 1e-12, "template {template} at {at}: {height}");
            }
        }
        // The largest error that the mask's own arithmetic finds is met at a post or a crossing of edges.
        for template in 0..FINE {
            let exact = template::error_m(template, &nine);
            let at_posts = (0..9).map(|post| {
                let at = DVec2::new((post % 3) as f64, (post / 3) as f64);
                (height_m(template, &nine, at) - f64::from(nine[post])).abs()
            });
            assert!(at_posts.fold(0.0, f64::max) <= exact + 1e-9, "template {template}");
        }
    }

    #[test]
    fn spreads_are_root_mean_squares() {
        let mut spread = Spread::default();
        [3.0, -4.0, f64::NAN].iter().for_each(|value| spread.add(*value));
        assert_eq!((spread.rms(), spread.largest), (12.5f64.sqrt(), 4.0));
        assert!(Spread::default().rms().is_nan());
    }
}
