//! From a cell to uniform numbers, by an integer hash.
//!
//! A plant's place, kind and size must not depend on which block was built first, so there is no running generator:
//! every number is a function of (cell column, cell row, salt). Integers only, so that a shader can compute the same.
//!
//! Invariant: the values are frozen. A change moves every tree of every world, and the test says so.
//!
//! Source: M. Jarzynski, M. Olano, Hash Functions for GPU Rendering, 2020: `pcg3d`, after M. O'Neill's PCG, 2014.

/// Three well mixed words of a cell and a salt. Salts name what the numbers are for.
pub fn hash(column: i32, row: i32, salt: u32) -> [u32; 3] {
    const MULTIPLIER: u32 = 1_664_525;
    const INCREMENT: u32 = 1_013_904_223;
    let mut v = [column as u32, row as u32, salt].map(|w| w.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT));
    let mix = |v: &mut [u32; 3]| {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    };
    mix(&mut v);
    v = v.map(|w| w ^ (w >> 16));
    mix(&mut v);
    v
}

/// A word as a number in 0..1: its upper 24 bits, so that every value is exact in an f32 and 1 is never reached.
pub fn uniform(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Three numbers in 0..1 of a cell and a salt.
pub fn uniforms(column: i32, row: i32, salt: u32) -> [f32; 3] {
    hash(column, row, salt).map(uniform)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_values_are_frozen() {
        assert_eq!(hash(0, 0, 0), FROZEN[0]);
        assert_eq!(hash(1, 0, 0), FROZEN[1]);
        assert_eq!(hash(-1, 1000, 7), FROZEN[2]);
        assert_eq!(hash(i32::MIN, i32::MAX, u32::MAX), FROZEN[3]);
    }

    /// Computed outside this crate from the published listing, in whole numbers modulo 2^32.
    const FROZEN: [[u32; 3]; 4] = [
        [0x9baf_d7c6, 0xa8e8_8a6b, 0x3f15_482c],
        [0xa1fe_c616, 0x54e4_e5e7, 0x7b1d_d140],
        [0x6880_1723, 0x51f8_06fc, 0x7ae2_46fe],
        [0x0019_a03b, 0xee46_2c6d, 0xcadd_34cc],
    ];

    #[test]
    fn one_bit_of_a_cell_flips_half_of_the_bits() {
        // Per input bit, 1,024 cells x 96 bits: the mean of fair coins is 0.5 +- 0.0016, five deviations 0.008. The
        // top bits of a product mix less, so 0.08 is allowed: a hash that fails to mix is off by 0.2 and more.
        for input in 0..2 {
            for bit in 0..20 {
                let flipped: u32 = (0..1_024)
                    .map(|i| {
                        let cell = [i * 37 - 9_000, i * 11 - 4_000];
                        let mut other = cell;
                        other[input] ^= 1 << bit;
                        let (a, b) = (hash(cell[0], cell[1], 1), hash(other[0], other[1], 1));
                        a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum::<u32>()
                    })
                    .sum();
                let share = f64::from(flipped) / (1_024.0 * 96.0);
                assert!((share - 0.5).abs() < 0.08, "input {input}, bit {bit}: {share}");
            }
        }
    }

    #[test]
    fn numbers_are_uniform_and_neighbours_independent() {
        let side = 256;
        let cells: Vec<[f32; 3]> = (0..side * side).map(|i| uniforms(i % side, i / side, 3)).collect();
        for axis in 0..3 {
            let mut bins = [0u32; 64];
            for cell in &cells {
                assert!((0.0..1.0).contains(&cell[axis]));
                bins[(cell[axis] * 64.0) as usize] += 1;
            }
            let expected = f64::from(side * side) / 64.0;
            let chi2: f64 = bins.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
            // 63 degrees of freedom: mean 63, deviation 11.2; five deviations.
            assert!(chi2 < 63.0 + 56.0, "axis {axis}: {chi2}");
            let mean = |f: &dyn Fn(usize) -> f64| {
                (0..cells.len() - side as usize).map(f).sum::<f64>() / (cells.len() - side as usize) as f64
            };
            for apart in [1, side as usize] {
                let covariance =
                    mean(&|i| (f64::from(cells[i][axis]) - 0.5) * (f64::from(cells[i + apart][axis]) - 0.5));
                // Variance 1/12 each; the mean of 65,000 products deviates by 1/12/255; five deviations.
                assert!(covariance.abs() < 5.0 / 12.0 / 255.0, "axis {axis}, {apart} apart: {covariance}");
            }
        }
    }
}
