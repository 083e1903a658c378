//! Cuts convex polygons along the ground's cell edges and diagonals.
//!
//! Every edge of a polygon remembers the ends it had before any cut, and every cut of it is made from those
//! ([`crossing`]); so two polygons that share an edge, or two blocks that cut the same polygon, get the same spots along
//! it. Lines are cut in the order u, v, u + v.
//!
//! Invariant others rely on: pieces fill the polygon without a gap, overlap or T-junction, and each lies within one
//! triangle of the ground. They are convex but for the rounding of a spot (half a unit), and no line crosses one more than
//! twice, because spots along an edge keep their order in u, v and u + v.

use super::lattice::{Axis, Spot, UNITS, crossing, twice_area};

/// Corners that a polygon may come with.
pub const MOST_CORNERS: usize = 8;

/// Corners that a piece may have: each of the two cuts an axis adds at most one.
const ROOM: usize = MOST_CORNERS + 6;

#[derive(Debug, Clone, Copy)]
struct Corner {
    at: Spot,
    /// Ends of the uncut edge that the edge from here is a part of; `None`: the edge is its own.
    edge: Option<(Spot, Spot)>,
}

/// A polygon, or what cuts left of it.
#[derive(Debug, Clone, Copy)]
pub struct Polygon {
    corners: [Corner; ROOM],
    len: usize,
}

/// Where a block lies, in cells: from `first` on, `cells` in both directions.
#[derive(Debug, Clone, Copy)]
pub struct CellSquare {
    /// First column.
    pub column: i64,
    /// First row.
    pub row: i64,
    /// Cells along a side.
    pub cells: i64,
}

impl Polygon {
    const EMPTY: Self = Self { corners: [Corner { at: Spot { u: 0, v: 0 }, edge: None }; ROOM], len: 0 };

    /// A polygon of 3 to [`MOST_CORNERS`] corners, at once if it is convex: turning from east to south, or the other way,
    /// the result always turns from east to south. `None` if it is not convex or has no area.
    pub fn new(corners: &[Spot]) -> Option<Self> {
        if !(3..=MOST_CORNERS).contains(&corners.len()) {
            return None;
        }
        let len = corners.len();
        let mut turns = 0i128;
        for at in 0..len {
            let turn = twice_area(corners[at], corners[(at + 1) % len], corners[(at + 2) % len]).signum();
            if turn * turns < 0 {
                return None;
            }
            turns = if turn == 0 { turns } else { turn };
        }
        // A star turns one way only and is not convex either: its fan has triangles of both signs.
        let fan = |at: usize| twice_area(corners[0], corners[at], corners[at + 1]).signum();
        if turns == 0 || (1..len - 1).any(|at| fan(at) * turns < 0) {
            return None;
        }
        let mut polygon = Self::EMPTY;
        for at in 0..len {
            let corner = if turns > 0 { corners[at] } else { corners[len - 1 - at] };
            polygon.push(Corner { at: corner, edge: None });
        }
        for at in 0..len {
            polygon.corners[at].edge = Some((polygon.corners[at].at, polygon.corners[(at + 1) % len].at));
        }
        Some(polygon)
    }

    /// Its corners.
    pub fn corners(&self) -> impl Iterator<Item = Spot> + '_ {
        self.corners[..self.len].iter().map(|corner| corner.at)
    }

    fn push(&mut self, corner: Corner) {
        // The room is proven by the number of cuts; a corner too many would be a fault that must not stop a flight.
        if self.len < ROOM {
            self.corners[self.len] = corner;
            self.len += 1;
        }
    }

    fn bounds(&self, axis: Axis) -> (i64, i64) {
        self.corners()
            .map(|spot| spot.along(axis))
            .fold((i64::MAX, i64::MIN), |(low, high), at| (low.min(at), high.max(at)))
    }

    /// The parts below and above a line; one that would be a line only is empty.
    fn split(&self, axis: Axis, line: i64) -> (Self, Self) {
        let (low, high) = self.bounds(axis);
        if high <= line {
            return (*self, Self::EMPTY);
        }
        if low >= line {
            return (Self::EMPTY, *self);
        }
        let (mut below, mut above) = (Self::EMPTY, Self::EMPTY);
        for at in 0..self.len {
            let (here, next) = (self.corners[at], self.corners[(at + 1) % self.len].at);
            let (side, next_side) = ((here.at.along(axis) - line).signum(), (next.along(axis) - line).signum());
            // From a corner on the line a part goes on along its edge, or along the line to where the polygon comes back.
            let chord = Corner { at: here.at, edge: None };
            if side <= 0 {
                below.push(if side == 0 && next_side > 0 { chord } else { here });
            }
            if side >= 0 {
                above.push(if side == 0 && next_side < 0 { chord } else { here });
            }
            if side * next_side < 0 {
                let (a, b) = here.edge.unwrap_or((here.at, next));
                let spot = crossing(axis, line, a, b);
                let (leaves, enters) = (Corner { at: spot, edge: None }, Corner { at: spot, edge: here.edge });
                below.push(if side < 0 { leaves } else { enters });
                above.push(if side < 0 { enters } else { leaves });
            }
        }
        (below, above)
    }

    /// Cuts it along all lines within a square of cells, and hands out each piece with its cell.
    pub fn cut(self, square: CellSquare, mut piece: impl FnMut(i64, i64, &Self)) {
        let within = |polygon: Self, axis: Axis, first: i64| {
            let (_, above) = polygon.split(axis, first * UNITS);
            above.split(axis, (first + square.cells) * UNITS).0
        };
        let inside = within(within(self, Axis::U, square.column), Axis::V, square.row);
        inside.strips(Axis::U, |column, strip| {
            strip.strips(Axis::V, |row, cell| {
                let (north_west, south_east) = cell.split(Axis::W, (column + row + 1) * UNITS);
                for half in [north_west, south_east] {
                    if half.len >= 3 {
                        piece(column, row, &half);
                    }
                }
            });
        });
    }

    /// Cuts it along all of an axis' cell lines that cross it.
    fn strips(self, axis: Axis, mut strip: impl FnMut(i64, Self)) {
        if self.len < 3 {
            return;
        }
        let (low, high) = self.bounds(axis);
        let mut rest = self;
        let mut cell = low.div_euclid(UNITS);
        while (cell + 1) * UNITS < high {
            let (below, above) = rest.split(axis, (cell + 1) * UNITS);
            if below.len >= 3 {
                strip(cell, below);
            }
            rest = above;
            cell += 1;
        }
        if rest.len >= 3 {
            strip(cell, rest);
        }
    }

    /// Triangles as places in its list of corners. A triangle of no area is left out where it is a mere repetition of a
    /// corner, and else kept, so that every edge still meets one equal to it.
    pub fn fan(&self, mut triangle: impl FnMut(usize, usize, usize)) {
        let at = |place: usize| self.corners[place % self.len].at;
        let flat = |apex: usize| {
            (1..self.len - 1).filter(|next| twice_area(at(apex), at(apex + next), at(apex + next + 1)) == 0).count()
        };
        // Nearly always the first corner will do.
        let apex = (0..self.len).find(|apex| flat(*apex) == 0);
        let apex = apex.or_else(|| (0..self.len).min_by_key(|apex| flat(*apex))).unwrap_or(0);
        for next in 1..self.len - 1 {
            let places = [apex, apex + next, apex + next + 1].map(|place| place % self.len);
            let [a, b, c] = places.map(at);
            if a != b && b != c && c != a {
                triangle(places[0], places[1], places[2]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use std::collections::HashMap;

    fn pieces(corners: &[Spot], square: CellSquare) -> Vec<Vec<Spot>> {
        let mut found = Vec::new();
        Polygon::new(corners).expect("convex").cut(square, |_, _, piece| found.push(piece.corners().collect()));
        found
    }

    /// Twice the area of a ring.
    fn area(ring: &[Spot]) -> i128 {
        (1..ring.len() - 1).map(|at| twice_area(ring[0], ring[at], ring[at + 1])).sum()
    }

    #[test]
    fn pieces_fill_a_polygon_lie_in_a_triangle_each_and_share_their_edges() {
        let mut rng = StdRng::seed_from_u64(11);
        let square = CellSquare { column: 0, row: 0, cells: 30 };
        for round in 0..3_000 {
            // Big, small, thin and on lines.
            let reach = [40 * UNITS, 2 * UNITS, 5_000, 20][round % 4];
            let from = Spot { u: rng.random_range(0..30 * UNITS), v: rng.random_range(0..30 * UNITS) };
            let from = if round % 3 == 0 { Spot { u: from.u / UNITS * UNITS, v: from.v } } else { from };
            let mut spot = || from.moved(rng.random_range(-reach..=reach), rng.random_range(-reach..=reach));
            let corners = [spot(), spot(), spot()];
            if twice_area(corners[0], corners[1], corners[2]) == 0 {
                continue;
            }
            let mut edges: HashMap<(Spot, Spot), i32> = HashMap::new();
            let mut sum = 0;
            for piece in pieces(&corners, square) {
                sum += area(&piece);
                let (column, row) = piece.iter().fold((i64::MAX, i64::MAX), |(c, r), s| (c.min(s.u), r.min(s.v)));
                let (column, row) = (column.div_euclid(UNITS), row.div_euclid(UNITS));
                let diagonal = (column + row + 1) * UNITS;
                let north_west = piece.iter().all(|s| s.along(Axis::W) <= diagonal);
                let south_east = piece.iter().all(|s| s.along(Axis::W) >= diagonal);
                assert!(north_west || south_east, "{corners:?} {piece:?}");
                assert!(piece.iter().all(|s| s.u <= (column + 1) * UNITS && s.v <= (row + 1) * UNITS));
                for at in 0..piece.len() {
                    let (a, b) = (piece[at], piece[(at + 1) % piece.len()]);
                    // Thinner than a unit, both sides may be cut at one spot.
                    if a != b {
                        *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
                    }
                }
            }
            // What is left over is the outline: its edges lie on the triangle's, within the rounding, or on the square's.
            for ((a, b), count) in edges.into_iter().filter(|(_, count)| *count != 0) {
                assert!(count.abs() == 1, "{corners:?}");
                let on_border = |s: Spot| s.u == 0 || s.v == 0 || s.u == 30 * UNITS || s.v == 30 * UNITS;
                let on_outline = (0..3).any(|at| {
                    let (from, to) = (corners[at], corners[(at + 1) % 3]);
                    let long = ((to.u - from.u) as f64).hypot((to.v - from.v) as f64);
                    [a, b].iter().all(|s| twice_area(from, to, *s).unsigned_abs() as f64 <= 0.75 * long + 1.0)
                });
                assert!(on_outline || (on_border(a) && on_border(b)), "{corners:?} {a:?} {b:?}");
            }
            if corners.iter().all(|s| (0..=30 * UNITS).contains(&s.u) && (0..=30 * UNITS).contains(&s.v)) {
                // Each crossing is off by at most half a unit, over edges of at most 2.9 reaches, about both sides.
                let exact = twice_area(corners[0], corners[1], corners[2]).abs();
                assert!((sum - exact).abs() <= 9 * i128::from(reach) + 40, "{corners:?}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn neighbouring_blocks_cut_a_polygon_at_the_same_spots() {
        let mut rng = StdRng::seed_from_u64(12);
        for _ in 0..2_000 {
            let mut spot = || Spot { u: rng.random_range(20 * UNITS..40 * UNITS), v: rng.random_range(0..30 * UNITS) };
            let corners = [spot(), spot(), spot()];
            if twice_area(corners[0], corners[1], corners[2]) == 0 {
                continue;
            }
            let border = 30 * UNITS;
            let on_border = |square| {
                let mut spots: Vec<Spot> =
                    pieces(&corners, square).into_iter().flatten().filter(|spot| spot.u == border).collect();
                spots.sort();
                spots.dedup();
                spots
            };
            let west = on_border(CellSquare { column: 0, row: 0, cells: 30 });
            let east = on_border(CellSquare { column: 30, row: 0, cells: 30 });
            let touches = corners.iter().any(|s| s.u == border);
            assert!(west == east || touches, "{corners:?}");
        }
    }

    #[test]
    fn what_is_not_convex_or_flat_is_none() {
        let spot = |u, v| Spot { u, v };
        assert!(Polygon::new(&[spot(0, 0), spot(5, 5), spot(10, 10)]).is_none());
        assert!(Polygon::new(&[spot(0, 0), spot(10, 0), spot(0, 10), spot(10, 10)]).is_none());
        assert!(Polygon::new(&[spot(0, 0), spot(10, 0)]).is_none());
        // A corner in the middle of an edge is allowed, and either way around.
        let square = [spot(0, 0), spot(5, 0), spot(10, 0), spot(10, 10), spot(0, 10)];
        let mut back = square;
        back.reverse();
        for corners in [square, back] {
            let polygon = Polygon::new(&corners).unwrap();
            let (mut triangles, mut sum) = (0, 0);
            let spots: Vec<Spot> = polygon.corners().collect();
            polygon.fan(|a, b, c| {
                triangles += 1;
                sum += twice_area(spots[a], spots[b], spots[c]);
            });
            assert_eq!((triangles, sum), (3, 200));
        }
    }
}
