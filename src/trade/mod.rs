//! What `poligon trade` measures: for each setting that trades accuracy for speed, its error and its cost.
//!
//! One knob is turned at a time, the others stand as in the preset `standard`. All values of a knob are alive at once and
//! take turns at the same cameras, so their costs compare even on a busy machine. Errors are exact properties of what
//! is drawn, not of the machine.

pub mod flight;
mod knobs;
mod landscape;
mod plot;
mod post_step;
mod stage;
mod surface;
mod table;

pub use knobs::measure;
pub use plot::{all as plots, sheet};
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
    pub const FULL: Self = Self { quick: false, size_px: [1280, 720], places: 4, rounds: 9 };
    /// Less than three minutes.
    pub const QUICK: Self = Self { quick: true, size_px: [1280, 720], places: 2, rounds: 7 };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::{tiny_request, tiny_world};
    use std::sync::Arc;

    #[test]
    fn every_knob_runs_from_coarse_to_fine_and_its_error_keeps_its_limit() {
        if let Err(reason) = visual::Gpu::headless() {
            println!("skipped: {reason}");
            return;
        }
        let effort = Effort { quick: true, size_px: [48, 27], places: 1, rounds: 2 };
        let mut told = 0;
        let trade = measure(&Arc::new(tiny_world()), &tiny_request(), &effort, &mut |_| told += 1).unwrap();
        let names: Vec<&str> = trade.knobs.iter().map(|knob| knob.name.as_str()).collect();
        let landscape = ["plants", "reach of what stands", "haze", "ground detail"];
        assert_eq!(names[..5], ["window", "pixel limit", "near radius", "post step", "render scale"]);
        assert_eq!(names[5..], landscape);
        assert!(told >= names.len());
        for knob in &trade.knobs {
            assert!(knob.points.len() >= 2 && !knob.unit.is_empty() && !knob.cost_unit.is_empty(), "{}", knob.name);
            assert!(knob.points.iter().all(|point| point.error.is_finite() && point.cost > 0.0), "{knob:?}");
        }
        // The rings promise this; the largest error is taken at the nearest point of each sub-block, as they do.
        for point in &trade.knobs[1].points {
            assert!(point.error_max.unwrap() <= point.setting * (1.0 + 1e-9), "{point:?}");
        }
        let step = &trade.knobs[3].points;
        assert!(step.windows(2).all(|pair| pair[1].error < pair[0].error), "{step:?}");
    }
}
