//! Lists of places to look from: TOML files of `[[picture]]` tables. Used by `gallery` and `bench scene`.
//!
//! Each has a `name`; a `time` (ISO); optionally `visibility_m` and `fov_y_deg`; and where from: either `eye` and `look` as
//! `shot` takes them, or `airfield` (its code) with `runway` and `distance_m` (the eye on a 3 degree glide that far before
//! the threshold, looking along it), or `airfield` with `bearing_deg`, `distance_m` and `above_m` (the eye there from the
//! reference point, looking at it).

use crate::failure::Failure;
use crate::scenery;
use crate::still::{self, Standpoint};
use crate::values;
use glam::{DQuat, DVec2, DVec3};
use serde::Deserialize;
use sim::UtcTime;
use std::io::Read;
use std::path::Path;
use terrain::Area;
use terrain::features::model::Airfield;
use terrain::store::World;

/// The list of the embedded world.
const ISSYK_KUL: &str = include_str!("../assets/gallery/issyk_kul.toml");
/// Largest list read.
const MAX_BYTES: u64 = 1 << 20;
/// Most entries of a list.
const MOST: usize = 500;
/// Slope of a normal approach.
const GLIDE_DEG: f64 = 3.0;
/// How high the glide passes over the threshold, metres (the datum height of an ILS, ICAO Annex 10: 15 m).
const THRESHOLD_CROSSING_M: f64 = 15.0;

/// A place with what is particular to its picture.
#[derive(Debug, Clone)]
pub struct Viewpoint {
    /// As the list calls it.
    pub name: String,
    /// Where from and when.
    pub stand: Standpoint,
    /// Visibility, if the list has one, metres.
    pub visibility_m: Option<f64>,
    /// Vertical field of view, if the list has one, radians.
    pub fov_y_rad: Option<f64>,
}

/// A list and where it came from.
#[derive(Debug)]
pub struct Views {
    entries: Vec<Entry>,
    source: String,
}

impl Views {
    /// Reads a list; without a path the embedded world's.
    ///
    /// # Errors
    /// [`Failure::Misuse`] if it cannot be read or is no list.
    pub fn read(path: Option<&Path>) -> Result<Self, Failure> {
        let (text, source) = match path {
            Some(path) => (text(path)?, path.display().to_string()),
            None => (ISSYK_KUL.to_owned(), "the built-in list".to_owned()),
        };
        let wrong = |found: String| Failure::Misuse(format!("{source}: expected a list of pictures, found {found}"));
        let list: List = toml::from_str(&text).map_err(|error| wrong(error.message().to_owned()))?;
        if list.picture.is_empty() || list.picture.len() > MOST {
            return Err(wrong(format!("{} pictures (1 to {MOST} will do)", list.picture.len())));
        }
        Ok(Self { entries: list.picture, source })
    }

    /// All places of the list in a world.
    ///
    /// # Errors
    /// [`Failure::Misuse`] names the entry that has no place there.
    pub fn places(&self, world: &World, area: &Area) -> Result<Vec<Viewpoint>, Failure> {
        let place = |entry: &Entry| {
            let stand = standpoint(entry, world, area)
                .map_err(|found| Failure::Misuse(format!("{}: `{}`: {found}", self.source, entry.name)))?;
            let (visibility_m, fov_y_rad) = (entry.visibility_m, entry.fov_y_deg.map(f64::to_radians));
            Ok(Viewpoint { name: entry.name.clone(), stand, visibility_m, fov_y_rad })
        };
        self.entries.iter().map(place).collect()
    }
}

fn text(path: &Path) -> Result<String, Failure> {
    let failed = |error: std::io::Error| Failure::Misuse(format!("{}: {error}", path.display()));
    let mut text = String::new();
    std::fs::File::open(path).map_err(failed)?.take(MAX_BYTES).read_to_string(&mut text).map_err(failed)?;
    Ok(text)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    picture: Vec<Entry>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    name: String,
    time: Option<String>,
    visibility_m: Option<f64>,
    fov_y_deg: Option<f64>,
    eye: Option<String>,
    look: Option<String>,
    airfield: Option<String>,
    runway: Option<String>,
    bearing_deg: Option<f64>,
    distance_m: Option<f64>,
    above_m: Option<f64>,
}

fn standpoint(entry: &Entry, world: &World, area: &Area) -> Result<Standpoint, String> {
    let time = match &entry.time {
        Some(text) => UtcTime::parse(text).map_err(|error| error.to_string())?,
        None => scenery::default_moment(world),
    };
    for (what, value, range) in [
        ("visibility_m", entry.visibility_m, 100.0..=1e6),
        ("fov_y_deg", entry.fov_y_deg, 1.0..=150.0),
        ("bearing_deg", entry.bearing_deg, -360.0..=360.0),
        ("distance_m", entry.distance_m, 0.0..=1e5),
        ("above_m", entry.above_m, 1.0..=1e5),
    ] {
        if let Some(value) = value.filter(|value| !range.contains(value)) {
            return Err(format!("{what} {value}, which is not within {}..={}", range.start(), range.end()));
        }
    }
    let (eye_m, attitude) = place(entry, world, area)?;
    let heavens = scenery::heavens(world, time).map_err(|error| error.to_string())?;
    Ok(Standpoint { eye_m, attitude, heavens })
}

fn place(entry: &Entry, world: &World, area: &Area) -> Result<(DVec3, DQuat), String> {
    if let (Some(eye), Some(look), None) = (&entry.eye, &entry.look, &entry.airfield) {
        let eye = values::place(eye).map_err(|error| error.to_string())?;
        let look = values::look(look).map_err(|error| error.to_string())?;
        let eye_m = scenery::position(world, area, eye).map_err(|error| error.to_string())?;
        return Ok((eye_m, still::attitude(world, eye_m, look.azimuth_deg, look.elevation_deg)));
    }
    let (Some(code), None, None) = (&entry.airfield, &entry.eye, &entry.look) else {
        return Err("neither `eye` and `look` nor `airfield`".into());
    };
    let Some(airfield) = world.features.airfields.iter().find(|airfield| airfield.code == *code) else {
        let known: Vec<&str> = world.features.airfields.iter().map(|airfield| airfield.code.as_str()).collect();
        return Err(format!("airfield `{code}`, where the world has {}", known.join(" ")));
    };
    let distance_m = entry.distance_m.unwrap_or(3_000.0);
    match &entry.runway {
        Some(runway) => approach(airfield, runway, distance_m),
        None => {
            let true_bearing_rad = entry.bearing_deg.unwrap_or(180.0).to_radians();
            let reference = DVec3::new(airfield.reference.x, airfield.level_m, airfield.reference.y);
            let bearing_rad = scenery::grid_heading_rad(world, reference, true_bearing_rad);
            let eye_m = reference
                + terrain::frame::direction(bearing_rad, 0.0) * distance_m
                + DVec3::Y * entry.above_m.unwrap_or(600.0);
            Ok((eye_m, looking(reference - eye_m)))
        }
    }
}

/// On the glide before a runway's threshold, looking along it.
fn approach(airfield: &Airfield, designator: &str, distance_m: f64) -> Result<(DVec3, DQuat), String> {
    for runway in &airfield.runways {
        for end in 0..2 {
            if runway.designators[end] == designator {
                let (from, to) = (runway.ends[end], runway.ends[1 - end]);
                let along: DVec2 = (to - from).normalize_or_zero();
                let glide = GLIDE_DEG.to_radians();
                let at = from - along * distance_m;
                let height_m = airfield.level_m + THRESHOLD_CROSSING_M + distance_m * glide.tan();
                let ahead = DVec3::new(along.x, -glide.tan(), along.y);
                return Ok((DVec3::new(at.x, height_m, at.y), looking(ahead)));
            }
        }
    }
    let known: Vec<String> = airfield.runways.iter().map(|runway| runway.designators.join("/")).collect();
    Err(format!("runway `{designator}`, where {} has {}", airfield.code, known.join(" ")))
}

fn looking(along: DVec3) -> DQuat {
    let (heading_rad, elevation_rad) = terrain::frame::heading_elevation(along);
    terrain::frame::attitude(heading_rad, elevation_rad, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::features::model::{Origin, Runway, RunwaySurface};

    #[test]
    fn the_built_in_list_is_one_and_has_at_least_16_pictures() {
        let list: List = toml::from_str(ISSYK_KUL).unwrap();
        assert!(list.picture.len() >= 16);
        for entry in &list.picture {
            assert!(entry.eye.is_some() == entry.look.is_some() && entry.eye.is_some() != entry.airfield.is_some());
            assert!(entry.time.as_ref().is_none_or(|time| UtcTime::parse(time).is_ok()), "{}", entry.name);
        }
    }

    #[test]
    fn an_approach_is_on_the_glide_and_looks_down_it() {
        let runway = Runway {
            ends: [DVec2::new(0.0, 0.0), DVec2::new(3_000.0, 0.0)],
            width_m: 45.0,
            designators: ["09".into(), "27".into()],
            surface: RunwaySurface::Asphalt,
            lit: true,
            from: Origin::Assumed,
        };
        let airfield = Airfield {
            code: "XXXX".into(),
            name: String::new(),
            reference: DVec2::ZERO,
            level_m: 500.0,
            runways: vec![runway],
            taxiways: Vec::new(),
            aprons: Vec::new(),
        };
        let (eye_m, attitude) = approach(&airfield, "27", 3_000.0).unwrap();
        // tan 3 degrees = 0.0524078.
        assert!((eye_m - DVec3::new(6_000.0, 500.0 + 15.0 + 157.223, 0.0)).length() < 0.01, "{eye_m}");
        let ahead = attitude * DVec3::NEG_Z;
        assert!((ahead - DVec3::new(-1.0, -0.052_407_8, 0.0).normalize()).length() < 1e-6, "{ahead}");
        assert!(approach(&airfield, "18", 1.0).unwrap_err().contains("09/27"));
    }
}
