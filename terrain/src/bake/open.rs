//! From a file to a raster: what it is is told from its content, not from its name.
//!
//! Told apart: TIFF and PNG by their signatures; zip and gzip, which are unpacked (the first file inside that can be
//! heights) and told apart again; a USGS DEM by its first record; SRTM by its length. What an archive may unpack to is
//! bounded by [`MAX_UNPACKED_BYTES`] whatever it declares.

use super::raster::{Raster, Unreadable};
use super::{geotiff, hgt, png, usgs_dem};
use flate2::read::MultiGzDecoder;
use std::io::{Cursor, Read};
use std::path::Path;

/// Most bytes that an archive's file may have: ten times the largest SRTM tile.
pub const MAX_UNPACKED_BYTES: u64 = 1 << 28;

/// Largest file read: 4 GiB, where a TIFF ends.
const MAX_FILE_BYTES: u64 = 1 << 32;

/// Reads a file of heights in any of the known formats.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn open(path: &Path) -> Result<Raster, Unreadable> {
    let refused = |e: std::io::Error| Unreadable::new("a readable file", e.to_string());
    let length = std::fs::metadata(path).map_err(refused)?.len();
    if length > MAX_FILE_BYTES {
        return Err(Unreadable::new(format!("at most {MAX_FILE_BYTES} bytes"), length.to_string()));
    }
    let bytes = std::fs::read(path).map_err(refused)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let world_file = bytes.starts_with(png::SIGNATURE).then(|| world_file(path)).flatten();
    read(&bytes, &name, world_file.as_deref())
}

/// Reads the bytes of a file of that name; `world_file` is the text beside a picture.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(bytes: &[u8], name: &str, world_file: Option<&str>) -> Result<Raster, Unreadable> {
    if bytes.starts_with(b"PK\x03\x04") {
        let (inner, inner_name) = unzip(bytes)?;
        return read_plain(&inner, &inner_name, world_file);
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let inner = bounded(MultiGzDecoder::new(bytes))?;
        return read_plain(&inner, name.strip_suffix(".gz").unwrap_or(name), world_file);
    }
    read_plain(bytes, name, world_file)
}

fn read_plain(bytes: &[u8], name: &str, world_file: Option<&str>) -> Result<Raster, Unreadable> {
    match bytes {
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => geotiff::read(bytes),
        _ if bytes.starts_with(png::SIGNATURE) => png::read(bytes, world_file),
        _ if usgs_dem::looks_like(bytes) => usgs_dem::read(bytes),
        _ if hgt::side(bytes.len()).is_some() || name.to_ascii_lowercase().ends_with(".hgt") => hgt::read(bytes, name),
        _ => Err(Unreadable::new(
            "GeoTIFF, SRTM .hgt, USGS .dem or grey PNG, perhaps in a zip or gzip",
            format!(
                "{} bytes that begin with {:02x?}",
                bytes.len(),
                bytes.get(..bytes.len().min(8)).unwrap_or_default()
            ),
        )),
    }
}

/// The first file of a zip that may hold heights, and its name.
fn unzip(bytes: &[u8]) -> Result<(Vec<u8>, String), Unreadable> {
    let damaged = |e: zip::result::ZipError| Unreadable::new("an undamaged zip", e.to_string());
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let holds_heights = |name: &str| {
        let name = name.to_ascii_lowercase();
        [".hgt", ".tif", ".tiff", ".dem", ".png"].iter().any(|end| name.ends_with(end))
    };
    let found = (0..archive.len())
        .find(|&i| archive.name_for_index(i).is_some_and(|name| name.is_ok_and(|name| holds_heights(&name))));
    let Some(index) = found else {
        let found = format!("{} others", archive.len());
        return Err(Unreadable::new("a .hgt, .tif, .dem or .png in the zip", found));
    };
    let file = archive.by_index(index).map_err(damaged)?;
    let name = file.name().map_err(damaged)?.into_owned();
    Ok((bounded(file)?, name))
}

/// All bytes of a stream, unless there are too many.
fn bounded(stream: impl Read) -> Result<Vec<u8>, Unreadable> {
    let mut bytes = Vec::new();
    stream
        .take(MAX_UNPACKED_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| Unreadable::new("an undamaged archive", e.to_string()))?;
    if bytes.len() as u64 > MAX_UNPACKED_BYTES {
        return Err(Unreadable::new(format!("at most {MAX_UNPACKED_BYTES} bytes in the archive"), "more"));
    }
    Ok(bytes)
}

/// The text of the world file beside a picture.
fn world_file(path: &Path) -> Option<String> {
    ["pgw", "pngw", "wld", "PGW", "WLD"].iter().find_map(|extension| {
        let file = std::fs::File::open(path.with_extension(extension)).ok()?;
        let mut text = String::new();
        file.take(4096).read_to_string(&mut text).ok()?;
        Some(text)
    })
}
