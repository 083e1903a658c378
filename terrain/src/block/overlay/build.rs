//! A block's overlay: the features that touch it, cut to its ground and packed for the GPU.

use super::clip::{CellSquare, Polygon};
use super::lattice::{self, Lattice, Spot, UNITS};
use super::region::{Region, Triangle};
use super::source::{Item, Shape, Source, Sources, on_runway};
use super::{ACROSS_PER_METRE, EXTENT_PER_METRE, Kind, NO_SHORE_M, Overlay, PLACE_BITS, Part, TURN_STEPS, Vertex};
use crate::block::payload::Landscape;
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS};
use glam::DVec2;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Most vertices of a block: 80 MiB. What comes beyond is not drawn.
const MOST_VERTICES: usize = 1 << 22;

/// Makes the overlays of a world's blocks.
#[derive(Debug)]
pub struct Overlays {
    field: Arc<Field>,
    lattice: Lattice,
    sources: Sources,
}

/// Along and across of a plan point, and what else a vertex says.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub kind: Kind,
    pub origin: Spot,
    pub along: DVec2,
    /// To the right of along, and longer than 1 where the ground is steep.
    pub across: DVec2,
    pub start_m: f64,
    pub half_m: f64,
    pub half_length_m: f64,
}

impl Overlays {
    /// Of a landscape; makes ready all its features.
    pub fn new(landscape: &Landscape) -> Self {
        let field = landscape.ground.field().clone();
        Self {
            lattice: Lattice::of(field.grid()),
            sources: Sources::new(&landscape.features, &landscape.lakes, &field),
            field,
        }
    }

    /// Blocks that have anything, row by row.
    pub fn blocks(&self) -> Vec<BlockIndex> {
        let mut blocks: Vec<BlockIndex> = self.sources.blocks().collect();
        blocks.sort_by_key(|block| (block.z, block.x));
        blocks
    }

    /// What lies on a block.
    pub fn block(&self, block: BlockIndex) -> Overlay {
        let mut overlay = Overlay::default();
        let mut drape = Drape {
            field: &self.field,
            lattice: self.lattice,
            square: CellSquare { column: block.first_column(), row: block.first_row(), cells: i64::from(CELLS) },
            overlay: &mut overlay,
        };
        for item in self.sources.of_block(block) {
            let Some(source) = self.sources.sources.get(item.source as usize) else { continue };
            drape.item(source, item);
        }
        overlay
    }
}

/// What is being draped over a block.
pub(super) struct Drape<'a> {
    pub field: &'a Field,
    pub lattice: Lattice,
    pub square: CellSquare,
    pub overlay: &'a mut Overlay,
}

impl Drape<'_> {
    fn item(&mut self, source: &Source, item: &Item) {
        let things = item.first as usize..(item.first + item.count) as usize;
        let first = self.overlay.indices.len() as u32;
        match &source.shape {
            Shape::Ribbon { ribbon, along_m } => {
                for segment in things {
                    let field = self.field;
                    let lattice = self.lattice;
                    ribbon.segment(field, &lattice, segment, |quad| {
                        let right = DVec2::new(-quad.along.y, quad.along.x);
                        let frame = Frame {
                            kind: source.kind,
                            origin: quad.origin,
                            along: quad.along,
                            across: right * quad.stretch,
                            start_m: f64::from(along_m[segment]) + quad.start_m,
                            half_m: ribbon.half_m,
                            half_length_m: 0.0,
                        };
                        self.polygon(quad.polygon, &frame);
                    });
                }
            }
            Shape::Area { triangles, origin, along } => {
                let frame = Frame {
                    kind: source.kind,
                    origin: *origin,
                    along: *along,
                    across: DVec2::new(-along.y, along.x),
                    start_m: 0.0,
                    half_m: 0.0,
                    half_length_m: 0.0,
                };
                for triangle in &triangles[things] {
                    self.polygon(*triangle, &frame);
                }
            }
            Shape::Water { parts } => {
                for (block, region) in &parts[things] {
                    self.water(source.kind, *block, region.clone());
                }
            }
            Shape::Marks { marks, start_m, along } => {
                for (number, mark) in things.clone().zip(&marks[things]) {
                    let first = self.overlay.indices.len() as u32;
                    let place = |at: DVec2| self.lattice.spot(on_runway(*start_m, *along, at));
                    let [Some(a), Some(b), Some(c), Some(d)] = mark.corners.map(place) else { continue };
                    let (Some(origin), Some(polygon)) = (place(mark.centre), Polygon::new(&[a, b, c, d])) else {
                        continue;
                    };
                    let frame = Frame {
                        kind: source.kind,
                        origin,
                        along: *along,
                        across: DVec2::new(-along.y, along.x),
                        start_m: 0.0,
                        half_m: mark.half_m,
                        half_length_m: mark.half_length_m,
                    };
                    self.polygon(polygon, &frame);
                    self.part(item.source, number as u32, first);
                }
                return;
            }
        }
        self.part(item.source, 0, first);
    }

    /// Closes a part that began at an index; without a triangle there is none.
    fn part(&mut self, source: u32, piece: u32, first: u32) {
        let count = self.overlay.indices.len() as u32 - first;
        if count > 0 {
            self.overlay.parts.push(Part { source, piece, first, count });
        }
    }

    /// Cuts a polygon to the block's triangles.
    pub fn polygon(&mut self, polygon: Polygon, frame: &Frame) {
        let Self { field, lattice, square, overlay } = self;
        polygon.cut(*square, |column, row, piece| {
            let first = overlay.vertices.len();
            if first > MOST_VERTICES {
                return;
            }
            let middle = (column + row + 1) * UNITS;
            let north_west = piece.corners().all(|spot| spot.u + spot.v <= middle);
            if is_void(field, column, row, north_west) {
                return;
            }
            for spot in piece.corners() {
                overlay.vertices.push(vertex(field, lattice, square, frame, spot));
            }
            piece.fan(|a, b, c| overlay.indices.extend([a, b, c].map(|place| (first + place) as u32)));
        });
    }
}

impl Drape<'_> {
    /// Water within an outline. Vertices are shared where they are equal: open water is most of a lake.
    fn water(&mut self, kind: Kind, block: BlockIndex, region: Region) {
        let Self { field, lattice, square, overlay } = self;
        let mut known: HashMap<[u32; 5], u32> = HashMap::new();
        region.cut(block, |column, row, north_west, piece| {
            if overlay.vertices.len() > MOST_VERTICES || is_void(field, column, row, north_west) {
                return;
            }
            piece.triangles(&mut |triangle| {
                for (spot, shores_m) in triangle.corners.into_iter().zip(shores_m(lattice, &triangle)) {
                    let (east, south) = (spot.u - square.column * UNITS, spot.v - square.row * UNITS);
                    let vertex = Vertex {
                        east: east as u32 | (kind as u32) << PLACE_BITS,
                        south: south as u32,
                        height_m: lattice::height_m(field, spot) as f32,
                        along_m: shores_m[0] as f32,
                        across: (shores_m[1] * ACROSS_PER_METRE).round() as u32,
                    };
                    let index = *known.entry(vertex.words()).or_insert_with(|| {
                        overlay.vertices.push(vertex);
                        overlay.vertices.len() as u32 - 1
                    });
                    overlay.indices.push(index);
                }
            });
        });
    }
}

/// Distances of a triangle's corners from its first two edges that are shores, so that between them the distance from the
/// edge itself is found; an edge whose triangle has no width, or a third one, counts as none.
fn shores_m(lattice: &Lattice, triangle: &Triangle) -> [[f64; 2]; 3] {
    let mut found = [NO_SHORE_M; 3];
    let corners = triangle.corners.map(|spot| lattice.between_m(triangle.corners[0], spot));
    let shores = (0..3).filter(|edge| triangle.shore[*edge]);
    for (number, edge) in shores.take(2).enumerate() {
        let (a, b, c) = (corners[edge], corners[(edge + 1) % 3], corners[(edge + 2) % 3]);
        let away_m = (b - a).perp_dot(c - a).abs() / (b - a).length();
        if away_m > 0.0 {
            found[edge][number] = 0.0;
            found[(edge + 1) % 3][number] = 0.0;
            found[(edge + 2) % 3][number] = away_m.min(NO_SHORE_M[number]);
        }
    }
    found
}

/// Whether a triangle of the ground is not there.
fn is_void(field: &Field, column: i64, row: i64, north_west: bool) -> bool {
    let corner = if north_west { field.post_m(column, row) } else { field.post_m(column + 1, row + 1) };
    (corner + field.post_m(column, row + 1) + field.post_m(column + 1, row)).is_nan()
}

fn vertex(field: &Field, lattice: &Lattice, square: &CellSquare, frame: &Frame, spot: Spot) -> Vertex {
    let away_m = lattice.between_m(frame.origin, spot);
    let packed = |value: f64, per_metre: f64, most: f64| (value * per_metre).round().clamp(-most, most);
    let across = packed(away_m.dot(frame.across), ACROSS_PER_METRE, 32_767.0) as i16 as u16;
    let half = packed(frame.half_m, ACROSS_PER_METRE, 32_767.0) as u16;
    let extra = if frame.kind == Kind::White {
        packed(frame.half_length_m, EXTENT_PER_METRE, 1_023.0) as u32
    } else {
        // To the right, clockwise from east; the last of the steps is the first.
        let turn = frame.across.y.atan2(frame.across.x).rem_euclid(TAU) / TAU;
        (turn * TURN_STEPS).round() as u32 % TURN_STEPS as u32
    };
    let (east, south) = (spot.u - square.column * UNITS, spot.v - square.row * UNITS);
    Vertex {
        east: east as u32 | (frame.kind as u32) << PLACE_BITS,
        south: south as u32 | extra << PLACE_BITS,
        height_m: lattice::height_m(field, spot) as f32,
        along_m: (frame.start_m + away_m.dot(frame.along)) as f32,
        across: u32::from(across) | u32::from(half) << 16,
    }
}
