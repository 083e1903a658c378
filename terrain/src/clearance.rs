//! How far a straight line stays above the ground.
//!
//! Frame: see [`crate::frame`]. Over one triangle the vertical gap between a line and the ground is linear, so along a
//! segment it is piecewise linear, and its least value lies where the segment crosses a cell line or a diagonal, or at
//! an end. All of these places are looked at: the answer is exact to f64 rounding, and its cost is three evaluations a
//! cell crossed (some 6,000 for 400 km at 200 m).
//!
//! Invariant others rely on: over void and beyond the world there is no ground; such parts count for nothing but are
//! said ([`Clearance::share`]).

use crate::field::Field;
use crate::ground::Area;
use glam::DVec3;

/// How a segment passes over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// Least height of the segment above the ground under it, metres, negative where it is cut; infinite if there is no
    /// ground under it.
    pub least_m: f64,
    /// Fraction of the way from the segment's start where that is.
    pub fraction: f64,
    /// Share of the segment that has ground under it, 0..=1.
    pub share: f64,
}

impl Area {
    /// How the segment from `from` to `to` passes over the ground. A segment that is not finite has none under it.
    pub fn clearance(&self, from: DVec3, to: DVec3) -> Clearance {
        let mut clearance = Clearance { least_m: f64::INFINITY, fraction: 0.0, share: 0.0 };
        let field = self.field();
        let grid = field.grid();
        let in_cells =
            |p: DVec3| DVec3::new((p.x - grid.west_m) / grid.step_m, p.y, (p.z - grid.north_m) / grid.step_m);
        let (start, end) = (in_cells(from), in_cells(to));
        let along = end - start;
        if !start.is_finite() || !along.is_finite() {
            return clearance;
        }
        let places = crossings(field, start, along);
        // A segment that only touches the world in one point is that point twice.
        for pair in places.windows(2) {
            let (enter, exit) = (pair[0], pair[1]);
            let middle = start + along * (0.5 * (enter + exit));
            let Some(plane) = Plane::under(field, middle.x, middle.z) else { continue };
            clearance.share += exit - enter;
            for fraction in [enter, exit] {
                let at = start + along * fraction;
                let gap_m = at.y - plane.height_m(at.x, at.z);
                if gap_m < clearance.least_m {
                    (clearance.least_m, clearance.fraction) = (gap_m, fraction);
                }
            }
        }
        clearance.share = clearance.share.min(1.0);
        clearance
    }
}

/// Fractions of the segment's part over the grid, in order: its two ends and every crossing of a column of posts, a row
/// of posts and a diagonal. Empty if it does not pass over the grid.
fn crossings(field: &Field, start: DVec3, along: DVec3) -> Vec<f64> {
    let cells_x = f64::from(field.grid().columns() - 1);
    let cells_z = f64::from(field.grid().rows() - 1);
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (s, d, cells) in [(start.x, along.x, cells_x), (start.z, along.z, cells_z)] {
        if d != 0.0 {
            let (a, b) = ((0.0 - s) / d, (cells - s) / d);
            (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
        } else if !(0.0..=cells).contains(&s) {
            return Vec::new();
        }
    }
    if first > last {
        return Vec::new();
    }
    let mut places = vec![first, last];
    // A diagonal runs from south-west to north-east: on it column plus row is a whole number.
    let families = [
        (start.x, along.x, cells_x),
        (start.z, along.z, cells_z),
        (start.x + start.z, along.x + along.z, cells_x + cells_z),
    ];
    for (s, d, lines) in families {
        if d == 0.0 {
            continue;
        }
        let (a, b) = (s + d * first, s + d * last);
        let (low, high) = (a.min(b).clamp(0.0, lines).floor(), a.max(b).clamp(0.0, lines).ceil());
        let (low, high) = (low as u32, high as u32);
        places.extend((low..=high).map(|line| (f64::from(line) - s) / d).filter(|t| *t > first && *t < last));
    }
    places.sort_unstable_by(f64::total_cmp);
    places
}

/// The plane of a triangle of the ground, in cells from the north-west post.
struct Plane {
    column: f64,
    row: f64,
    /// Height over the cell's corner at (`column`, `row`), metres.
    corner_m: f64,
    /// Rise over one cell east and one cell south, metres.
    rise_m: [f64; 2],
}

impl Plane {
    /// The plane under a point; beside a void that of a triangle with data that has the point on its rim.
    fn under(field: &Field, x: f64, z: f64) -> Option<Self> {
        /// Cells. Far above the rounding of a place (4e-12 at the far side of the widest grid), far below what shows.
        const RIM: f64 = 1e-9;
        // The last six reach each of the triangles that meet in a post.
        const AROUND: [(f64, f64); 7] =
            [(0.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (2.0, -1.0), (1.0, -2.0), (-2.0, 1.0), (-1.0, 2.0)];
        AROUND.into_iter().find_map(|(dx, dz)| Self::at(field, x + RIM * dx, z + RIM * dz))
    }

    fn at(field: &Field, x: f64, z: f64) -> Option<Self> {
        let (cells_x, cells_z) = (i64::from(field.grid().columns()) - 1, i64::from(field.grid().rows()) - 1);
        // Ends that were cut at the grid's edge may lie a rounding beyond it.
        let (column, row) = ((x.floor() as i64).clamp(0, cells_x - 1), (z.floor() as i64).clamp(0, cells_z - 1));
        let (east, south) = (x - column as f64, z - row as f64);
        let post = |right: i64, down: i64| f64::from(field.post_m(column + right, row + down));
        let (ne, sw) = (post(1, 0), post(0, 1));
        let (corner_m, rise_m) = if east + south <= 1.0 {
            let nw = post(0, 0);
            (nw, [ne - nw, sw - nw])
        } else {
            let se = post(1, 1);
            (ne + sw - se, [se - sw, se - ne])
        };
        (corner_m + rise_m[0] + rise_m[1]).is_finite().then_some(Self {
            column: column as f64,
            row: row as f64,
            corner_m,
            rise_m,
        })
    }

    fn height_m(&self, x: f64, z: f64) -> f64 {
        self.corner_m + (x - self.column) * self.rise_m[0] + (z - self.row) * self.rise_m[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ground::Ground;
    use crate::{Grid, synthetic};
    use rand::{RngExt, SeedableRng, rngs::StdRng};
    use std::sync::Arc;

    fn area(field: Field) -> Area {
        Ground::new(Arc::new(field)).whole()
    }

    fn fields() -> Vec<Field> {
        let grid = Grid::centred(200.0, 2, 1).unwrap();
        let mut holed = synthetic::ridges(grid, 3).heights_m().to_vec();
        for at in [5, 200, 201, 202, 263, 900, 1500] {
            holed[at] = f32::NAN;
        }
        vec![
            synthetic::flat(grid, 12.0),
            synthetic::spike(grid, 17, 11, 9_000.0),
            synthetic::cliff(grid, 24, 10_000.0),
            synthetic::ridges(grid, 1),
            synthetic::rough(grid, 2, 800.0),
            Field::new(grid, holed).unwrap(),
        ]
    }

    /// Every triangle in turn: the segment's plan is cut to it by its three edges, and the gap is taken at both ends of
    /// what is left. Shares no code with the query, which never looks at a triangle's edges.
    fn slow(field: &Field, from: DVec3, to: DVec3) -> f64 {
        let grid = field.grid();
        let mut least = f64::INFINITY;
        for (column, row) in (0..grid.rows() - 1).flat_map(|r| (0..grid.columns() - 1).map(move |c| (c, r))) {
            for [a, b, c] in field.cell_triangles(column, row).into_iter().flatten().map(|t| t.corners) {
                let (mut first, mut last) = (0.0_f64, 1.0_f64);
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    let side = |at: DVec3| (q.z - p.z) * (at.x - p.x) - (q.x - p.x) * (at.z - p.z);
                    // A square metre of 40,000 is a rounding of places of 6 km: lines along an edge stay inside.
                    let (s0, s1) = (side(from) + 1e-6, side(to) + 1e-6);
                    match (s0 < 0.0, s1 < 0.0) {
                        (true, true) => (first, last) = (1.0, 0.0),
                        (true, false) => first = first.max(s0 / (s0 - s1)),
                        (false, true) => last = last.min(s0 / (s0 - s1)),
                        (false, false) => {}
                    }
                }
                if first > last {
                    continue;
                }
                let normal = (b - a).cross(c - a);
                for t in [first, last] {
                    let at = from + (to - from) * t;
                    let ground = a.y - (normal.x * (at.x - a.x) + normal.z * (at.z - a.z)) / normal.y;
                    least = least.min(at.y - ground);
                }
            }
        }
        least
    }

    /// Slopes reach 50 (10 km in a cell); the twin's edges are widened by 1e-6 m2 / 200 m = 5e-9 m.
    const AGREE_M: f64 = 1e-6;

    fn agree(area: &Area, from: DVec3, to: DVec3) {
        let quick = area.clearance(from, to);
        let slow = slow(area.field(), from, to);
        if quick.least_m == f64::INFINITY || slow == f64::INFINITY {
            // Only a touch of the world's or a void's rim may be seen by one and not by the other.
            assert!(quick.share < 1e-6, "{from} to {to}: {quick:?}, slow {slow}");
            return;
        }
        assert!((quick.least_m - slow).abs() < AGREE_M, "{from} to {to}: {quick:?}, slow {slow}");
        assert!((0.0..=1.0).contains(&quick.fraction) && (0.0..=1.0).contains(&quick.share));
    }

    #[test]
    fn the_least_gap_is_that_over_all_triangles() {
        for field in fields() {
            let area = area(field);
            let mut random = StdRng::seed_from_u64(7);
            for _ in 0..60 {
                let mut point = || {
                    DVec3::new(
                        random.random_range(-6_500.0..6_500.0),
                        random.random_range(-100.0..5_000.0),
                        random.random_range(-3_500.0..3_500.0),
                    )
                };
                let (from, to) = (point(), point());
                agree(&area, from, to);
                agree(&area, from, from + (to - from) * 0.01);
            }
        }
    }

    #[test]
    fn lines_along_posts_cell_lines_and_diagonals_too() {
        for field in fields() {
            let area = area(field);
            let mut random = StdRng::seed_from_u64(8);
            for _ in 0..25 {
                let (c, r) = (random.random_range(-30..=30), random.random_range(-15..=15));
                let from = DVec3::new(f64::from(c) * 200.0, random.random_range(0.0..4_000.0), f64::from(r) * 200.0);
                let reach = 200.0 * f64::from(random.random_range(1..12));
                for (dx, dz) in [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, -1), (-1, 1), (1, 1)] {
                    agree(&area, from, from + DVec3::new(f64::from(dx) * reach, -300.0, f64::from(dz) * reach));
                }
            }
        }
    }

    #[test]
    fn it_has_the_sign_of_the_segment_query() {
        let area = area(synthetic::rough(Grid::centred(200.0, 4, 4).unwrap(), 5, 800.0));
        let mut random = StdRng::seed_from_u64(9);
        for _ in 0..3_000 {
            let mut point = || {
                DVec3::new(
                    random.random_range(-1.2e4..1.2e4),
                    random.random_range(0.0..2e3),
                    random.random_range(-1.2e4..1.2e4),
                )
            };
            let (from, to) = (point(), point());
            let gap_m = area.clearance(from, to).least_m;
            assert!(gap_m.abs() < 1e-9 || (gap_m < 0.0) == area.segment(from, to).is_some(), "{from} to {to}: {gap_m}");
        }
    }

    #[test]
    fn what_has_no_ground_is_said() {
        let grid = Grid::centred(200.0, 2, 1).unwrap();
        let all = area(synthetic::flat(grid, 100.0));
        let over = all.clearance(DVec3::new(-12_000.0, 150.0, 0.0), DVec3::new(12_000.0, 150.0, 0.0));
        // The world spans half of the 24 km, or a little more with larger blocks.
        let spanned = (grid.east_m() - grid.west_m) / 24_000.0;
        assert!((over.share - spanned).abs() < 1e-12 && (over.least_m - 50.0).abs() < 1e-9, "{over:?}");
        for (from, to) in [
            (DVec3::new(7_000.0, 0.0, 0.0), DVec3::new(9_000.0, 0.0, 0.0)),
            (DVec3::NAN, DVec3::ZERO),
            (DVec3::ZERO, DVec3::new(f64::INFINITY, 0.0, 0.0)),
            (DVec3::splat(f64::MAX), DVec3::splat(-f64::MAX)),
        ] {
            let none = all.clearance(from, to);
            assert_eq!((none.least_m, none.share), (f64::INFINITY, 0.0), "{from} to {to}");
        }
        let void = area(Field::new(grid, vec![f32::NAN; grid.posts()]).unwrap());
        assert_eq!(void.clearance(DVec3::ZERO, DVec3::X * 3_000.0).share, 0.0);
        // Straight down: the gap at the lower end.
        assert_eq!(all.clearance(DVec3::new(1.0, 900.0, 1.0), DVec3::new(1.0, 130.0, 1.0)).least_m, 30.0);
    }

    /// The corner cases of cost: a line over the widest grid touches each cell line and diagonal once.
    #[test]
    fn a_line_over_a_wide_world_is_a_few_thousand_evaluations() {
        let grid = Grid::centred(200.0, 67, 1).unwrap();
        let field = synthetic::ridges(grid, 1);
        let places = crossings(&field, DVec3::new(0.3, 0.0, 0.1), DVec3::new(2009.5, 0.0, 29.7));
        assert!((4_000..7_000).contains(&places.len()), "{}", places.len());
        assert!(places.is_sorted());
    }
}
