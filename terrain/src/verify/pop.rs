//! What a switch of level moves on the screen: the pop, over a track that is flown.
//!
//! At each block's change of ring both surfaces are laid over each other ([`super::surface`]); a vertical difference of
//! `g` metres at a plan distance of `d` metres spans at most `g / d * focal` pixels. It is taken at every vertex of the
//! overlay with its own distance, from where the window really switches: a margin before a ring's radius when it turns
//! finer, a little behind it when it turns coarser.

use super::flight::{Flight, RingSwitch};
use super::surface::{Surface, differences};
use crate::block::payload::tile_heights_m;
use crate::block::rings::REFERENCE_FOCAL_PX;
use glam::{DVec2, DVec3};

/// A switch and what it moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pop {
    /// The block and its rings.
    pub switch: RingSwitch,
    /// The eye at the switch, metres.
    pub eye_m: DVec3,
    /// Largest move of a point, pixels of the reference view, on axis.
    pub px: f64,
    /// Largest vertical move, metres.
    pub move_m: f64,
}

/// Flies to the next point of a track; tells what each switch moved.
pub fn step(flight: &mut Flight, eye_m: DVec3, speed_mps: f64) -> Vec<Pop> {
    let switches = flight.fly_to(DVec2::new(eye_m.x, eye_m.z), speed_mps);
    let landscape = flight.window().landscape();
    switches.into_iter().map(|switch| pop(landscape, switch, eye_m)).collect()
}

fn pop(landscape: &crate::block::Landscape, switch: RingSwitch, eye_m: DVec3) -> Pop {
    let field = landscape.ground.field();
    let grid = field.grid();
    let heights_m = tile_heights_m(field, switch.block);
    let (old, new) = (landscape.mesh(switch.block, switch.from), landscape.mesh(switch.block, switch.to));
    let corner = DVec2::new(grid.x_m(switch.block.first_column()), grid.z_m(switch.block.first_row()));
    let from_eye = corner - DVec2::new(eye_m.x, eye_m.z);
    let (mut px, mut move_m) = (0.0f64, 0.0f64);
    let (old, new) = (Surface::of(old.indices(), &heights_m), Surface::of(new.indices(), &heights_m));
    differences(&old, &new, |place, gap_m| {
        let distance_m = (from_eye + place * grid.step_m).length();
        px = px.max(gap_m.abs() / distance_m * REFERENCE_FOCAL_PX);
        move_m = move_m.max(gap_m.abs());
    });
    Pop { switch, eye_m, px, move_m }
}

/// Points every `step_m` along the straight line from `from` to `to`, both ends included; plan x, z in metres.
pub fn line(from: DVec2, to: DVec2, step_m: f64) -> Vec<DVec2> {
    let steps = ((to - from).length() / step_m).ceil().clamp(1.0, 1e6) as u32;
    (0..=steps).map(|at| from.lerp(to, f64::from(at) / f64::from(steps))).collect()
}
