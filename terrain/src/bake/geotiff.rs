//! GeoTIFF: heights in the first band of the first image.
//!
//! Read: strips and tiles, 8 to 64 bit integers and 32 or 64 bit floats, uncompressed, deflate or LZW with their
//! predictors (by the `tiff` crate); pixel scale and tie point or a full transformation; pixel-is-area and
//! pixel-is-point; longitude and latitude, UTM and other transverse Mercator maps; `GDAL_NODATA`; vertical units of
//! feet. Refused by name: other projections, other units, ground control points.
//!
//! Sizes are checked against the file's length before anything is allocated.
//!
//! Source: OGC 19-008r4, GeoTIFF Standard 1.1, 2019.

use super::crs::{Crs, DATUM_WGS84, Datum, geographic_datum};
use super::photo::Photo;
use super::raster::{Affine, MAX_SAMPLES, Raster, Unreadable};
use crate::projection::{Geodetic, TransverseMercator};
use glam::DVec2;
use std::io::Cursor;
use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;

/// No deflate or LZW stream unpacks to more than this many times its length (deflate 1032, LZW about 2730).
const MAX_UNPACKING: u64 = 3000;

/// What 16 bit writers put where they have nothing, when they do not say so; no place on Earth is so low.
const UNDECLARED_NO_DATA: [f32; 2] = [-32_768.0, -32_767.0];

type Bytes<'a> = Decoder<Cursor<&'a [u8]>>;

/// Reads the first band.
///
/// # Errors
/// [`Unreadable`] says what in the file is not as it must be.
pub fn read(bytes: &[u8]) -> Result<Raster, Unreadable> {
    let damaged = |e: tiff::TiffError| Unreadable::new("an undamaged TIFF", e.to_string());
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(damaged)?;
    let (columns, rows) = decoder.dimensions().map_err(damaged)?;
    let bits = first_u32(&mut decoder, Tag::BitsPerSample)?.unwrap_or(1);
    let bands = first_u32(&mut decoder, Tag::SamplesPerPixel)?.unwrap_or(1).max(1);
    let image_bytes = check_size(bytes.len(), columns, rows, bands, bits)?;
    let most = usize::try_from(image_bytes.saturating_mul(4)).unwrap_or(usize::MAX).saturating_add(1 << 24);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    limits.ifd_value_size = bytes.len().min(1 << 27);
    decoder = decoder.with_limits(limits);

    let keys = GeoKeys::read(&mut decoder)?;
    let crs = keys.crs()?;
    let affine = georeference(&mut decoder, keys.pixel_is_point())?;
    let scale = keys.vertical_unit_m()?;
    let no_data = match text(&mut decoder, Tag::GdalNodata).and_then(|t| t.trim().parse::<f64>().ok()) {
        Some(declared) => vec![declared as f32],
        None => UNDECLARED_NO_DATA.to_vec(),
    };
    let samples = first_band(&mut decoder, (columns as usize, rows as usize), bands as usize, &no_data, scale)?;
    let mut raster = Raster::new((columns as usize, rows as usize), samples, affine, crs, "GeoTIFF")?;
    raster.credit = credit(&mut decoder);
    Ok(raster)
}

/// Reads red, green, blue and perhaps alpha of 8 bits; also the luminance and colour differences that JPEG has in their
/// place. Bands beyond them (infrared) are left out. What equals `GDAL_NODATA` in all three shows nothing.
///
/// # Errors
/// [`Unreadable`] says what in the file is not as it must be.
pub fn read_photo(bytes: &[u8]) -> Result<Photo, Unreadable> {
    let damaged = |e: tiff::TiffError| Unreadable::new("an undamaged TIFF", e.to_string());
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(damaged)?;
    let (columns, rows) = decoder.dimensions().map_err(damaged)?;
    let bits = first_u32(&mut decoder, Tag::BitsPerSample)?.unwrap_or(1);
    let bands = first_u32(&mut decoder, Tag::SamplesPerPixel)?.unwrap_or(1).max(1);
    let planar = first_u32(&mut decoder, Tag::PlanarConfiguration)? == Some(2);
    let colour = decoder.colortype().map_err(damaged)?;
    let (samples, luminance) = match colour {
        ColorType::RGB(8) if !planar => (3, false),
        ColorType::YCbCr(8) if !planar => (3, true),
        ColorType::RGBA(8) if !planar => (4, false),
        _ => {
            return Err(Unreadable::new(
                "red, green, blue and perhaps alpha of 8 bits, pixel by pixel",
                format!("{bands} bands, {colour:?}{}", if planar { ", band by band" } else { "" }),
            ));
        }
    };
    let image_bytes = check_size(bytes.len(), columns, rows, bands, bits)?;
    let most = usize::try_from(image_bytes).unwrap_or(usize::MAX).saturating_add(1 << 24);
    let mut limits = Limits::default();
    limits.decoding_buffer_size = most;
    limits.intermediate_buffer_size = most;
    limits.ifd_value_size = bytes.len().min(1 << 27);
    decoder = decoder.with_limits(limits);
    let keys = GeoKeys::read(&mut decoder)?;
    let place = Raster {
        columns: columns as usize,
        rows: rows as usize,
        samples_m: Vec::new(),
        affine: georeference(&mut decoder, keys.pixel_is_point())?,
        crs: keys.crs()?,
        format: "GeoTIFF",
        credit: credit(&mut decoder),
    };
    let no_data = text(&mut decoder, Tag::GdalNodata).and_then(|t| t.trim().parse::<f64>().ok());
    let pixels = match decoder.read_image().map_err(damaged)? {
        DecodingResult::U8(all) => {
            let colour = |p: &[u8]| if luminance { red_green_blue([p[0], p[1], p[2]]) } else { [p[0], p[1], p[2]] };
            let pixel = |p: &[u8]| {
                let [r, g, b] = colour(p);
                let nothing = no_data.is_some_and(|none| [r, g, b].iter().all(|c| f64::from(*c) == none));
                [r, g, b, if nothing { 0 } else { p.get(3).copied().unwrap_or(255) }]
            };
            all.chunks_exact(samples).map(pixel).collect()
        }
        _ => return Err(Unreadable::new("colours of 8 bits", "others")),
    };
    Photo::new(place, pixels)
}

/// Colours of luminance and colour differences of the full range (JFIF 1.02; coefficients of ITU-R BT.601).
fn red_green_blue([y, blue, red]: [u8; 3]) -> [u8; 3] {
    let (y, blue, red) = (f32::from(y), f32::from(blue) - 128.0, f32::from(red) - 128.0);
    // A cast saturates.
    [y + 1.402 * red, y - 0.344_136 * blue - 0.714_136 * red, y + 1.772 * blue].map(|c| c.round() as u8)
}

/// Bytes of the whole image, if so many can be in a file of that length.
fn check_size(file: usize, columns: u32, rows: u32, bands: u32, bits: u32) -> Result<u64, Unreadable> {
    let samples = u64::from(columns) * u64::from(rows);
    let image_bytes = samples.saturating_mul(u64::from(bands)).saturating_mul(u64::from(bits.max(8)) / 8);
    let plausible = (file as u64).saturating_mul(MAX_UNPACKING);
    if samples == 0 || samples > MAX_SAMPLES || image_bytes > plausible {
        return Err(Unreadable::new(
            format!("1..={MAX_SAMPLES} samples, no more than a file of {file} bytes can hold"),
            format!("{columns} x {rows} samples in {bands} bands of {bits} bits"),
        ));
    }
    Ok(image_bytes)
}

fn first_band(
    decoder: &mut Bytes,
    (columns, rows): (usize, usize),
    bands: usize,
    no_data: &[f32],
    scale: f32,
) -> Result<Vec<f32>, Unreadable> {
    let damaged = |e: tiff::TiffError| Unreadable::new("undamaged samples", e.to_string());
    let planar = first_u32(decoder, Tag::PlanarConfiguration)? == Some(2);
    let stride = if planar { 1 } else { bands };
    let (chunk_columns, chunk_rows) = decoder.chunk_dimensions();
    let (chunk_columns, chunk_rows) = (chunk_columns as usize, chunk_rows as usize);
    if chunk_columns == 0 || chunk_rows == 0 {
        return Err(Unreadable::new("strips or tiles of at least one sample", "empty ones"));
    }
    // tiff 0.11 turns the bytes of predicted floats once too often in big-endian files.
    let predicted = first_u32(decoder, Tag::Predictor)? == Some(3);
    let swapped = predicted && decoder.byte_order() == tiff::tags::ByteOrder::BigEndian;
    let across = columns.div_ceil(chunk_columns);
    let mut samples = vec![f32::NAN; columns * rows];
    for chunk in 0..across * rows.div_ceil(chunk_rows) {
        let number = u32::try_from(chunk).map_err(|_| Unreadable::new("fewer strips or tiles", chunk.to_string()))?;
        // Read first: it answers a bad number with an error, the dimensions with a panic.
        let mut decoded = decoder.read_chunk(number).map_err(damaged)?;
        if swapped {
            swap_floats(&mut decoded);
        }
        let heights = heights(decoded, stride, no_data, scale)?;
        let (width, height) = decoder.chunk_data_dimensions(number);
        let (width, height) = (width as usize, height as usize);
        let (left, top) = (chunk % across * chunk_columns, chunk / across * chunk_rows);
        if heights.len() < width * height || left + width > columns || top + height > rows {
            return Err(Unreadable::new(
                "strips or tiles that fill the image",
                format!("{width} x {height} at {left}, {top}"),
            ));
        }
        for row in 0..height {
            let to = (top + row) * columns + left;
            samples[to..to + width].copy_from_slice(&heights[row * width..(row + 1) * width]);
        }
    }
    Ok(samples)
}

fn swap_floats(chunk: &mut DecodingResult) {
    match chunk {
        DecodingResult::F32(v) => v.iter_mut().for_each(|v| *v = f32::from_bits(v.to_bits().swap_bytes())),
        DecodingResult::F64(v) => v.iter_mut().for_each(|v| *v = f64::from_bits(v.to_bits().swap_bytes())),
        _ => {}
    }
}

/// Every `stride`-th sample as metres; what equals a no-data value as NaN.
fn heights(chunk: DecodingResult, stride: usize, no_data: &[f32], scale: f32) -> Result<Vec<f32>, Unreadable> {
    macro_rules! taken {
        ($values:expr) => {
            $values
                .iter()
                .step_by(stride)
                // The no-data value is compared in the samples' own type: 32 bit floats print to fewer digits.
                .map(|&v| v as f32)
                .map(|h| if no_data.iter().any(|n| *n == h) { f32::NAN } else { h * scale })
                .collect()
        };
    }
    Ok(match chunk {
        DecodingResult::U8(v) => taken!(v),
        DecodingResult::I8(v) => taken!(v),
        DecodingResult::U16(v) => taken!(v),
        DecodingResult::I16(v) => taken!(v),
        DecodingResult::U32(v) => taken!(v),
        DecodingResult::I32(v) => taken!(v),
        DecodingResult::U64(v) => taken!(v),
        DecodingResult::I64(v) => taken!(v),
        DecodingResult::F32(v) => taken!(v),
        DecodingResult::F64(v) => taken!(v),
        DecodingResult::F16(_) => return Err(Unreadable::new("integers, 32 or 64 bit floats", "16 bit floats")),
    })
}

fn georeference(decoder: &mut Bytes, pixel_is_point: bool) -> Result<Affine, Unreadable> {
    let affine = if let Some(m) = doubles(decoder, Tag::ModelTransformationTag)?.filter(|m| m.len() >= 8) {
        Affine { origin: DVec2::new(m[3], m[7]), right: DVec2::new(m[0], m[4]), down: DVec2::new(m[1], m[5]) }
    } else {
        let scale = doubles(decoder, Tag::ModelPixelScaleTag)?.filter(|s| s.len() >= 2);
        let tie = doubles(decoder, Tag::ModelTiepointTag)?.filter(|t| t.len() >= 6);
        let (Some(scale), Some(tie)) = (scale, tie) else {
            return Err(Unreadable::new(
                "a pixel scale and a tie point, or a transformation",
                "none (a plain TIFF, or one with ground control points)",
            ));
        };
        let size = DVec2::new(scale[0], scale[1]);
        Affine::north_up(tie[3] - tie[0] * size.x, tie[4] + tie[1] * size.y, size)
    };
    Ok(if pixel_is_point { affine.from_centre() } else { affine })
}

/// The GeoTIFF keys.
struct GeoKeys {
    shorts: Vec<(u16, u16)>,
    doubles: Vec<(u16, f64)>,
}

const MODEL_TYPE: u16 = 1024;
const RASTER_TYPE: u16 = 1025;
const GEOGRAPHIC_TYPE: u16 = 2048;
const GEODETIC_DATUM: u16 = 2050;
const ANGULAR_UNITS: u16 = 2054;
const PROJECTED_TYPE: u16 = 3072;
const PROJECTION: u16 = 3074;
const COORDINATE_TRANSFORMATION: u16 = 3075;
const LINEAR_UNITS: u16 = 3076;
const ORIGIN_LON: u16 = 3080;
const ORIGIN_LAT: u16 = 3081;
const FALSE_EASTING: u16 = 3082;
const FALSE_NORTHING: u16 = 3083;
const ORIGIN_SCALE: u16 = 3092;
const VERTICAL_UNITS: u16 = 4099;
const USER_DEFINED: u16 = 32_767;
const METRE: u16 = 9001;
const DEGREE: u16 = 9102;

impl GeoKeys {
    fn read(decoder: &mut Bytes) -> Result<Self, Unreadable> {
        let missing = || Unreadable::new("GeoTIFF keys", "none (a plain TIFF)");
        let directory = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).map_err(|_| missing())?;
        let parameters = doubles(decoder, Tag::GeoDoubleParamsTag)?.unwrap_or_default();
        let mut keys = Self { shorts: Vec::new(), doubles: Vec::new() };
        for entry in directory.get(4..).unwrap_or_default().chunks_exact(4) {
            match entry[1] {
                0 => keys.shorts.push((entry[0], entry[3])),
                34_736 => keys.doubles.extend(parameters.get(usize::from(entry[3])).map(|&v| (entry[0], v))),
                _ => {}
            }
        }
        Ok(keys)
    }

    fn short(&self, key: u16) -> Option<u16> {
        self.shorts.iter().find(|(k, _)| *k == key).map(|(_, v)| *v)
    }

    fn double(&self, key: u16) -> Option<f64> {
        self.doubles.iter().find(|(k, _)| *k == key).map(|(_, v)| *v)
    }

    fn pixel_is_point(&self) -> bool {
        self.short(RASTER_TYPE) == Some(2)
    }

    fn vertical_unit_m(&self) -> Result<f32, Unreadable> {
        match self.short(VERTICAL_UNITS) {
            None | Some(0 | 9001 | USER_DEFINED) => Ok(1.0),
            Some(9002) => Ok(0.3048),
            Some(9003) => Ok(1200.0 / 3937.0),
            Some(other) => Err(Unreadable::new("heights in metres or feet", format!("EPSG unit {other}"))),
        }
    }

    fn crs(&self) -> Result<Crs, Unreadable> {
        let projected = match self.short(MODEL_TYPE) {
            Some(1) => true,
            Some(2) => false,
            Some(other) => {
                return Err(Unreadable::new("a projected or geographic model", format!("model type {other}")));
            }
            None => self.short(PROJECTED_TYPE).is_some(),
        };
        if !projected {
            if let Some(unit) = self.short(ANGULAR_UNITS).filter(|unit| ![DEGREE, USER_DEFINED].contains(unit)) {
                return Err(Unreadable::new("degrees", format!("EPSG unit {unit}")));
            }
            return Ok(Crs::Geographic(self.datum()?));
        }
        if let Some(unit) = self.short(LINEAR_UNITS).filter(|unit| ![METRE, USER_DEFINED].contains(unit)) {
            return Err(Unreadable::new("eastings in metres", format!("EPSG unit {unit}")));
        }
        match self.short(PROJECTED_TYPE) {
            Some(code) if code != USER_DEFINED => {
                Crs::from_epsg(u32::from(code)).ok_or_else(|| unsupported(format!("EPSG:{code}")))
            }
            _ => self.user_projection(),
        }
    }

    fn user_projection(&self) -> Result<Crs, Unreadable> {
        let datum = self.datum()?;
        match (self.short(PROJECTION), self.short(COORDINATE_TRANSFORMATION)) {
            (Some(code @ 16_001..=16_060), _) => Ok(Crs::utm(u32::from(code) - 16_000, false, datum)),
            (Some(code @ 16_101..=16_160), _) => Ok(Crs::utm(u32::from(code) - 16_100, true, datum)),
            (_, Some(1)) => {
                let parameter = |key, otherwise| self.double(key).unwrap_or(otherwise);
                let origin = Geodetic::from_degrees(parameter(ORIGIN_LAT, 0.0), parameter(ORIGIN_LON, 0.0));
                let origin_m = DVec2::new(parameter(FALSE_EASTING, 0.0), parameter(FALSE_NORTHING, 0.0));
                let map = TransverseMercator::new(datum.ellipsoid, origin, parameter(ORIGIN_SCALE, 1.0), origin_m);
                let map = Box::new(map);
                Ok(Crs::TransverseMercator { map, datum, name: format!("transverse Mercator {}", datum.name) })
            }
            (_, Some(method)) => Err(unsupported(format!("coordinate transformation {method}"))),
            (_, None) => Err(unsupported("no projection".into())),
        }
    }

    fn datum(&self) -> Result<Datum, Unreadable> {
        let code = match (self.short(GEOGRAPHIC_TYPE), self.short(GEODETIC_DATUM)) {
            (Some(code), _) if code != USER_DEFINED => code,
            // The registry numbers a datum 2000 above its longitude-latitude system.
            (_, Some(code @ 6000..7000)) => code - 2000,
            // Only the projection was named: the habit of writers that mean WGS84.
            (None, None) => return Ok(DATUM_WGS84),
            _ => return Err(Unreadable::new("a known datum", "a user-defined one")),
        };
        geographic_datum(u32::from(code))
            .ok_or_else(|| Unreadable::new("WGS84, WGS72, NAD27, NAD83, ETRS89 or ED50", format!("EPSG:{code}")))
    }
}

fn unsupported(found: String) -> Unreadable {
    Unreadable::new("longitude and latitude, UTM or another transverse Mercator map", found)
}

fn credit(decoder: &mut Bytes) -> Option<String> {
    // GDAL's own metadata, an XML list of items.
    if let Some(xml) = text(decoder, Tag::Unknown(42_112))
        && let Some((_, rest)) = xml.split_once("name=\"SOURCE\"")
        && let Some((_, rest)) = rest.split_once('>')
        && let Some((source, _)) = rest.split_once('<')
    {
        return Some(source.trim().to_owned());
    }
    text(decoder, Tag::Copyright).map(|t| t.trim().to_owned()).filter(|t| !t.is_empty())
}

fn text(decoder: &mut Bytes, tag: Tag) -> Option<String> {
    let value = decoder.find_tag(tag).ok().flatten()?;
    value.into_string().ok().map(|t| t.trim_end_matches('\0').to_owned())
}

fn doubles(decoder: &mut Bytes, tag: Tag) -> Result<Option<Vec<f64>>, Unreadable> {
    let damaged = |e: tiff::TiffError| Unreadable::new(format!("numbers in tag {tag:?}"), e.to_string());
    decoder.find_tag(tag).map_err(damaged)?.map(|v| v.into_f64_vec().map_err(damaged)).transpose()
}

fn first_u32(decoder: &mut Bytes, tag: Tag) -> Result<Option<u32>, Unreadable> {
    let damaged = |e: tiff::TiffError| Unreadable::new(format!("a number in tag {tag:?}"), e.to_string());
    let values = decoder.find_tag_unsigned_vec::<u32>(tag).map_err(damaged)?;
    Ok(values.and_then(|v| v.first().copied()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_must_fit_into_the_file() {
        assert_eq!(check_size(2_000, 100, 10, 1, 16), Ok(2_000));
        // 1 KiB unpacks to at most 3 MB.
        assert!(check_size(1_024, 1_500, 1_000, 1, 16).is_ok());
        assert!(check_size(1_024, 1_600, 1_000, 1, 16).is_err());
        assert!(check_size(usize::MAX, 23_171, 23_171, 1, 16).is_err());
        assert!(check_size(1 << 30, u32::MAX, u32::MAX, u32::MAX, u32::MAX).is_err());
        assert!(check_size(1_024, 0, 10, 1, 16).is_err());
    }
}
