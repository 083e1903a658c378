//! Every feature that is draped, made ready once, and which of them a block has.

use super::Kind;
use super::clip::Polygon;
use super::lattice::{Lattice, Spot, UNITS};
use super::markings::{self, Mark};
use super::polygon;
use super::region::Region;
use super::ribbon::{MOST_WIDTH_M, Ribbon};
use crate::features::cover::CoverClass;
use crate::features::lakes::Lakes;
use crate::features::model::{Features, RunwaySurface, WaterwayClass};
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS};
use glam::DVec2;
use std::collections::{HashMap, HashSet};

/// Most spots of all ribbons: 16 bytes each. What comes beyond is not drawn.
const MOST_SPOTS: usize = 1 << 26;

/// A feature and what its vertices say.
#[derive(Debug)]
pub struct Source {
    /// What it is.
    pub kind: Kind,
    /// Its shape.
    pub shape: Shape,
}

/// The shape of a feature.
#[derive(Debug)]
pub enum Shape {
    /// A line with a width; along it the metres at each spot.
    Ribbon {
        /// The line.
        ribbon: Ribbon,
        /// Metres along at each spot, signed where a direction has a meaning.
        along_m: Vec<f32>,
    },
    /// Triangles, with slabs that follow the outline's longest edge.
    Area {
        /// The triangles.
        triangles: Vec<Polygon>,
        /// Where along and across are 0.
        origin: Spot,
        /// Unit.
        along: DVec2,
    },
    /// Water within its outlines: what of it lies in which block.
    Water {
        /// A part for each block that it touches.
        parts: Vec<(BlockIndex, Region)>,
    },
    /// Paint in the frame of a runway.
    Marks {
        /// The marks.
        marks: Vec<Mark>,
        /// First threshold, metres.
        start_m: DVec2,
        /// Towards the second, unit.
        along: DVec2,
    },
}

/// Segments, triangles or marks of a source that touch a block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Item {
    /// Which source.
    pub source: u32,
    /// The first.
    pub first: u32,
    /// How many in a row.
    pub count: u32,
}

/// Sources, and the items of each block in the order of painting.
#[derive(Debug, Default)]
pub struct Sources {
    /// All, in the order of painting.
    pub sources: Vec<Source>,
    blocks: HashMap<BlockIndex, Vec<Item>>,
}

impl Sources {
    /// Of a world's features.
    pub fn new(features: &Features, lakes: &Lakes, field: &Field) -> Self {
        let lattice = Lattice::of(field.grid());
        let mut sources = Vec::new();
        let mut room = MOST_SPOTS;
        let mut ribbons = |kind: Kind, line: &[DVec2], width_m: f32, sources: &mut Vec<Source>| {
            let half_m = 0.5 * f64::from(width_m).clamp(0.1, MOST_WIDTH_M);
            for ribbon in Ribbon::of_line(field, &lattice, line, half_m, room) {
                room -= ribbon.spots.len();
                let along_m = lengths(&lattice, &ribbon);
                sources.push(Source { kind, shape: Shape::Ribbon { ribbon, along_m } });
            }
        };
        open_water(features, lakes, field, &mut sources);
        let mut waterways: Vec<_> = features.waterways.iter().filter(|water| !water.tunnel).collect();
        // Ditches below rivers.
        waterways.sort_by_key(|water| match water.class {
            WaterwayClass::Ditch => 0,
            WaterwayClass::Stream => 1,
            WaterwayClass::Canal => 2,
            WaterwayClass::River => 3,
        });
        for water in waterways {
            for reach in outside_lakes(&water.line, lakes) {
                ribbons(Kind::Water, reach, water.width_m, &mut sources);
            }
        }
        let mut roads: Vec<_> = features.roads.iter().filter(|road| !road.tunnel).collect();
        // Wide roads over narrow ones.
        roads.sort_by_key(|road| (Kind::of_road(road.class, road.paved, road.width_m), std::cmp::Reverse(road.class)));
        for road in roads {
            ribbons(Kind::of_road(road.class, road.paved, road.width_m), &road.line, road.width_m, &mut sources);
        }
        for airfield in &features.airfields {
            for apron in &airfield.aprons {
                let triangles = polygon::triangles(&lattice, apron);
                if let Some(origin) = triangles.first().and_then(|triangle| triangle.corners().next()) {
                    let along = longest_edge(apron);
                    sources.push(Source { kind: Kind::Apron, shape: Shape::Area { triangles, origin, along } });
                }
            }
            for (line, width_m) in &airfield.taxiways {
                ribbons(Kind::Taxiway, line, *width_m, &mut sources);
            }
            for runway in &airfield.runways {
                let kind = match runway.surface {
                    RunwaySurface::Asphalt => Kind::RunwayAsphalt,
                    RunwaySurface::Concrete => Kind::RunwayConcrete,
                    RunwaySurface::Gravel => Kind::RunwayGravel,
                    RunwaySurface::Grass => Kind::RunwayGrass,
                };
                let [start, end] = runway.ends;
                let middle = 0.5 * (start + end);
                // Each half counts from its own threshold, for the tyres' traces.
                ribbons(kind, &[start, middle], runway.width_m, &mut sources);
                ribbons(kind, &[end, middle], runway.width_m, &mut sources);
                let marks = markings::marks(runway);
                if !marks.is_empty() {
                    let along = (end - start).normalize_or(DVec2::X);
                    sources.push(Source { kind: Kind::White, shape: Shape::Marks { marks, start_m: start, along } });
                }
            }
        }
        sources.sort_by_key(|source| source.kind);
        let mut blocks = HashMap::new();
        for (number, source) in (0..).zip(&sources) {
            index(&lattice, field, number, source, &mut blocks);
        }
        Self { sources, blocks }
    }

    /// The items of a block, in the order of painting.
    pub fn of_block(&self, block: BlockIndex) -> &[Item] {
        self.blocks.get(&block).map_or(&[], Vec::as_slice)
    }

    /// Blocks that have any, in no order.
    pub fn blocks(&self) -> impl Iterator<Item = BlockIndex> + '_ {
        self.blocks.keys().copied()
    }
}

/// Lakes, the sea, ponds and rivers drawn by their banks.
fn open_water(features: &Features, lakes: &Lakes, field: &Field, sources: &mut Vec<Source>) {
    let grid = field.grid();
    let lattice = Lattice::of(grid);
    let lakes = lakes.lakes().iter().map(|lake| (Kind::StillWater, &lake.rings));
    let areas = features.areas.iter().filter(|area| area.cover == CoverClass::Water);
    let areas = areas.map(|area| (Kind::WaterArea, &area.rings));
    let all: Vec<(Kind, Vec<Vec<Spot>>)> = areas
        .chain(lakes)
        .map(|(kind, rings)| {
            let spots = |ring: &Vec<DVec2>| ring.iter().map(|at| lattice.spot(*at)).collect::<Option<Vec<Spot>>>();
            (kind, rings.iter().filter_map(spots).collect())
        })
        .collect();
    // A river is often drawn in parts: where two meet is no shore.
    let (mut edges, mut joints) = (HashSet::new(), HashSet::new());
    let key = |a: Spot, b: Spot| (a.min(b), a.max(b));
    for ring in all.iter().flat_map(|(_, rings)| rings) {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            if !edges.insert(key(*a, *b)) {
                joints.insert(key(*a, *b));
            }
        }
    }
    for (kind, rings) in all {
        let parts = Region::new(&rings, &|a, b| !joints.contains(&key(a, b))).by_block(grid);
        if !parts.is_empty() {
            sources.push(Source { kind, shape: Shape::Water { parts } });
        }
    }
}

/// The parts of a line of running water that are not in a lake, up to the first point in one: a lake is drawn by itself.
fn outside_lakes<'a>(line: &'a [DVec2], lakes: &Lakes) -> Vec<&'a [DVec2]> {
    if lakes.lakes().is_empty() {
        return vec![line];
    }
    let wet: Vec<bool> = line.iter().map(|at| lakes.lake_at(*at).is_some()).collect();
    let mut parts = Vec::new();
    let mut first = 0;
    for at in 1..line.len() {
        let ends = at + 1 == line.len();
        if wet[at - 1] && wet[at] {
            if at - first > 1 {
                parts.push(&line[first..at]);
            }
            first = at;
        } else if ends {
            parts.push(&line[first..]);
        }
    }
    parts
}

fn longest_edge(ring: &[DVec2]) -> DVec2 {
    let edges = (0..ring.len()).map(|at| ring[(at + 1) % ring.len()] - ring[at]);
    edges.max_by(|a, b| a.length().total_cmp(&b.length())).map_or(DVec2::X, |edge| edge.normalize_or(DVec2::X))
}

fn lengths(lattice: &Lattice, ribbon: &Ribbon) -> Vec<f32> {
    let mut sum_m = 0.0;
    let mut along_m = vec![0.0];
    for pair in ribbon.spots.windows(2) {
        sum_m += lattice.between_m(pair[0], pair[1]).length();
        along_m.push(sum_m as f32);
    }
    along_m
}

/// Puts a source's things into the lists of the blocks that they may touch.
fn index(lattice: &Lattice, field: &Field, source: u32, of: &Source, blocks: &mut HashMap<BlockIndex, Vec<Item>>) {
    let grid = field.grid();
    let side = i64::from(CELLS) * UNITS;
    let mut touch = |low: Spot, high: Spot, thing: u32| {
        let last = |count: u32| i64::from(count) - 1;
        for z in low.v.div_euclid(side).max(0)..=high.v.div_euclid(side).min(last(grid.blocks_z)) {
            for x in low.u.div_euclid(side).max(0)..=high.u.div_euclid(side).min(last(grid.blocks_x)) {
                let items = blocks.entry(BlockIndex { x: x as i32, z: z as i32 }).or_default();
                match items.last_mut() {
                    Some(item) if item.source == source && item.first + item.count == thing => item.count += 1,
                    Some(item) if item.source == source && item.first + item.count > thing => {}
                    _ => items.push(Item { source, first: thing, count: 1 }),
                }
            }
        }
    };
    let bounds = |spots: &mut dyn Iterator<Item = Spot>| {
        spots.fold((Spot { u: i64::MAX, v: i64::MAX }, Spot { u: i64::MIN, v: i64::MIN }), |(low, high), spot| {
            (Spot { u: low.u.min(spot.u), v: low.v.min(spot.v) }, Spot { u: high.u.max(spot.u), v: high.v.max(spot.v) })
        })
    };
    match &of.shape {
        Shape::Ribbon { ribbon, .. } => {
            // A segment is at most ten steps long, so its box is a few blocks. A mitre reaches 1.5 half widths.
            let margin = (2.0 * ribbon.half_m / lattice.unit_m()).ceil() as i64;
            for (at, pair) in (0..).zip(ribbon.spots.windows(2)) {
                let (low, high) = bounds(&mut pair.iter().copied());
                touch(low.moved(-margin, -margin), high.moved(margin, margin), at);
            }
        }
        Shape::Area { triangles, .. } => {
            for (at, triangle) in (0..).zip(triangles) {
                let (low, high) = bounds(&mut triangle.corners());
                touch(low, high, at);
            }
        }
        Shape::Water { parts } => {
            for (at, (block, _)) in (0..).zip(parts) {
                blocks.entry(*block).or_default().push(Item { source, first: at, count: 1 });
            }
        }
        Shape::Marks { marks, start_m, along } => {
            for (at, mark) in (0..).zip(marks) {
                let corners: Option<Vec<Spot>> =
                    mark.corners.iter().map(|corner| lattice.spot(on_runway(*start_m, *along, *corner))).collect();
                if let Some(corners) = corners {
                    let (low, high) = bounds(&mut corners.into_iter());
                    touch(low, high, at);
                }
            }
        }
    }
}

/// Plan point of a place on a runway: along and to the right of a direction.
pub fn on_runway(start_m: DVec2, along: DVec2, at: DVec2) -> DVec2 {
    start_m + along * at.x + DVec2::new(-along.y, along.x) * at.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::lakes::Lake;

    #[test]
    fn running_water_ends_in_a_lake() {
        let p = DVec2::new;
        let ring = vec![p(10.0, -5.0), p(40.0, -5.0), p(40.0, 5.0), p(10.0, 5.0)];
        let lakes = Lakes::new(vec![Lake { name: String::new(), level_m: 0.0, rings: vec![ring] }]);
        let line: Vec<DVec2> = (0..8).map(|at| p(f64::from(at) * 8.0, 0.0)).collect();
        // 16, 24, 32 and 40 are in it or on its edge.
        let parts = outside_lakes(&line, &lakes);
        assert_eq!(parts.len(), 2);
        assert_eq!((parts[0], parts[1].last()), (&line[..3], line.last()));
        assert_eq!(outside_lakes(&line, &Lakes::default()), vec![&line[..]]);
        assert!(outside_lakes(&line[2..4], &lakes).is_empty());
    }
}
