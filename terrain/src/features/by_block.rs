//! Roads, running water and runways as strips, block by block: what the ground map tints.
//!
//! Frame: metres east and south of the block's north-west corner. A block has every strip that touches one of its
//! texels, those just beyond its border too, so neighbours agree on the texels that they share.

use super::model::{Features, RoadClass, RunwaySurface};
use crate::block::ground_map::SIDE;
use crate::grid::{BlockIndex, Grid};
use glam::{DVec2, Vec2};

/// Narrower roads are too faint on texels of some 95 m to be worth their time.
const LEAST_ROAD_M: f32 = 4.0;

/// What a strip is made of; later kinds lie over earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StripKind {
    /// Running water and its wet banks.
    Water,
    /// Gravel and ballast.
    Gravel,
    /// Sealed roads, old runways.
    Asphalt,
    /// Runways of concrete.
    Concrete,
}

/// All kinds, from the lowest.
pub const KINDS: [StripKind; 4] = [StripKind::Water, StripKind::Gravel, StripKind::Asphalt, StripKind::Concrete];

/// A straight piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strip {
    /// What it is made of.
    pub kind: StripKind,
    /// Its middle line.
    pub ends: [Vec2; 2],
    /// Half its width.
    pub half_m: f32,
}

/// See the module.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StripsByBlock {
    blocks_x: i32,
    /// Row by row; empty if there are none at all.
    blocks: Vec<Vec<Strip>>,
}

impl StripsByBlock {
    /// The strips of a world's features.
    pub fn new(grid: &Grid, features: &Features) -> Self {
        let mut all = Self { blocks_x: grid.blocks_x as i32, blocks: Vec::new() };
        for water in features.waterways.iter().filter(|water| !water.tunnel) {
            // Banks are as wide again as a brook, and a few metres along a river.
            all.add(grid, &water.line, water.width_m + water.width_m.min(6.0), StripKind::Water);
        }
        for road in features.roads.iter().filter(|road| !road.tunnel && road.width_m >= LEAST_ROAD_M) {
            let kind =
                if road.paved && road.class != RoadClass::Railway { StripKind::Asphalt } else { StripKind::Gravel };
            // Verges and ditches.
            let verge_m = if road.class <= RoadClass::Tertiary { 4.0 } else { 2.0 };
            all.add(grid, &road.line, road.width_m + verge_m, kind);
        }
        for airfield in &features.airfields {
            for (line, width_m) in &airfield.taxiways {
                all.add(grid, line, *width_m, StripKind::Asphalt);
            }
            for runway in &airfield.runways {
                let kind = match runway.surface {
                    RunwaySurface::Asphalt => StripKind::Asphalt,
                    RunwaySurface::Concrete => StripKind::Concrete,
                    RunwaySurface::Gravel => StripKind::Gravel,
                    RunwaySurface::Grass => continue,
                };
                all.add(grid, &runway.ends, runway.width_m, kind);
            }
        }
        all
    }

    /// The strips of a block.
    pub fn of(&self, block: BlockIndex) -> &[Strip] {
        let inside = block.x >= 0 && block.x < self.blocks_x && block.z >= 0;
        let at = i64::from(block.z) * i64::from(self.blocks_x) + i64::from(block.x);
        self.blocks.get(at as usize).filter(|_| inside).map_or(&[], Vec::as_slice)
    }

    fn add(&mut self, grid: &Grid, line: &[DVec2], width_m: f32, kind: StripKind) {
        let half_m = 0.5 * width_m;
        let block_m = grid.block_m();
        let reach_m = f64::from(half_m) + block_m / f64::from(SIDE - 1);
        let corner = DVec2::new(grid.west_m, grid.north_m);
        let world = DVec2::new(grid.east_m(), grid.south_m());
        for ends in line.windows(2) {
            let (low, high) = (ends[0].min(ends[1]) - reach_m, ends[0].max(ends[1]) + reach_m);
            if !(low.is_finite() && high.is_finite()) || low.cmpgt(world).any() || high.cmplt(corner).any() {
                continue;
            }
            // A piece is no longer than a block, so that the box about it holds few blocks that it does not touch.
            let pieces = (ends[0].distance(ends[1]) / block_m).ceil().clamp(1.0, 4_096.0) as u32;
            for piece in 0..pieces {
                let at = |i: u32| ends[0].lerp(ends[1], f64::from(i) / f64::from(pieces));
                self.add_piece(grid, corner, [at(piece), at(piece + 1)], reach_m, half_m, kind);
            }
        }
    }

    fn add_piece(&mut self, grid: &Grid, corner: DVec2, ends: [DVec2; 2], reach_m: f64, half_m: f32, kind: StripKind) {
        let block_m = grid.block_m();
        let last = DVec2::new(f64::from(grid.blocks_x), f64::from(grid.blocks_z)) - 1.0;
        let low = ((ends[0].min(ends[1]) - reach_m - corner) / block_m).floor();
        let high = ((ends[0].max(ends[1]) + reach_m - corner) / block_m).floor();
        if low.cmpgt(last).any() || high.cmplt(DVec2::ZERO).any() {
            return;
        }
        let (low, high) = (low.max(DVec2::ZERO).as_ivec2(), high.min(last).as_ivec2());
        self.blocks.resize((grid.blocks_x * grid.blocks_z) as usize, Vec::new());
        for z in low.y..=high.y {
            for x in low.x..=high.x {
                let origin = corner + block_m * DVec2::new(f64::from(x), f64::from(z));
                let ends = ends.map(|end| (end - origin).as_vec2());
                self.blocks[(z * self.blocks_x + x) as usize].push(Strip { kind, ends, half_m });
            }
        }
    }
}

/// Share of every texel of a ground map that strips of one kind cover, as a texel sees it through a tent of its own
/// width; empty if there are none. Where strips of a kind meet the widest counts.
pub fn coverage(strips: &[Strip], kind: StripKind, texel_m: f32) -> Vec<f32> {
    let mut covered = Vec::new();
    for strip in strips.iter().filter(|strip| strip.kind == kind) {
        covered.resize((SIDE * SIDE) as usize, 0.0);
        let reach_m = strip.half_m + texel_m;
        let [a, b] = strip.ends;
        let along = b - a;
        let per_length2 = 1.0 / along.length_squared().max(1e-6);
        let texel = |at_m: f32| (at_m / texel_m).clamp(0.0, (SIDE - 1) as f32);
        let (low, high) = (a.min(b) - reach_m, a.max(b) + reach_m);
        let side_m = texel_m * (SIDE - 1) as f32;
        if low.cmpgt(Vec2::splat(side_m)).any() || high.cmplt(Vec2::ZERO).any() {
            continue;
        }
        for row in texel(low.y).ceil() as usize..=texel(high.y).floor() as usize {
            for column in texel(low.x).ceil() as usize..=texel(high.x).floor() as usize {
                let at = Vec2::new(column as f32, row as f32) * texel_m;
                let t = ((at - a).dot(along) * per_length2).clamp(0.0, 1.0);
                let away_m = at.distance(a + t * along);
                if away_m < reach_m {
                    let share =
                        within_tent((away_m + strip.half_m) / texel_m) - within_tent((away_m - strip.half_m) / texel_m);
                    let texel = &mut covered[row * SIDE as usize + column];
                    *texel = share.max(*texel);
                }
            }
        }
    }
    covered
}

/// The part of a tent over -1..1 that lies below `t`.
fn within_tent(t: f32) -> f32 {
    if t < 0.0 { 0.5 * (1.0 + t).max(0.0).powi(2) } else { 1.0 - 0.5 * (1.0 - t).max(0.0).powi(2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::model::Road;

    fn road(line: Vec<DVec2>, width_m: f32) -> Road {
        Road { class: RoadClass::Primary, width_m, paved: true, tunnel: false, bridge: false, line }
    }

    #[test]
    fn neighbours_agree_and_a_road_covers_its_own_area() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let line = vec![DVec2::new(-5_900.0, -4_000.0), DVec2::new(5_800.0, -2_100.0)];
        let features = Features { roads: vec![road(line, 16.0)], ..Features::default() };
        let strips = StripsByBlock::new(&grid, &features);
        let texel_m = (grid.block_m() / f64::from(SIDE - 1)) as f32;
        let covered = |x, z| coverage(strips.of(BlockIndex { x, z }), StripKind::Asphalt, texel_m);
        let (west, east) = (covered(0, 0), covered(1, 0));
        for row in 0..SIDE as usize {
            let (a, b) = (west[row * 64 + 63], east[row * 64]);
            // Coordinates of one block differ from the other's by a rounding of 6 km in f32, 0.5 mm of 95 m.
            assert!((a - b).abs() < 2e-5, "row {row}: {a} and {b}");
        }
        // 16 m and 4 m of verges over the 5,900 m that lie in the western block, 1.3 % longer for their slant.
        let area_m2 = west.iter().sum::<f32>() * texel_m * texel_m;
        let expected_m2 = 20.0 * 5_900.0 * (1.0_f32 + (1_900.0_f32 / 11_700.0).powi(2)).sqrt();
        // The sums of a tent over its lattice are exact for straight lines but for half a texel at either end.
        assert!((area_m2 - expected_m2).abs() < 20.0 * 2.0 * texel_m, "{area_m2} and {expected_m2}");
        assert!(strips.of(BlockIndex { x: 0, z: 1 }).is_empty() && strips.of(BlockIndex { x: -1, z: 0 }).is_empty());
    }

    #[test]
    fn what_is_not_there_costs_nothing_and_far_lines_are_left_out() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        assert_eq!(StripsByBlock::new(&grid, &Features::default()).blocks, Vec::<Vec<Strip>>::new());
        let far = vec![DVec2::splat(1e12), DVec2::new(1e12, 2e12)];
        let through = vec![DVec2::new(-1e9, 0.0), DVec2::new(1e9, 1.0)];
        let features = Features { roads: vec![road(far, 8.0), road(through, 8.0)], ..Features::default() };
        let strips = StripsByBlock::new(&grid, &features);
        assert!(strips.blocks.iter().flatten().all(|strip| strip.ends.iter().all(|end| end.is_finite())));
    }
}
