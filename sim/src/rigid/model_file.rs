//! `M.toml` as it is written.

use super::gear::file::{SkidFile, WheelFile};
use super::handbook::Handbook;
use super::power::file::{EngineFile, PropellerFile};
use crate::autopilot::Tuning;
use crate::case::Setting;
use crate::table::Interpolation;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelFile {
    /// What it looks like: the name of a shape of whoever draws it.
    pub looks: Option<String>,
    pub body: Option<BodyFile>,
    #[serde(default)]
    pub reference: ReferenceFile,
    #[serde(default, deserialize_with = "in_order")]
    pub controls: Vec<(String, ControlFile)>,
    #[serde(default)]
    pub signal: Vec<SignalFile>,
    #[serde(default)]
    pub aero: AeroFile,
    #[serde(default)]
    pub table: BTreeMap<String, TableFile>,
    #[serde(default)]
    pub thrust: Vec<ThrustFile>,
    #[serde(default)]
    pub daveml: Vec<DavemlFile>,
    #[serde(default)]
    pub wheel: Vec<WheelFile>,
    #[serde(default)]
    pub skid: Vec<SkidFile>,
    pub engine: Option<EngineFile>,
    pub propeller: Option<PropellerFile>,
    pub fuel: Option<FuelFile>,
    pub stall: Option<StallFile>,
    pub autopilot: Option<Tuning>,
    pub handbook: Option<Handbook>,
}

/// A table's entries in the order of the file.
fn in_order<'de, D: Deserializer<'de>>(table: D) -> Result<Vec<(String, ControlFile)>, D::Error> {
    struct Entries;
    impl<'de> Visitor<'de> for Entries {
        type Value = Vec<(String, ControlFile)>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a table of controls, NAME = { min, max, initial }")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
            let mut entries = Vec::new();
            while let Some(entry) = map.next_entry()? {
                entries.push(entry);
            }
            Ok(entries)
        }
    }
    table.deserialize_map(Entries)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BodyFile {
    pub mass_kg: f64,
    #[serde(deserialize_with = "crate::file::square")]
    pub inertia_kgm2: [[f64; 3]; 3],
    #[serde(default, deserialize_with = "crate::file::exactly")]
    pub cg_m: [f64; 3],
    pub never_exceed_mps: Option<f64>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ReferenceFile {
    pub area_m2: Option<f64>,
    pub span_m: Option<f64>,
    pub chord_m: Option<f64>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    pub moment_point_m: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ControlFile {
    pub min: f64,
    pub max: f64,
    #[serde(default)]
    pub initial: f64,
    /// How fast it moves, in its own unit a second; at once if left out.
    pub per_s: Option<f64>,
    /// Time in which it goes all but 1/e of the rest of its way, seconds; at once if left out.
    pub lag_s: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SignalFile {
    pub name: String,
    pub min: f64,
    pub max: f64,
    pub term: Vec<SignalTermFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SignalTermFile {
    pub value: Option<f64>,
    pub table: Option<String>,
    pub and_table: Option<String>,
    #[serde(default)]
    pub times: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FuelFile {
    #[serde(deserialize_with = "crate::file::exactly")]
    pub at_m: [f64; 3],
    pub capacity_kg: f64,
    /// Name of the signal that is the engine's flow, kg/s.
    pub flow: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StallFile {
    pub warning_rad: f64,
    pub buffet_rad: f64,
    pub full_buffet_rad: f64,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq, Debug, Default)]
#[serde(rename_all = "snake_case")]
pub(super) enum AxesFile {
    #[default]
    Wind,
    Stability,
    Body,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct AeroFile {
    #[serde(default)]
    pub axes: AxesFile,
    pub min_speed_mps: Option<f64>,
    #[serde(default)]
    pub term: Vec<TermFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TermFile {
    pub to: String,
    pub value: Option<f64>,
    pub table: Option<String>,
    /// Another table that it is multiplied with.
    pub and_table: Option<String>,
    #[serde(default)]
    pub times: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TableFile {
    pub axes: Vec<String>,
    pub breakpoints: Vec<Vec<f64>>,
    pub values: Vec<f64>,
    #[serde(default)]
    pub interpolation: InterpolationFile,
    #[serde(default)]
    pub outside: OutsideFile,
}

#[derive(Deserialize, Default, Clone, Copy)]
#[serde(rename_all = "snake_case")]
pub(super) enum InterpolationFile {
    #[default]
    Linear,
    Pchip,
}

impl From<InterpolationFile> for Interpolation {
    fn from(file: InterpolationFile) -> Self {
        match file {
            InterpolationFile::Linear => Self::Linear,
            InterpolationFile::Pchip => Self::Pchip,
        }
    }
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(super) enum OutsideFile {
    #[default]
    Clamp,
    Error,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(non_snake_case)]
pub(super) struct ThrustFile {
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    pub force_N: Option<[f64; 3]>,
    pub table: Option<String>,
    #[serde(default, deserialize_with = "crate::file::exactly_if")]
    pub at_m: Option<[f64; 3]>,
    #[serde(default)]
    pub times: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DavemlFile {
    pub file: PathBuf,
    #[serde(default)]
    pub set: BTreeMap<String, Setting>,
}
