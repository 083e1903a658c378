//! USGS ASCII DEM (`.dem`, the old 1024-byte-record format): profiles from south to north, one after another eastward.
//!
//! Read: UTM and longitude-latitude (arc seconds), heights in metres or feet, NAD27, NAD83, WGS72 and WGS84. NAD27 is
//! tied to WGS84 by a mean shift without grids: +-10 m in plan. Samples stand on points; profiles of a UTM sheet start
//! and end where the sheet does, and what they leave of the rectangle is void.
//!
//! Source: USGS, Standards for Digital Elevation Models, part 2: Specifications, 1998, appendix 2-A to 2-C.

use super::crs::{Crs, DATUM_NAD27, DATUM_NAD83, DATUM_WGS72, DATUM_WGS84};
use super::raster::{Affine, Raster, Unreadable};
use glam::DVec2;

const RECORD: usize = 1024;
const VOID: i64 = -32_767;

/// Whether the bytes look like a type A record: text, and small whole numbers where the level and the units stand.
pub fn looks_like(bytes: &[u8]) -> bool {
    bytes.len() >= RECORD
        && bytes[..864].iter().all(|b| (0x20..0x7f).contains(b))
        && whole(bytes, 144, 6).is_some_and(|level| (1..=4).contains(&level))
        && whole(bytes, 528, 6).is_some_and(|unit| (0..=3).contains(&unit))
}

/// A profile: where it starts and its heights in units of the vertical resolution.
struct Profile {
    start: DVec2,
    base: f64,
    heights: Vec<Option<i64>>,
}

/// Reads a sheet.
///
/// # Errors
/// [`Unreadable`] names the field of the record that is not as it must be.
pub fn read(bytes: &[u8]) -> Result<Raster, Unreadable> {
    if !looks_like(bytes) {
        return Err(Unreadable::new("a type A record of 1024 characters", "something else"));
    }
    let crs = crs(bytes)?;
    let to_degrees = if matches!(crs, Crs::Geographic(_)) { 1.0 / 3600.0 } else { 1.0 };
    let vertical_m = match whole(bytes, 534, 6) {
        Some(1) => 0.3048,
        Some(2) => 1.0,
        other => return Err(field("height unit (1 feet, 2 metres)", other)),
    };
    let spacing = |at| real(bytes, at, 12).filter(|s| *s > 0.0 && s.is_finite());
    let (Some(dx), Some(dy), Some(dz)) = (spacing(816), spacing(828), spacing(840)) else {
        return Err(Unreadable::new("a resolution in x, y and z above 0", "none"));
    };
    let count = whole(bytes, 858, 6).filter(|n| (1..=100_000).contains(n));
    let Some(count) = count else { return Err(field("number of profiles", whole(bytes, 858, 6))) };

    let mut at = RECORD;
    let mut profiles = Vec::new();
    for number in 1..=count {
        let profile = profile(bytes, &mut at)
            .ok_or_else(|| Unreadable::new(format!("profile {number} of {count}"), "a damaged or missing record"))?;
        profiles.push(profile);
    }
    assemble(&profiles, DVec2::new(dx, dy), dz, vertical_m, crs, to_degrees)
}

/// Lays the profiles into the rectangle that holds them.
fn assemble(
    profiles: &[Profile],
    size: DVec2,
    dz: f64,
    vertical_m: f64,
    crs: Crs,
    to_degrees: f64,
) -> Result<Raster, Unreadable> {
    let low = profiles.iter().map(|p| p.start).fold(DVec2::INFINITY, DVec2::min);
    let high = profiles
        .iter()
        .map(|p| p.start + DVec2::new(0.0, (p.heights.len() as f64 - 1.0) * size.y))
        .fold(DVec2::NEG_INFINITY, DVec2::max);
    let span = ((high - low) / size).round() + 1.0;
    let samples: usize = profiles.iter().map(|p| p.heights.len()).sum();
    // A sheet is a slightly turned rectangle: most of its bounding rectangle has samples.
    let most = samples as f64 * 20.0 + 10_000.0;
    if !(span.x >= 1.0 && span.y >= 1.0 && span.x * span.y <= most) {
        let found = format!("{} x {} samples for {samples}", span.x, span.y);
        return Err(Unreadable::new("profiles that lie side by side", found));
    }
    let (columns, rows) = (span.x as usize, span.y as usize);
    let mut heights_m = vec![f32::NAN; columns * rows];
    for profile in profiles {
        let offset = ((profile.start - low) / size).round();
        for (i, height) in profile.heights.iter().enumerate() {
            let row = rows - 1 - (offset.y as usize + i).min(rows - 1);
            if let Some(height) = height {
                let metres = (*height as f64 * dz + profile.base) * vertical_m;
                heights_m[row * columns + offset.x as usize] = metres as f32;
            }
        }
    }
    let affine = Affine::north_up(low.x * to_degrees, high.y * to_degrees, size * to_degrees).from_centre();
    let mut raster = Raster::new((columns, rows), heights_m, affine, crs, "USGS DEM")?;
    raster.credit = Some("USGS".into());
    Ok(raster)
}

fn crs(bytes: &[u8]) -> Result<Crs, Unreadable> {
    let datum = match whole(bytes, 890, 2) {
        // Blank or 0 in sheets older than the field.
        None | Some(0 | 1) => DATUM_NAD27,
        Some(2) => DATUM_WGS72,
        Some(3) => DATUM_WGS84,
        Some(4) => DATUM_NAD83,
        other => return Err(field("horizontal datum (1 to 4)", other)),
    };
    match (whole(bytes, 156, 6), whole(bytes, 162, 6), whole(bytes, 528, 6)) {
        (Some(0), _, Some(3)) => Ok(Crs::Geographic(datum)),
        (Some(1), Some(zone), Some(2)) if (1..=60).contains(&zone.abs()) => {
            Ok(Crs::utm(zone.unsigned_abs() as u32, zone < 0, datum))
        }
        (system, zone, unit) => Err(Unreadable::new(
            "system 0 in arc seconds or 1 (UTM) in metres with a zone of 1 to 60",
            format!("system {}, zone {}, unit {}", shown(system), shown(zone), shown(unit)),
        )),
    }
}

/// The type B record at `at`, which moves to the next one.
fn profile(bytes: &[u8], at: &mut usize) -> Option<Profile> {
    /// Characters of the record's head, and heights of six characters in the first block and in the others.
    const HEAD: usize = 144;
    const FIRST: usize = (RECORD - HEAD) / 6;
    const NEXT: usize = RECORD / 6;
    let head = bytes.get(*at..)?;
    let count = usize::try_from(whole(head, 12, 6)?).ok().filter(|n| (1..=100_000).contains(n))?;
    let start = DVec2::new(real(head, 24, 24)?, real(head, 48, 24)?);
    let base = real(head, 72, 24).unwrap_or(0.0);
    let mut heights = Vec::with_capacity(count.min(head.len() / 6 + 1));
    for i in 0..count {
        let place = if i < FIRST { HEAD + 6 * i } else { RECORD * (1 + (i - FIRST) / NEXT) + 6 * ((i - FIRST) % NEXT) };
        let height = whole(head, place, 6)?;
        heights.push((height > VOID).then_some(height));
    }
    let blocks = 1 + count.saturating_sub(FIRST).div_ceil(NEXT);
    *at += RECORD * blocks;
    (start.is_finite() && base.is_finite()).then_some(Profile { start, base, heights })
}

fn characters(bytes: &[u8], at: usize, length: usize) -> Option<&str> {
    std::str::from_utf8(bytes.get(at..at + length)?).ok().map(str::trim)
}

fn whole(bytes: &[u8], at: usize, length: usize) -> Option<i64> {
    characters(bytes, at, length)?.parse().ok()
}

/// A Fortran number: its exponent may be a D.
fn real(bytes: &[u8], at: usize, length: usize) -> Option<f64> {
    characters(bytes, at, length)?.replace(['D', 'd'], "E").parse().ok()
}

fn field(name: &str, found: Option<i64>) -> Unreadable {
    Unreadable::new(format!("{name} in the type A record"), shown(found))
}

fn shown(found: Option<i64>) -> String {
    found.map_or("no number".into(), |n| n.to_string())
}
