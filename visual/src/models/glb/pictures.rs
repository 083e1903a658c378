//! The pictures that a file's base colours name, few and small enough to be held at once.

use super::{GlbError, wrong};
use image::{ImageReader, RgbaImage};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Cursor;

/// Most pictures of a file.
pub const MAX_PICTURES: usize = 16;
/// Largest side of one, pixels: all together are at most 256 MiB.
pub const MAX_SIDE_PX: u32 = 2_048;

/// Pictures by their numbers in the file. One that is not there leaves the factor's colour.
pub(super) fn of(
    file: &gltf::Gltf,
    blob: &[u8],
    beside: &impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<BTreeMap<usize, RgbaImage>, GlbError> {
    let colours = file.materials().filter_map(|material| material.pbr_metallic_roughness().base_color_texture());
    let named: BTreeSet<usize> = colours.map(|colour| colour.texture().source().index()).collect();
    if named.len() > MAX_PICTURES {
        return Err(wrong(&format!("at most {MAX_PICTURES} pictures"), named.len()));
    }
    let mut pictures = BTreeMap::new();
    for picture in file.images().filter(|picture| named.contains(&picture.index())) {
        let bytes = match picture.source() {
            gltf::image::Source::View { view, .. } => Some(blob[view.offset()..view.offset() + view.length()].to_vec()),
            gltf::image::Source::Uri { uri, .. } => beside(uri),
        };
        if let Some(bytes) = bytes {
            pictures.insert(picture.index(), decoded(&bytes)?);
        }
    }
    Ok(pictures)
}

fn decoded(bytes: &[u8]) -> Result<RgbaImage, GlbError> {
    let broken = |error: String| wrong("a PNG texture", error);
    let reader =
        || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| broken(error.to_string()));
    let (width, height) = reader()?.into_dimensions().map_err(|error| broken(error.to_string()))?;
    if width.max(height) > MAX_SIDE_PX {
        let most = format!("a picture of at most {MAX_SIDE_PX} x {MAX_SIDE_PX} pixels");
        return Err(wrong(&most, format_args!("{width} x {height}")));
    }
    let picture = reader()?.decode().map_err(|error| broken(error.to_string()))?;
    Ok(picture.into_rgba8())
}
