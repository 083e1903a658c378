//! A case: what surrounds a flight or a shot, where it starts and how it is stepped. `C.toml`.
//!
//! Units are SI, degrees only where a key's name says so. The same file serves an aircraft and a shell; a part that a
//! run does not use may be left out. North, east, down are those of the place; in a flat frame they are the frame's.
//!
//! Invariant others rely on: a [`Case`] is checked; its numbers are finite, its steps above 0.

mod reader;

use crate::atmosphere::Atmosphere;
use crate::file::{self, FileError};
use crate::integrate::Integrator;
use crate::planet::{Place, Planet};
use crate::wind::Wind;
use glam::DVec3;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The name of the embedded world in [`Run::world`].
pub const DEFAULT_WORLD: &str = "default";

/// Most steps of one run: an hour at 10 kHz, twice.
pub const MOST_STEPS: f64 = 72e6;

/// A checked case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The file it comes from; other files are named relative to it.
    pub file: PathBuf,
    /// The Earth.
    pub planet: Planet,
    /// The air.
    pub atmosphere: Atmosphere,
    /// Its motion.
    pub wind: Wind,
    /// Its unrest.
    pub turbulence: Option<Turbulence>,
    /// Where it starts.
    pub initial: Initial,
    /// What is found before the start.
    pub trim: Option<Trim>,
    /// How it is stepped.
    pub run: Run,
    /// The shot, if it is one.
    pub shot: Option<Shot>,
}

/// Dryden turbulence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turbulence {
    /// Standard deviation along each axis, m/s.
    pub sigma_mps: f64,
    /// Seed.
    pub seed: u64,
}

/// The axes that initial rates are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RatesFrame {
    /// The stars.
    #[default]
    Inertial,
    /// The rotating Earth.
    Earth,
    /// North, east, down as they turn with the place.
    Local,
}

/// An attitude as it is given: body to north, east, down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Attitude {
    /// Roll, pitch, yaw, radians.
    Angles([f64; 3]),
    /// w, x, y, z.
    Quaternion([f64; 4]),
}

/// A velocity over the Earth as it is given, m/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Velocity {
    /// North, east, down.
    Ned(DVec3),
    /// Forward, right, down of the body.
    Body(DVec3),
}

/// Where and how a body starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Initial {
    /// The place; for a flat frame given in metres, see `flat_m`.
    pub place: Place,
    /// Position in a flat frame, north, east, down, if it was given in metres.
    pub flat_m: Option<DVec3>,
    /// Velocity.
    pub velocity: Velocity,
    /// Attitude.
    pub attitude: Attitude,
    /// Roll, pitch and yaw rate, rad/s.
    pub rates_radps: DVec3,
    /// What they are relative to.
    pub rates_frame: RatesFrame,
}

/// What trim varies, and what it sets.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trim {
    /// Controls, or `roll_deg`, `pitch_deg`, `yaw_deg`, `alpha_deg`, `speed_mps`.
    pub vary: Vec<String>,
    /// Values: a number is set before the search, the name of an output column is copied after it.
    #[serde(default)]
    pub set: BTreeMap<String, Setting>,
}

/// A value to set.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Setting {
    /// A number, in the unit that the name says.
    Number(f64),
    /// The name of a column of the trimmed state.
    Column(String),
}

/// How a run is stepped.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// How long, seconds.
    pub seconds: Option<f64>,
    /// Step, seconds.
    pub dt_s: Option<f64>,
    /// Time between rows of the output, seconds.
    pub output_dt_s: Option<f64>,
    /// Integrator.
    pub integrator: Integrator,
    /// What ends it early: `ground`, or a column below or above a value.
    pub stop: Vec<String>,
    /// The world whose ground is met: its folder, or [`DEFAULT_WORLD`].
    pub world: Option<PathBuf>,
}

/// A shot. Angles in radians.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Speed at the muzzle over the Earth, m/s.
    pub speed_mps: Option<f64>,
    /// Added to `look_angle_rad` and to what the zero asks for; the sum is the bore's elevation over the horizon.
    pub elevation_rad: f64,
    /// Clockwise from north.
    pub azimuth_rad: f64,
    /// Distance along the level line of sight at which the shot meets it, metres.
    pub zero_range_m: Option<f64>,
    /// Height of the line of sight over the bore at the muzzle, metres.
    pub sight_height_m: f64,
    /// Elevation of the line of sight.
    pub look_angle_rad: f64,
    /// What ends it.
    pub until: Option<String>,
    /// Rows every so many metres of range.
    pub step_m: Option<f64>,
    /// Rows every so many seconds.
    pub step_s: Option<f64>,
}

impl Case {
    /// Reads and checks a case.
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
        let raw: reader::CaseFile = file::toml_text(file, text)?;
        raw.checked(file).map_err(|why| FileError::new(file, why))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planet::{EARTH_GM_M3PS2, Gravity, STANDARD_GRAVITY_MPS2, Shape};

    fn read(text: &str) -> Result<Case, String> {
        Case::from_text(Path::new("c.toml"), text).map_err(|error| error.to_string())
    }

    #[test]
    fn an_empty_case_is_a_flat_one_with_standard_air() {
        let case = read("").unwrap();
        assert_eq!(
            (case.planet, case.atmosphere, case.run.integrator),
            (Planet::flat(), Atmosphere::standard(), Integrator::Rk4)
        );
        assert!(case.wind.is_still() && case.shot.is_none() && case.trim.is_none());
    }

    #[test]
    fn the_earth_is_as_deep_as_it_is_asked_for() {
        let case = read("[frame]\nkind = 'ellipsoid'").unwrap();
        assert_eq!(case.planet, Planet::wgs84());
        let round =
            read("[frame]\nkind = 'round'\nradius_m = 6371007.1809\ngm_m3ps2 = 3.986004418e14\nrotation_radps = 0")
                .unwrap();
        assert_eq!(round.planet.gravity, Gravity::InverseSquare(EARTH_GM_M3PS2));
        assert_eq!(
            (round.planet.shape, round.planet.rotation_radps),
            (Shape::Round { radius_m: 6_371_007.180_9 }, 0.0)
        );
        let flat =
            read("[frame]\ngravity = 'inverse_square'\nlatitude_deg = 45\nrotation_radps = 7.292115e-5").unwrap();
        assert_eq!(flat.planet.gravity, Gravity::PlumbInverseSquare(STANDARD_GRAVITY_MPS2));
        assert!(flat.planet.rotation().z < 0.0);
        let there = read("[initial]\nlat_deg = 42\nlon_deg = -282.5").unwrap();
        let start = there.planet.position_m(there.initial.place);
        assert!(start.length() < 1e-8, "{start}: the plane touches where the body starts");
        assert!((there.planet.place(start).lon_rad.to_degrees() - 77.5).abs() < 1e-12);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_key() {
        for (text, told) in [
            ("[frame]\nkind = 'cube'", "cube"),
            ("[frame]\ngravity = 'j2'", "frame.gravity"),
            ("[frame]\nkind = 'ellipsoid'\nradius_m = 6.4e6", "frame.radius_m"),
            ("[frame]\nradius = 6.4e6", "radius"),
            ("[frame]\ng_mps2 = nan", "frame.g_mps2"),
            ("[atmosphere]\nmodel = 'none'\ndensity_kgpm3 = 1.0", "atmosphere.density_kgpm3"),
            ("[atmosphere]\nstation = {humidity = 78}", "atmosphere.station.humidity"),
            ("[[wind]]\naltitude_m = 5\n[[wind]]\naltitude_m = 5", "wind[1].altitude_m: expected above 5"),
            ("[initial]\nlat_deg = 91", "initial.lat_deg"),
            ("[initial]\nlat_deg = 1\nnorth_m = 1", "found both"),
            ("[initial]\nquaternion = [0, 0, 0, 0]", "initial.quaternion"),
            ("[initial]\nvelocity_ned_mps = [1, 2, 3]\nvelocity_body_mps = [1, 2, 3]", "found both"),
            ("[run]\ndt_s = 0", "run.dt_s"),
            ("[run]\ndt_s = 1e-6\nseconds = 1e5", "run.seconds / run.dt_s"),
            ("[run]\nintegrator = 'euler'", "euler"),
            ("[shot]\nstep_m = 1\nstep_s = 1", "found both"),
            ("[turbulence]\nkind = 'dryden'\nsigma_mps = -1", "turbulence.sigma_mps"),
            ("[sky]", "sky"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with("c.toml: ") && error.contains(told), "{text}: {error}");
        }
    }
}
