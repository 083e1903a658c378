//! Photographs: GeoTIFF with red, green, blue and perhaps alpha of 8 bits, PNG or JPEG with a world file.
//!
//! Where they lie is read as for heights ([`super::geotiff`], [`super::png`]). Colours are sRGB as written; a pixel
//! with alpha below one half shows nothing.

use super::crs::{Crs, DATUM_WGS84};
use super::geotiff;
use super::mosaic::pixel_m;
use super::png::parse_world_file;
use super::raster::{MAX_SAMPLES, Raster, Unreadable};
use crate::projection::Projection;
use crate::store::ImageryInfo;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::{Cursor, Read};
use std::path::Path;

/// Largest file read.
const MAX_FILE_BYTES: u64 = 1 << 32;

/// A photograph.
#[derive(Debug)]
pub struct Photo {
    /// Where it lies; without samples.
    pub place: Raster,
    /// Row by row.
    pub pixels: Vec<[u8; 4]>,
}

impl Photo {
    /// Pixels at a place.
    ///
    /// # Errors
    /// [`Unreadable`] as [`Raster::new`].
    pub fn new(place: Raster, pixels: Vec<[u8; 4]>) -> Result<Self, Unreadable> {
        let place = place.checked()?;
        if place.columns == 0 || place.rows == 0 || place.columns.checked_mul(place.rows) != Some(pixels.len()) {
            let found = format!("{} for {} x {}", pixels.len(), place.columns, place.rows);
            return Err(Unreadable::new("as many pixels as the size needs, at least one", found));
        }
        Ok(Self { place, pixels })
    }

    /// As a world's description has it.
    pub(super) fn described(&self, projection: &Projection, path: &Path) -> ImageryInfo {
        ImageryInfo {
            file: path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            format: self.place.format.into(),
            system: self.place.crs.name(),
            columns: self.place.columns,
            rows: self.place.rows,
            pixel_m: pixel_m(projection, &self.place).to_array(),
            credit: self.place.credit.clone().unwrap_or_default(),
        }
    }
}

/// Reads a photograph in any of the known formats.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn open(path: &Path) -> Result<Photo, Unreadable> {
    let refused = |e: std::io::Error| Unreadable::new("a readable file", e.to_string());
    let mut bytes = Vec::new();
    std::fs::File::open(path).map_err(refused)?.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(refused)?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(Unreadable::new(format!("at most {MAX_FILE_BYTES} bytes"), "more"));
    }
    let beside = ["pgw", "pngw", "jgw", "jpgw", "jpegw", "wld", "PGW", "JGW", "WLD"].iter().find_map(|extension| {
        let file = std::fs::File::open(path.with_extension(extension)).ok()?;
        let mut text = String::new();
        file.take(4096).read_to_string(&mut text).ok()?;
        Some(text)
    });
    read(&bytes, beside.as_deref())
}

/// Reads a photograph's bytes; `world_file` is the text beside it.
///
/// # Errors
/// [`Unreadable`] says what was expected and found.
pub fn read(bytes: &[u8], world_file: Option<&str>) -> Result<Photo, Unreadable> {
    match bytes {
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => geotiff::read_photo(bytes),
        [0x89, b'P', b'N', b'G', ..] => picture(bytes, ImageFormat::Png, "PNG", world_file),
        [0xff, 0xd8, 0xff, ..] => picture(bytes, ImageFormat::Jpeg, "JPEG", world_file),
        _ => Err(Unreadable::new(
            "GeoTIFF of red, green, blue, or PNG or JPEG with a world file",
            format!(
                "{} bytes that begin with {:02x?}",
                bytes.len(),
                bytes.get(..bytes.len().min(8)).unwrap_or_default()
            ),
        )),
    }
}

fn picture(
    bytes: &[u8],
    format: ImageFormat,
    name: &'static str,
    world_file: Option<&str>,
) -> Result<Photo, Unreadable> {
    let Some(text) = world_file else {
        return Err(Unreadable::new(format!("a world file (.pgw, .jgw or .wld) beside the {name}"), "none"));
    };
    let affine = parse_world_file(text)?;
    let damaged = |e: image::ImageError| Unreadable::new(format!("an undamaged {name}"), e.to_string());
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_SAMPLES * 4);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (columns, rows) = decoder.dimensions();
    // Deflate packs at most 1032 to 1; a JPEG's emptiest block of 64 pixels takes some bits.
    let most = MAX_SAMPLES.min(1100 * bytes.len() as u64);
    if u64::from(columns) * u64::from(rows) > most {
        let found = format!("{columns} x {rows}");
        return Err(Unreadable::new(format!("at most {most} pixels in {} bytes", bytes.len()), found));
    }
    let pixels = DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgba8().pixels().map(|p| p.0).collect();
    let place = Raster {
        columns: columns as usize,
        rows: rows as usize,
        samples_m: Vec::new(),
        affine,
        crs: Crs::Geographic(DATUM_WGS84),
        format: name,
        credit: None,
    };
    Photo::new(place, pixels)
}
