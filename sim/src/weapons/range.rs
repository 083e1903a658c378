//! A firing range as data: who attacks with what, what stands and drives there, and the wind. `RANGE.toml`.
//!
//! Places are latitude and longitude in degrees (WGS84), headings clockwise from true north, winds the velocity of the
//! air to true north and east; all are laid on the world's map, whose grid turns from true north by the convergence at
//! the own aircraft's start. Altitudes are metres above mean sea level.
//!
//! Targets stand on the world's ground; those that swim must be on one of its lakes, at its level, with their whole route.
//! A convoy's vehicles drive one route, the first of the list ahead, `spacing_m` over speed seconds apart.

use super::target_kind::StandOn;
use super::{TargetKind, builtin};
use crate::aircraft::AircraftState;
use crate::file::{self, FileError};
use crate::scene::{Catalogue, Column, Command, Height, Reaction, Refused, Scene, Surroundings, TargetStart};
use crate::utc::UtcTime;
use crate::wind::Wind;
use glam::{DQuat, DVec2, DVec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::store::World;
use terrain::{Area, Geodetic, Ground};

/// The embedded range, on the embedded world.
pub const BUILTIN: &str = include_str!("../../../assets/scenarios/range.toml");

/// A range as its file has it.
#[derive(Debug, Clone)]
pub struct Range {
    /// The file it comes from.
    pub file: PathBuf,
    raw: RangeFile,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RangeFile {
    name: String,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    turbulence_mps: f64,
    #[serde(default)]
    wind: Vec<WindRow>,
    own: Own,
    #[serde(default)]
    target: Vec<Standing>,
    #[serde(default)]
    convoy: Vec<Convoy>,
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
struct Own {
    lat_deg: f64,
    lon_deg: f64,
    altitude_m: f64,
    #[serde(default)]
    heading_deg: f64,
    speed_mps: f64,
    #[serde(default)]
    station: Vec<StationFile>,
    select: Option<String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct StationFile {
    weapon: String,
    rounds: u32,
    #[serde(deserialize_with = "file::exactly")]
    at_m: [f64; 3],
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

/// A world under a range: its map, its ground, and how its grid is turned.
struct Laid<'a> {
    world: &'a World,
    area: Area,
    convergence_rad: f64,
}

impl Range {
    /// Reads a range.
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
        let raw: RangeFile = file::toml_text(file, text)?;
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
        Ok(Self { file: file.to_owned(), raw })
    }

    /// What people call it.
    pub fn name(&self) -> &str {
        &self.raw.name
    }

    /// The scene of it on a world: the embedded weapons and kinds of targets are added to the catalogue.
    ///
    /// # Errors
    /// [`FileError`] names the entry that the world or the scene refuses, and why.
    pub fn scene(
        &self,
        world: &World,
        date: UtcTime,
        step_hz: u32,
        mut catalogue: Catalogue,
    ) -> Result<Scene, FileError> {
        let fail = |key: &str, why: &dyn std::fmt::Display| FileError::new(&self.file, format!("{key}: {why}"));
        builtin::add_all(&mut catalogue).map_err(|why| fail("catalogue", &why))?;
        let own = &self.raw.own;
        let start = Geodetic::from_degrees(own.lat_deg, own.lon_deg);
        let laid = Laid {
            world,
            area: Ground::new(world.field.clone()).whole(),
            convergence_rad: world.projection.grid_convergence_rad(start),
        };
        let plan = laid.place([own.lat_deg, own.lon_deg], false).map_err(|why| fail("own", &why))?.0;
        let heading_rad = own.heading_deg.to_radians() - laid.convergence_rad;
        let state = AircraftState::level(DVec3::new(plan.x, own.altitude_m, plan.y), heading_rad, own.speed_mps);
        let mut around = Surroundings::over(world.projection.centre().lat_rad).map_err(|why| fail("world", &why))?;
        let turn = DQuat::from_rotation_z(-laid.convergence_rad);
        let row = |row: &WindRow| (row.altitude_m, turn * DVec3::new(row.north_mps, row.east_mps, 0.0));
        around.wind = Wind::new(self.raw.wind.iter().map(row).collect()).map_err(|not| {
            fail("wind", &format_args!("expected a height above {} m, found {}", not.before_m, not.found_m))
        })?;
        (around.turbulence_mps, around.seed) = (self.raw.turbulence_mps, self.raw.seed);
        let mut scene = Scene::furnished(state, date, step_hz, around, Arc::new(catalogue))
            .map_err(|why| fail("wind, turbulence_mps", &why))?;
        for (at, target) in self.raw.target.iter().enumerate() {
            laid.stand(&mut scene, target).map_err(|why| fail(&format!("target[{at}]"), &why))?;
        }
        for (at, convoy) in self.raw.convoy.iter().enumerate() {
            laid.drive(&mut scene, convoy, at as u32).map_err(|why| fail(&format!("convoy[{at}]"), &why))?;
        }
        let owner = scene.own_id();
        for (at, station) in own.station.iter().enumerate() {
            let StationFile { weapon, rounds, at_m } = station.clone();
            let load = Command::Load { owner, weapon, rounds, at_m: DVec3::from_array(at_m) };
            scene.order(load).map_err(|why| fail(&format!("own.station[{at}]"), &why))?;
        }
        if own.select.is_some() {
            let arm = Command::Arm { owner, master: false, weapon: own.select.clone(), fuze: None };
            scene.order(arm).map_err(|why| fail("own.select", &why))?;
        }
        Ok(scene)
    }
}

impl Laid<'_> {
    /// Plan place of a latitude and a longitude in degrees, and on water its level; it must have ground, or water.
    fn place(&self, [lat_deg, lon_deg]: [f64; 2], on_water: bool) -> Result<(DVec2, f64), Refused> {
        if !(lat_deg.abs() < 90.0 && lon_deg.abs() <= 180.0) {
            return Err(Refused::new(format_args!("expected degrees on the Earth, found {lat_deg}, {lon_deg}")));
        }
        let plan = self.world.projection.to_world(Geodetic::from_degrees(lat_deg, lon_deg));
        let ground_m = self.area.height_m(plan.x, plan.y).ok_or_else(|| {
            Refused::new(format_args!("expected a place on the world's ground, found {lat_deg}, {lon_deg}"))
        })?;
        if !on_water {
            return Ok((plan, ground_m));
        }
        let lake = self.world.lakes.lake_at(plan);
        let dry = || Refused::new(format_args!("expected a place on a lake of the world, found {lat_deg}, {lon_deg}"));
        lake.map(|lake| (plan, lake.level_m)).ok_or_else(dry)
    }

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
