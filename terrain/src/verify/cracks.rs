//! No cracks: every triangle edge meets its opposite, no vertex lies inside another's edge, shared vertices are equal to
//! the bit.
//!
//! Three looks, from the small to the large. [`templates`]: all pairs of neighbouring sub-blocks of a block in all states
//! that their templates depend on. [`pairs`]: all states of the sub-blocks on both sides of a block border. Both together
//! cover every pair of blocks with any masks. [`Sheet`]: all triangles of a real window, laid out post by post.
//!
//! Written on lattice coordinates alone: a triangle is three posts. Frame as in [`crate::grid`]: column +X, row +Z.

use super::flight::Piece;
use crate::block::Landscape;
use crate::block::mask::{Mask, SUBS};
use crate::block::mesh::{TILE, post_of};
use crate::block::payload::tile_heights_m;
use crate::block::rings::Rings;
use crate::block::template;
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS, Grid};
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// How much was looked at and what was wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cracks {
    /// Directed triangle edges looked at, or shared edges of templates.
    pub edges: u64,
    /// Edges without their opposite, walked twice one way, or with a vertex inside.
    pub t_junctions: u64,
    /// Vertices that two blocks place differently.
    pub position_mismatches: u64,
}

impl Cracks {
    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self {
            edges: self.edges + other.edges,
            t_junctions: self.t_junctions + other.t_junctions,
            position_mismatches: self.position_mismatches + other.position_mismatches,
        }
    }
}

/// Column and row of a post.
type Post = (i32, i32);

/// The sides of a sub-block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Side {
    North,
    East,
    South,
    West,
}

impl Side {
    /// All four.
    pub const ALL: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];

    /// Steps of column and row to the neighbour there.
    fn step(self) -> (i32, i32) {
        match self {
            Self::North => (0, -1),
            Self::East => (1, 0),
            Self::South => (0, 1),
            Self::West => (-1, 0),
        }
    }

    /// The side that the neighbour there has in common.
    pub fn opposite(self) -> Self {
        Self::ALL[(self as usize + 2) % 4]
    }

    fn has(self, (column, row): Post) -> bool {
        match self {
            Self::North => row == 0,
            Self::East => column == 2,
            Self::South => row == 2,
            Self::West => column == 0,
        }
    }

    /// Place along the side.
    fn along(self, (column, row): Post) -> i32 {
        match self {
            Self::North | Self::South => column,
            Self::East | Self::West => row,
        }
    }
}

/// Vertices and directed edges of a template on one side, as places along it; an edge walked twice is there twice.
fn on_side(template: usize, side: Side) -> (BTreeSet<i32>, Vec<(i32, i32)>) {
    let (mut vertices, mut edges) = (BTreeSet::new(), Vec::new());
    for triangle in template::triangles(template) {
        let posts = triangle.map(|post| (i32::from(post) % 3, i32::from(post) / 3));
        for at in 0..3 {
            let (from, to) = (posts[at], posts[(at + 1) % 3]);
            if side.has(from) {
                vertices.insert(side.along(from));
                if side.has(to) {
                    edges.push((side.along(from), side.along(to)));
                }
            }
        }
    }
    edges.sort();
    (vertices, edges)
}

/// Whether two templates fit along a side of the first: the same vertices, every edge walked once each way.
pub fn fit(template: usize, side: Side, neighbour: usize) -> bool {
    let (vertices, edges) = on_side(template, side);
    let (theirs, their_edges) = on_side(neighbour, side.opposite());
    let mut opposite: Vec<(i32, i32)> = their_edges.iter().map(|(from, to)| (*to, *from)).collect();
    opposite.sort();
    let once = edges.windows(2).all(|pair| pair[0] != pair[1]);
    // From end to end without a gap.
    let whole = edges.iter().map(|(from, to)| (to - from).abs()).sum::<i32>() == 2;
    vertices == theirs && edges == opposite && once && whole
}

/// Masks with all states of some sub-blocks, the others coarse.
fn all_states(subs: &[(usize, usize)]) -> impl Iterator<Item = Mask> + '_ {
    (0..1u32 << subs.len()).map(|state| {
        let mut mask = Mask::NONE;
        for (bit, (column, row)) in subs.iter().enumerate() {
            if state >> bit & 1 == 1 {
                mask.set_fine(*column, *row);
            }
        }
        mask
    })
}

/// A sub-block of a block and those beside it.
fn with_neighbours((column, row): (usize, usize)) -> Vec<(usize, usize)> {
    let steps = Side::ALL.map(Side::step).into_iter().filter_map(|(dc, dr)| {
        let (c, r) = (column as i32 + dc, row as i32 + dr);
        let inside = (0..SUBS as i32).contains(&c) && (0..SUBS as i32).contains(&r);
        inside.then_some((c as usize, r as usize))
    });
    std::iter::once((column, row)).chain(steps).collect()
}

/// All pairs of neighbouring sub-blocks of a block: every place, every side, every state of the two and of all beside
/// them, which is all that their templates depend on. Also says which pairs of templates occurred.
pub fn templates() -> (Cracks, BTreeSet<(usize, Side, usize)>) {
    let (mut cracks, mut met) = (Cracks::default(), BTreeSet::new());
    for row in 0..SUBS {
        for column in 0..SUBS {
            for side in Side::ALL {
                let (dc, dr) = side.step();
                let (c, r) = (column as i32 + dc, row as i32 + dr);
                if !(0..SUBS as i32).contains(&c) || !(0..SUBS as i32).contains(&r) {
                    continue;
                }
                let (c, r) = (c as usize, r as usize);
                let mut subs = with_neighbours((column, row));
                subs.extend(with_neighbours((c, r)));
                subs.sort();
                subs.dedup();
                for mask in all_states(&subs) {
                    met.insert((mask.template(column, row), side, mask.template(c, r)));
                    cracks.edges += 1;
                }
            }
        }
    }
    cracks.t_junctions = met.iter().filter(|(here, side, there)| !fit(*here, *side, *there)).count() as u64;
    (cracks, met)
}

/// All pairs of sub-blocks across a block border: every place along it, every side, every state of either sub-block and
/// of those beside it in its own block. Also says which pairs of templates occurred.
pub fn pairs() -> (Cracks, BTreeSet<(usize, Side, usize)>) {
    let (mut cracks, mut met) = (Cracks::default(), BTreeSet::new());
    let at = |side: Side, along: usize| match side {
        Side::North => (along, 0),
        Side::East => (SUBS - 1, along),
        Side::South => (along, SUBS - 1),
        Side::West => (0, along),
    };
    let states = |sub: (usize, usize)| -> Vec<usize> {
        all_states(&with_neighbours(sub)).map(|mask| mask.template(sub.0, sub.1)).collect()
    };
    for side in Side::ALL {
        for along in 0..SUBS {
            let theirs = states(at(side.opposite(), along));
            for here in states(at(side, along)) {
                for there in &theirs {
                    met.insert((here, side, *there));
                    cracks.edges += 1;
                }
            }
        }
    }
    cracks.t_junctions = met.iter().filter(|(here, side, there)| !fit(*here, *side, *there)).count() as u64;
    (cracks, met)
}

/// Splits an eye into the post north-west of it and the rest in metres, as the renderer does.
pub type SplitEye = fn(&Grid, DVec3) -> ([i32; 2], [f32; 2]);

/// All triangles of a window, post by post.
pub struct Sheet<'f> {
    field: &'f Field,
    origin: BlockIndex,
    blocks: i32,
    side: i32,
    /// A bit a directed edge that starts at a post, by where it leads: 5 x 5 posts around it.
    edges: Vec<u32>,
    /// Where each post was placed by the first block that has it: x, y, z bits.
    placed: Vec<Option<[u32; 3]>>,
    present: Vec<bool>,
    eye_m: DVec3,
    eye_post: [i32; 2],
    eye_fraction_m: [f32; 2],
    cracks: Cracks,
}

impl<'f> Sheet<'f> {
    /// An empty sheet for `blocks` x `blocks` blocks from `origin` on, seen from an eye.
    pub fn new(field: &'f Field, origin: BlockIndex, blocks: u32, eye_m: DVec3, split: SplitEye) -> Self {
        let cells = blocks * CELLS;
        // One more for the apron.
        let side = cells as usize + 2;
        let (eye_post, eye_fraction_m) = split(field.grid(), eye_m);
        Self {
            field,
            origin,
            blocks: blocks as i32,
            side: side as i32,
            edges: vec![0; side * side],
            placed: vec![None; side * side],
            present: vec![false; (blocks * blocks) as usize],
            eye_m,
            eye_post,
            eye_fraction_m,
            cracks: Cracks::default(),
        }
    }

    /// Lays a block's triangles out. Blocks outside the sheet count as wrong.
    pub fn add(&mut self, piece: Piece<'_>) {
        let (x, z) = (piece.block.x - self.origin.x, piece.block.z - self.origin.z);
        if !(0..self.blocks).contains(&x) || !(0..self.blocks).contains(&z) {
            self.cracks.t_junctions += 1;
            return;
        }
        self.present[(z * self.blocks + x) as usize] = true;
        let corner = (x * CELLS as i32, z * CELLS as i32);
        self.place(piece, corner);
        for triangle in piece.indices.as_chunks::<3>().0 {
            let posts = triangle.map(|index| {
                let (column, row) = post_of(index);
                (corner.0 + column as i32, corner.1 + row as i32)
            });
            for at in 0..3 {
                self.walk(posts[at], posts[(at + 1) % 3]);
            }
        }
    }

    fn walk(&mut self, from: Post, to: Post) {
        self.cracks.edges += 1;
        match direction(from, to) {
            Some(bit) => {
                let seen = &mut self.edges[(from.1 * self.side + from.0) as usize];
                self.cracks.t_junctions += u64::from(*seen >> bit & 1);
                *seen |= 1 << bit;
            }
            None => self.cracks.t_junctions += 1,
        }
    }

    /// Places all posts of a block's tile, the apron too, with the arithmetic of the vertex stage (`shared/posts.wgsl`),
    /// in f32 and in its order.
    fn place(&mut self, piece: Piece<'_>, corner: Post) {
        let step_m = self.field.grid().step_m as f32;
        let eye_high_m = self.eye_m.y as f32;
        let eye_low_m = (self.eye_m.y - f64::from(eye_high_m)) as f32;
        let first = [piece.block.first_column() as i32, piece.block.first_row() as i32];
        let plan = |axis: usize, local: i32| {
            let away = (first[axis] + local - self.eye_post[axis]) as f32;
            (away * step_m - self.eye_fraction_m[axis]).to_bits()
        };
        for row in 0..TILE as i32 {
            for column in 0..TILE as i32 {
                let height_m = piece.heights_m[(row * TILE as i32 + column) as usize];
                let up = (height_m - eye_high_m) - eye_low_m;
                let bits = [plan(0, column), up.to_bits(), plan(1, row)];
                let kept = &mut self.placed[((corner.1 + row) * self.side + corner.0 + column) as usize];
                match kept {
                    // No data has no place, but must have none for all.
                    Some(known) => self.cracks.position_mismatches += u64::from(*known != bits),
                    None => *kept = Some(bits),
                }
            }
        }
    }

    /// Looks at every edge.
    pub fn check(mut self) -> Cracks {
        let mut wrong = 0;
        for row in 0..self.side {
            for column in 0..self.side {
                let from = (column, row);
                let mut bits = self.edges[(row * self.side + column) as usize];
                while bits != 0 {
                    let bit = bits.trailing_zeros() as i32;
                    bits &= bits - 1;
                    let (dc, dr) = (bit % 5 - 2, bit / 5 - 2);
                    let to = (column + dc, row + dr);
                    let half_way = dc % 2 == 0 && dr % 2 == 0;
                    let t_junction = half_way && self.starts((column + dc / 2, row + dr / 2)) != 0;
                    let met = direction(to, from).is_some_and(|back| self.starts(to) >> back & 1 == 1);
                    wrong += u64::from(t_junction) + u64::from(!met && !self.is_rim(from, to));
                }
            }
        }
        self.cracks.t_junctions += wrong;
        self.cracks
    }

    fn starts(&self, (column, row): Post) -> u32 {
        self.edges[(row * self.side + column) as usize]
    }

    /// Whether an edge may lack its opposite: it is one of level 0, and the ground's triangle beyond it is void or of a
    /// block that is not there.
    fn is_rim(&self, from: Post, to: Post) -> bool {
        let (column, row) = to;
        // The triangle that walks from `to` to `from`: the cell's north-west corner and the third post.
        let beyond = match (from.0 - column, from.1 - row) {
            (0, 1) => ((column, row), (column + 1, row)),
            (1, -1) => return self.is_rim_diagonal((column, row - 1), (column, row - 1)),
            (-1, 0) => ((column - 1, row), (column - 1, row + 1)),
            (1, 0) => ((column, row - 1), (column + 1, row - 1)),
            (0, -1) => ((column - 1, row - 1), (column - 1, row)),
            (-1, 1) => return self.is_rim_diagonal((column - 1, row), (column, row + 1)),
            _ => return false,
        };
        let (cell, third) = beyond;
        !self.is_present(cell) || self.is_void(third)
    }

    /// A diagonal lies within a cell, so only void can be beyond it.
    fn is_rim_diagonal(&self, cell: Post, third: Post) -> bool {
        self.is_present(cell) && self.is_void(third)
    }

    fn is_present(&self, (column, row): Post) -> bool {
        let (x, z) = (column.div_euclid(CELLS as i32), row.div_euclid(CELLS as i32));
        (0..self.blocks).contains(&x) && (0..self.blocks).contains(&z) && self.present[(z * self.blocks + x) as usize]
    }

    fn is_void(&self, (column, row): Post) -> bool {
        let (first_column, first_row) = (self.origin.first_column(), self.origin.first_row());
        self.field.post_m(first_column + i64::from(column), first_row + i64::from(row)).is_nan()
    }
}

/// Number of a directed edge by where it leads; `None` beyond two posts or nowhere.
fn direction(from: Post, to: Post) -> Option<i32> {
    let (dc, dr) = (to.0 - from.0, to.1 - from.1);
    let near = (-2..=2).contains(&dc) && (-2..=2).contains(&dr) && (dc, dr) != (0, 0);
    near.then_some((dr + 2) * 5 + dc + 2)
}

/// The window that an eye has after a jump, every block in its ring, laid out and looked at.
pub fn window(landscape: &Landscape, rings: &Rings, blocks: u32, eye_m: DVec3, split: SplitEye) -> Cracks {
    let field = landscape.ground.field();
    let grid = field.grid();
    let middle = DVec2::new(eye_m.x - grid.west_m, eye_m.z - grid.north_m) / grid.block_m();
    let half = blocks as i32 / 2;
    let origin = BlockIndex { x: middle.x.round() as i32 - half, z: middle.y.round() as i32 - half };
    let mut sheet = Sheet::new(field, origin, blocks, eye_m, split);
    for z in origin.z..origin.z + blocks as i32 {
        for x in origin.x..origin.x + blocks as i32 {
            let block = BlockIndex { x, z };
            if !grid.contains_block(block) {
                continue;
            }
            let ring = rings.ring_at(grid.distance_to_block_m(eye_m.x, eye_m.z, block));
            let heights_m = tile_heights_m(field, block);
            sheet.add(Piece { block, indices: landscape.mesh(block, ring).indices(), heights_m: &heights_m });
        }
    }
    sheet.check()
}
