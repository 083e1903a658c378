//! What `verify` reports: seams, the far surface, switches of level, heights, and the picture against the ground.

use serde::Serialize;

/// `verify`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Verify {
    /// Vertices inside a neighbour's edge. Must be 0.
    pub t_junctions: u64,
    /// Shared vertices that are not equal to the bit. Must be 0.
    pub position_mismatches: u64,
    /// How much was looked at.
    pub edges_checked: EdgesChecked,
    /// Windows looked at, each around another eye.
    pub eyes: u64,
    /// Beyond the near radius.
    pub far: Far,
    /// What a switch of level shows.
    pub pop: Pop,
    /// Within the near radius.
    pub near: Near,
    /// What is draped on the ground; null where there is nothing.
    pub overlay: Option<Draped>,
    /// The picture against the ground; null without an adapter.
    pub gpu: Option<Gpu>,
}

/// Edges looked at.
#[derive(Debug, Clone, Default, Serialize)]
pub struct EdgesChecked {
    /// Of templates beside templates.
    pub templates: u64,
    /// Of pairs of blocks.
    pub pairs: u64,
    /// Of windows on this world.
    pub window: u64,
}

/// The far surface against the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Far {
    /// Largest distance found.
    pub error_max_m: f64,
    /// Largest distance found in each ring.
    pub errors_max_m: Vec<f64>,
    /// Largest allowed in each ring.
    pub limits_m: Vec<f64>,
    /// Places beyond their ring's limit. Must be 0.
    pub violations: u64,
}

/// What a switch of level shows, over a track.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Pop {
    /// Largest move of a point, on axis.
    pub max_px: f64,
    /// Largest vertical move of a point, metres.
    pub max_move_m: f64,
    /// Largest mean change of grey over a block's surface at a switch, of 255; null without an adapter.
    pub max_grey: Option<f64>,
    /// The same with blocks that show in fewer; null without an adapter.
    pub max_grey_any: Option<f64>,
    /// Largest change of grey of one pixel, of 255; null without an adapter.
    pub worst_pixel_grey: Option<f64>,
    /// Switches whose grey was looked at; null without an adapter.
    pub grey_switches: Option<u64>,
    /// Switches looked at.
    pub switches: u64,
    /// Length of the track.
    pub track_km: f64,
}

/// Heights within the near radius while the eye moves.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Near {
    /// Heights that changed. Must be 0.
    pub height_changes: u64,
    /// Largest difference from the ground. Must be 0.
    pub max_difference_m: f64,
    /// Places where the drawn surface was compared with the ground.
    pub places: u64,
}

/// What is draped on the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Draped {
    /// Blocks looked at.
    pub blocks: u64,
    /// Their vertices.
    pub vertices: u64,
    /// Their triangles.
    pub triangles: u64,
    /// Edges that meet only a part of another. Must be 0.
    pub t_junctions: u64,
    /// What two blocks do not have alike at their border. Must be 0.
    pub border_mismatches: u64,
    /// Triangles that reach over a cell's edge or diagonal. Must be 0.
    pub crossings: u64,
    /// Largest difference from the ground query.
    pub max_height_error_m: f64,
}

impl From<terrain::verify::overlay::Draped> for Draped {
    fn from(found: terrain::verify::overlay::Draped) -> Self {
        Self {
            blocks: found.blocks,
            vertices: found.vertices,
            triangles: found.triangles,
            t_junctions: found.t_junctions,
            border_mismatches: found.border_mismatches,
            crossings: found.crossings,
            max_height_error_m: found.max_height_error_m,
        }
    }
}

/// The picture against the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Gpu {
    /// Heights read back.
    pub vertices_checked: u64,
    /// Heights that are not the posts to the bit. Must be 0.
    pub height_mismatches: u64,
    /// Posts that two blocks place differently on the device. Must be 0.
    pub position_mismatches: u64,
    /// Pixels whose depth was compared.
    pub pixels_checked: u64,
    /// Pixels whose depth is outside its bounds. Must be 0.
    pub pixels_outside: u64,
    /// Pixels on silhouettes, left out.
    pub pixels_excluded: u64,
}
