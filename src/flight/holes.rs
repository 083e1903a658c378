//! Holes: pixels that show sky where the ground should be.
//!
//! A hole is a pixel with cleared depth whose ray meets the ground within the range that the window guarantees. The far
//! surface may lie up to a pixel of the reference view under the ground, so along a skyline sky is right where a ray just
//! meets a ridge: a pixel counts only if the rays [`MARGIN_PX`] around it meet the ground too.

use crate::failure::Failure;
use crate::flight::device_failed;
use crate::scenery::Scenery;
use glam::DVec3;
use terrain::Area;
use visual::camera::{DEPTH_CLEAR, View};
use visual::capture;

/// How far around a pixel the ground must be met, pixels of the picture drawn.
const MARGIN_PX: f64 = 2.0;
/// Every how many pixels, along both sides, one is looked at.
const APART_PX: u32 = 8;
/// Longest ray for a pixel that looks straight down, metres: more than any eye is high.
const LONGEST_M: f64 = 200_000.0;

/// Holes among a grid of the last picture's pixels; `None` where its depth was not kept. `view` is the very view drawn.
///
/// # Errors
/// [`Failure::Failed`] if the device fails.
pub fn count(scenery: &Scenery, view: &View) -> Result<Option<u64>, Failure> {
    let Some(texture) = scenery.depth() else { return Ok(None) };
    let size_px = [texture.width(), texture.height()];
    let depth = capture::read_depth(&scenery.gpu, texture).map_err(device_failed)?;
    let range_m = scenery.terrain.window().view_range_min_m();
    Ok(Some(among(&depth, size_px, view, &scenery.area, range_m)))
}

fn among(depth: &[f32], [width, height]: [u32; 2], view: &View, area: &Area, range_m: f64) -> u64 {
    let meets = |x_px: f64, y_px: f64| {
        let ray = view.ray(x_px / f64::from(width), y_px / f64::from(height));
        meets_ground(area, view.eye_m, ray, range_m)
    };
    let mut holes = 0;
    for y in (APART_PX / 2..height).step_by(APART_PX as usize) {
        for x in (APART_PX / 2..width).step_by(APART_PX as usize) {
            if depth.get((y * width + x) as usize) != Some(&DEPTH_CLEAR) {
                continue;
            }
            let (x, y) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            // The highest ray of the five misses most often: it is asked first.
            let around = [(0.0, -1.0), (0.0, 0.0), (-1.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
            holes += u64::from(around.iter().all(|(dx, dy)| meets(x + dx * MARGIN_PX, y + dy * MARGIN_PX)));
        }
    }
    holes
}

/// Whether a ray from the eye meets the ground nearer, in plan, than `range_m`.
fn meets_ground(area: &Area, eye_m: DVec3, ray: DVec3, range_m: f64) -> bool {
    let ray = ray.normalize_or_zero();
    let level = ray.x.hypot(ray.z);
    let length_m = if level * LONGEST_M > range_m { range_m / level } else { LONGEST_M };
    area.segment(eye_m, eye_m + ray * length_m).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use terrain::{Grid, Ground, synthetic};

    #[test]
    fn sky_in_front_of_ground_is_a_hole_and_sky_over_it_is_none() {
        let grid = Grid::centred(200.0, 24, 24).expect("a grid");
        let area = Ground::new(Arc::new(synthetic::flat(grid, 100.0))).whole();
        let size_px = [320, 240];
        let level = View::fov_y(DVec3::new(13.0, 600.0, 7.0), glam::DQuat::IDENTITY, 1.0, size_px);
        // All sky: every looked-at pixel below the horizon, but for those whose ground is out of range, is a hole.
        let sky = vec![DEPTH_CLEAR; 320 * 240];
        let range_m = 66_000.0;
        let focal_px = level.focal_px();
        let rows = (4..240).step_by(8).filter(|row| {
            // The highest ray asked is 2 px above the pixel's centre; the ground there must be within range.
            let below = (f64::from(*row) + 0.5 - 2.0 - 120.0) / focal_px;
            below > 500.0 / range_m
        });
        assert_eq!(among(&sky, size_px, &level, &area, range_m), 40 * rows.count() as u64);
        let ground = vec![0.001; 320 * 240];
        assert_eq!(among(&ground, size_px, &level, &area, range_m), 0);
        let up = View { attitude: terrain::frame::attitude(0.0, 1.2, 0.0), ..level };
        assert_eq!(among(&sky, size_px, &up, &area, range_m), 0);
        let down = View { attitude: terrain::frame::attitude(0.0, -1.57, 0.0), ..level };
        assert_eq!(among(&sky, size_px, &down, &area, range_m), 40 * 30);
    }
}
