//! A situation as data: who flies what from where, what stands and drives there, the wind, and what a script flies where
//! no pilot does. `S.toml`.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | the file, and the scene of it on a world |
//! | `own.rs` | the own aircraft: its model, its place on a runway or in the air, its stores |
//! | `script.rs` | what is done when, in the place of a pilot |
//! | `air.rs` | the air as a station measured it |
//! | `laid.rs` | places of the Earth on a world's map |
//!
//! Places are latitude and longitude in degrees (WGS84), headings clockwise from true north, winds the velocity of the
//! air to true north and east; all are laid on the world's map, whose grid turns from true north by the convergence at
//! the own aircraft's start. Altitudes are metres above mean sea level.
//!
//! Targets stand on the world's ground; those that swim must be on one of its lakes, at its level, with their whole route.
//! A convoy's vehicles drive one route, the first of the list ahead, `spacing_m` over speed seconds apart.

mod air;
mod laid;
mod own;
mod script;

use crate::file::{self, FileError};
use crate::loose::{LooseKind, MOST_LOOSE};
use crate::scene::{Catalogue, Column, Height, LooseStart, Reaction, Refused, Scene, Surroundings, TargetStart};
use crate::utc::UtcTime;
use crate::weapons::target_kind::StandOn;
use crate::weapons::{TargetKind, builtin};
use crate::wind::Wind;
use air::Report;
use glam::{DQuat, DVec2, DVec3};
use laid::Laid;
use own::Own;
use script::Step;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::store::World;

/// The embedded situations by name, all on the embedded world.
pub const BUILTIN: [(&str, &str); 3] = [
    ("circuit", include_str!("../../../assets/scenarios/circuit.toml")),
    ("valley", include_str!("../../../assets/scenarios/valley.toml")),
    ("range", include_str!("../../../assets/scenarios/range.toml")),
];

/// A situation as its file has it.
#[derive(Debug, Clone)]
pub struct Situation {
    /// The file it comes from.
    pub file: PathBuf,
    raw: SituationFile,
}

/// A moment worth a picture.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moment {
    /// When, scene seconds.
    pub at_s: f64,
    /// What it shows.
    pub name: String,
    /// Name of the camera, if it is not the cockpit.
    pub camera: Option<String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct SituationFile {
    name: String,
    /// What the pilot is told, line by line.
    #[serde(default)]
    say: Vec<String>,
    /// Date and time, as ISO.
    date: Option<String>,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    turbulence_mps: f64,
    air: Option<Report>,
    #[serde(default)]
    wind: Vec<WindRow>,
    own: Own,
    #[serde(default)]
    target: Vec<Standing>,
    #[serde(default)]
    convoy: Vec<Convoy>,
    #[serde(default)]
    loose: Vec<Lying>,
    #[serde(default)]
    script: Vec<Step>,
    #[serde(default)]
    picture: Vec<Moment>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct WindRow {
    altitude_m: f64,
    #[serde(default)]
    north_mps: f64,
    #[serde(default)]
    east_mps: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Standing {
    kind: String,
    lat_deg: f64,
    lon_deg: f64,
    #[serde(default)]
    heading_deg: f64,
    /// Above the ground: a bridge's deck.
    #[serde(default)]
    over_ground_m: f64,
}

/// Loose things in a row to the right of the way that they face.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Lying {
    kind: String,
    lat_deg: f64,
    lon_deg: f64,
    #[serde(default)]
    heading_deg: f64,
    /// Of its foot; above 0 it is let go there, onto another.
    #[serde(default)]
    over_ground_m: f64,
    #[serde(default = "one")]
    count: u32,
    #[serde(default)]
    spacing_m: f64,
}

fn one() -> u32 {
    1
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Convoy {
    kinds: Vec<String>,
    #[serde(deserialize_with = "file::rows")]
    route: Vec<[f64; 2]>,
    speed_mps: f64,
    spacing_m: f64,
    #[serde(default)]
    loops: bool,
    #[serde(default)]
    reaction: ReactionName,
}

#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ReactionName {
    DriveOn,
    #[default]
    Stop,
    Scatter,
}

impl Situation {
    /// An embedded one.
    ///
    /// # Errors
    /// [`FileError`] names those that there are.
    pub fn builtin(name: &str) -> Result<Self, FileError> {
        let text = BUILTIN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text).ok_or_else(|| {
            let known: Vec<&str> = BUILTIN.iter().map(|(known, _)| *known).collect();
            FileError::new(name, format_args!("expected one of [{}], found {name}", known.join(", ")))
        })?;
        Self::from_text(Path::new(name), text)
    }

    /// Reads a situation.
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
        let raw: SituationFile = file::toml_text(file, text)?;
        for (at, convoy) in raw.convoy.iter().enumerate() {
            let fail = |why: String| Err(FileError::new(file, format!("convoy[{at}].{why}")));
            if convoy.kinds.is_empty() {
                return fail("kinds: expected at least one, found none".to_owned());
            }
            if convoy.route.len() < 2 {
                return fail(format!("route: expected at least two places, found {}", convoy.route.len()));
            }
            if !(convoy.speed_mps > 0.0 && convoy.spacing_m >= 0.0) {
                let (speed, spacing) = (convoy.speed_mps, convoy.spacing_m);
                return fail(format!("speed_mps, spacing_m: expected numbers above 0, found {speed}, {spacing}"));
            }
        }
        let fail = |key: &str, why: &dyn std::fmt::Display| Err(FileError::new(file, format!("{key}: {why}")));
        if let Some(at) = raw.picture.iter().position(|one| !(0.0..=1e6).contains(&one.at_s)) {
            return fail(
                &format!("picture[{at}].at_s"),
                &format_args!("expected seconds, found {}", raw.picture[at].at_s),
            );
        }
        for (at, step) in raw.script.iter().enumerate() {
            if let Err(why) = step.check() {
                return fail(&format!("script[{at}]"), &why);
            }
        }
        let situation = Self { file: file.to_owned(), raw };
        situation.date()?;
        Ok(situation)
    }

    /// What the pilot is told, line by line.
    pub fn say(&self) -> &[String] {
        &self.raw.say
    }

    /// Moments worth a picture.
    pub fn moments(&self) -> &[Moment] {
        &self.raw.picture
    }

    /// Date and time that it is set at, if it names one.
    ///
    /// # Errors
    /// [`FileError`] says what was expected.
    pub fn date(&self) -> Result<Option<UtcTime>, FileError> {
        let parsed = self.raw.date.as_deref().map(UtcTime::parse).transpose();
        parsed.map_err(|why| FileError::new(&self.file, format!("date: {why}")))
    }

    /// How long its script is, scene seconds; 0 without one.
    pub fn scripted_s(&self) -> f64 {
        self.raw.script.iter().map(|step| step.at_s).fold(0.0, f64::max)
    }

    /// What people call it.
    pub fn name(&self) -> &str {
        &self.raw.name
    }

    /// The scene of it on a world: the embedded weapons and kinds of targets are added to the catalogue. With `scripted`
    /// its script flies.
    ///
    /// # Errors
    /// [`FileError`] names the entry that the world or the scene refuses, and why.
    pub fn scene(
        &self,
        world: &World,
        date: UtcTime,
        step_hz: u32,
        mut catalogue: Catalogue,
        scripted: bool,
    ) -> Result<Scene, FileError> {
        let fail = |key: &str, why: &dyn std::fmt::Display| FileError::new(&self.file, format!("{key}: {why}"));
        builtin::add_all(&mut catalogue).map_err(|why| fail("catalogue", &why))?;
        let own = &self.raw.own;
        let model = own.add_model(&self.file, &mut catalogue).map_err(|why| fail("own.aircraft", &why))?;
        let start = own.start(world, model.as_deref()).map_err(|why| fail("own", &why))?;
        let laid = Laid::new(world, start.place);
        let mut around = Surroundings::over(world.projection.centre().lat_rad).map_err(|why| fail("world", &why))?;
        let turn = DQuat::from_rotation_z(-laid.convergence_rad);
        let row = |row: &WindRow| (row.altitude_m, turn * DVec3::new(row.north_mps, row.east_mps, 0.0));
        around.wind = Wind::new(self.raw.wind.iter().map(row).collect()).map_err(|not| {
            fail("wind", &format_args!("expected a height above {} m, found {}", not.before_m, not.found_m))
        })?;
        (around.turbulence_mps, around.seed) = (self.raw.turbulence_mps, self.raw.seed);
        if let Some(report) = &self.raw.air {
            around.atmosphere = report.atmosphere().map_err(|why| fail("air", &why))?;
        }
        let at_m = start.state.position_m;
        let ground_m = laid.area.height_m(at_m.x, at_m.z).unwrap_or(at_m.y);
        let altimeter_pa = air::qnh_pa(&around.atmosphere, ground_m);
        let mut scene = Scene::furnished(start.state, date, step_hz, around, Arc::new(catalogue))
            .map_err(|why| fail("wind, turbulence_mps", &why))?;
        let owner = own.seat(&mut scene, &start, altimeter_pa).map_err(|why| fail("own", &why))?;
        for (at, target) in self.raw.target.iter().enumerate() {
            laid.stand(&mut scene, target).map_err(|why| fail(&format!("target[{at}]"), &why))?;
        }
        for (at, convoy) in self.raw.convoy.iter().enumerate() {
            laid.drive(&mut scene, convoy, at as u32).map_err(|why| fail(&format!("convoy[{at}]"), &why))?;
        }
        for (at, lying) in self.raw.loose.iter().enumerate() {
            laid.lay(&mut scene, lying).map_err(|why| fail(&format!("loose[{at}]"), &why))?;
        }
        own.arm(&mut scene).map_err(|(key, why)| fail(&format!("own.{key}"), &why))?;
        if scripted {
            for (at, step) in self.raw.script.iter().enumerate() {
                step.schedule(&mut scene, owner, &laid, start.runway.as_ref())
                    .map_err(|why| fail(&format!("script[{at}]"), &why))?;
            }
        }
        Ok(scene)
    }
}

impl Laid<'_> {
    fn kind<'s>(scene: &'s Scene, name: &str) -> Result<&'s TargetKind, Refused> {
        scene.catalogue().target_kind(name)
    }

    fn stand(&self, scene: &mut Scene, target: &Standing) -> Result<(), Refused> {
        let on_water = Self::kind(scene, &target.kind)?.stand.on == StandOn::Water;
        let (plan_m, level_m) = self.place([target.lat_deg, target.lon_deg], on_water)?;
        let heading_rad = target.heading_deg.to_radians() - self.convergence_rad;
        let height = if on_water { Height::Msl(level_m) } else { Height::OverGround(target.over_ground_m) };
        let attitude = DQuat::from_rotation_y(-heading_rad);
        scene.add_target(&TargetStart { height, attitude, ..TargetStart::standing(&target.kind, plan_m) })?;
        Ok(())
    }

    fn lay(&self, scene: &mut Scene, lying: &Lying) -> Result<(), Refused> {
        let kind = LooseKind::named(&lying.kind).ok_or_else(|| {
            let known = LooseKind::ALL.map(LooseKind::name).join(", ");
            Refused::new(format_args!("kind: expected one of [{known}], found {}", lying.kind))
        })?;
        let (count, spacing_m) = (lying.count, lying.spacing_m);
        if !(1..=MOST_LOOSE as u32).contains(&count) || !(0.0..=1_000.0).contains(&spacing_m) {
            return Err(Refused::new(format_args!(
                "count, spacing_m: expected 1..={MOST_LOOSE} and 0..=1000, found {count} and {spacing_m}"
            )));
        }
        if !lying.heading_deg.is_finite() {
            return Err(Refused::new(format_args!("heading_deg: expected degrees, found {}", lying.heading_deg)));
        }
        let (first_m, _) = self.place([lying.lat_deg, lying.lon_deg], false)?;
        let heading_rad = lying.heading_deg.to_radians() - self.convergence_rad;
        let right = DVec2::new(heading_rad.cos(), heading_rad.sin());
        for number in 0..count {
            scene.add_loose(&LooseStart {
                kind,
                plan_m: first_m + right * (f64::from(number) * spacing_m),
                over_ground_m: lying.over_ground_m,
                attitude: DQuat::from_rotation_y(-heading_rad),
            })?;
        }
        Ok(())
    }

    fn drive(&self, scene: &mut Scene, convoy: &Convoy, number: u32) -> Result<(), Refused> {
        let reaction = match convoy.reaction {
            ReactionName::DriveOn => Reaction::DriveOn,
            ReactionName::Stop => Reaction::Stop,
            ReactionName::Scatter => Reaction::Scatter,
        };
        let last = convoy.kinds.len() - 1;
        for (place, kind) in convoy.kinds.iter().enumerate() {
            let on_water = Self::kind(scene, kind)?.stand.on == StandOn::Water;
            let route: Vec<(DVec2, f64)> =
                convoy.route.iter().map(|at| self.place(*at, on_water)).collect::<Result<_, _>>()?;
            let ahead_s = (last - place) as f64 * convoy.spacing_m / convoy.speed_mps;
            scene.add_target(&TargetStart {
                height: if on_water { Height::Msl(route[0].1) } else { Height::OverGround(0.0) },
                route_m: route[1..].iter().map(|(plan, _)| *plan).collect(),
                speed_mps: convoy.speed_mps,
                loops: convoy.loops,
                ahead_s,
                column: Some(Column { number, reaction }),
                ..TargetStart::standing(kind, route[0].0)
            })?;
        }
        Ok(())
    }
}
