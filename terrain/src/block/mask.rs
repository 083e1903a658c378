//! Which sub-blocks of a block are fine: 225 bits that say all there is to say about its mesh.
//!
//! Invariant others rely on: a mask alone decides a block's triangles. The mask for a limit is a fixpoint of "fine where
//! the gap of my actual template exceeds the limit", reached from none fine in rounds: in each, every sub-block is judged
//! by the mask of the round before, so the result is unique and the same everywhere. Neighbours that turn fine change a
//! template, so one round is not enough; four or five are.

use super::template::{self, EAST, FINE, NORTH, SOUTH, WEST};
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS, POSTS};

/// Sub-blocks along a block's side.
pub const SUBS: usize = CELLS as usize / 2;

/// One bit a sub-block, row by row from the north-west; set is fine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Mask([u64; 4]);

/// The heights of a block's posts, row by row.
pub type BlockPosts = [f32; (POSTS * POSTS) as usize];

impl Mask {
    /// Level 1: none fine.
    pub const NONE: Self = Self([0; 4]);

    /// Bytes of a stored mask.
    pub const BYTES: usize = 32;

    /// Level 0: all fine.
    pub fn all() -> Self {
        let mut mask = Self::NONE;
        (0..SUBS * SUBS).for_each(|at| mask.set_fine(at % SUBS, at / SUBS));
        mask
    }

    /// Whether the sub-block is fine.
    #[inline]
    pub fn is_fine(&self, column: usize, row: usize) -> bool {
        let at = row * SUBS + column;
        self.0[at / 64] >> (at % 64) & 1 == 1
    }

    /// Makes a sub-block fine.
    pub fn set_fine(&mut self, column: usize, row: usize) {
        let at = row * SUBS + column;
        self.0[at / 64] |= 1 << (at % 64);
    }

    /// Number of fine sub-blocks.
    pub fn fine(&self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    /// Template of a sub-block: [`FINE`], or the edges with a midpoint: those of the block's border and those towards a
    /// fine neighbour.
    #[inline]
    pub fn template(&self, column: usize, row: usize) -> usize {
        if self.is_fine(column, row) {
            return FINE;
        }
        let last = SUBS - 1;
        let mut edges = 0;
        if row == 0 || self.is_fine(column, row - 1) {
            edges |= NORTH;
        }
        if column == last || self.is_fine(column + 1, row) {
            edges |= EAST;
        }
        if row == last || self.is_fine(column, row + 1) {
            edges |= SOUTH;
        }
        if column == 0 || self.is_fine(column - 1, row) {
            edges |= WEST;
        }
        edges
    }

    /// Number of triangles of the block's mesh.
    pub fn triangles(&self) -> u32 {
        self.templates().map(|t| template::triangles(t).len() as u32).sum()
    }

    /// All templates, row by row.
    pub fn templates(&self) -> impl Iterator<Item = usize> + '_ {
        (0..SUBS * SUBS).map(|at| self.template(at % SUBS, at / SUBS))
    }

    /// Little-endian bytes, as stored.
    pub fn to_bytes(self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        for (eight, word) in bytes.chunks_exact_mut(8).zip(self.0) {
            eight.copy_from_slice(&word.to_le_bytes());
        }
        bytes
    }

    /// From stored bytes; `None` if a bit is set that no sub-block has.
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Option<Self> {
        let mut words = [0u64; 4];
        for (word, eight) in words.iter_mut().zip(bytes.chunks_exact(8)) {
            *word = eight.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
        }
        let (mask, all) = (Self(words), Self::all());
        mask.0.iter().zip(all.0).all(|(word, known)| word & !known == 0).then_some(mask)
    }

    /// The least mask whose every template is within `limit_m` of the ground. A sub-block with a void post is fine.
    pub fn for_limit(posts: &BlockPosts, limit_m: f64) -> Self {
        let mut mask = Self::NONE;
        // What was last found within the limit, so that a pass looks again only at changed templates.
        let mut checked = [usize::MAX; SUBS * SUBS];
        loop {
            let before = mask;
            for row in 0..SUBS {
                for column in 0..SUBS {
                    let template = before.template(column, row);
                    let seen = &mut checked[row * SUBS + column];
                    if template == FINE || *seen == template {
                        continue;
                    }
                    *seen = template;
                    let error = error_m(template, posts, column, row);
                    // Also true for NaN: a void post.
                    if error.is_nan() || error > limit_m {
                        mask.set_fine(column, row);
                    }
                }
            }
            if mask == before {
                return mask;
            }
        }
    }

    /// Greatest vertical distance between the block's mesh and the ground, metres. Void posts count for nothing.
    pub fn error_m(&self, posts: &BlockPosts) -> f64 {
        let mut worst = 0.0f64;
        for row in 0..SUBS {
            for column in 0..SUBS {
                worst = worst.max(error_m(self.template(column, row), posts, column, row));
            }
        }
        worst
    }
}

/// The heights of a block; void outside the field.
pub fn block_posts(field: &Field, block: BlockIndex) -> BlockPosts {
    let (first_column, first_row) = (block.first_column(), block.first_row());
    std::array::from_fn(|at| {
        let (column, row) = (at as i64 % i64::from(POSTS), at as i64 / i64::from(POSTS));
        field.post_m(first_column + column, first_row + row)
    })
}

/// NaN if any of the sub-block's nine posts is void.
fn error_m(template: usize, posts: &BlockPosts, column: usize, row: usize) -> f64 {
    let wide = POSTS as usize;
    let corner = 2 * row * wide + 2 * column;
    let nine: [f32; 9] = std::array::from_fn(|post| posts[corner + post / 3 * wide + post % 3]);
    if nine.iter().any(|h| h.is_nan()) { f64::NAN } else { template::error_m(template, &nine) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Grid, synthetic};

    fn posts(field: &Field) -> BlockPosts {
        block_posts(field, BlockIndex { x: 0, z: 0 })
    }

    fn one_block() -> Grid {
        Grid::centred(200.0, 1, 1).unwrap()
    }

    #[test]
    fn levels_have_the_published_triangle_counts() {
        let subs = SUBS as u32;
        assert_eq!(Mask::all().triangles(), 8 * subs * subs);
        // Inner sub-blocks 2 triangles, those on an edge 3, those in a corner 4.
        let inner = subs - 2;
        assert_eq!(Mask::NONE.triangles(), 2 * inner * inner + 3 * 4 * inner + 4 * 4);
        if CELLS == 30 {
            assert_eq!((Mask::all().triangles(), Mask::NONE.triangles()), (1800, 510));
        }
    }

    #[test]
    fn flat_needs_nothing_and_noise_needs_all() {
        assert_eq!(Mask::for_limit(&posts(&synthetic::flat(one_block(), -430.0)), 0.0), Mask::NONE);
        assert_eq!(Mask::for_limit(&posts(&synthetic::rough(one_block(), 1, 9_000.0)), 1.0), Mask::all());
        let spike = posts(&synthetic::spike(one_block(), 7, 9, 9_000.0));
        let mask = Mask::for_limit(&spike, 14.0);
        assert!(mask.is_fine(3, 4) && mask.fine() < 10);
        assert!(mask.error_m(&spike) <= 14.0);
    }

    #[test]
    fn a_mask_keeps_its_limit_and_makes_nothing_fine_that_never_exceeded_it() {
        for seed in 0..20 {
            let posts = posts(&synthetic::ridges(one_block(), seed));
            let mut coarser = Mask::all();
            for limit_m in [2.0, 13.9, 27.8, 55.6] {
                let mask = Mask::for_limit(&posts, limit_m);
                assert!(mask.error_m(&posts) <= limit_m, "seed {seed}, limit {limit_m}");
                for at in 0..SUBS * SUBS {
                    let (column, row) = (at % SUBS, at / SUBS);
                    let ever = (0..FINE).any(|template| error_m(template, &posts, column, row) > limit_m);
                    assert!(ever || !mask.is_fine(column, row), "seed {seed}, limit {limit_m}, ({column}, {row})");
                }
                assert!(mask.triangles() <= coarser.triangles(), "a larger limit needs no more triangles here");
                coarser = mask;
            }
        }
    }

    #[test]
    fn void_is_fine_and_bytes_come_back() {
        let mut posts = posts(&synthetic::flat(one_block(), 5.0));
        posts[POSTS as usize * 4 + 4] = f32::NAN;
        let mask = Mask::for_limit(&posts, 1.0);
        // The post is a corner of four sub-blocks.
        assert_eq!(mask.fine(), 4);
        assert_eq!(Mask::from_bytes(&mask.to_bytes()), Some(mask));
        let mut bytes = mask.to_bytes();
        bytes[31] = 0xFF;
        assert_eq!(Mask::from_bytes(&bytes).is_some(), CELLS == 32);
    }
}
