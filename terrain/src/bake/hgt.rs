//! SRTM `.hgt`: big-endian 16 bit metres, one degree square, 1201 or 3601 samples a side, void -32768.
//!
//! The samples stand on the degree lines, so neighbours share a row or column; the file's name gives the south-west
//! *sample*. Heights are above the EGM96 geoid, places on WGS84.
//!
//! Source: USGS, SRTM Topography (SRTM_Topo.pdf), section 3.1.

use super::crs::{Crs, DATUM_WGS84};
use super::raster::{Affine, Raster, Unreadable};
use glam::DVec2;

const VOID: i16 = -32_768;

/// Samples a side of a file of that many bytes.
pub fn side(bytes: usize) -> Option<usize> {
    [1201, 3601].into_iter().find(|n| n * n * 2 == bytes)
}

/// South-west sample, latitude and longitude in degrees, from a name such as `N43E007.hgt`.
pub fn corner_deg(name: &str) -> Option<(f64, f64)> {
    let stem = name.rsplit(['/', '\\']).next()?.get(..7)?;
    let number = |range: std::ops::Range<usize>| -> Option<f64> {
        stem.get(range).filter(|t| t.bytes().all(|b| b.is_ascii_digit()))?.parse().ok()
    };
    let sign = |at: usize, plus: u8, minus: u8| -> Option<f64> {
        match stem.as_bytes()[at].to_ascii_uppercase() {
            letter if letter == plus => Some(1.0),
            letter if letter == minus => Some(-1.0),
            _ => None,
        }
    };
    let lat: f64 = sign(0, b'N', b'S')? * number(1..3)?;
    let lon: f64 = sign(3, b'E', b'W')? * number(4..7)?;
    (lat.abs() <= 90.0 && lon.abs() <= 180.0).then_some((lat, lon))
}

/// Reads a tile; `name` is the file's.
///
/// # Errors
/// [`Unreadable`] if the length is not a tile's or the name not a corner's.
pub fn read(bytes: &[u8], name: &str) -> Result<Raster, Unreadable> {
    let side = side(bytes.len()).ok_or_else(|| {
        Unreadable::new("2884802 or 25934402 bytes (1201 or 3601 samples a side)", format!("{}", bytes.len()))
    })?;
    let (lat, lon) = corner_deg(name)
        .ok_or_else(|| Unreadable::new("a name that gives the south-west corner, as N43E007.hgt", name))?;
    let samples = bytes
        .chunks_exact(2)
        .map(|b| i16::from_be_bytes([b[0], b[1]]))
        .map(|h| if h == VOID { f32::NAN } else { f32::from(h) })
        .collect();
    let size = 1.0 / (side - 1) as f64;
    let affine = Affine::north_up(lon, lat + 1.0, DVec2::splat(size)).from_centre();
    let mut raster = Raster::new((side, side), samples, affine, Crs::Geographic(DATUM_WGS84), "SRTM .hgt")?;
    raster.credit = Some("SRTM, NASA and USGS".into());
    Ok(raster)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_gives_the_corner() {
        assert_eq!(corner_deg("N43E007.hgt"), Some((43.0, 7.0)));
        assert_eq!(corner_deg("dir/s29w072.HGT.zip"), Some((-29.0, -72.0)));
        for bad in ["", "N43", "X43E007.hgt", "N4xE007.hgt", "N43E999.hgt", "N+3E007.hgt", "№43E007"] {
            assert_eq!(corner_deg(bad), None, "{bad}");
        }
    }
}
