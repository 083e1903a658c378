//! The detail texture: tiling noise that breaks up the ground near the eye.
//!
//! No feature is longer than a twelfth of the texture, or its repetition would show from the air. RGBA8: red and
//! green a surface slope (0.5 is level), blue and alpha two shades (mean 0.5). Every mip is the mean
//! of the one below, a little fainter, so with distance the slope fades to level and the shades to grey: no shimmer, no fade to tune.

use terrain::block::ground_map::unit;

/// Contrast that a mip keeps of the one below it beyond plain averaging: what is far enough to show the repetition is
/// faded out before it does.
const KEPT: f32 = 0.7;

/// The texture and all its mips, each a square of four-byte texels; `side` a power of two.
pub fn mip_chain(side: u32) -> Vec<Vec<u8>> {
    let size = side as usize;
    let relief: Vec<f32> = (0..size * size).map(|at| fractal(at % size, at / size, size, 12, 4, 11)).collect();
    let shade: Vec<f32> = (0..size * size).map(|at| fractal(at % size, at / size, size, 14, 4, 23)).collect();
    let grain: Vec<f32> = (0..size * size).map(|at| fractal(at % size, at / size, size, 18, 4, 47)).collect();
    let mut texels: Vec<[f32; 4]> = (0..size * size)
        .map(|at| {
            let (x, y) = (at % size, at / size);
            let slope = |dx: usize, dy: usize| {
                let ahead = relief[(y + dy) % size * size + (x + dx) % size];
                let behind = relief[(y + size - dy) % size * size + (x + size - dx) % size];
                0.5 + 3.0 * (behind - ahead)
            };
            [slope(1, 0), slope(0, 1), shade[at], grain[at]]
        })
        .collect();
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

/// Value noise that repeats after `size` texels: octaves from `cells` lattice cells up, mean 0.5.
fn fractal(x: usize, y: usize, size: usize, cells: usize, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    for octave in 0..octaves {
        let cells = cells << octave;
        if cells > size {
            break;
        }
        sum += weight
            * lattice(
                x as f32 * cells as f32 / size as f32,
                y as f32 * cells as f32 / size as f32,
                cells,
                seed + octave,
            );
        total += weight;
        weight *= 0.6;
    }
    // Sums of noises huddle around the mean; spread them again.
    0.5 + 1.7 * (sum / total - 0.5)
}

fn lattice(x: f32, y: f32, cells: usize, seed: u32) -> f32 {
    let (x0, y0) = (x.floor() as usize, y.floor() as usize);
    let ease = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (ease(x.fract()), ease(y.fract()));
    let at = |dx: usize, dy: usize| unit(((x0 + dx) % cells) as i32, ((y0 + dy) % cells) as i32, seed);
    let (top, bottom) = (at(0, 0) + u * (at(1, 0) - at(0, 0)), at(0, 1) + u * (at(1, 1) - at(0, 1)));
    top + v * (bottom - top)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_mip_is_level_and_grey() {
        let levels = mip_chain(256);
        assert_eq!(levels.len(), 9);
        for channel in &levels[8] {
            // Eight mips keep at most KEPT^8 of half the range: 0.5 * 0.0576 * 255 = 7.4, and a rounding.
            assert!(channel.abs_diff(128) <= 8, "{:?}", levels[8]);
        }
    }
}
