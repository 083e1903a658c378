//! Least and greatest heights over ever larger squares of cells: lets a long ray skip what it flies over.
//!
//! Level `k` has nodes of 2^k x 2^k cells, from level [`BASE`] up to one node for all. A node covers the posts of its
//! cells on all four sides, so the range of two neighbours overlaps in the posts they share and a ray that passes above
//! a node's greatest height cannot touch any triangle in it. Void posts count for neither; a node that is all void has
//! least > greatest.
//!
//! Source of the idea: A. Tevs, I. Ihrke, H.-P. Seidel. Maximum mipmaps for fast, accurate, and scalable dynamic height
//! field rendering. I3D 2008.

use crate::edit::Changed;
use crate::field::Field;
use crate::grid::PostRect;
use crate::paged::Paged;
use std::collections::BTreeSet;

/// Finest level kept: nodes of 4 x 4 cells. Finer ones would cost as much memory as the posts and skip too little.
pub const BASE: u32 = 2;

/// Least and greatest height of a node, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Least height; +infinity if all is void.
    pub least_m: f32,
    /// Greatest height; -infinity if all is void.
    pub greatest_m: f32,
}

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Debug, Clone, PartialEq)]
struct Level {
    columns: usize,
    nodes: Paged<Range>,
}

impl Range {
    /// Nothing there.
    pub const VOID: Self = Self { least_m: f32::INFINITY, greatest_m: f32::NEG_INFINITY };

    /// The range of both together.
    pub fn union(self, other: Self) -> Self {
        Self { least_m: self.least_m.min(other.least_m), greatest_m: self.greatest_m.max(other.greatest_m) }
    }

    /// Widened to take in a height; NaN changes nothing.
    pub fn include(self, height_m: f32) -> Self {
        // f32::min and max return the other operand for NaN.
        Self { least_m: self.least_m.min(height_m), greatest_m: self.greatest_m.max(height_m) }
    }

    /// Whether no post with data was met.
    pub fn is_void(self) -> bool {
        self.least_m > self.greatest_m
    }
}

impl Pyramid {
    /// The pyramid of a field; one pass over its posts.
    pub fn new(field: &Field) -> Self {
        let (columns, rows) = (field.grid().columns() as usize, field.grid().rows() as usize);
        let side = 1 << BASE;
        let (wide, high) = ((columns - 1).div_ceil(side), (rows - 1).div_ceil(side));
        let heights = field.heights_m();
        let mut nodes = vec![Range::VOID; wide * high];
        for (row, line) in heights.chunks_exact(columns).enumerate() {
            // A post on a node's border belongs to the nodes on both sides.
            let below = (row / side).min(high - 1);
            let above = if row.is_multiple_of(side) && row > 0 { row / side - 1 } else { below };
            for node_row in [above, below].into_iter().take(1 + usize::from(above != below)) {
                for (at, node) in nodes[node_row * wide..][..wide].iter_mut().enumerate() {
                    let end = ((at + 1) * side + 1).min(columns);
                    *node = line[at * side..end].iter().fold(*node, |range, &h| range.include(h));
                }
            }
        }
        let mut levels = vec![Level { columns: wide, nodes: Paged::new(nodes) }];
        while let Some(level) = levels.last().filter(|level| level.nodes.len() > 1) {
            let (wide, high) = (level.columns.div_ceil(2), level.rows().div_ceil(2));
            let nodes = (0..wide * high).map(|at| level.parent(at % wide, at / wide)).collect();
            levels.push(Level { columns: wide, nodes: Paged::new(nodes) });
        }
        Self { levels }
    }

    /// The pyramid of a field's next version: only what has a changed post is made anew.
    pub(crate) fn edited(&self, field: &Field, changed: &Changed) -> Self {
        let side = 1 << BASE;
        let mut at: BTreeSet<(usize, usize)> = BTreeSet::new();
        let (wide, high) = (self.levels[0].columns, self.levels[0].rows());
        for rect in changed.rects() {
            // A post on a node's border belongs to the nodes on both sides.
            let nodes = |first: i64, count: u32, most: usize| {
                let last = first + i64::from(count) - 1;
                ((first - 1).max(0) as usize / side)..=(last as usize / side).min(most - 1)
            };
            for row in nodes(rect.row, rect.rows, high) {
                at.extend(nodes(rect.column, rect.columns, wide).map(|column| (row, column)));
            }
        }
        let mut levels: Vec<Level> = Vec::with_capacity(self.levels.len());
        for level in &self.levels {
            let made = at.iter().map(|&(row, column)| {
                let node = match levels.last() {
                    Some(below) => below.parent(column, row),
                    None => base_node(field, column, row),
                };
                (row * level.columns + column, node)
            });
            let nodes = level.nodes.with(made);
            levels.push(Level { columns: level.columns, nodes });
            at = at.iter().map(|(row, column)| (row / 2, column / 2)).collect();
        }
        Self { levels }
    }

    /// Coarsest level: one node for all.
    pub fn top(&self) -> u32 {
        BASE + self.levels.len() as u32 - 1
    }

    /// The node of a level that holds a cell; `level` within [`BASE`]..=[`Self::top`].
    pub fn node(&self, level: u32, cell_column: u32, cell_row: u32) -> Range {
        let level_nodes = &self.levels[(level - BASE) as usize];
        level_nodes.nodes.get((cell_row >> level) as usize * level_nodes.columns + (cell_column >> level) as usize)
    }

    /// Range of all heights.
    pub fn all(&self) -> Range {
        self.levels.last().map_or(Range::VOID, |level| level.nodes.get(0))
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| level.nodes.bytes()).sum()
    }
}

impl Level {
    fn rows(&self) -> usize {
        self.nodes.len() / self.columns
    }

    /// The node of the next level that has this level's nodes from twice its place on.
    fn parent(&self, column: usize, row: usize) -> Range {
        let (columns, rows) = ((2 * column + 2).min(self.columns), (2 * row + 2).min(self.rows()));
        (2 * row..rows)
            .flat_map(|row| (2 * column..columns).map(move |column| (row, column)))
            .fold(Range::VOID, |range, (row, column)| range.union(self.nodes.get(row * self.columns + column)))
    }
}

/// A node of the finest level kept, from its posts.
fn base_node(field: &Field, column: usize, row: usize) -> Range {
    let side = 1 << BASE;
    let rect = PostRect {
        column: (column * side) as i64,
        row: (row * side) as i64,
        columns: side as u32 + 1,
        rows: side as u32 + 1,
    };
    field.read(rect).into_iter().fold(Range::VOID, Range::include)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::synthetic;

    #[test]
    fn every_node_is_the_range_of_its_posts() {
        for (blocks_x, blocks_z) in [(1, 1), (3, 2)] {
            let grid = Grid::centred(200.0, blocks_x, blocks_z).unwrap();
            let mut heights = synthetic::ridges(grid, 7).heights_m().to_vec();
            heights[..40].fill(f32::NAN);
            let field = Field::new(grid, heights).unwrap();
            let pyramid = Pyramid::new(&field);
            for level in BASE..=pyramid.top() {
                for cell_row in (0..grid.rows() - 1).step_by(1 << level) {
                    for cell_column in (0..grid.columns() - 1).step_by(1 << level) {
                        let mut slow = Range::VOID;
                        for row in cell_row..=(cell_row + (1 << level)).min(grid.rows() - 1) {
                            for column in cell_column..=(cell_column + (1 << level)).min(grid.columns() - 1) {
                                slow = slow.include(field.post_m(i64::from(column), i64::from(row)));
                            }
                        }
                        assert_eq!(pyramid.node(level, cell_column, cell_row), slow, "level {level}");
                    }
                }
            }
        }
    }
}
