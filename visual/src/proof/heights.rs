//! The device's posts against the field's, to the bit.

use super::Stage;
use crate::camera::View;
use crate::gpu::GpuError;
use crate::passes::heights;
use std::collections::HashMap;
use terrain::block::mesh::TILE;

/// What was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heights {
    /// Posts of tiles read back, aprons included.
    pub vertices_checked: u64,
    /// Heights that are not the field's to the bit.
    pub height_mismatches: u64,
    /// Posts that two blocks place differently on the device.
    pub position_mismatches: u64,
}

/// Compares all posts of all resident blocks; the stage must have followed the view.
///
/// # Errors
/// What the device reports.
pub fn compare(stage: &Stage, view: &View) -> Result<Heights, GpuError> {
    let placed = heights::read(&stage.gpu, &stage.terrain, view)?;
    let window = stage.terrain.window();
    let field = window.landscape().ground.field();
    let tile = (TILE * TILE) as usize;
    let mut found = Heights::default();
    let mut first: HashMap<(i64, i64), [u32; 3]> = HashMap::new();
    for (slot, posts) in placed.chunks_exact(tile).enumerate() {
        let Some(resident) = window.resident(slot) else { continue };
        for (at, post) in posts.iter().enumerate() {
            let column = resident.block.first_column() + at as i64 % i64::from(TILE);
            let row = resident.block.first_row() + at as i64 / i64::from(TILE);
            let known_m = field.post_m(column, row);
            // No data is no data, whatever its bits.
            let same = known_m.to_bits() == post.height || (known_m.is_nan() && f32::from_bits(post.height).is_nan());
            found.vertices_checked += 1;
            found.height_mismatches += u64::from(!same);
            if !known_m.is_nan() {
                let kept = first.entry((column, row)).or_insert(post.relative);
                found.position_mismatches += u64::from(*kept != post.relative);
            }
        }
    }
    Ok(found)
}
