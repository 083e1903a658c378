//! Events that change the ground, as data, and what such a change reaches.
//!
//! Frame: see [`crate::frame`]. An edit says which posts get which heights; posts are all there is, so picture, physics and
//! queries follow by themselves. [`crate::Field::edited`] makes the next version of the ground.
//!
//! A crater is a bowl with a rim, added to the heights that are there: with `r` the distance from the centre over the
//! radius, `-depth + (depth + rim) r^2` inside, and outside the ejecta, `rim (r^-3 - 1/27) / (1 - 1/27)`, to three radii.
//! Sources: thickness of ejecta as the inverse cube of the distance, T. R. McGetchin, M. Settle, J. W. Head, Earth and
//! Planetary Science Letters 20 (1973); depth below the rim 0.196 and height of the rim 0.036 of the diameter of simple
//! craters, R. J. Pike, Impact and Explosion Cratering (1977). Craters of explosions are of the same shape.
//!
//! Invariant others rely on: a crater smaller than the step changes no post; a void post stays void under a crater.

use crate::block::light::Walk;
use crate::block::mesh::TILE;
use crate::field::{Corner, Field, MAX_HEIGHT_M};
use crate::grid::{BlockIndex, CELLS, Grid, PostRect};
use crate::pyramid::Range;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Greatest radius of a crater, metres.
pub const MOST_RADIUS_M: f64 = 5_000.0;
/// Greatest depth of a crater, metres.
pub const MOST_DEPTH_M: f64 = 2_000.0;
/// Depth below the ground before, over the radius: 0.196 less 0.036, of the diameter.
pub const DEPTH_OF_RADIUS: f64 = 0.32;
/// Height of the rim over the depth below the ground before.
const RIM_OF_DEPTH: f64 = 0.036 / 0.160;
/// Where the ejecta end, radii.
const EJECTA_RADII: f64 = 3.0;

/// An event that changes the ground.
#[derive(Debug, Clone, PartialEq)]
pub enum Edit {
    /// A crater.
    Crater(Crater),
    /// Posts and their new heights, metres; a void post may get one.
    Posts(Vec<(Corner, f32)>),
}

/// A bowl with a rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crater {
    /// Its middle, world x and z, metres.
    pub centre_m: DVec2,
    /// From the middle to the crest of the rim, metres.
    pub radius_m: f64,
    /// Of its middle below the ground before, metres.
    pub depth_m: f64,
}

/// Why an edit cannot be made.
#[derive(Debug, Clone, PartialEq)]
pub enum EditError {
    /// The crater's place or size.
    Crater(Crater),
    /// The post is none of the grid's.
    Post(Corner),
    /// The height that a post would get.
    Height(Corner, f32),
}

impl fmt::Display for EditError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Crater(Crater { centre_m, radius_m, depth_m }) => write!(
                f,
                "expected a crater at a finite place with a radius over 0 m and up to {MOST_RADIUS_M} m and a depth over \
                 0 m and up to {MOST_DEPTH_M} m, found one at {centre_m} with {radius_m} m and {depth_m} m"
            ),
            Self::Post(Corner { column, row }) => {
                write!(f, "expected a post of the grid, found column {column}, row {row}")
            }
            Self::Height(Corner { column, row }, height_m) => write!(
                f,
                "the new height at column {column}, row {row} must be within +-{MAX_HEIGHT_M} m, found {height_m}"
            ),
        }
    }
}

impl std::error::Error for EditError {}

impl Crater {
    /// A crater of the depth that its radius goes with.
    pub fn simple(centre_m: DVec2, radius_m: f64) -> Self {
        Self { centre_m, radius_m, depth_m: DEPTH_OF_RADIUS * radius_m }
    }

    /// Whether posts a step apart can show it.
    pub fn reaches_posts(&self, step_m: f64) -> bool {
        self.radius_m >= step_m
    }

    /// How much higher the ground is than before at a distance from the middle, metres.
    pub fn rise_m(&self, distance_m: f64) -> f64 {
        const LAST: f64 = 1.0 / (EJECTA_RADII * EJECTA_RADII * EJECTA_RADII);
        let (r, rim_m) = (distance_m / self.radius_m, RIM_OF_DEPTH * self.depth_m);
        if r < 1.0 {
            (self.depth_m + rim_m) * (r * r) - self.depth_m
        } else if r < EJECTA_RADII {
            rim_m * ((1.0 / (r * r * r) - LAST) / (1.0 - LAST))
        } else {
            0.0
        }
    }

    fn check(&self) -> Result<(), EditError> {
        let within = |value: f64, most: f64| value > 0.0 && value <= most;
        let good =
            self.centre_m.is_finite() && within(self.radius_m, MOST_RADIUS_M) && within(self.depth_m, MOST_DEPTH_M);
        if good { Ok(()) } else { Err(EditError::Crater(*self)) }
    }
}

/// The posts whose heights edits change, and to what.
pub(crate) fn posts(field: &Field, edits: &[Edit]) -> Result<BTreeMap<Corner, f32>, EditError> {
    let grid = field.grid();
    let mut posts: BTreeMap<Corner, f32> = BTreeMap::new();
    let before = |corner: &Corner| field.post_m(i64::from(corner.column), i64::from(corner.row));
    for edit in edits {
        match edit {
            Edit::Crater(crater) => {
                crater.check()?;
                if !crater.reaches_posts(grid.step_m) {
                    continue;
                }
                for corner in around(grid, crater.centre_m, EJECTA_RADII * crater.radius_m) {
                    let old_m = posts.get(&corner).copied().unwrap_or_else(|| before(&corner));
                    let (x_m, z_m) = (grid.x_m(i64::from(corner.column)), grid.z_m(i64::from(corner.row)));
                    let (east, south) = (x_m - crater.centre_m.x, z_m - crater.centre_m.y);
                    // A square root of squares, not `hypot`: the same on every machine.
                    let height_m = (f64::from(old_m) + crater.rise_m((east * east + south * south).sqrt())) as f32;
                    if !old_m.is_nan() {
                        posts.insert(corner, height_m);
                    }
                }
            }
            Edit::Posts(list) => {
                for &(corner, height_m) in list {
                    if corner.column >= grid.columns() || corner.row >= grid.rows() {
                        return Err(EditError::Post(corner));
                    }
                    posts.insert(corner, height_m);
                }
            }
        }
    }
    if let Some((corner, height_m)) =
        posts.iter().find(|(_, height_m)| height_m.is_nan() || height_m.abs() > MAX_HEIGHT_M)
    {
        return Err(EditError::Height(*corner, *height_m));
    }
    posts.retain(|corner, height_m| before(corner).to_bits() != height_m.to_bits());
    Ok(posts)
}

/// The posts of the grid in the square about a place.
fn around(grid: &Grid, centre_m: DVec2, reach_m: f64) -> impl Iterator<Item = Corner> + use<> {
    let range = |centre: f64, first: f64, posts: u32| {
        let at = |m: f64| ((m - first) / grid.step_m).clamp(-1.0, f64::from(posts));
        (at(centre - reach_m).ceil().max(0.0) as u32)..(at(centre + reach_m).floor() + 1.0).min(f64::from(posts)) as u32
    };
    let columns = range(centre_m.x, grid.west_m, grid.columns());
    range(centre_m.y, grid.north_m, grid.rows())
        .flat_map(move |row| columns.clone().map(move |column| Corner { column, row }))
}

/// What a new version of the ground changed, and which blocks that reaches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Changed {
    parts: Vec<Part>,
}

/// Changed posts that one block owns.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    rect: PostRect,
    /// Greatest height, before or after, of those posts and their neighbours: of all that a ray meets between them.
    greatest_m: f32,
    /// Whether a post was void before.
    filled: bool,
}

/// Steps from a block's posts to the farthest post that its ground map reads, `sites` of [`crate::features::cover_rules`].
const MAP_REACH: i64 = 3;
/// Steps from a texel to the farthest post that its share of the sky reads ([`crate::block::light`]).
const SKY_REACH: i64 = 9;

impl Changed {
    pub(crate) fn new(before: &Field, posts: &BTreeMap<Corner, f32>) -> Self {
        let mut parts: BTreeMap<(u32, u32), Part> = BTreeMap::new();
        for (corner, &height_m) in posts {
            let (column, row) = (i64::from(corner.column), i64::from(corner.row));
            let here = PostRect { column, row, columns: 1, rows: 1 };
            let ring = PostRect { column: column - 1, row: row - 1, columns: 3, rows: 3 };
            let range = before.read(ring).into_iter().fold(Range::VOID, Range::include).include(height_m);
            let filled = before.post_m(column, row).is_nan();
            parts
                .entry((corner.row / CELLS, corner.column / CELLS))
                .and_modify(|part| {
                    part.rect = around_both(part.rect, here);
                    part.greatest_m = part.greatest_m.max(range.greatest_m);
                    part.filled |= filled;
                })
                .or_insert(Part { rect: here, greatest_m: range.greatest_m, filled });
        }
        Self { parts: parts.into_values().collect() }
    }

    /// Whether no post changed.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Whether a post was void before.
    pub fn fills_void(&self) -> bool {
        self.parts.iter().any(|part| part.filled)
    }

    /// Rectangles that hold all changed posts.
    pub fn rects(&self) -> impl Iterator<Item = PostRect> + '_ {
        self.parts.iter().map(|part| part.rect)
    }

    /// This change and the one after it.
    #[must_use]
    pub fn and(mut self, next: &Self) -> Self {
        self.parts.extend(&next.parts);
        self
    }

    /// Whether a block's own posts changed: its heights, masks and triangles.
    pub fn reaches_surface(&self, block: BlockIndex) -> bool {
        self.meets(block, 0)
    }

    /// Whether anything of a block's payload but its light may have changed.
    pub fn reaches_payload(&self, block: BlockIndex) -> bool {
        self.meets(block, MAP_REACH)
    }

    /// Whether a block's light may have changed, for a walk towards the sun: by a normal, by what of the sky is seen,
    /// or by a shadow. `lowest_m` is the block's lowest ground, on which a shadow is longest.
    pub(crate) fn reaches_light(&self, block: BlockIndex, walk: &Walk, lowest_m: f32) -> bool {
        self.meets(block, SKY_REACH)
            || self.parts.iter().any(|part| {
                let (low, high) = offsets(part.rect, block);
                walk.may_shade([low, high], part.greatest_m - lowest_m)
            })
    }

    /// Whether the square of plan from `low` to `high` (x, z, metres) or its surroundings changed: everything that stands in
    /// it takes its ground, slope and site from posts within a few steps.
    pub fn reaches_square(&self, grid: &Grid, low: DVec2, high: DVec2) -> bool {
        let room_m = MAP_REACH as f64 * grid.step_m;
        self.plans(grid).any(|(first, last)| (first - room_m).cmple(high).all() && (last + room_m).cmpge(low).all())
    }

    /// Plan rectangles (x, z, metres) that hold all ground that changed: cells with a changed post.
    pub fn plans(&self, grid: &Grid) -> impl Iterator<Item = (DVec2, DVec2)> + use<'_> {
        let grid = *grid;
        let at = move |column: i64, row: i64| DVec2::new(grid.x_m(column), grid.z_m(row));
        self.rects().map(move |rect| (at(rect.column - 1, rect.row - 1), at(last_column(rect) + 1, last_row(rect) + 1)))
    }

    /// The blocks of a grid that a test of this change holds for, of those near enough that it can.
    pub fn blocks(&self, grid: &Grid, test: impl Fn(&Self, BlockIndex) -> bool) -> BTreeSet<BlockIndex> {
        let near = |part: &Part| {
            let block = |at: i64| (at / i64::from(CELLS)) as i32;
            let (x, z) = (block(part.rect.column), block(part.rect.row));
            (z - 1..=z + 1).flat_map(move |z| (x - 1..=x + 1).map(move |x| BlockIndex { x, z }))
        };
        let all: BTreeSet<BlockIndex> = self.parts.iter().flat_map(near).collect();
        all.into_iter().filter(|block| grid.contains_block(*block) && test(self, *block)).collect()
    }

    /// Whether a changed post is among those of a block's height tile, or within `reach` steps of its own.
    fn meets(&self, block: BlockIndex, reach: i64) -> bool {
        let (column, row) = (block.first_column(), block.first_row());
        // The tile's apron is the last that a height tile has; reaches count from the light map's texels, as many.
        let last = i64::from(TILE) - 1 + reach;
        self.parts.iter().any(|Part { rect, .. }| {
            last_column(*rect) >= column - reach
                && rect.column <= column + last
                && last_row(*rect) >= row - reach
                && rect.row <= row + last
        })
    }
}

fn last_column(rect: PostRect) -> i64 {
    rect.column + i64::from(rect.columns) - 1
}

fn last_row(rect: PostRect) -> i64 {
    rect.row + i64::from(rect.rows) - 1
}

fn around_both(a: PostRect, b: PostRect) -> PostRect {
    let (column, row) = (a.column.min(b.column), a.row.min(b.row));
    let columns = (last_column(a).max(last_column(b)) - column + 1) as u32;
    let rows = (last_row(a).max(last_row(b)) - row + 1) as u32;
    PostRect { column, row, columns, rows }
}

/// Least and greatest steps (columns, rows) from a texel of a block's light map to a ray's neighbour of a changed post.
fn offsets(rect: PostRect, block: BlockIndex) -> (DVec2, DVec2) {
    let last = i64::from(TILE) - 1;
    let least = [rect.column - 1 - block.first_column() - last, rect.row - 1 - block.first_row() - last];
    let greatest = [last_column(rect) + 1 - block.first_column(), last_row(rect) + 1 - block.first_row()];
    let steps = |[column, row]: [i64; 2]| DVec2::new(column as f64, row as f64);
    (steps(least), steps(greatest))
}

#[cfg(test)]
mod tests;
