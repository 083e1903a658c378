//! Whole-number plan coordinates, on which the ground's cells can be cut without rounding.
//!
//! A [`Spot`] counts [`UNITS`] along a post step: u east of column 0, v south of row 0. So a cell's edges are the spots
//! whose u or v is a multiple of [`UNITS`], and its south-west to north-east diagonal those whose u + v is one. At the
//! usual step of 200 m a unit is 3 mm.
//!
//! Invariant others rely on: a crossing of an edge with a line is a function of the edge's two ends and the line alone,
//! so whoever cuts the edge, from either side and in whatever order, gets the same spot. The crossings of one edge keep
//! their order along it in u, v and u + v: an exact crossing between two whole numbers rounds to one between them.

use crate::field::Field;
use crate::grid::Grid;
use glam::DVec2;

/// Units along a post step.
pub const UNITS: i64 = 1 << 16;

/// Farthest a spot may lie from column 0 or row 0: 16 times the largest grid. What lies beyond is not drawn.
pub const FARTHEST: i64 = UNITS << 19;

/// A plan point on the lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Spot {
    /// East of column 0, units.
    pub u: i64,
    /// South of row 0, units.
    pub v: i64,
}

/// The directions that the ground is cut along.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Lines of constant u: the cells' west and east edges.
    U,
    /// Lines of constant v: their north and south edges.
    V,
    /// Lines of constant u + v: their diagonals.
    W,
}

impl Spot {
    /// Where it lies across the lines of an axis.
    pub fn along(self, axis: Axis) -> i64 {
        match axis {
            Axis::U => self.u,
            Axis::V => self.v,
            Axis::W => self.u + self.v,
        }
    }

    /// Moved by whole units.
    pub fn moved(self, du: i64, dv: i64) -> Self {
        Self { u: self.u + du, v: self.v + dv }
    }
}

/// Twice the area of a triangle, units squared: positive if it turns from east to south.
pub fn twice_area(a: Spot, b: Spot, c: Spot) -> i128 {
    let (bu, bv) = (i128::from(b.u - a.u), i128::from(b.v - a.v));
    let (cu, cv) = (i128::from(c.u - a.u), i128::from(c.v - a.v));
    bu * cv - bv * cu
}

/// Where the edge between two spots on either side of a line crosses it; see the module.
pub fn crossing(axis: Axis, line: i64, a: Spot, b: Spot) -> Spot {
    let (a, b) = if b < a { (b, a) } else { (a, b) };
    let (from, to) = (a.along(axis), b.along(axis));
    let other = |spot: Spot| if axis == Axis::U { spot.v } else { spot.u };
    let (start, end) = (other(a), other(b));
    let (part, whole) = (line - from, to - from);
    let (part, whole) = if whole < 0 { (-part, -whole) } else { (part, whole) };
    let at = start + rounded_share(end - start, part, whole.max(1));
    match axis {
        Axis::U => Spot { u: line, v: at },
        Axis::V => Spot { u: at, v: line },
        Axis::W => Spot { u: at, v: line - at },
    }
}

/// `length * part / whole` to the nearest whole number, halves up.
fn rounded_share(length: i64, part: i64, whole: i64) -> i64 {
    // Within a block all three are below 2^23; the wide way is for hostile lines only.
    match length.checked_mul(part).and_then(|product| product.checked_mul(2)?.checked_add(whole)) {
        Some(doubled) => doubled.div_euclid(2 * whole),
        None => {
            let (length, part, whole) = (i128::from(length), i128::from(part), i128::from(whole));
            (2 * length * part + whole).div_euclid(2 * whole) as i64
        }
    }
}

/// The lattice of a grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    corner_m: DVec2,
    unit_m: f64,
}

impl Lattice {
    /// Of a grid.
    pub fn of(grid: &Grid) -> Self {
        Self { corner_m: DVec2::new(grid.west_m, grid.north_m), unit_m: grid.step_m / UNITS as f64 }
    }

    /// Metres of a unit.
    pub fn unit_m(&self) -> f64 {
        self.unit_m
    }

    /// Nearest spot to a plan point; `None` if it is farther than [`FARTHEST`] or not finite.
    pub fn spot(&self, at: DVec2) -> Option<Spot> {
        let units = ((at - self.corner_m) / self.unit_m).round();
        let most = FARTHEST as f64;
        (units.abs().cmple(DVec2::splat(most)).all()).then_some(Spot { u: units.x as i64, v: units.y as i64 })
    }

    /// Plan point of a spot, metres.
    pub fn plan_m(&self, spot: Spot) -> DVec2 {
        self.corner_m + DVec2::new(spot.u as f64, spot.v as f64) * self.unit_m
    }

    /// From one spot to another, metres.
    pub fn between_m(&self, from: Spot, to: Spot) -> DVec2 {
        DVec2::new((to.u - from.u) as f64, (to.v - from.v) as f64) * self.unit_m
    }

    /// A length in whole units.
    pub fn units(&self, length_m: DVec2) -> (i64, i64) {
        let units = (length_m / self.unit_m).round();
        (units.x as i64, units.y as i64)
    }
}

/// Height of the ground over a spot, metres; NaN over void and beyond the world.
///
/// On a post, a cell's edge or a diagonal it is made of the posts at the ends alone, so triangles on either side agree to
/// the bit.
pub fn height_m(field: &Field, spot: Spot) -> f64 {
    let (column, row) = (spot.u.div_euclid(UNITS), spot.v.div_euclid(UNITS));
    let (east, south) = (spot.u.rem_euclid(UNITS), spot.v.rem_euclid(UNITS));
    let post = |columns: i64, rows: i64| f64::from(field.post_m(column + columns, row + rows));
    let share = |part: i64| part as f64 / UNITS as f64;
    let between = |from: f64, to: f64, part: i64| from + (to - from) * share(part);
    match (east, south) {
        (0, 0) => post(0, 0),
        (0, _) => between(post(0, 0), post(0, 1), south),
        (_, 0) => between(post(0, 0), post(1, 0), east),
        _ if east + south == UNITS => between(post(0, 1), post(1, 0), east),
        _ if east + south < UNITS => {
            let nw = post(0, 0);
            nw + share(east) * (post(1, 0) - nw) + share(south) * (post(0, 1) - nw)
        }
        _ => {
            let se = post(1, 1);
            se + share(UNITS - east) * (post(0, 1) - se) + share(UNITS - south) * (post(1, 0) - se)
        }
    }
}

/// How much the ground rises a metre east and a metre south, in the triangle around a plan point given in units; zero
/// over void.
pub fn slope(field: &Field, u: f64, v: f64) -> DVec2 {
    let units = UNITS as f64;
    let (column, row) = ((u / units).floor(), (v / units).floor());
    let post = |columns: i64, rows: i64| f64::from(field.post_m(column as i64 + columns, row as i64 + rows));
    let (east, south) = (u / units - column, v / units - row);
    let rise = if east + south <= 1.0 {
        let nw = post(0, 0);
        DVec2::new(post(1, 0) - nw, post(0, 1) - nw)
    } else {
        let se = post(1, 1);
        DVec2::new(se - post(0, 1), se - post(1, 0))
    };
    let slope = rise / field.grid().step_m;
    if slope.is_finite() { slope } else { DVec2::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn a_crossing_is_on_its_line_the_same_from_both_ends_and_keeps_its_order() {
        let mut rng = StdRng::seed_from_u64(5);
        for far in [300, 70_000, 3_000_000, FARTHEST] {
            for _ in 0..2_000 {
                let mut spot = || Spot { u: rng.random_range(-far..=far), v: rng.random_range(-far..=far) };
                let (a, b) = (spot(), spot());
                let mut crossings = vec![a, b];
                for axis in [Axis::U, Axis::V, Axis::W] {
                    let (low, high) = (a.along(axis).min(b.along(axis)), a.along(axis).max(b.along(axis)));
                    if high - low < 2 {
                        continue;
                    }
                    for _ in 0..3 {
                        let line = rng.random_range(low + 1..high);
                        let at = crossing(axis, line, a, b);
                        assert_eq!(at, crossing(axis, line, b, a));
                        assert_eq!(at.along(axis), line);
                        crossings.push(at);
                    }
                }
                // In the order along the edge nothing goes back, in any of the three.
                let towards = |axis| (b.along(axis) - a.along(axis)).signum();
                crossings.sort_by_key(|c| (c.u * towards(Axis::U), c.v * towards(Axis::V)));
                for axis in [Axis::U, Axis::V, Axis::W] {
                    for pair in crossings.windows(2) {
                        assert!((pair[1].along(axis) - pair[0].along(axis)) * towards(axis) >= 0);
                    }
                }
            }
        }
    }

    #[test]
    fn heights_are_those_of_the_ground_query() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let field = std::sync::Arc::new(crate::synthetic::ridges(grid, 3));
        let area = crate::ground::Ground::new(field.clone()).whole();
        let lattice = Lattice::of(&grid);
        let side = i64::from(crate::CELLS) * UNITS;
        let mut rng = StdRng::seed_from_u64(6);
        for at in 0..20_000 {
            let (u, v) = (rng.random_range(0..=side), rng.random_range(0..=side));
            // Also on edges, diagonals and posts.
            let cell = u / UNITS * UNITS;
            let spot = match at % 5 {
                0 => Spot { u: cell, v },
                1 => Spot { u, v: v / UNITS * UNITS },
                2 => Spot { u, v: (v / UNITS * UNITS + UNITS - (u - cell)).min(side) },
                3 => Spot { u: cell, v: v / UNITS * UNITS },
                _ => Spot { u, v },
            };
            let plan = lattice.plan_m(spot);
            let asked = area.height_m(plan.x, plan.y).unwrap();
            // A plan point is rounded at 3 km: 1e-12 m; heights of 5 km: 1e-12 m, and slopes here are below 10.
            assert!((height_m(&field, spot) - asked).abs() < 1e-10, "{spot:?}");
        }
    }

    #[test]
    fn what_is_far_away_or_not_a_number_has_no_spot() {
        let lattice = Lattice::of(&Grid::centred(200.0, 1, 1).unwrap());
        assert!(lattice.spot(DVec2::new(1e300, 0.0)).is_none());
        assert!(lattice.spot(DVec2::new(f64::NAN, 0.0)).is_none());
        assert!(lattice.spot(DVec2::new(f64::INFINITY, 0.0)).is_none());
        let spot = lattice.spot(DVec2::new(12.3456, -7.5)).unwrap();
        assert!((lattice.plan_m(spot) - DVec2::new(12.3456, -7.5)).length() < lattice.unit_m());
    }
}
