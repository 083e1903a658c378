//! The detail texture: tiling patterns that the ground near the eye is made of, whatever covers it.
//!
//! RGBA8, mean 0.5 in every channel: red and green the slope of a relief of knolls and edges; blue *clumps*: tussocks,
//! bushes, patches; alpha *grain*: cracks between stones and fine grit. The shader (`shaders/shared/detail.wgsl`) reads
//! it at two scales and weighs the channels by the colour of the ground map: rock shows relief and cracks, grass and
//! steppe clumps, sand grit, snow little of anything.
//!
//! No feature is longer than a twelfth of the texture, or its repetition would show from the air; what repetition is
//! left is bent apart by the shader (`detail_places` there, and its twin in the test). Every mip is the mean of the one below, a
//! little fainter, so with distance the slope fades to level and the patterns to grey: no shimmer, no fade to tune.

use std::sync::OnceLock;
use terrain::block::ground_map::unit;

/// Texels along the texture.
pub const SIDE: u32 = 512;

/// Contrast that a mip keeps of the one below it beyond plain averaging.
const KEPT: f32 = 0.88;

/// The texture and all its mips, each a square of four-byte texels. Made once a process: some 0.2 s of work, which a thread
/// may do ahead.
pub fn levels() -> &'static [Vec<u8>] {
    static LEVELS: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    LEVELS.get_or_init(|| mip_chain(SIDE))
}

/// The texture and all its mips; `side` a power of two.
fn mip_chain(side: u32) -> Vec<Vec<u8>> {
    let size = side as usize;
    let mut texels = patterns(size);
    let mut level_side = size;
    let mut levels = Vec::new();
    loop {
        levels.push(texels.iter().flatten().map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8).collect());
        if level_side == 1 {
            return levels;
        }
        let half = level_side / 2;
        texels = (0..half * half)
            .map(|at| {
                let (x, y) = (2 * (at % half), 2 * (at / half));
                std::array::from_fn(|c| {
                    let four =
                        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| texels[(y + dy) * level_side + x + dx][c]);
                    0.5 + KEPT * (four.iter().sum::<f32>() / 4.0 - 0.5)
                })
            })
            .collect();
        level_side = half;
    }
}

/// The texels of the whole texture.
fn patterns(size: usize) -> Vec<[f32; 4]> {
    let relief = channel(size, |x, y| {
        let knolls = fractal(x, y, 12, 5, 11);
        // Edges where two knolls meet: a fold of the noise.
        let folds = 1.0 - (2.0 * fractal(x, y, 20, 4, 29) - 1.0).abs();
        0.55 * knolls + 0.45 * folds
    });
    let clumps = channel(size, |x, y| {
        let (patch, tuft, blade) = (fractal(x, y, 12, 3, 23), cells(x, y, 29, 31)[0], cells(x, y, 71, 37)[0]);
        patch - 0.45 * tuft - 0.35 * blade
    });
    let grain = channel(size, |x, y| {
        let [near, next] = cells(x, y, 23, 41);
        let [small, smaller] = cells(x, y, 61, 43);
        // Thin dark joints between stones of two sizes, and grit.
        let joint = |gap: f32, width: f32| (gap / width).min(1.0);
        0.16 * joint(next - near, 0.30) + 0.22 * joint(smaller - small, 0.45) + 1.2 * fractal(x, y, 24, 4, 47)
    });
    let (relief, clumps, grain) = (spread(relief, 0.2), spread(clumps, 0.17), spread(grain, 0.16));
    let slope = |x: usize, y: usize, dx: usize, dy: usize| {
        let ahead = relief[(y + dy) % size * size + (x + dx) % size];
        let behind = relief[(y + size - dy) % size * size + (x + size - dx) % size];
        behind - ahead
    };
    let slopes = |dx, dy| spread((0..size * size).map(|at| slope(at % size, at / size, dx, dy)).collect(), 0.14);
    let (east, south) = (slopes(1, 0), slopes(0, 1));
    (0..size * size).map(|at| [east[at], south[at], clumps[at], grain[at]]).collect()
}

/// A pattern over the texture's texels, coordinates 0..1.
fn channel(size: usize, at: impl Fn(f32, f32) -> f32) -> Vec<f32> {
    (0..size * size).map(|i| at((i % size) as f32 / size as f32, (i / size) as f32 / size as f32)).collect()
}

/// The same pattern with mean 0.5 and a standard deviation of `deviation`.
fn spread(values: Vec<f32>, deviation: f32) -> Vec<f32> {
    let number = values.len() as f64;
    let mean = values.iter().map(|v| f64::from(*v)).sum::<f64>() / number;
    let variance = values.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / number;
    let gain = f64::from(deviation) / variance.sqrt().max(1e-9);
    values.into_iter().map(|v| (0.5 + (f64::from(v) - mean) * gain) as f32).collect()
}

/// Value noise that repeats after 1: octaves from `cells` lattice cells up, 0 to 1.
fn fractal(x: f32, y: f32, cells: usize, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        let cells = cells << octave;
        sum += weight * lattice(x * cells as f32, y * cells as f32, cells, seed + octave);
        total += weight;
        weight *= 0.6;
    }
    sum / total
}

fn lattice(x: f32, y: f32, cells: usize, seed: u32) -> f32 {
    let (x0, y0) = (x.floor() as usize, y.floor() as usize);
    let ease = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (ease(x.fract()), ease(y.fract()));
    let at = |dx: usize, dy: usize| unit(((x0 + dx) % cells) as i32, ((y0 + dy) % cells) as i32, seed);
    let (top, bottom) = (at(0, 0) + u * (at(1, 0) - at(0, 0)), at(0, 1) + u * (at(1, 1) - at(0, 1)));
    top + v * (bottom - top)
}

/// Distances to the nearest and the next of scattered points, one in each of `cells` x `cells` squares, in squares.
/// Source: S. Worley, A cellular texture basis function, 1996.
fn cells(x: f32, y: f32, cells: usize, seed: u32) -> [f32; 2] {
    let (x, y, side) = (x * cells as f32, y * cells as f32, cells as i32);
    let (x0, y0) = (x.floor() as i32, y.floor() as i32);
    let mut found = [f32::INFINITY; 2];
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (column, row) = ((x0 + dx).rem_euclid(side), (y0 + dy).rem_euclid(side));
            let place = (unit(column, row, seed), unit(column, row, seed ^ 0x55));
            let (east, south) = ((x0 + dx) as f32 + place.0 - x, (y0 + dy) as f32 + place.1 - y);
            let squared = east * east + south * south;
            if squared < found[0] {
                found = [squared, found[0]];
            } else if squared < found[1] {
                found[1] = squared;
            }
        }
    }
    found.map(f32::sqrt)
}

#[cfg(test)]
#[path = "detail_tests.rs"]
mod tests;
