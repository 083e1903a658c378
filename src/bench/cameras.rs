//! Eyes along the scenic track, and one frame of one scenery: what frames are measured with.
//!
//! A frame is timed when the window has come to rest and the picture has been drawn once: streaming is measured by
//! `fly --headless --paced`. The time is that of culling, recording, submitting and waiting for the picture, without
//! overlay.

use crate::failure::Failure;
use crate::scenery::{Heavens, Scenery};
use glam::{DQuat, DVec2, DVec3};
use sim::track::{Flight, ISSYK_KUL_FLIGHT, TrackHeight};
use sim::{Track, frame};
use std::time::Instant;
use terrain::store::World;
use terrain::{Geodetic, Ground};
use visual::capture::Offscreen;

/// Updates after which a window has certainly come to rest: a jump of 24 x 24 blocks takes four.
const MOST_UPDATES: u32 = 400;

/// Where one stands and looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The eye, world metres.
    pub eye_m: DVec3,
    /// View axes to world.
    pub attitude: DQuat,
}

/// Cameras at shares (0..=1) of the scenic track, looking ahead. Over another world than the default one the track is a
/// diagonal, 1,500 m over the highest ground.
///
/// # Errors
/// [`Failure::Failed`] if there is no track.
pub fn along_track(world: &World, shares: &[f64]) -> Result<Vec<Camera>, Failure> {
    let failed = |error: sim::track::TrackError| Failure::while_doing("laying the track", error);
    let plan = |lat_deg: f64, lon_deg: f64| {
        let DVec2 { x, y } = world.projection.to_world(Geodetic::from_degrees(lat_deg, lon_deg));
        (x, y)
    };
    let flight = Flight::parse(ISSYK_KUL_FLIGHT).map_err(failed)?;
    let area = Ground::new(world.field.clone()).whole();
    let scenic = Track::through(&flight, &plan).map_err(failed)?;
    let inside = shares.iter().all(|share| {
        let at = scenic.at(share * scenic.length_m()).position_m;
        area.height_m(at.x, at.z).is_some()
    });
    let track = if inside {
        scenic
    } else {
        let grid = *area.grid();
        let distance_m = 0.7 * (grid.east_m() - grid.west_m).min(grid.south_m() - grid.north_m);
        let height = TrackHeight::AboveHighest { clearance_m: 1_500.0, ahead_m: 5_000.0 };
        let height_at = move |x_m: f64, z_m: f64| area.height_m(x_m, z_m);
        Track::centred((0.0, 0.0), 0.8, distance_m, 250.0, height, &height_at).map_err(failed)?
    };
    Ok(shares
        .iter()
        .map(|share| {
            let state = track.state(share * track.length_m(), 0.7);
            Camera { eye_m: state.position_m, attitude: frame::view_attitude(state.attitude) }
        })
        .collect())
}

impl Camera {
    /// The same eye turned to the right, radians.
    #[must_use]
    pub fn turned(self, right_rad: f64) -> Self {
        Self { attitude: DQuat::from_rotation_y(-right_rad) * self.attitude, ..self }
    }

    /// Brings the window to rest around the eye and draws the picture once, so that everything is warm.
    ///
    /// # Errors
    /// What the device reports.
    pub fn settle(
        &self,
        scenery: &mut Scenery,
        heavens: impl Into<Heavens> + Copy,
        target: &Offscreen,
    ) -> Result<(), Failure> {
        let view = scenery.view(self.eye_m, self.attitude, target.size_px);
        for _ in 0..MOST_UPDATES {
            let before = scenery.terrain.window().counters();
            scenery.follow(&view, 0.0, heavens);
            let after = scenery.terrain.window().counters();
            let still = before.upload_bytes_total == after.upload_bytes_total
                && (before.shifts, before.switches, before.relights) == (after.shifts, after.switches, after.relights);
            if still && scenery.is_settled() {
                break;
            }
        }
        self.frame_ms(scenery, heavens, target).map(|_| ())
    }

    /// Draws a frame; milliseconds until the picture is there.
    ///
    /// # Errors
    /// What the device reports.
    pub fn frame_ms(
        &self,
        scenery: &mut Scenery,
        heavens: impl Into<Heavens> + Copy,
        target: &Offscreen,
    ) -> Result<f64, Failure> {
        let failed = |error: visual::GpuError| Failure::while_doing("drawing a frame", error);
        let start = Instant::now();
        let view = scenery.view(self.eye_m, self.attitude, target.size_px);
        scenery.follow(&view, 0.0, heavens);
        scenery.draw(&view, heavens, 0.0, Vec::new(), &target.view).map_err(failed)?;
        scenery.gpu.wait().map_err(failed)?;
        Ok(start.elapsed().as_secs_f64() * 1e3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_to_the_right() {
        let north = Camera { eye_m: DVec3::ZERO, attitude: DQuat::IDENTITY };
        let east = north.turned(std::f64::consts::FRAC_PI_2).attitude * DVec3::NEG_Z;
        assert!((east - DVec3::X).length() < 1e-12, "{east}");
    }
}
