//! Areas of any outline, with islands, cut exactly along the ground's cell edges and diagonals.
//!
//! A region is a set of loops: a place is inside by the even-odd rule over all of them, whichever way each turns. A line
//! is cut in one go for both of its sides: the places where loops cross it are sorted and taken in pairs, and each pair
//! becomes an edge along the line of the part on either side. So both sides have the same edges by construction, with
//! outlines of any shape, and what is left over in the end is the outline alone.
//!
//! As in [`super::clip`], an edge of an outline remembers the ends it had before any cut, and every cut of it is made
//! from those. The triangles of a piece use all its edges, none of them in part: a corner that lies on another edge gets
//! a triangle without area rather than none.

use super::lattice::{Axis, Spot, UNITS, crossing, twice_area};
use crate::grid::{BlockIndex, CELLS, Grid};

/// An edge of an outline as it was before any cut.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Uncut {
    ends: (Spot, Spot),
    /// Whether it is a shore, and not where two outlines of one water meet.
    shore: bool,
}

/// A corner and what the edge from it to the next is a part of; `None`: it lies along a line of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Corner {
    at: Spot,
    edge: Option<Uncut>,
}

type Loop = Vec<Corner>;

/// See the module.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Region {
    loops: Vec<Loop>,
}

/// A triangle of a region: it turns from east to south, or has no area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangle {
    /// Its corners.
    pub corners: [Spot; 3],
    /// Whether the edge from each corner to the next is a shore.
    pub shore: [bool; 3],
}

impl Region {
    /// Of rings; `shore` says of an edge whether it is one. A corner that would lie on a line of the ground is moved off
    /// it by a unit or two, so that no outline touches a line without crossing it.
    pub fn new(rings: &[Vec<Spot>], shore: &dyn Fn(Spot, Spot) -> bool) -> Self {
        let loops = rings.iter().map(|ring| {
            let mut corners = Loop::new();
            for at in 0..ring.len() {
                let (from, to) = (ring[at], ring[(at + 1) % ring.len()]);
                let ends = (off_lines(from), off_lines(to));
                push(&mut corners, Corner { at: ends.0, edge: Some(Uncut { ends, shore: shore(from, to) }) });
            }
            closed(corners)
        });
        Self { loops: loops.flatten().collect() }
    }

    /// Whether nothing is in it.
    pub fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }

    /// Number of its corners.
    pub fn corners(&self) -> usize {
        self.loops.iter().map(Vec::len).sum()
    }

    /// The parts below a line and above it.
    fn split(self, axis: Axis, line: i64) -> (Self, Self) {
        let mut sides = [Self::default(), Self::default()];
        let mut cut = Cut { axis, line, chains: Vec::new() };
        for corners in self.loops {
            let above = |corner: &Corner| usize::from(corner.at.along(axis) >= line);
            let first = above(&corners[0]);
            if corners.iter().all(|corner| above(corner) == first) {
                sides[first].loops.push(corners);
            } else {
                cut.take(&corners);
            }
        }
        let [below, above] = cut.sides();
        sides[0].loops.extend(below);
        sides[1].loops.extend(above);
        let [below, above] = sides;
        (below, above)
    }

    /// Hands out the part of each stretch of a cell's length, from `first` on to before `last`.
    fn strips(self, axis: Axis, first: i64, last: i64, mut strip: impl FnMut(i64, Self)) {
        let mut rest = self;
        for at in first..last {
            if rest.is_empty() {
                return;
            }
            let (below, above) = rest.split(axis, (at + 1) * UNITS);
            rest = above;
            if !below.is_empty() {
                strip(at, below);
            }
        }
    }

    /// The part in each block of a grid.
    pub fn by_block(self, grid: &Grid) -> Vec<(BlockIndex, Self)> {
        let (x, z) = (i64::from(grid.blocks_x), i64::from(grid.blocks_z));
        let side = i64::from(CELLS) * UNITS;
        let inside = self.split(Axis::U, 0).1.split(Axis::U, x * side).0;
        let inside = inside.split(Axis::V, 0).1.split(Axis::V, z * side).0;
        let mut parts = Vec::new();
        inside.halves([0, x], [0, z], &mut parts);
        parts
    }

    fn halves(self, x: [i64; 2], z: [i64; 2], parts: &mut Vec<(BlockIndex, Self)>) {
        let side = i64::from(CELLS) * UNITS;
        let (wide, high) = (x[1] - x[0], z[1] - z[0]);
        if self.is_empty() || wide < 1 || high < 1 {
        } else if wide == 1 && high == 1 {
            parts.push((BlockIndex { x: x[0] as i32, z: z[0] as i32 }, self));
        } else if wide >= high {
            let middle = x[0] + wide / 2;
            let (west, east) = self.split(Axis::U, middle * side);
            west.halves([x[0], middle], z, parts);
            east.halves([middle, x[1]], z, parts);
        } else {
            let middle = z[0] + high / 2;
            let (north, south) = self.split(Axis::V, middle * side);
            north.halves(x, [z[0], middle], parts);
            south.halves(x, [middle, z[1]], parts);
        }
    }

    /// Hands out the part of a block in each triangle of its ground: column, row, whether it is the north-western one.
    pub fn cut(self, block: BlockIndex, mut piece: impl FnMut(i64, i64, bool, Self)) {
        let (column, row, cells) = (block.first_column(), block.first_row(), i64::from(CELLS));
        self.strips(Axis::U, column, column + cells, |column, strip| {
            strip.strips(Axis::V, row, row + cells, |row, cell| {
                let (north_west, south_east) = cell.split(Axis::W, (column + row + 1) * UNITS);
                for (half, is_north_west) in [(north_west, true), (south_east, false)] {
                    if !half.is_empty() {
                        piece(column, row, is_north_west, half);
                    }
                }
            });
        });
    }

    /// Its triangles.
    pub fn triangles(self, triangle: &mut dyn FnMut(Triangle)) {
        let mut loops: Vec<Loop> = self.loops.into_iter().flat_map(simple_loops).collect();
        if let [only] = &mut *loops {
            turn(only, true);
            return clip_ears(std::mem::take(only), triangle);
        }
        let depth = |at: usize| {
            let others = loops.iter().enumerate().filter(|(other, corners)| *other != at && holds(corners, &loops[at]));
            others.count()
        };
        let depths: Vec<usize> = (0..loops.len()).map(depth).collect();
        let mut holes: Vec<(usize, Loop)> = Vec::new();
        let mut outers: Vec<(usize, Loop)> = Vec::new();
        for (mut corners, depth) in loops.into_iter().zip(depths) {
            turn(&mut corners, depth % 2 == 0);
            if depth % 2 == 0 { &mut outers } else { &mut holes }.push((depth, corners));
        }
        // From the east, so that what lies east of a hole is a part of its outline already.
        let east = |corners: &Loop| corners.iter().map(|corner| corner.at.u).max();
        holes.sort_by_key(|(_, corners)| std::cmp::Reverse(east(corners)));
        let whole: Vec<Loop> = outers.iter().map(|(_, corners)| corners.clone()).collect();
        for (depth, hole) in holes {
            let around =
                outers.iter().zip(&whole).position(|((outer, _), whole)| outer + 1 == depth && holds(whole, &hole));
            if let Some(at) = around {
                bridge(&mut outers[at].1, hole);
            }
        }
        for (_, corners) in outers {
            clip_ears(corners, triangle);
        }
    }
}

/// Loops that cross a line, as chains from crossing to crossing.
struct Cut {
    axis: Axis,
    line: i64,
    chains: Vec<Chain>,
}

/// What of a loop lies between two crossings, which are its first corner and `to`.
struct Chain {
    above: bool,
    corners: Loop,
    to: Spot,
}

/// An end of a chain: which, and whether it is the last.
type End = (usize, bool);

impl Cut {
    fn take(&mut self, corners: &Loop) {
        let len = corners.len();
        let above = |at: usize| corners[at % len].at.along(self.axis) >= self.line;
        let Some(start) = (0..len).find(|at| above(*at) != above(at + len - 1)) else { return };
        let first = self.chains.len();
        for at in start..start + len {
            let before = corners[(at + len - 1) % len];
            let here = corners[at % len];
            if above(at) != above(at + len - 1) {
                let spot = self.spot(before, here.at);
                if let Some(chain) = self.chains[first..].last_mut() {
                    chain.to = spot;
                }
                let corner = Corner { at: spot, edge: before.edge };
                self.chains.push(Chain { above: above(at), corners: vec![corner], to: spot });
            }
            if let Some(chain) = self.chains.last_mut() {
                chain.corners.push(here);
            }
        }
        let back = self.chains[first].corners[0].at;
        if let Some(chain) = self.chains.last_mut() {
            chain.to = back;
        }
    }

    /// Where an edge crosses; a corner on the line is the crossing itself.
    fn spot(&self, from: Corner, to: Spot) -> Spot {
        if let Some(on) = [from.at, to].into_iter().find(|spot| spot.along(self.axis) == self.line) {
            return on;
        }
        let (a, b) = from.edge.map_or((from.at, to), |edge| edge.ends);
        crossing(self.axis, self.line, a, b)
    }

    /// The loops below and above.
    fn sides(self) -> [Vec<Loop>; 2] {
        [false, true].map(|above| {
            let mut ends: Vec<(i64, End)> = Vec::new();
            for (number, chain) in self.chains.iter().enumerate().filter(|(_, chain)| chain.above == above) {
                let place = |spot: Spot| if self.axis == Axis::U { spot.v } else { spot.u };
                ends.push((place(chain.corners[0].at), (number, false)));
                ends.push((place(chain.to), (number, true)));
            }
            ends.sort_unstable();
            let mut partner = vec![[(0, false); 2]; self.chains.len()];
            for pair in ends.chunks_exact(2) {
                for (one, other) in [(pair[0].1, pair[1].1), (pair[1].1, pair[0].1)] {
                    partner[one.0][usize::from(one.1)] = other;
                }
            }
            let mut used = vec![false; self.chains.len()];
            let mut loops = Vec::new();
            for (first, chain) in self.chains.iter().enumerate() {
                if chain.above != above || used[first] {
                    continue;
                }
                let mut corners = Loop::new();
                let (mut at, mut last) = (first, false);
                while !std::mem::replace(&mut used[at], true) {
                    self.chains[at].append(last, &mut corners);
                    // On along the line.
                    (at, last) = partner[at][usize::from(!last)];
                }
                loops.extend(closed(corners));
            }
            loops
        })
    }
}

impl Chain {
    /// Adds the chain to a loop, from its first end or from its last.
    fn append(&self, from_last: bool, corners: &mut Loop) {
        if from_last {
            push(corners, Corner { at: self.to, edge: self.corners[self.corners.len() - 1].edge });
            for pair in self.corners.windows(2).rev() {
                push(corners, Corner { at: pair[1].at, edge: pair[0].edge });
            }
            push(corners, Corner { at: self.corners[0].at, edge: None });
        } else {
            self.corners.iter().for_each(|corner| push(corners, *corner));
            push(corners, Corner { at: self.to, edge: None });
        }
    }
}

/// Adds a corner; one in the same place, with its edge of no length, makes room for it.
fn push(corners: &mut Loop, corner: Corner) {
    if corners.last().is_some_and(|last| last.at == corner.at) {
        corners.pop();
    }
    corners.push(corner);
}

/// A loop, if it is more than a line to and fro.
fn closed(mut corners: Loop) -> Option<Loop> {
    while corners.len() > 1 && corners.first().map(|c| c.at) == corners.last().map(|c| c.at) {
        corners.pop();
    }
    (corners.len() >= 3).then_some(corners)
}

/// The spot, or the nearest to its east or south that lies on no line of the ground.
fn off_lines(spot: Spot) -> Spot {
    let on = |spot: Spot| [spot.u, spot.v, spot.u + spot.v].iter().any(|along| along % UNITS == 0);
    let near = [(0, 0), (1, 0), (0, 1), (1, 1), (1, 2)].map(|(du, dv)| spot.moved(du, dv));
    near.into_iter().find(|spot| !on(*spot)).unwrap_or(spot)
}

/// A loop that comes to one place several times, as loops that do not.
fn simple_loops(corners: Loop) -> Vec<Loop> {
    let mut found = Vec::new();
    let mut open: Loop = Vec::new();
    for corner in corners {
        if let Some(first) = open.iter().position(|other| other.at == corner.at) {
            let inner = open.split_off(first);
            found.extend(closed(inner));
        }
        open.push(corner);
    }
    found.extend(closed(open));
    found
}

/// Twice the area of a loop, units squared.
fn twice_loop_area(corners: &[Corner]) -> i128 {
    let Some(first) = corners.first() else { return 0 };
    corners.windows(2).map(|pair| twice_area(first.at, pair[0].at, pair[1].at)).sum()
}

/// Makes a loop turn from east to south, or the other way.
fn turn(corners: &mut Loop, positive: bool) {
    if (twice_loop_area(corners) < 0) == positive {
        let edges: Vec<Option<Uncut>> = corners.iter().map(|corner| corner.edge).collect();
        corners.reverse();
        let len = corners.len();
        for (at, corner) in corners.iter_mut().enumerate() {
            corner.edge = edges[(2 * len - 2 - at) % len];
        }
    }
}

/// Whether a loop holds another, judged by the middle of the other's first edge.
fn holds(corners: &[Corner], other: &[Corner]) -> bool {
    let [from, to] = [other[0].at, other[1].at];
    let (u, v) = (from.u + to.u, from.v + to.v);
    let mut inside = false;
    for at in 0..corners.len() {
        let (a, b) = (corners[at].at, corners[(at + 1) % corners.len()].at);
        if (2 * a.v > v) != (2 * b.v > v) {
            // East of the middle: all in whole numbers of half units.
            let side =
                i128::from(v - 2 * a.v) * i128::from(b.u - a.u) - i128::from(u - 2 * a.u) * i128::from(b.v - a.v);
            inside ^= (side > 0) == (b.v > a.v);
        }
    }
    inside
}

/// Joins a hole to its outline by an edge to and fro, from its easternmost corner to one that it sees.
fn bridge(outer: &mut Loop, mut hole: Loop) {
    let Some(start) = (0..hole.len()).max_by_key(|at| hole[*at].at.u) else { return };
    hole.rotate_left(start);
    let from = hole[0].at;
    let mut ends: Vec<usize> = (0..outer.len()).filter(|at| outer[*at].at.u >= from.u).collect();
    ends.sort_by_key(|at| i128::from(outer[*at].at.u - from.u).pow(2) + i128::from(outer[*at].at.v - from.v).pow(2));
    let len = outer.len();
    let seen = |end: usize| {
        let to = outer[end].at;
        // Where corners share a place, into the one whose inside faces the hole.
        let (before, after) = (outer[(end + len - 1) % len].at, outer[(end + 1) % len].at);
        let left_of_next = twice_area(to, after, from) >= 0;
        let left_of_last = twice_area(before, to, from) >= 0;
        let inside = if twice_area(before, to, after) >= 0 {
            left_of_next && left_of_last
        } else {
            left_of_next || left_of_last
        };
        inside
            && (0..len).all(|at| {
                let (a, b) = (outer[at].at, outer[(at + 1) % len].at);
                let apart = |p, q, r, s| twice_area(p, q, r).signum() * twice_area(p, q, s).signum() >= 0;
                a == to || b == to || apart(from, to, a, b) || apart(a, b, from, to)
            })
    };
    let Some(end) = ends.into_iter().find(|end| seen(*end)) else { return };
    let to = Corner { at: outer[end].at, edge: None };
    let back = Corner { at: from, edge: None };
    let joined = std::iter::once(to).chain(hole).chain([back]).collect::<Loop>();
    outer.splice(end..end, joined);
}

/// Cuts corner after corner off a loop that turns from east to south.
fn clip_ears(mut corners: Loop, triangle: &mut dyn FnMut(Triangle)) {
    let mut at = 0;
    while corners.len() > 3 {
        let len = corners.len();
        let order = (0..len).map(|away| (at + away) % len);
        let proper = order.clone().find(|middle| is_ear(&corners, *middle, false));
        // A corner on a straight edge; or, where rounding has crossed two edges, any.
        let middle =
            proper.or_else(|| order.clone().find(|middle| is_ear(&corners, *middle, true))).unwrap_or(at % len);
        let before = (middle + len - 1) % len;
        emit([corners[before], corners[middle], corners[(middle + 1) % len]], false, triangle);
        corners[before].edge = None;
        corners.remove(middle);
        // Not the next corner: so the triangles are less often long and thin.
        at = if middle == 0 { 0 } else { middle } + 1;
    }
    if let [a, b, c] = corners[..] {
        emit([a, b, c], true, triangle);
    }
}

fn emit(corners: [Corner; 3], last: bool, triangle: &mut dyn FnMut(Triangle)) {
    let places = corners.map(|corner| corner.at);
    if places[0] != places[1] && places[1] != places[2] && places[2] != places[0] {
        let mut shore = corners.map(|corner| corner.edge.is_some_and(|edge| edge.shore));
        shore[2] &= last;
        triangle(Triangle { corners: places, shore });
    }
}

/// Whether the triangle at a corner holds no other corner, and has an area, or, `flat`, has none.
fn is_ear(corners: &[Corner], middle: usize, flat: bool) -> bool {
    let len = corners.len();
    let [a, b, c] = [len - 1, 0, 1].map(|away| corners[(middle + away) % len].at);
    let area = twice_area(a, b, c);
    if flat {
        return area == 0;
    }
    area > 0
        && corners.iter().map(|corner| corner.at).all(|at| {
            at == a
                || at == b
                || at == c
                || twice_area(a, b, at) < 0
                || twice_area(b, c, at) < 0
                || twice_area(c, a, at) < 0
        })
}

#[cfg(test)]
#[path = "region_tests.rs"]
mod tests;
