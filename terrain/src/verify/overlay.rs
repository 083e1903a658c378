//! What is draped on the ground lies in it: no T-junction, no step, equal from both sides of every border.
//!
//! Looks at the triangles of blocks as they are drawn. Edges of a feature's triangles are cancelled against each other,
//! within a block and then between blocks; what is left over is its outline. Two edges left over that lie on one another in
//! opposite directions are a T-junction: the surface on one side has a vertex there that the other has not.

use crate::block::Landscape;
use crate::block::overlay::lattice::{Lattice, Spot, UNITS, twice_area};
use crate::block::overlay::{Overlay, Overlays};
use crate::grid::{BlockIndex, CELLS};
use crate::ground::Area;
use std::collections::{BTreeMap, HashMap, HashSet};

/// What was found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Draped {
    /// Blocks looked at.
    pub blocks: u64,
    /// Vertices.
    pub vertices: u64,
    /// Triangles.
    pub triangles: u64,
    /// Edges that meet only a part of another.
    pub t_junctions: u64,
    /// Vertices that two blocks place at different heights, and edges on a border that its other side has not.
    pub border_mismatches: u64,
    /// Triangles that reach into more than one triangle of the ground.
    pub crossings: u64,
    /// Largest difference from the ground query.
    pub max_height_error_m: f64,
}

type Edges = HashMap<(Spot, Spot), i32>;

/// Looks at the overlays of up to `most_blocks` blocks, evenly chosen where there are more; `progress` is told the share done.
pub fn look(landscape: &Landscape, most_blocks: usize, mut progress: impl FnMut(f64)) -> Draped {
    let overlays = Overlays::new(landscape);
    let area = landscape.ground.whole();
    let lattice = Lattice::of(area.grid());
    let all = overlays.blocks();
    let every = all.len().div_ceil(most_blocks.max(1)).max(1);
    let looked: Vec<BlockIndex> = all.into_iter().step_by(every).collect();
    let mut found = Draped { blocks: looked.len() as u64, ..Draped::default() };
    let mut outlines: BTreeMap<(u32, u32), Edges> = BTreeMap::new();
    let mut heights: HashMap<Spot, u32> = HashMap::new();
    for (at, block) in looked.iter().enumerate() {
        let overlay = overlays.block(*block);
        found.vertices += overlay.vertices.len() as u64;
        found.triangles += overlay.indices.len() as u64 / 3;
        let spots = spots(&overlay, *block);
        found.max_height_error_m = found.max_height_error_m.max(height_error_m(&overlay, &spots, &area, &lattice));
        found.border_mismatches += border_heights(&overlay, &spots, &mut heights);
        found.crossings += overlay.indices.chunks_exact(3).filter(|corners| crosses(corners, &spots)).count() as u64;
        for part in &overlay.parts {
            let indices = &overlay.indices[part.first as usize..(part.first + part.count) as usize];
            let mut edges = Edges::new();
            for corners in indices.chunks_exact(3) {
                // As they come: all turn the same way, but for slivers that rounding has turned over, edges and all.
                let corners = [0, 1, 2].map(|corner: usize| spots[corners[corner] as usize]);
                for corner in 0..3 {
                    cancel(&mut edges, corners[corner], corners[(corner + 1) % 3], 1);
                }
            }
            let outline = outlines.entry((part.source, part.piece)).or_default();
            for ((a, b), count) in edges {
                cancel(outline, a, b, count);
            }
        }
        progress((at + 1) as f64 / looked.len() as f64);
    }
    let looked: HashSet<BlockIndex> = looked.into_iter().collect();
    for edges in outlines.values() {
        found.t_junctions += t_junctions(edges);
        found.border_mismatches += edges.keys().filter(|edge| open_border(edge, &looked, &area)).count() as u64;
    }
    found
}

/// World spots of a block's vertices.
fn spots(overlay: &Overlay, block: BlockIndex) -> Vec<Spot> {
    let (u, v) = (block.first_column() * UNITS, block.first_row() * UNITS);
    let spot = |(east, south)| Spot { u: u + east, v: v + south };
    overlay.vertices.iter().map(|vertex| spot(vertex.place())).collect()
}

fn height_error_m(overlay: &Overlay, spots: &[Spot], area: &Area, lattice: &Lattice) -> f64 {
    let error = |(vertex, spot): (&crate::block::overlay::Vertex, &Spot)| {
        let at = lattice.plan_m(*spot);
        area.height_m(at.x, at.y).map_or(f64::INFINITY, |height_m| (f64::from(vertex.height_m) - height_m).abs())
    };
    overlay.vertices.iter().zip(spots).map(error).fold(0.0, f64::max)
}

/// Vertices on a block's border whose height another block gave with other bits.
fn border_heights(overlay: &Overlay, spots: &[Spot], heights: &mut HashMap<Spot, u32>) -> u64 {
    let side = i64::from(CELLS) * UNITS;
    let on_border = |spot: &Spot| spot.u % side == 0 || spot.v % side == 0;
    let mut mismatches = 0;
    for (vertex, spot) in overlay.vertices.iter().zip(spots).filter(|(_, spot)| on_border(spot)) {
        let bits = vertex.height_m.to_bits();
        mismatches += u64::from(*heights.entry(*spot).or_insert(bits) != bits);
    }
    mismatches
}

/// Whether a triangle reaches over a cell's edge or diagonal.
fn crosses(corners: &[u32], spots: &[Spot]) -> bool {
    let corners = [0, 1, 2].map(|corner: usize| spots[corners[corner] as usize]);
    [|spot: &Spot| spot.u, |spot: &Spot| spot.v, |spot: &Spot| spot.u + spot.v].into_iter().any(|along| {
        let (low, high) = corners.iter().fold((i64::MAX, i64::MIN), |(l, h), s| (l.min(along(s)), h.max(along(s))));
        (low.div_euclid(UNITS) + 1) * UNITS < high
    })
}

fn cancel(edges: &mut Edges, a: Spot, b: Spot, count: i32) {
    if a == b {
        return;
    }
    let (key, count) = if a < b { ((a, b), count) } else { ((b, a), -count) };
    let sum = edges.entry(key).or_default();
    *sum += count;
    if *sum == 0 {
        edges.remove(&key);
    }
}

/// Edges left over that lie on another of the opposite direction.
fn t_junctions(edges: &Edges) -> u64 {
    // An edge lies in one cell, or between two; those that may overlap begin in the same cell or on its border.
    type Run = (Spot, Spot, i32);
    let mut cells: HashMap<(i64, i64), Vec<Run>> = HashMap::new();
    for ((a, b), count) in edges {
        let cell = |low: i64, high: i64| (low + high).div_euclid(2 * UNITS);
        cells.entry((cell(a.u, b.u), cell(a.v, b.v))).or_default().push((*a, *b, *count));
    }
    let mut found = 0;
    for edges in cells.values() {
        for (at, (a, b, count)) in edges.iter().enumerate() {
            let overlap = |(c, d, other): &&(Spot, Spot, i32)| {
                count * other < 0 && twice_area(*a, *b, *c) == 0 && twice_area(*a, *b, *d) == 0 && a.max(c) < b.min(d)
            };
            found += edges[at + 1..].iter().filter(overlap).count() as u64;
        }
    }
    found
}

/// Whether an edge left over lies on a border between two blocks that were looked at, with ground on both sides.
fn open_border((a, b): &(Spot, Spot), looked: &HashSet<BlockIndex>, area: &Area) -> bool {
    let side = i64::from(CELLS) * UNITS;
    let block = |u: i64, v: i64| BlockIndex { x: u.div_euclid(side) as i32, z: v.div_euclid(side) as i32 };
    let middle = |axis: fn(&Spot) -> i64| (axis(a) + axis(b)).div_euclid(2);
    let (u, v) = (middle(|spot| spot.u), middle(|spot| spot.v));
    let sides = if a.u == b.u && a.u % side == 0 {
        [(u - 1, v), (u, v)]
    } else if a.v == b.v && a.v % side == 0 {
        [(u, v - 1), (u, v)]
    } else {
        return false;
    };
    let lattice = Lattice::of(area.grid());
    sides.into_iter().all(|(u, v)| {
        let at = lattice.plan_m(Spot { u, v });
        looked.contains(&block(u, v)) && area.height_m(at.x, at.y).is_some()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::ground_map::Climate;
    use crate::features::model::{
        Airfield, Features, Origin, Road, RoadClass, Runway, RunwaySurface, Waterway, WaterwayClass,
    };
    use crate::grid::Grid;
    use crate::{Field, synthetic};
    use glam::DVec2;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use std::sync::Arc;

    /// Winding roads, a river and an airfield over steep ridges, some with sharp turns and short segments.
    fn made_up(field: Field) -> Landscape {
        let mut rng = StdRng::seed_from_u64(4);
        let grid = *field.grid();
        let mut lines = |count: usize, turn: f64, step_m: f64| -> Vec<Vec<DVec2>> {
            (0..count)
                .map(|_| {
                    let mut at = DVec2::new(
                        rng.random_range(grid.west_m..grid.east_m()),
                        rng.random_range(grid.north_m..grid.south_m()),
                    );
                    let mut heading = rng.random_range(0.0..std::f64::consts::TAU);
                    let mut line = vec![at];
                    for _ in 0..120 {
                        heading += rng.random_range(-turn..turn);
                        at += DVec2::from_angle(heading) * rng.random_range(0.02..2.0) * step_m;
                        line.push(at);
                    }
                    line
                })
                .collect()
        };
        let road = |class, width_m, line| Road { class, width_m, paved: true, tunnel: false, bridge: false, line };
        let mut features = Features::default();
        features.roads.extend(lines(40, 0.6, 60.0).into_iter().map(|line| road(RoadClass::Tertiary, 6.0, line)));
        features.roads.extend(lines(15, 2.8, 12.0).into_iter().map(|line| road(RoadClass::Track, 3.0, line)));
        features.waterways.extend(lines(6, 0.8, 90.0).into_iter().map(|line| Waterway {
            class: WaterwayClass::River,
            width_m: 14.0,
            tunnel: false,
            line,
        }));
        let ends = [DVec2::new(-700.0, -333.0), DVec2::new(800.0, 410.0)];
        features.airfields.push(Airfield {
            code: "TEST".into(),
            name: String::new(),
            reference: DVec2::ZERO,
            level_m: 0.0,
            runways: vec![Runway {
                ends,
                width_m: 30.0,
                designators: ["06".into(), "24R".into()],
                surface: RunwaySurface::Asphalt,
                lit: true,
                from: Origin::Assumed,
            }],
            taxiways: vec![(lines(1, 0.5, 30.0).remove(0), 15.0)],
            aprons: vec![vec![
                DVec2::new(10.0, 20.0),
                DVec2::new(300.0, 30.0),
                DVec2::new(250.0, 280.0),
                DVec2::new(120.0, 90.0),
            ]],
        });
        let climate = Climate::new(0.8, 1_000.0);
        Landscape { features: Arc::new(features), ..Landscape::bare(Arc::new(field), [13.0, 26.0, 52.0], climate) }
    }

    #[test]
    fn what_is_draped_on_ridges_lies_in_them_without_seams() {
        for (step_m, seed) in [(200.0, 1), (50.0, 2)] {
            let field = synthetic::ridges(Grid::centred(step_m, 2, 2).unwrap(), seed);
            let found = look(&made_up(field), 100, |_| {});
            assert!(found.blocks == 4 && found.vertices > 10_000, "{found:?}");
            assert_eq!((found.t_junctions, found.border_mismatches, found.crossings), (0, 0, 0), "{found:?}");
            // Half an ulp of an f32 at 4,096 m and more, and rounding in f64.
            assert!(found.max_height_error_m <= 0.000_245, "{found:?}");
        }
    }

    #[test]
    fn void_ground_carries_nothing() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let field =
            synthetic::from_fn(
                grid,
                |column, row| if (column / 7 + row / 5) % 3 == 0 { f32::NAN } else { 10.0 * row as f32 },
            );
        let found = look(&made_up(field), 100, |_| {});
        assert!(found.vertices > 1_000, "{found:?}");
        assert_eq!((found.t_junctions, found.border_mismatches, found.crossings), (0, 0, 0), "{found:?}");
        assert!(found.max_height_error_m <= 0.000_245, "{found:?}");
    }

    #[test]
    fn a_t_junction_and_a_crossing_are_seen() {
        let spot = |u, v| Spot { u, v };
        let mut edges = Edges::new();
        cancel(&mut edges, spot(0, 0), spot(100, 200), 1);
        cancel(&mut edges, spot(100, 200), spot(50, 100), 1);
        cancel(&mut edges, spot(50, 100), spot(0, 0), 1);
        assert_eq!(t_junctions(&edges), 2);
        let spots = [spot(10, 10), spot(20, 10), spot(UNITS - 5, 30)];
        assert!(crosses(&[0, 1, 2], &spots));
        assert!(!crosses(&[0, 1, 1], &spots));
    }
}
