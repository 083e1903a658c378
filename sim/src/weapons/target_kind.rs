//! A kind of target: shape, armour, how it stands and drives, what draws it. `T.toml`.
//!
//! The shape's frame has forward -Z and up +Y about the shape's reference point, metres. How it stands:
//!
//! | `stand` | rule |
//! |---|---|
//! | `wheels` | three points of contact lie on the ground: the middle of the front, `front_m` ahead, and both ends of the rear, `rear_m` behind and `half_width_m` aside; so over one triangle it lies flat on it, with its pitch and roll |
//! | `upright` | level; the lowest of the four corners of the same rectangle is on the ground, as buildings stand |
//! | `water` | level; `draught_m` of it below the water |
//!
//! `below_m` is the depth of the contact plane (of the keel) under the reference point.

use super::armour::Armour;
use crate::ballistics::shape::Shape;
use crate::file::{self, FileError};
use glam::DVec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// How a target stands. Metres, shape's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// By which rule.
    pub on: StandOn,
    /// From the reference point to the front's contact.
    pub front_m: f64,
    /// From the reference point to the rear's contacts.
    pub rear_m: f64,
    /// From the middle to a contact on either side.
    pub half_width_m: f64,
    /// From the reference point down to the plane of contact; on water to the water.
    pub below_m: f64,
}

/// The rule by which a target stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StandOn {
    /// On three points of contact.
    Wheels,
    /// Level on its lowest corner.
    Upright,
    /// Level on water.
    Water,
}

/// A checked kind of target.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetKind {
    /// The file it comes from.
    pub file: PathBuf,
    /// What people call it.
    pub label: String,
    /// Name of the model that draws it.
    pub model: String,
    /// What shells strike.
    pub shape: Shape,
    /// What it is made of.
    pub armour: Armour,
    /// How it stands.
    pub stand: Stand,
    /// Fastest it drives, m/s; 0 stands for ever.
    pub most_speed_mps: f64,
    /// Fastest it turns, rad/s.
    pub turn_radps: f64,
    /// Whether it burns when it is destroyed.
    pub burns: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct KindFile {
    label: String,
    model: String,
    armour: Armour,
    shape: ShapeFile,
    stand: StandFile,
    #[serde(default)]
    most_speed_mps: f64,
    #[serde(default)]
    turn_degps: f64,
    #[serde(default)]
    burns: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum ShapeFile {
    /// Halves of the sides: right, up, back.
    Block([f64; 3]),
    /// Half its height, its radius.
    Cylinder([f64; 2]),
    /// Its radius.
    Sphere(f64),
    /// Corners of a convex hull.
    Hull(Vec<[f64; 3]>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StandFile {
    on: StandOn,
    #[serde(default)]
    front_m: f64,
    #[serde(default)]
    rear_m: f64,
    #[serde(default)]
    half_width_m: f64,
    below_m: f64,
    draught_m: Option<f64>,
}

impl TargetKind {
    /// Reads and checks a kind of target.
    ///
    /// # Errors
    /// [`FileError`] names the key, what was expected and what was found.
    pub fn read(file: &Path) -> Result<Self, FileError> {
        Self::from_text(file, &file::text(file)?)
    }

    /// The same of a text; `file` is what errors call it.
    ///
    /// # Errors
    /// [`FileError`] names the key, what was expected and what was found.
    pub fn from_text(file: &Path, text: &str) -> Result<Self, FileError> {
        let raw: KindFile = file::toml_text(file, text)?;
        let fail = |why: String| FileError::new(file, why);
        let within = |key: &str, found: f64, least: f64, most: f64| match found {
            found if (least..=most).contains(&found) => Ok(()),
            found => Err(fail(format!("{key}: expected {least}..={most}, found {found}"))),
        };
        for (key, text) in [("label", &raw.label), ("model", &raw.model)] {
            if text.is_empty() || text.len() > 100 {
                return Err(fail(format!("{key}: expected 1 to 100 bytes, found {}", text.len())));
            }
        }
        within("most_speed_mps", raw.most_speed_mps, 0.0, 1_000.0)?;
        within("turn_degps", raw.turn_degps, 0.0, 360.0)?;
        if raw.most_speed_mps > 0.0 && raw.turn_degps == 0.0 {
            return Err(fail("turn_degps: expected a rate above 0 of what drives, found 0".to_owned()));
        }
        let shape = match &raw.shape {
            ShapeFile::Block(half_m) => Shape::block(DVec3::from_array(*half_m)),
            ShapeFile::Cylinder([half_height_m, radius_m]) => Shape::cylinder(*half_height_m, *radius_m),
            ShapeFile::Sphere(radius_m) => Shape::sphere(*radius_m),
            ShapeFile::Hull(points) => {
                Shape::hull(&points.iter().map(|point| DVec3::from_array(*point)).collect::<Vec<_>>())
            }
        };
        let shape = shape.map_err(|error| fail(format!("shape: {error}")))?;
        let StandFile { on, front_m, rear_m, half_width_m, below_m, draught_m } = raw.stand;
        let least = if on == StandOn::Wheels { 0.01 } else { 0.0 };
        within("stand.front_m", front_m, least, 1_000.0)?;
        within("stand.rear_m", rear_m, least, 1_000.0)?;
        within("stand.half_width_m", half_width_m, least, 1_000.0)?;
        within("stand.below_m", below_m, 0.0, 1_000.0)?;
        let below_m = match (on, draught_m) {
            (StandOn::Water, Some(draught_m)) => {
                within("stand.draught_m", draught_m, 0.0, 2.0 * below_m)?;
                below_m - draught_m
            }
            (StandOn::Water, None) => {
                return Err(fail("stand.draught_m: expected a number on water, found none".to_owned()));
            }
            (_, None) => below_m,
            (_, Some(_)) => return Err(fail("stand.draught_m: expected none but on water".to_owned())),
        };
        Ok(Self {
            file: file.to_owned(),
            label: raw.label,
            model: raw.model,
            shape,
            armour: raw.armour,
            stand: Stand { on, front_m, rear_m, half_width_m, below_m },
            most_speed_mps: raw.most_speed_mps,
            turn_radps: raw.turn_degps.to_radians(),
            burns: raw.burns,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TANK: &str = "label = 'tank'\nmodel = 'tank'\narmour = 'heavy'\nmost_speed_mps = 15\nturn_degps = 30\n\
        shape = { block = [1.8, 1.1, 3.4] }\n\
        stand = { on = 'wheels', front_m = 2.2, rear_m = 2.2, half_width_m = 1.4, below_m = 1.1 }\n";

    fn read(text: &str) -> Result<TargetKind, String> {
        TargetKind::from_text(Path::new("t.toml"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn what_is_wrong_is_named_with_its_key() {
        assert_eq!(read(TANK).unwrap().armour, Armour::Heavy);
        for (text, told) in [
            (TANK.replace("'heavy'", "'thick'"), "thick"),
            (TANK.replace("1.8", "-1.8"), "shape: half_m.x must be above 0"),
            (TANK.replace("block", "cube"), "cube"),
            (TANK.replace("turn_degps = 30", "turn_degps = 0"), "turn_degps: expected a rate above 0"),
            (TANK.replace("front_m = 2.2", "front_m = 0"), "stand.front_m: expected 0.01..=1000, found 0"),
            (TANK.replace("'wheels'", "'water'"), "stand.draught_m: expected a number on water"),
            (TANK.replace("below_m = 1.1", "below_m = 1.1, draught_m = 1"), "stand.draught_m: expected none"),
            (TANK.replace("15", "nan"), "most_speed_mps: expected a finite number"),
            (format!("{TANK}wheels = 6"), "wheels"),
        ] {
            let error = read(&text).unwrap_err();
            assert!(error.starts_with("t.toml") && error.contains(told), "{text}: {error}");
        }
    }
}
