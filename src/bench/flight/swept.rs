//! The swept step of a shell against the ground, beside the one segment that a straight step would be.
//!
//! Steps of 1/120 s at 760 m/s, bent by gravity and drag, at random places of a world: a third high above the ground, a
//! third below 200 m, a third that end under it.

use super::shell;
use glam::DVec3;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use sim::ballistics::impact::ground_impact;
use sim::ballistics::path::StepPath;
use std::hint::black_box;
use std::time::Instant;
use terrain::Area;

const SEED: u64 = 20_261_124;
const PATHS: usize = 20_000;
const SPEED_MPS: f64 = 760.0;

/// The steps, the same in every run over the same world.
pub fn paths(area: &Area) -> Vec<StepPath> {
    let mut random = StdRng::seed_from_u64(SEED);
    let grid = *area.grid();
    let mut paths = Vec::with_capacity(PATHS);
    for tried in 0..4 * PATHS {
        if paths.len() == PATHS {
            break;
        }
        let x = random.random_range(grid.west_m..grid.east_m());
        let z = random.random_range(grid.north_m..grid.south_m());
        let Some(ground_m) = area.height_m(x, z) else { continue };
        let above_m = match tried % 3 {
            0 => random.random_range(200.0..6_000.0),
            1 => random.random_range(5.0..200.0),
            _ => 1.0,
        };
        let azimuth = random.random_range(0.0f64..std::f64::consts::TAU);
        let from_m = DVec3::new(x, ground_m + above_m, z);
        let from_mps = DVec3::new(azimuth.cos(), -0.5, azimuth.sin()).normalize() * SPEED_MPS;
        let y = shell::stepped(from_m, from_mps);
        let (to_m, to_mps) = (DVec3::new(y[0], y[1], y[2]), DVec3::new(y[3], y[4], y[5]));
        paths.push(StepPath { from_m, from_mps, to_m, to_mps, step_s: shell::step_s() });
    }
    paths
}

/// Nanoseconds a swept step, and a segment between its ends.
pub fn each_ns(area: &Area, paths: &[StepPath]) -> (f64, f64) {
    let each = |work: &dyn Fn(&StepPath) -> bool| {
        let start = Instant::now();
        for path in paths {
            black_box(work(black_box(path)));
        }
        start.elapsed().as_secs_f64() * 1e9 / paths.len().max(1) as f64
    };
    (each(&|path| ground_impact(path, area).is_some()), each(&|path| area.segment(path.from_m, path.to_m).is_some()))
}
