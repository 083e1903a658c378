//! Cover as `cover.bin`: how many cells make a post step (u32, little-endian), then the cells, deflated.

use crate::features::cover::Cover;
use crate::grid::Grid;
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use std::io::{self, Read, Write};

/// Most cells along a post step: 1 m at 400 m posts.
const MAX_PER_STEP: u32 = 400;

/// The file's bytes.
pub(super) fn to_bytes(cover: &Cover, grid: &Grid) -> io::Result<Vec<u8>> {
    let per_step = (grid.step_m / cover.cell_m()).round() as u32;
    let mut encoder = DeflateEncoder::new(per_step.to_le_bytes().to_vec(), Compression::fast());
    encoder.write_all(cover.cells())?;
    encoder.finish()
}

/// From the file's bytes.
pub(super) fn from_bytes(bytes: &[u8], grid: &Grid) -> Result<Cover, String> {
    let Some((per_step, packed)) = bytes.split_first_chunk::<4>() else {
        return Err(format!("{} bytes", bytes.len()));
    };
    let per_step = u32::from_le_bytes(*per_step);
    if !(1..=MAX_PER_STEP).contains(&per_step) {
        return Err(format!("{per_step} cells along a post step"));
    }
    let side = |posts: u32| u64::from(posts - 1) * u64::from(per_step);
    let expected = side(grid.columns()) * side(grid.rows());
    let mut cells = Vec::new();
    DeflateDecoder::new(packed).take(expected + 1).read_to_end(&mut cells).map_err(|error| error.to_string())?;
    let found = cells.len();
    Cover::new(grid, per_step, cells).ok_or_else(|| format!("{found} cells for {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cover_comes_back_and_damage_is_told() {
        let grid = Grid::centred(200.0, 1, 1).unwrap();
        let side = (crate::CELLS * 4) as usize;
        let cover = Cover::new(&grid, 4, (0..side * side).map(|at| (at / 97 % 13) as u8).collect()).unwrap();
        let bytes = to_bytes(&cover, &grid).unwrap();
        assert_eq!(from_bytes(&bytes, &grid), Ok(cover));
        assert!(from_bytes(&bytes[..3], &grid).is_err());
        assert!(from_bytes(&bytes[..bytes.len() / 2], &grid).is_err());
        assert!(from_bytes(&[255; 40], &grid).is_err());
    }
}
