//! What a switch of level changes in the picture, in grey.
//!
//! The eye stands where the window switches and looks at the block. Two pictures are drawn that differ in that block's
//! mesh alone. Grey is the luma of the shown (sRGB-coded) colour, 0 to 255; which pixels show the block is found from
//! depth. The change is the mean of the absolute difference over the block's *surface*: pixels that show it in both
//! pictures, and so do their four neighbours. On its outline a block may move by the pixel that the limit grants, against
//! whatever lies behind; that is what the pop in pixels bounds, and it is no shade of the surface. The mean over all
//! pixels, outline included, and the worst single one are told beside it.

use super::Stage;
use crate::camera::View;
use crate::gpu::GpuError;
use glam::DVec3;
use terrain::BlockIndex;

/// What a switch changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GreyChange {
    /// Pixels of the block's surface.
    pub pixels: u64,
    /// Mean over them, of 255.
    pub mean: f64,
    /// Pixels that show the block in either picture.
    pub pixels_any: u64,
    /// Mean over those, of 255.
    pub mean_any: f64,
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
    let [(old, old_depth), (new, new_depth)] = &pictures[..] else { return Ok(GreyChange::default()) };
    let shown = |depths: &[f32]| -> Vec<bool> {
        let shows = |at: u32| {
            let (x, y) = (f64::from(at % width) + 0.5, f64::from(at / width) + 0.5);
            let depth = depths[at as usize];
            let point =
                view.eye_m + view.ray(x / f64::from(width), y / f64::from(height)) * (view.near_m / f64::from(depth));
            depth > 0.0 && grid.block_at(point.x, point.z) == block
        };
        (0..width * height).map(shows).collect()
    };
    let (before, after) = (shown(old_depth), shown(new_depth));
    let side = width as usize;
    let both = |at: usize| before.get(at) == Some(&true) && after.get(at) == Some(&true);
    let mut found = GreyChange::default();
    for at in 0..before.len() {
        if !before[at] && !after[at] {
            continue;
        }
        let change = (luma(&old.rgba[4 * at..]) - luma(&new.rgba[4 * at..])).abs();
        found.pixels_any += 1;
        found.mean_any += change;
        found.worst = found.worst.max(change);
        let around = [at.wrapping_sub(1), at + 1, at.wrapping_sub(side), at + side];
        if both(at) && around.iter().all(|at| both(*at)) {
            found.pixels += 1;
            found.mean += change;
        }
    }
    found.mean /= found.pixels.max(1) as f64;
    found.mean_any /= found.pixels_any.max(1) as f64;
    Ok(found)
}

/// Luma of a pixel as displayed, 0 to 255: Rec. 709 weights on the coded values of red, green and blue.
pub fn luma(rgba: &[u8]) -> f64 {
    0.2126 * f64::from(rgba[0]) + 0.7152 * f64::from(rgba[1]) + 0.0722 * f64::from(rgba[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_255_and_green_is_most_of_it() {
        assert!((luma(&[255, 255, 255, 0]) - 255.0).abs() < 1e-9);
        assert!(luma(&[0, 255, 0, 0]) > 0.7 * 255.0);
    }
}
