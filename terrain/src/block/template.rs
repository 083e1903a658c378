//! How one sub-block (2 x 2 cells, 3 x 3 posts) is cut into triangles: the one table behind every level.
//!
//! Posts of a sub-block are numbered row by row from the north-west:
//! ```text
//! 0 1 2   NW N NE
//! 3 4 5   W  C  E
//! 6 7 8   SW S SE
//! ```
//! A *coarse* sub-block keeps its four corners and the diagonal from south-west to north-east, the same that cuts every
//! cell, and takes in the midpoint of each edge that asks for it: 16 templates of 2 + k triangles for k midpoints.
//! Template [`FINE`] is the eight triangles of level 0.
//!
//! Invariant others rely on: a template's outline has exactly the corners and the midpoints named by its edges, so two
//! sub-blocks that agree on a shared edge's midpoint share the same vertices there. Triangles are counter-clockwise seen
//! from above. Because level 1 is nested in level 0, the gap between a template and the ground is piecewise linear and
//! its greatest value stands at a vertex of the two triangulations laid over each other: [`gaps`] lists those.

use std::sync::LazyLock;

/// Edge bits of a coarse template: which edges have their midpoint.
pub const NORTH: usize = 1;
/// The edge towards the next column.
pub const EAST: usize = 2;
/// The edge towards the next row.
pub const SOUTH: usize = 4;
/// The edge towards the previous column.
pub const WEST: usize = 8;

/// Number of the level-0 template, behind the 16 coarse ones.
pub const FINE: usize = 16;

/// Triangles of a template, as post numbers of the sub-block.
pub type Triangles = Vec<[u8; 3]>;

/// A linear form over the nine posts whose value is the template's height minus the ground's at one point.
pub type Gap = [f64; 9];

const NW: u8 = 0;
const N: u8 = 1;
const NE: u8 = 2;
const W: u8 = 3;
const C: u8 = 4;
const E: u8 = 5;
const SW: u8 = 6;
const S: u8 = 7;
const SE: u8 = 8;

/// The eight triangles of level 0: each cell's north-western and south-eastern half.
const LEVEL_0: [[u8; 3]; 8] =
    [[NW, W, N], [W, C, N], [N, C, NE], [C, E, NE], [W, SW, C], [SW, S, C], [C, S, E], [S, SE, E]];

static TABLE: LazyLock<[Triangles; 17]> = LazyLock::new(|| {
    std::array::from_fn(|template| if template == FINE { LEVEL_0.to_vec() } else { coarse(template) })
});

static GAPS: LazyLock<[Vec<Gap>; 17]> =
    LazyLock::new(|| std::array::from_fn(|template| overlay_gaps(triangles(template))));

/// The triangles of a template, 0..=[`FINE`].
pub fn triangles(template: usize) -> &'static [[u8; 3]] {
    &TABLE[template]
}

/// All points where a template's height can differ most from the ground's; empty for [`FINE`].
pub fn gaps(template: usize) -> &'static [Gap] {
    &GAPS[template]
}

/// Greatest vertical distance between a template and the ground, in the unit of the heights. NaN if a post that it
/// depends on is void.
pub fn error_m(template: usize, posts: &[f32; 9]) -> f64 {
    gaps(template).iter().fold(0.0, |worst: f64, gap| {
        let at = gap.iter().zip(posts).map(|(w, h)| if *w == 0.0 { 0.0 } else { w * f64::from(*h) }).sum::<f64>().abs();
        if at.is_nan() { at } else { worst.max(at) }
    })
}

/// Each half keeps the diagonal; its two legs are cut where asked.
fn coarse(edges: usize) -> Triangles {
    let mut all = half([NW, W, SW, NE, N], edges & WEST != 0, edges & NORTH != 0);
    all.extend(half([SE, E, NE, SW, S], edges & EAST != 0, edges & SOUTH != 0));
    all
}

/// One half: `apex`, then counter-clockwise the first leg's midpoint and end, the second leg's end and midpoint.
fn half([apex, mid1, end1, end2, mid2]: [u8; 5], cut1: bool, cut2: bool) -> Triangles {
    match (cut1, cut2) {
        (false, false) => vec![[apex, end1, end2]],
        (true, false) => vec![[apex, mid1, end2], [mid1, end1, end2]],
        (false, true) => vec![[apex, end1, mid2], [mid2, end1, end2]],
        (true, true) => vec![[apex, mid1, mid2], [mid1, end1, mid2], [mid2, end1, end2]],
    }
}

/// East and south of a post in the sub-block, in cells.
fn place(post: u8) -> (f64, f64) {
    (f64::from(post % 3), f64::from(post / 3))
}

/// Weights of the nine posts for a surface's height at a point; `None` outside the triangle.
fn weights([a, b, c]: [u8; 3], (x, z): (f64, f64)) -> Option<Gap> {
    let ((ax, az), (bx, bz), (cx, cz)) = (place(a), place(b), place(c));
    let area = (bx - ax) * (cz - az) - (cx - ax) * (bz - az);
    let wb = ((x - ax) * (cz - az) - (cx - ax) * (z - az)) / area;
    let wc = ((bx - ax) * (z - az) - (x - ax) * (bz - az)) / area;
    let wa = 1.0 - wb - wc;
    // Places are halves and thirds of cells at worst, so anything under 1e-9 is rounding.
    [wa, wb, wc].iter().all(|w| *w > -1e-9).then(|| {
        let mut all = [0.0; 9];
        for (post, w) in [(a, wa), (b, wb), (c, wc)] {
            all[post as usize] = w;
        }
        all
    })
}

fn surface(triangles: &[[u8; 3]], at: (f64, f64)) -> Gap {
    triangles.iter().find_map(|t| weights(*t, at)).expect("a template covers its sub-block")
}

/// The forms at all vertices of the overlay of a template with level 0: posts and crossings of edges.
fn overlay_gaps(template: &[[u8; 3]]) -> Vec<Gap> {
    let edges = |triangles: &[[u8; 3]]| -> Vec<[u8; 2]> {
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect()
    };
    let mut points: Vec<(f64, f64)> = (0..9).map(place).collect();
    for [a, b] in edges(template) {
        for [c, d] in edges(&LEVEL_0) {
            let ((ax, az), (bx, bz), (cx, cz), (dx, dz)) = (place(a), place(b), place(c), place(d));
            let turn = (bx - ax) * (dz - cz) - (bz - az) * (dx - cx);
            if turn == 0.0 {
                continue;
            }
            let along = ((cx - ax) * (dz - cz) - (cz - az) * (dx - cx)) / turn;
            let across = ((cx - ax) * (bz - az) - (cz - az) * (bx - ax)) / turn;
            if (0.0..=1.0).contains(&along) && (0.0..=1.0).contains(&across) {
                points.push((ax + along * (bx - ax), az + along * (bz - az)));
            }
        }
    }
    let mut forms: Vec<Gap> = Vec::new();
    for at in points {
        let (t, g) = (surface(template, at), surface(&LEVEL_0, at));
        let mut form: Gap = std::array::from_fn(|post| t[post] - g[post]);
        form.iter_mut().filter(|w| w.abs() < 1e-9).for_each(|w| *w = 0.0);
        let known = |other: &Gap| form.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-9);
        if form.iter().any(|w| *w != 0.0) && !forms.iter().any(known) {
            forms.push(form);
        }
    }
    forms
}

#[cfg(test)]
mod tests {
    use super::*;

    fn twice_area([a, b, c]: [u8; 3]) -> f64 {
        let ((ax, az), (bx, bz), (cx, cz)) = (place(a), place(b), place(c));
        // Z points south, so counter-clockwise from above is a negative turn.
        -((bx - ax) * (cz - az) - (cx - ax) * (bz - az))
    }

    /// Directed edges that no triangle walks the other way: the outline.
    fn outline(template: usize) -> Vec<[u8; 2]> {
        let all: Vec<[u8; 2]> = triangles(template).iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let mut rim: Vec<_> = all.iter().filter(|[a, b]| !all.contains(&[*b, *a])).copied().collect();
        rim.sort();
        rim
    }

    #[test]
    fn every_template_covers_its_sub_block_once_facing_up() {
        for template in 0..=FINE {
            let cut = template.count_ones() as usize;
            assert_eq!(triangles(template).len(), if template == FINE { 8 } else { 2 + cut });
            assert!(triangles(template).iter().all(|t| twice_area(*t) > 0.0), "template {template}");
            assert_eq!(triangles(template).iter().map(|t| twice_area(*t)).sum::<f64>(), 8.0);
        }
    }

    #[test]
    fn outlines_have_exactly_the_midpoints_asked_for() {
        // West and south are walked away from the north-west corner, counter-clockwise.
        let sides = [(NORTH, [NE, N, NW]), (EAST, [SE, E, NE]), (SOUTH, [SW, S, SE]), (WEST, [NW, W, SW])];
        for template in 0..=FINE {
            let mut expected: Vec<[u8; 2]> = sides
                .iter()
                .flat_map(|(bit, [from, middle, to])| {
                    let cut = template == FINE || template & bit != 0;
                    if cut { vec![[*from, *middle], [*middle, *to]] } else { vec![[*from, *to]] }
                })
                .collect();
            expected.sort();
            assert_eq!(outline(template), expected, "template {template}");
        }
    }

    #[test]
    fn the_gap_is_the_worst_over_a_dense_grid_and_never_less() {
        let mut posts = [0.0f32; 9];
        let mut state = 1u32;
        for _ in 0..200 {
            for post in &mut posts {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *post = (state >> 8) as f32 / 16_777_216.0 * 1_000.0;
            }
            for template in 0..=FINE {
                let mut worst = 0.0f64;
                // Sixths and quarters of a cell hit every crossing: 24 steps.
                for iz in 0..=48 {
                    for ix in 0..=48 {
                        let at = (f64::from(ix) / 24.0, f64::from(iz) / 24.0);
                        let value = |form: Gap| form.iter().zip(&posts).map(|(w, h)| w * f64::from(*h)).sum::<f64>();
                        let gap = value(surface(triangles(template), at)) - value(surface(&LEVEL_0, at));
                        worst = worst.max(gap.abs());
                    }
                }
                let error = error_m(template, &posts);
                // Ten roundings of f64 at 1,000 m.
                assert!((error - worst).abs() < 1e-9, "template {template}: {error} and {worst}");
            }
        }
    }
}
