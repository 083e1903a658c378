//! The surface that an index list draws over a block's posts, and the difference of two such surfaces, exactly.
//!
//! Places are in posts from the block's north-west corner: x east, y south. Every mesh stays within sub-blocks of 2 x 2
//! cells, so surfaces are compared sub-block by sub-block. Both are piecewise linear: over the overlay of their triangles
//! the difference is linear in each piece, so its extremes stand at vertices of the overlay, which are the vertices of
//! both and the crossings of their edges. They are found by crossing every edge with every other.

use crate::block::mask::SUBS;
use crate::block::mesh::{TILE, post_of};
use crate::grid::CELLS;
use glam::DVec2;

/// Places are whole, halves and thirds of posts; what is nearer than this is the same.
const SAME: f64 = 1e-9;

/// A triangle's posts, column and row in the block; first the least, then counter-clockwise seen from above.
type Corners = [[u16; 2]; 3];

/// See the module.
#[derive(Debug, Clone)]
pub struct Surface<'h> {
    heights_m: &'h [f32],
    /// Triangles by sub-block, row by row.
    subs: Vec<Vec<Corners>>,
}

impl<'h> Surface<'h> {
    /// What a triangle list draws over a height tile (`TILE` x `TILE`).
    pub fn of(indices: &[u16], heights_m: &'h [f32]) -> Self {
        let mut surface = Self { heights_m, subs: vec![Vec::new(); SUBS * SUBS] };
        for triangle in indices.as_chunks::<3>().0 {
            surface.add(triangle.map(|index| {
                let (column, row) = post_of(index);
                [column as u16, row as u16]
            }));
        }
        surface
    }

    /// The ground over a height tile, from its definition: two triangles a cell, cut from south-west to north-east, and
    /// none with a void corner.
    pub fn ground(heights_m: &'h [f32]) -> Self {
        let mut surface = Self { heights_m, subs: vec![Vec::new(); SUBS * SUBS] };
        for row in 0..CELLS as u16 {
            for column in 0..CELLS as u16 {
                let (nw, ne) = ([column, row], [column + 1, row]);
                let (sw, se) = ([column, row + 1], [column + 1, row + 1]);
                for corners in [[nw, sw, ne], [sw, se, ne]] {
                    if corners.iter().all(|post| surface.post_m(*post).is_finite()) {
                        surface.add(corners);
                    }
                }
            }
        }
        surface
    }

    fn add(&mut self, mut corners: Corners) {
        let first = (0..3).min_by_key(|at| corners[*at]).unwrap_or(0);
        corners.rotate_left(first);
        // Three times the centroid over three times the sub-block's side.
        let sub = |axis: usize| corners.iter().map(|post| usize::from(post[axis])).sum::<usize>() / 6;
        self.subs[sub(1) * SUBS + sub(0)].push(corners);
    }

    fn post_m(&self, [column, row]: [u16; 2]) -> f64 {
        f64::from(self.heights_m[usize::from(row) * TILE as usize + usize::from(column)])
    }

    /// Height over a place, metres; `None` where no triangle is.
    pub fn height_m(&self, place: DVec2) -> Option<f64> {
        let sub = |at: f64| ((at * 0.5) as usize).min(SUBS - 1);
        self.height_in_sub(sub(place.y) * SUBS + sub(place.x), place)
    }

    fn height_in_sub(&self, sub: usize, place: DVec2) -> Option<f64> {
        self.subs[sub].iter().find_map(|corners| self.height_in(corners, place))
    }

    /// Height of one triangle over a place; `None` outside it.
    fn height_in(&self, corners: &Corners, place: DVec2) -> Option<f64> {
        let [a, b, c] = corners.map(at);
        let (ab, ac, ap) = (b - a, c - a, place - a);
        let area = ab.perp_dot(ac);
        let (to_b, to_c) = (ap.perp_dot(ac) / area, ab.perp_dot(ap) / area);
        (to_b >= -SAME && to_c >= -SAME && to_b + to_c <= 1.0 + SAME).then(|| {
            let [ha, hb, hc] = corners.map(|post| self.post_m(post));
            ha + to_b * (hb - ha) + to_c * (hc - ha)
        })
    }
}

fn at([column, row]: [u16; 2]) -> DVec2 {
    DVec2::new(f64::from(column), f64::from(row))
}

/// Tells every place where the difference of two surfaces can be greatest, and the difference (`a` minus `b`) there in
/// metres; infinite where only one of them is. Sub-blocks with the same triangles in both are left out: 0.
pub fn differences(a: &Surface<'_>, b: &Surface<'_>, mut tell: impl FnMut(DVec2, f64)) {
    let same_heights = std::ptr::eq(a.heights_m, b.heights_m);
    let mut places = Vec::new();
    for sub in 0..SUBS * SUBS {
        let (of_a, of_b) = (&a.subs[sub], &b.subs[sub]);
        if same_heights && of_a.len() == of_b.len() && of_a.iter().all(|triangle| of_b.contains(triangle)) {
            continue;
        }
        places.clear();
        for corners in of_a.iter().chain(of_b) {
            let [p, q, r] = corners.map(at);
            // The middle shows where one has a hole.
            places.extend([p, q, r, (p + q + r) / 3.0]);
        }
        for (p, q) in of_a.iter().flat_map(sides) {
            for (r, s) in of_b.iter().flat_map(sides) {
                places.extend(crossing(p, q, r, s));
            }
        }
        for place in &places {
            match (a.height_in_sub(sub, *place), b.height_in_sub(sub, *place)) {
                (Some(height_a), Some(height_b)) => tell(*place, height_a - height_b),
                (None, None) => {}
                _ => tell(*place, f64::INFINITY),
            }
        }
    }
}

/// Greatest absolute difference of two surfaces, metres.
pub fn greatest_difference_m(a: &Surface<'_>, b: &Surface<'_>) -> f64 {
    let mut worst = 0.0f64;
    differences(a, b, |_, gap_m| worst = worst.max(gap_m.abs()));
    worst
}

fn sides(corners: &Corners) -> [(DVec2, DVec2); 3] {
    let [a, b, c] = corners.map(at);
    [(a, b), (b, c), (c, a)]
}

/// Where two edges cross within both; where they only touch there is a vertex anyway.
fn crossing(p: DVec2, q: DVec2, r: DVec2, s: DVec2) -> Option<DVec2> {
    let turn = (q - p).perp_dot(s - r);
    let (along, across) = ((r - p).perp_dot(s - r) / turn, (r - p).perp_dot(q - p) / turn);
    let inside = |t: f64| t > SAME && t < 1.0 - SAME;
    (turn != 0.0 && inside(along) && inside(across)).then(|| p + (q - p) * along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::mask::{Mask, block_posts};
    use crate::block::mesh;
    use crate::block::payload::tile_heights_m;
    use crate::{BlockIndex, Grid, Ground, synthetic};
    use std::sync::Arc;

    #[test]
    fn the_ground_and_level_0_are_the_area_of_the_queries() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let field = Arc::new(synthetic::rough(grid, 3, 900.0));
        let area = Ground::new(field.clone()).whole();
        let block = BlockIndex { x: 1, z: 0 };
        let tile = tile_heights_m(&field, block);
        let (ground, level_0) = (Surface::ground(&tile), Surface::of(mesh::level_0(), &tile));
        assert_eq!(greatest_difference_m(&ground, &level_0), 0.0);
        for at in 0..2000 {
            let place = DVec2::new(f64::from(at % 97), f64::from(at % 89)) * f64::from(CELLS) / 97.0;
            let known = area.height_m(grid.x_m(block.first_column()) + 200.0 * place.x, grid.north_m + 200.0 * place.y);
            // A dozen roundings at 900 m.
            assert!((ground.height_m(place).unwrap() - known.unwrap()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_mask_s_error_is_the_difference_found_here() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let block = BlockIndex { x: 0, z: 0 };
        for seed in 0..10 {
            let field = synthetic::ridges(grid, seed);
            let (tile, posts) = (tile_heights_m(&field, block), block_posts(&field, block));
            for limit_m in [5.0, 30.0, 1e9] {
                let mask = Mask::for_limit(&posts, limit_m);
                let list = mesh::indices(&mask, None);
                let found = greatest_difference_m(&Surface::of(&list, &tile), &Surface::ground(&tile));
                assert!((found - mask.error_m(&posts)).abs() < 1e-9, "{found} and {}", mask.error_m(&posts));
            }
        }
    }

    #[test]
    fn a_missing_triangle_is_an_infinite_difference() {
        let field = synthetic::flat(Grid::centred(200.0, 1, 1).unwrap(), 7.0);
        let tile = tile_heights_m(&field, BlockIndex { x: 0, z: 0 });
        let holed = Surface::of(&mesh::level_0()[3..], &tile);
        assert_eq!(greatest_difference_m(&holed, &Surface::ground(&tile)), f64::INFINITY);
    }
}
