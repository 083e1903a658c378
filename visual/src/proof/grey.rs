//! What a switch of level changes in the picture, in grey.
//!
//! The eye stands where the window switches and looks at the block. Two pictures are drawn that differ in that block's
//! mesh alone. Grey is the luma of the shown (sRGB-coded) colour, 0 to 255; the change is the mean of its absolute
//! difference over the pixels where either picture shows the block, found from depth.

use super::Stage;
use crate::camera::View;
use crate::gpu::GpuError;
use glam::DVec3;
use terrain::BlockIndex;

/// What a switch changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GreyChange {
    /// Pixels that show the block in either picture.
    pub pixels: u64,
    /// Mean over them, of 255.
    pub mean: f64,
    /// Largest change of one of them, of 255.
    pub worst: f64,
}

/// The view from an eye to the middle of a block, 60 degrees high.
pub fn view_of(stage: &Stage, block: BlockIndex, eye_m: DVec3) -> View {
    let field = stage.terrain.window().landscape().ground.field();
    let grid = field.grid();
    let half = i64::from(terrain::CELLS / 2);
    let (column, row) = (block.first_column() + half, block.first_row() + half);
    let height_m = f64::from(field.post_m(column, row));
    let height_m = if height_m.is_finite() { height_m } else { 0.0 };
    let towards = DVec3::new(grid.x_m(column), height_m, grid.z_m(row)) - eye_m;
    let (heading_rad, elevation_rad) = terrain::frame::heading_elevation(towards);
    let attitude = terrain::frame::attitude(heading_rad, elevation_rad, 0.0);
    View::fov_y(eye_m, attitude, 60f64.to_radians(), stage.size_px())
}

/// The change when a block goes from ring `from` to ring `to`.
///
/// # Errors
/// What the device reports.
pub fn change(
    stage: &mut Stage,
    view: &View,
    block: BlockIndex,
    from: usize,
    to: usize,
) -> Result<GreyChange, GpuError> {
    stage.follow(view);
    let landscape = stage.terrain.window().landscape().clone();
    let mut pictures = Vec::new();
    for ring in [from, to] {
        stage.terrain.show_mesh(&stage.gpu, block, &landscape.mesh(block, ring));
        stage.draw(view)?;
        pictures.push((stage.picture()?, stage.depth()?));
    }
    // The slot's list as the window knows it.
    let window = stage.terrain.window();
    if let Some(ring) = window.resident(window.slot(block)).map(|resident| resident.ring) {
        stage.terrain.show_mesh(&stage.gpu, block, &landscape.mesh(block, ring));
    }
    let grid = landscape.ground.field().grid();
    let [width, height] = view.size_px;
    let mut found = GreyChange::default();
    let mut sum = 0.0;
    for y in 0..height {
        for x in 0..width {
            let at = (y * width + x) as usize;
            let shows = |depth: f32| {
                let ray = view.ray((f64::from(x) + 0.5) / f64::from(width), (f64::from(y) + 0.5) / f64::from(height));
                let point = view.eye_m + ray * (view.near_m / f64::from(depth));
                depth > 0.0 && grid.block_at(point.x, point.z) == block
            };
            let [(old, old_depth), (new, new_depth)] = &pictures[..] else { continue };
            if shows(old_depth[at]) || shows(new_depth[at]) {
                let change = (luma(&old.rgba[4 * at..]) - luma(&new.rgba[4 * at..])).abs();
                found.pixels += 1;
                sum += change;
                found.worst = found.worst.max(change);
            }
        }
    }
    found.mean = sum / found.pixels.max(1) as f64;
    Ok(found)
}

/// Rec. 709 weights on coded values.
fn luma(rgba: &[u8]) -> f64 {
    0.2126 * f64::from(rgba[0]) + 0.7152 * f64::from(rgba[1]) + 0.0722 * f64::from(rgba[2])
}
