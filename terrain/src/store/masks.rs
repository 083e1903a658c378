//! The ring masks of a world as bytes: `masks.bin`.
//!
//! Limits of the far rings (f64, metres), then for each block, row by row from the north-west, a mask of 32 bytes a ring.
//! All little-endian.

use crate::block::Mask;
use crate::block::rings::{FAR_RINGS, RingMasks};
use crate::paged::Paged;

const HEAD: usize = 8 * FAR_RINGS;
const ENTRY: usize = Mask::BYTES * FAR_RINGS;

/// The bytes of masks.
pub fn to_bytes(masks: &RingMasks) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + masks.masks.len() * ENTRY);
    masks.limits_m.iter().for_each(|limit_m| bytes.extend(limit_m.to_le_bytes()));
    masks.masks.all().iter().flatten().for_each(|mask| bytes.extend(mask.to_bytes()));
    bytes
}

/// The masks of `blocks` blocks; `None` if the length is not theirs or a byte is none of a mask's.
pub fn from_bytes(bytes: &[u8], blocks: usize) -> Option<RingMasks> {
    if bytes.len() != HEAD + blocks * ENTRY {
        return None;
    }
    let (head, body) = bytes.split_at(HEAD);
    let mut limits_m = [0.0; FAR_RINGS];
    for (limit_m, eight) in limits_m.iter_mut().zip(head.as_chunks::<8>().0) {
        *limit_m = f64::from_le_bytes(*eight);
    }
    let all: Option<Vec<Mask>> = body.as_chunks::<{ Mask::BYTES }>().0.iter().map(Mask::from_bytes).collect();
    let masks = Paged::new(all?.as_chunks::<FAR_RINGS>().0.to_vec());
    Some(RingMasks { limits_m, masks })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::Rings;
    use crate::{Grid, synthetic};

    #[test]
    fn masks_come_back_and_a_wrong_length_does_not() {
        let grid = Grid::centred(200.0, 3, 2).unwrap();
        let masks = RingMasks::new(&synthetic::ridges(grid, 1), Rings::new(&grid, 24, 1.0).limits_m);
        let bytes = to_bytes(&masks);
        assert_eq!(from_bytes(&bytes, 6), Some(masks));
        for cut in [0, 1, HEAD, bytes.len() - 1] {
            assert_eq!(from_bytes(&bytes[..cut], 6), None);
        }
        assert_eq!(from_bytes(&bytes, 5), None);
    }
}
