//! From a mask to an index list: the one builder for level 0, level 1 and everything between.
//!
//! A vertex is nothing but its index `row * TILE + column` among the block's posts; the vertex stage reads the height.
//! Triangles go row by row of sub-blocks, so that a vertex cache of two rows of posts meets each vertex about once.
//!
//! Invariant others rely on: a triangle with a void post is left out, whatever the mask.

use super::mask::{BlockPosts, Mask, SUBS};
use super::template;
use crate::grid::{CELLS, POSTS};
use std::sync::LazyLock;

/// Texels along a height tile: the block's posts and an apron row and column towards south and east.
pub const TILE: u32 = CELLS + 2;

/// A triangle list of post indices.
pub type Indices = Vec<u16>;

static LEVEL_0: LazyLock<Indices> = LazyLock::new(|| indices(&Mask::all(), None));
static LEVEL_1: LazyLock<Indices> = LazyLock::new(|| indices(&Mask::NONE, None));

/// The mesh of a block without void at level 0: the same for all.
pub fn level_0() -> &'static Indices {
    &LEVEL_0
}

/// The mesh of a block without void at level 1: the same for all.
pub fn level_1() -> &'static Indices {
    &LEVEL_1
}

/// The triangle list of a mask. With posts, triangles that have a void corner are left out.
pub fn indices(mask: &Mask, posts: Option<&BlockPosts>) -> Indices {
    let mut list = Indices::with_capacity(mask.triangles() as usize * 3);
    let is_void = |column: usize, row: usize| posts.is_some_and(|posts| posts[row * POSTS as usize + column].is_nan());
    for row in 0..SUBS {
        for column in 0..SUBS {
            for triangle in template::triangles(mask.template(column, row)) {
                let corners = triangle.map(|post| (2 * column + post as usize % 3, 2 * row + post as usize / 3));
                if corners.iter().any(|(column, row)| is_void(*column, *row)) {
                    continue;
                }
                list.extend(corners.map(|(column, row)| (row * TILE as usize + column) as u16));
            }
        }
    }
    list
}

/// Column and row of an index.
pub fn post_of(index: u16) -> (u32, u32) {
    (u32::from(index) % TILE, u32::from(index) / TILE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic;
    use crate::{BlockIndex, Grid};
    use std::collections::HashMap;

    fn edges(list: &[u16]) -> HashMap<(u16, u16), u32> {
        let mut edges = HashMap::new();
        for t in list.as_chunks::<3>().0 {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                *edges.entry((a, b)).or_insert(0) += 1;
            }
        }
        edges
    }

    /// Every edge is walked once each way, except on the border, where it spans exactly one cell.
    fn assert_watertight(list: &[u16], name: &str) {
        let edges = edges(list);
        for (&(a, b), &count) in &edges {
            assert_eq!(count, 1, "{name}: edge {a}-{b} walked twice one way");
            if !edges.contains_key(&(b, a)) {
                let ((ca, ra), (cb, rb)) = (post_of(a), post_of(b));
                let on_border = (ca == cb && (ca == 0 || ca == CELLS)) || (ra == rb && (ra == 0 || ra == CELLS));
                assert!(on_border, "{name}: T-junction at edge ({ca}, {ra})-({cb}, {rb})");
                assert_eq!(ca.abs_diff(cb) + ra.abs_diff(rb), 1, "{name}: a border edge skips a post");
            }
        }
    }

    #[test]
    fn no_mask_has_a_t_junction() {
        assert_watertight(level_0(), "level 0");
        assert_watertight(level_1(), "level 1");
        let mut state = 7u64;
        for density in [1, 8, 32, 64, 96, 120, 127] {
            for round in 0..40 {
                let mut mask = Mask::NONE;
                for at in 0..SUBS * SUBS {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    if (state >> 57) < density {
                        mask.set_fine(at % SUBS, at / SUBS);
                    }
                }
                let list = indices(&mask, None);
                assert_eq!(list.len(), mask.triangles() as usize * 3);
                assert_watertight(&list, &format!("density {density}, round {round}"));
            }
        }
    }

    #[test]
    fn void_posts_are_in_no_triangle() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let field = synthetic::from_fn(grid, |c, r| if c + r < 9 { f32::NAN } else { 3.0 });
        let posts = super::super::mask::block_posts(&field, BlockIndex { x: 0, z: 0 });
        let list = indices(&Mask::for_limit(&posts, 1.0), Some(&posts));
        assert!(list.iter().all(|index| {
            let (c, r) = post_of(*index);
            c + r >= 9
        }));
        // All cells wholly beyond the void are there: their area is what is left.
        assert!(list.len() > 3 * 300);
    }
}
