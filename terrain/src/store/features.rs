//! Features as `features.bin`: postcard, checked for what others rely on when read.

use crate::features::model::Features;
use std::io;

/// The file's bytes.
pub(super) fn to_bytes(features: &Features) -> io::Result<Vec<u8>> {
    postcard::to_stdvec(features).map_err(io::Error::other)
}

/// From the file's bytes.
pub(super) fn from_bytes(bytes: &[u8]) -> Result<Features, String> {
    let features: Features = postcard::from_bytes(bytes).map_err(|error| error.to_string())?;
    match features.is_sound() {
        true => Ok(features),
        false => Err("a number that is not finite, or a line or ring of too few points".into()),
    }
}
