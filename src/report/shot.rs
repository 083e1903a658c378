//! What `shot` reports of a picture.

use serde::Serialize;

/// `shot`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Shot {
    /// The picture.
    pub out: String,
    /// Its size, `WxH` in pixels.
    pub size: String,
    /// Over its pixels.
    pub image_hash: String,
    /// Visibility drawn, after it was clamped to the range of the window.
    pub visibility_m: f64,
    /// Triangles of the ground.
    pub triangles_drawn: u64,
    /// Triangles of the same blocks at level 0.
    pub triangles_all_level0: u64,
    /// Buildings and other standing things.
    pub objects_drawn: u32,
    /// Blocks wanted and absent.
    pub late_blocks: u64,
}
