//! The detail texture: its mean, its mips, and how much of it repeats as one looks down on it.

use super::*;

#[test]
fn the_smallest_mip_is_level_and_grey() {
    let levels = mip_chain(128);
    assert_eq!(levels.len(), 8);
    for channel in &levels[7] {
        // The mean of all texels is 128 but for what was clamped at either end, at most a twentieth of the range.
        assert!(channel.abs_diff(128) <= 13, "{:?}", levels[7]);
    }
}

#[test]
fn the_texture_repeats_without_a_seam() {
    let size = 128;
    let texels = patterns(size);
    let step = |a: usize, b: usize| (0..4).map(|c| (texels[a][c] - texels[b][c]).abs()).fold(0.0, f32::max);
    let (mut inner, mut seam) = (0.0_f32, 0.0_f32);
    for row in 0..size {
        for column in 0..size - 1 {
            inner = inner.max(step(row * size + column, row * size + column + 1));
        }
        seam = seam.max(step(row * size + size - 1, row * size));
    }
    assert!(seam <= inner, "{seam} over the seam, {inner} elsewhere");
}

/// Twin of `detail_places` in `shaders/shared/detail.wgsl`, at a step of 200 m; posts counted over the world.
fn places(post: [f32; 2]) -> [[f32; 2]; 2] {
    let [x, z] = post;
    let wave = |u: f32, posts: f32, other: f32| (u / posts + (other / 5.1).sin()).sin();
    let wave = [wave(z, 1.7, x), wave(x, 1.7, z), wave(x, 2.3, z), wave(z, 2.3, x)];
    let turned = |[a, b]: [f32; 2]| [(x * a + z * b) / 30.0, (-x * b + z * a) / 30.0];
    let coarse = turned([11.0, 4.0]);
    [[coarse[0] + 0.32 * (wave[0] + wave[2]), coarse[1] + 0.32 * (wave[1] + wave[3])], turned([89.0, -38.0])]
}

fn read(level: usize, [u, v]: [f32; 2], channel: usize) -> f32 {
    let side = (SIDE >> level) as usize;
    let at = |w: f32| ((w.rem_euclid(1.0) * side as f32) as usize).min(side - 1);
    f32::from(levels()[level][(at(v) * side + at(u)) * 4 + channel]) / 255.0 - 0.5
}

/// What the shader makes of plain steppe, as a shade about 0: coarse and fine scale at the mips that pixels of
/// `pixel_m` read.
fn steppe(pixel_m: f32, side: usize) -> Vec<f32> {
    let level = |repeat_m: f32, bias: f32| {
        ((pixel_m / repeat_m * SIDE as f32).log2() + bias).round().clamp(0.0, SIDE.ilog2() as f32) as usize
    };
    let (coarse, fine) = (level(513.0, -0.5), level(62.0, -0.6));
    (0..side * side)
        .map(|at| {
            let post = [(at % side) as f32, (at / side) as f32].map(|p| 300.0 + p * pixel_m / 200.0);
            let [coarse_at, fine_at] = places(post);
            let clumps = read(coarse, coarse_at, 2);
            let fine_at = [fine_at[0] + 0.05 * clumps, fine_at[1] - 0.035 * clumps];
            0.95 * clumps
                + 0.24 * read(coarse, coarse_at, 3)
                + 1.05 * read(fine, fine_at, 2)
                + 0.30 * read(fine, fine_at, 3)
        })
        .collect()
}

/// The largest autocorrelation of a square picture at shifts of `from` to `to` pixels, and that shift.
fn largest_echo(shade: &[f32], side: usize, from: usize, to: usize) -> (f32, [i32; 2]) {
    let mean = shade.iter().sum::<f32>() / shade.len() as f32;
    let mut largest = (f32::NEG_INFINITY, [0, 0]);
    for dz in (0..=to as i32).step_by(2) {
        for dx in (-(to as i32)..=to as i32).step_by(2) {
            if (dx as f32).hypot(dz as f32) < from as f32 {
                continue;
            }
            let (mut both, mut first, mut second) = (0.0, 0.0, 0.0);
            for z in (0..side - dz as usize).step_by(5) {
                for x in (dx.min(0).unsigned_abs() as usize..side - dx.max(0) as usize).step_by(3) {
                    let a = shade[z * side + x] - mean;
                    let b = shade[(z + dz as usize) * side + (x as i32 + dx) as usize] - mean;
                    both += a * b;
                    first += a * a;
                    second += b * b;
                }
            }
            let echo = both / (first * second).sqrt().max(1e-12);
            if echo > largest.0 {
                largest = (echo, [dx, dz]);
            }
        }
    }
    largest
}

#[test]
fn plain_ground_shows_no_repetition_from_the_air() {
    // Straight down, 60 degrees over 720 pixels: a pixel is 4.8 m from 3 km, 1.6 m from 1 km, where the picture holds
    // hardly two repeats: an echo of 0.31 is left, of 0.67 without the bend.
    for (pixel_m, longest_m, most) in [(4.8, 1_100.0, 0.2), (1.6, 560.0, 0.35)] {
        let side = 500;
        // A lag of 60 m and more is past the longest feature, 43 m.
        let shade = steppe(pixel_m, side);
        let (echo, at) = largest_echo(&shade, side, (60.0 / pixel_m) as usize, (longest_m / pixel_m) as usize);
        println!("pixels of {pixel_m} m: echo {echo:.3} at {at:?}");
        assert!(echo < most, "echo {echo} at a shift of {at:?} pixels of {pixel_m} m");
    }
}
