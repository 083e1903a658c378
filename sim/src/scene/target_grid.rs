//! Which targets a path may come near: cells in plan, by size of target.
//!
//! A target goes into the cells that its swept square overlaps, on the level whose cells are at least as wide as it is:
//! so into four at most, whatever its size. A path asks the cells along its way, on the levels that are in use. Cells
//! are counted into buckets of a hash table each step, in time proportional to the targets, into memory that is kept.
//!
//! World frame, metres. Invariant others rely on: every target whose ball of radius `radius_m` the path enters during
//! the step is visited, perhaps more than once; which others are visited depends on the targets and the path alone.

use crate::ballistics::path::StepPath;
use crate::ballistics::targets::Target;

/// Edge of the smallest cells, as a power of 2: 16 m.
const FIRST_LEVEL: u32 = 4;
/// Levels: up to 2^23 m, wider than a shape of 100 km moving 12 km a second.
const LEVELS: u32 = 20;
/// Most columns of cells that a path asks on one level: beyond it every target is nearer to hand.
const MOST_COLUMNS: i64 = 1_024;

/// The targets of a step by cells.
#[derive(Debug, Clone, Default)]
pub(super) struct TargetGrid {
    /// Levels in use, a bit each.
    levels: u32,
    /// Cell and target, as they come.
    entries: Vec<(u64, u32)>,
    /// Where each bucket starts in `sorted`.
    starts: Vec<u32>,
    /// The same bucket by bucket.
    sorted: Vec<(u64, u32)>,
    targets: u32,
}

fn edge_m(level: u32) -> f64 {
    f64::from(1u32 << (FIRST_LEVEL + level))
}

/// A cell's name: level, column, row. Columns lie within +-2^20: worlds end at 10,000 km.
fn cell(level: u32, column: i64, row: i64) -> u64 {
    let part = |at: i64| (at as u64) & 0x0fff_ffff;
    u64::from(level) << 56 | part(column) << 28 | part(row)
}

impl TargetGrid {
    /// Takes in where the targets go during a step.
    pub fn rebuild(&mut self, targets: &[Target]) {
        self.levels = 0;
        self.targets = targets.len() as u32;
        self.entries.clear();
        for (index, target) in targets.iter().enumerate() {
            let (from, to) = (target.from.position_m, target.to.position_m);
            let reach = target.shape.radius_m();
            let (low, high) = (from.min(to) - reach, from.max(to) + reach);
            let width = (high.x - low.x).max(high.z - low.z);
            let level = (0..LEVELS - 1).find(|level| edge_m(*level) >= width).unwrap_or(LEVELS - 1);
            self.levels |= 1 << level;
            let place = |at: f64| (at / edge_m(level)).floor() as i64;
            for column in place(low.x)..=place(high.x) {
                for row in place(low.z)..=place(high.z) {
                    self.entries.push((cell(level, column, row), index as u32));
                }
            }
        }
        let buckets = self.entries.len().next_power_of_two();
        self.starts.clear();
        self.starts.resize(buckets + 1, 0);
        for (cell, _) in &self.entries {
            self.starts[Self::bucket(*cell, buckets) + 1] += 1;
        }
        for bucket in 0..buckets {
            self.starts[bucket + 1] += self.starts[bucket];
        }
        self.sorted.clear();
        self.sorted.resize(self.entries.len(), (0, 0));
        // From the last to the first, so that each bucket is filled from its end and `starts` ends at its start.
        for entry in self.entries.iter().rev() {
            let end = &mut self.starts[Self::bucket(entry.0, buckets) + 1];
            *end -= 1;
            self.sorted[*end as usize] = *entry;
        }
    }

    fn bucket(cell: u64, buckets: usize) -> usize {
        // Fibonacci hashing: the high bits of the product are well mixed. `buckets` is a power of 2.
        let mixed = (cell ^ (cell >> 29)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        ((mixed >> 32) as usize) & (buckets - 1)
    }

    fn in_cell(&self, cell: u64, visit: &mut impl FnMut(usize)) {
        let buckets = self.starts.len() - 1;
        let bucket = Self::bucket(cell, buckets);
        // After filling, a bucket's start stands one place further.
        let start = self.starts[bucket + 1] as usize;
        let end = self.starts.get(bucket + 2).map_or(self.sorted.len(), |next| *next as usize);
        for (_, target) in self.sorted[start..end].iter().filter(|(at, _)| *at == cell) {
            visit(*target as usize);
        }
    }

    /// Visits the targets that may come within a distance of a point in plan, perhaps more than once.
    pub fn around(&self, x_m: f64, z_m: f64, reach_m: f64, mut visit: impl FnMut(usize)) {
        if self.targets == 0 || !(x_m.is_finite() && z_m.is_finite() && reach_m.is_finite()) {
            return;
        }
        for level in (0..LEVELS).filter(|level| self.levels & (1 << level) != 0) {
            let place = |at: f64| (at / edge_m(level)).floor() as i64;
            let (columns, rows) =
                (place(x_m - reach_m)..=place(x_m + reach_m), place(z_m - reach_m)..=place(z_m + reach_m));
            let cells = (columns.end() - columns.start() + 1).saturating_mul(rows.end() - rows.start() + 1);
            if cells > i64::from(self.targets).max(16) {
                (0..self.targets as usize).for_each(&mut visit);
                return;
            }
            for column in columns {
                for row in rows.clone() {
                    self.in_cell(cell(level, column, row), &mut visit);
                }
            }
        }
    }

    /// Visits the targets that a path may come near.
    pub fn near(&self, path: &StepPath, mut visit: impl FnMut(usize)) {
        if self.targets == 0 || !path.is_sound() {
            return;
        }
        // The path bends at most so far from its chord.
        let off_m = path.bulge_m() * (1.0 + 1e-6) + 1e-6;
        let (a, b) = if path.from_m.x <= path.to_m.x { (path.from_m, path.to_m) } else { (path.to_m, path.from_m) };
        let way_x = b.x - a.x;
        for level in (0..LEVELS).filter(|level| self.levels & (1 << level) != 0) {
            let edge = edge_m(level);
            let place = |at: f64| (at / edge).floor() as i64;
            let (first, last) = (place(a.x - off_m), place(b.x + off_m));
            let rows = place(a.z.max(b.z) + off_m) - place(a.z.min(b.z) - off_m);
            if last - first > MOST_COLUMNS || rows > MOST_COLUMNS {
                (0..self.targets as usize).for_each(&mut visit);
                return;
            }
            for column in first..=last {
                // The part of the chord over this column, and as far again as the path may be off it.
                let share = |x: f64| if way_x > 0.0 { ((x - a.x) / way_x).clamp(0.0, 1.0) } else { f64::NAN };
                let (from, to) = (share(column as f64 * edge - off_m), share((column + 1) as f64 * edge + off_m));
                let (from, to) = if from.is_nan() { (0.0, 1.0) } else { (from, to) };
                let (one, other) = (a.z + (b.z - a.z) * from, a.z + (b.z - a.z) * to);
                for row in place(one.min(other) - off_m)..=place(one.max(other) + off_m) {
                    self.in_cell(cell(level, column, row), &mut visit);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ballistics::shape::Shape;
    use crate::ballistics::targets::{Pose, target_impact};
    use crate::snapshot::StableId;
    use glam::DVec3;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    const SEED_TARGETS: u64 = 20_261_130;

    fn crowd(random: &mut StdRng, count: u64, span_m: f64) -> Vec<Target> {
        let one = |id| {
            let at = DVec3::new(random.random_range(-span_m..span_m), 0.0, random.random_range(-span_m..span_m));
            let way = DVec3::new(random.random_range(-9.0..9.0), 0.0, random.random_range(-9.0..9.0));
            let radius_m = 10f64.powf(random.random_range(-0.5..2.5));
            let shape = Shape::sphere(radius_m).unwrap();
            Target { id: StableId(id), shape, from: Pose::at(at), to: Pose::at(at + way) }
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn the_grid_finds_what_a_look_at_every_target_finds() {
        let mut random = StdRng::seed_from_u64(SEED_TARGETS);
        let mut grid = TargetGrid::default();
        let mut hits = 0;
        for (count, span_m) in [(0, 1.0), (1, 10.0), (300, 2_000.0), (300, 150_000.0)] {
            let targets = crowd(&mut random, count, span_m);
            grid.rebuild(&targets);
            for _ in 0..2_000 {
                let from = DVec3::new(random.random_range(-span_m..span_m), 0.0, random.random_range(-span_m..span_m));
                let mut direction = DVec3::new(random.random_range(-1.0..1.0), 0.1, random.random_range(-1.0..1.0));
                if random.random_bool(0.1) {
                    direction.x = 0.0;
                }
                let speed = 10f64.powf(random.random_range(0.0..4.0));
                let velocity = direction * speed;
                let bend = DVec3::new(0.0, random.random_range(-9.0..9.0), random.random_range(-40.0..40.0));
                let path = StepPath {
                    from_m: from,
                    from_mps: velocity,
                    to_m: from + velocity * 0.1 + bend * 0.05,
                    to_mps: velocity + bend,
                    step_s: 0.1,
                };
                let mut found = Vec::new();
                grid.near(&path, |index| found.push(index));
                for (index, target) in targets.iter().enumerate() {
                    if target_impact(&path, std::slice::from_ref(target), None).is_some() {
                        assert!(found.contains(&index), "{path:?} strikes {target:?}");
                        hits += 1;
                    }
                }
            }
        }
        assert!(hits > 1_000, "{hits}");
    }

    #[test]
    fn around_a_point_it_finds_every_target_within_reach_and_few_beyond() {
        let mut random = StdRng::seed_from_u64(SEED_TARGETS);
        let mut grid = TargetGrid::default();
        let mut within = 0;
        for (count, span_m, reach_m) in [(1, 10.0, 30.0), (300, 2_000.0, 150.0), (300, 150_000.0, 9_000.0)] {
            let targets = crowd(&mut random, count, span_m);
            grid.rebuild(&targets);
            for _ in 0..500 {
                let at = DVec3::new(random.random_range(-span_m..span_m), 0.0, random.random_range(-span_m..span_m));
                let mut found = Vec::new();
                grid.around(at.x, at.z, reach_m, |index| found.push(index));
                for (index, target) in targets.iter().enumerate() {
                    let near_m = at.distance(target.from.position_m).min(at.distance(target.to.position_m));
                    if near_m <= reach_m + target.shape.radius_m() {
                        assert!(found.contains(&index), "{at} {target:?}");
                        within += 1;
                    }
                }
            }
        }
        assert!(within > 1_000, "{within}");
        let mut crowd = crowd(&mut random, 4_000, 20_000.0);
        crowd.iter_mut().for_each(|target| target.shape = Shape::sphere(4.0).unwrap());
        grid.rebuild(&crowd);
        let mut asked = 0;
        for _ in 0..100 {
            let (x_m, z_m) = (random.random_range(-2e4..2e4), random.random_range(-2e4..2e4));
            grid.around(x_m, z_m, 100.0, |_| asked += 1);
        }
        // One target in 4e5 m2; two or three cells of 32 m more on each side than 200 m: 0.2 a question, four times over.
        assert!(asked < 100, "{asked}");
    }

    #[test]
    fn a_path_asks_few_targets_of_many() {
        let mut random = StdRng::seed_from_u64(SEED_TARGETS);
        let mut grid = TargetGrid::default();
        for (count, span_m) in [(1_000u64, 5_000.0), (16_000, 20_000.0)] {
            let mut targets = crowd(&mut random, count, span_m);
            for target in &mut targets {
                target.shape = Shape::sphere(4.0).unwrap();
            }
            grid.rebuild(&targets);
            let mut asked = 0;
            for _ in 0..1_000 {
                let from = DVec3::new(random.random_range(-span_m..span_m), 0.0, random.random_range(-span_m..span_m));
                let path = StepPath::straight(from, from + DVec3::new(6.0, 0.0, 5.0), 1.0 / 120.0);
                grid.near(&path, |_| asked += 1);
            }
            // One target in 10^5 m2 and two to four cells of 32 m: some 0.04 a path; the bound is a tenth of a percent.
            assert!(asked < 1_000, "{asked} of {count}");
        }
    }

    #[test]
    fn paths_that_are_none_and_worlds_ends_are_taken() {
        let mut grid = TargetGrid::default();
        let far = DVec3::new(-9.9e6, 0.0, 9.9e6);
        let shape = Shape::sphere(100_000.0).unwrap();
        grid.rebuild(&[Target { id: StableId(1), shape, from: Pose::at(far), to: Pose::at(far) }]);
        let mut visited = 0;
        grid.near(&StepPath::straight(far, far + DVec3::X, 0.1), |_| visited += 1);
        assert!(visited >= 1);
        let before = visited;
        grid.near(&StepPath::straight(DVec3::NAN, far, 0.1), |_| visited += 1);
        assert_eq!(visited, before);
        grid.near(&StepPath::straight(far, -far, 0.1), |_| visited += 1);
        assert!(visited > before, "a way through the whole world");
    }
}
