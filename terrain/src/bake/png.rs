//! 8 or 16 bit grey PNG with a world file: heights as whole metres, or in the unit that the height scale gives.
//!
//! A world file (`.pgw`, `.wld`, `.pngw`) is six numbers, one a line: east per column, north per column, east per row,
//! north per row, and the *centre* of the first pixel, here in degrees of longitude and latitude on WGS84.

use super::crs::{Crs, DATUM_WGS84};
use super::raster::{Affine, MAX_SAMPLES, Raster, Unreadable};
use glam::DVec2;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};
use std::io::Cursor;

/// A PNG's own signature.
pub const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Reads heights; `world_file` is the text beside the picture.
///
/// # Errors
/// [`Unreadable`] if there is no world file, either is damaged, or the picture is not grey.
pub fn read(bytes: &[u8], world_file: Option<&str>) -> Result<Raster, Unreadable> {
    let Some(text) = world_file else {
        return Err(Unreadable::new("a world file (.pgw, .pngw or .wld) beside the PNG", "none"));
    };
    let affine = parse_world_file(text)?;
    let damaged = |e: image::ImageError| Unreadable::new("an undamaged PNG", e.to_string());
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MAX_SAMPLES * 2);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (columns, rows) = decoder.dimensions();
    // Deflate packs at most 1032 to 1.
    let most = MAX_SAMPLES.min(1100 * bytes.len() as u64);
    if u64::from(columns) * u64::from(rows) > most {
        let found = format!("{columns} x {rows}");
        return Err(Unreadable::new(format!("at most {most} samples in {} bytes", bytes.len()), found));
    }
    let samples: Vec<f32> = match DynamicImage::from_decoder(decoder).map_err(damaged)? {
        DynamicImage::ImageLuma16(grey) => grey.into_raw().into_iter().map(f32::from).collect(),
        DynamicImage::ImageLuma8(grey) => grey.into_raw().into_iter().map(f32::from).collect(),
        other => return Err(Unreadable::new("a grey PNG of 8 or 16 bits", format!("{:?}", other.color()))),
    };
    Raster::new((columns as usize, rows as usize), samples, affine, Crs::Geographic(DATUM_WGS84), "PNG")
}

pub(super) fn parse_world_file(text: &str) -> Result<Affine, Unreadable> {
    let numbers: Vec<f64> = text.split_whitespace().take(7).map_while(|t| t.parse().ok()).collect();
    let [a, d, b, e, c, f] = numbers[..] else {
        return Err(Unreadable::new("six numbers in the world file", format!("{}", numbers.len())));
    };
    let affine = Affine { origin: DVec2::new(c, f), right: DVec2::new(a, d), down: DVec2::new(b, e) };
    Ok(affine.from_centre())
}
