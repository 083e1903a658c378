//! One picture from one place, with every block, tile and sky table waited for. Used by `shot` and `gallery`.

use crate::failure::Failure;
use crate::report;
use crate::scenery::{Heavens, Scenery};
use glam::{DQuat, DVec3};
use std::path::Path;
use terrain::store::World;
use visual::capture::{Offscreen, Picture};

/// Updates after which whatever streams has come to rest, however small its budget.
const MOST_UPDATES: u32 = 1_000;

/// Where a picture is taken from, and of which moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standpoint {
    /// The eye, world metres.
    pub eye_m: DVec3,
    /// View axes to world.
    pub attitude: DQuat,
    /// What shines.
    pub heavens: Heavens,
}

/// View axes for a direction of view given by a true azimuth and an elevation, degrees, from an eye.
pub fn attitude(world: &World, eye_m: DVec3, azimuth_deg: f64, elevation_deg: f64) -> DQuat {
    let heading_rad = crate::scenery::grid_heading_rad(world, eye_m, azimuth_deg.to_radians());
    terrain::frame::attitude(heading_rad, elevation_deg.to_radians(), 0.0)
}

/// Takes the picture.
///
/// # Errors
/// [`Failure::Failed`] for what the device reports.
pub fn take(scenery: &mut Scenery, at: &Standpoint, target: &Offscreen) -> Result<Picture, Failure> {
    let failed = |error: visual::GpuError| Failure::while_doing("taking a picture", error);
    let view = scenery.view(at.eye_m, at.attitude, target.size_px);
    for _ in 0..MOST_UPDATES {
        scenery.follow(&view, 0.0, at.heavens);
        if scenery.is_settled() {
            break;
        }
    }
    scenery.draw(&view, at.heavens, 0.0, Vec::new(), &target.view).map_err(failed)?;
    target.read(&scenery.gpu).map_err(failed)
}

/// Writes the picture and says what is in it.
///
/// # Errors
/// [`Failure::Failed`] if the file cannot be written.
pub fn write(scenery: &Scenery, picture: &Picture, out: &Path) -> Result<report::Shot, Failure> {
    picture.write_png(out).map_err(|error| Failure::Failed(error.to_string()))?;
    let counts = scenery.terrain.counts();
    Ok(report::Shot {
        out: out.display().to_string(),
        size: format!("{}x{}", picture.size_px[0], picture.size_px[1]),
        image_hash: report::hash(picture.hash()),
        visibility_m: scenery.visibility_m(),
        triangles_drawn: counts.triangles,
        triangles_all_level0: counts.triangles_all_level0,
        objects_drawn: scenery.things.object_counts().all(),
        late_blocks: scenery.late(),
    })
}
