//! What `poligon trade` measures: for each setting that trades accuracy for speed, its error and its cost.
//!
//! One knob is turned at a time, the others stand as in the preset `standard`. All values of a knob are alive at once and
//! take turns at the same cameras, so their costs compare even on a busy machine. Errors are exact properties of what
//! is drawn, not of the machine.

mod knobs;
mod plot;
mod post_step;
mod stage;
mod surface;
mod table;

pub use knobs::measure;
pub use plot::{one as plot, sheet};
pub use table::csv;

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Fewer values and cameras.
    pub quick: bool,
    /// Picture size, pixels.
    pub size_px: [u32; 2],
    /// Places on the track; at each the picture ahead and the one behind.
    pub places: u32,
    /// Rounds at each camera.
    pub rounds: u32,
}

impl Effort {
    /// Minutes.
    pub const FULL: Self = Self { quick: false, size_px: [1280, 720], places: 4, rounds: 3 };
    /// Less than three minutes.
    pub const QUICK: Self = Self { quick: true, size_px: [1280, 720], places: 1, rounds: 4 };
}
