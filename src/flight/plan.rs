//! What is flown: the track, for how long, and where pictures are taken.
//!
//! The embedded world has a scenic flight. A start, a heading or a speed that is asked for, or another world, gives a
//! straight track: from the place asked for, or along a diagonal through the world's middle. A scenario that is named is
//! flown by its pilot in a window, else by its script.

use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::output;
use crate::scenery;
use crate::stage;
use crate::values::Altitude;
use glam::DVec3;
use sim::aircraft::{ALTITUDE_M, AircraftState};
use sim::clock::DEFAULT_STEP_HZ;
use sim::file::FileError;
use sim::rigid::{Model, builtin};
use sim::scene::{BodyStart, Catalogue, Surroundings};
use sim::situation::{BUILTIN, Situation};
use sim::track::{Flight, ISSYK_KUL_FLIGHT, TrackError, TrackHeight};
use sim::{Levers, Scene, Track, UtcTime};
use std::path::Path;
use std::sync::Arc;
use terrain::store::World;
use terrain::{Area, Geodetic};

/// Speed of a straight track unless asked for, m/s.
const SPEED_MPS: f64 = 250.0;
/// Height of a diagonal track over the highest ground about it, metres.
const CLEARANCE_M: f64 = 600.0;
/// How far before and behind a track over ground looks, metres.
const AHEAD_M: f64 = 3_000.0;
/// Pictures of a track that names none.
const PICTURES: u32 = 8;
/// Frames a second of simulated time, where no clock drives.
pub const LOCKSTEP_HZ: f64 = 60.0;
/// Length of a headless flight unless asked for, seconds: some minute of work for a software adapter.
const HEADLESS_S: f64 = 10.0;

/// When a flight ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// After this many frames.
    Frames(u64),
    /// After this long: of simulated time in lockstep, else of wall time.
    Seconds(f64),
    /// When the pilot quits.
    Endless,
}

/// A place on the track worth a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PicturePlace {
    /// Along the track, metres.
    pub distance_m: f64,
    /// What it shows.
    pub name: String,
}

/// What is flown.
#[derive(Debug, Clone)]
pub enum Plan {
    /// A track through the world.
    Track {
        /// The way.
        track: Track,
        /// Where pictures are taken, however far is flown.
        pictures: Vec<PicturePlace>,
        /// The rigid body that is flown instead of the track, trimmed at its start, and its speed, m/s.
        aircraft: Option<(Arc<Model>, f64)>,
    },
    /// A situation, flown by its pilot or its script.
    Situation(Box<Situation>),
}

impl Length {
    /// The length asked for; a headless flight has an end of its own.
    pub fn of(args: &FlyArgs, headless: bool) -> Self {
        match (args.frames, args.seconds_s) {
            (Some(frames), _) => Self::Frames(frames),
            (None, Some(seconds_s)) => Self::Seconds(seconds_s),
            (None, None) if headless => Self::Seconds(HEADLESS_S),
            (None, None) => Self::Endless,
        }
    }

    /// The same, but a headless flight of a situation is as long as its script.
    pub fn scripted(self, args: &FlyArgs, plan: &Plan) -> Self {
        match plan {
            Plan::Situation(situation) if args.frames.is_none() && args.seconds_s.is_none() => {
                let last_s =
                    situation.moments().iter().map(|moment| moment.at_s).fold(situation.scripted_s(), f64::max);
                Self::Seconds(last_s.max(HEADLESS_S))
            }
            _ => self,
        }
    }

    /// Seconds of flight at a pace, if it has an end.
    fn seconds(self, hz: f64) -> Option<f64> {
        match self {
            Self::Frames(frames) => Some(frames as f64 / hz),
            Self::Seconds(seconds_s) => Some(seconds_s),
            Self::Endless => None,
        }
    }
}

impl Plan {
    /// The plan for a command line; `hz` is the pace that frames are expected at.
    ///
    /// # Errors
    /// [`Failure`] if a number makes no track, or a height above ground is asked for where there is none.
    pub fn new(args: &FlyArgs, length: Length, hz: f64, world: &World, area: &Area) -> Result<Self, Failure> {
        if let Some(named) = &args.scenario {
            return situation(named).map(|situation| Self::Situation(Box::new(situation)));
        }
        let is_straight =
            args.world.is_some() || args.eye.is_some() || args.heading_deg.is_some() || args.speed_mps.is_some();
        let track = if is_straight { straight(args, length, hz, world, area)? } else { scenic(world)? };
        let mut pictures: Vec<PicturePlace> = track
            .pictures()
            .iter()
            .map(|(distance_m, name)| PicturePlace { distance_m: *distance_m, name: name.clone() })
            .collect();
        if pictures.is_empty() {
            let apart_m = track.length_m() / f64::from(PICTURES - 1);
            pictures.extend((0..PICTURES).map(|number| {
                let distance_m = f64::from(number) * apart_m;
                PicturePlace { distance_m, name: format!("{:.1} km", distance_m / 1e3) }
            }));
        }
        Ok(Self::Track { track, pictures, aircraft: aircraft(args)? })
    }

    /// When it is flown, unless a date is asked for.
    ///
    /// # Errors
    /// [`Failure::Failed`] if a situation's own date is none.
    pub fn date(&self, args: &FlyArgs, world: &World) -> Result<UtcTime, Failure> {
        let own = match self {
            Self::Track { .. } => None,
            Self::Situation(situation) => situation.date().map_err(|error| Failure::Failed(error.to_string()))?,
        };
        Ok(args.view.time.or(own).unwrap_or_else(|| scenery::default_moment(world)))
    }

    /// What the pilot is told at the start.
    pub fn say(&self) -> &[String] {
        match self {
            Self::Track { .. } => &[],
            Self::Situation(situation) => situation.say(),
        }
    }

    /// A scene that flies the plan from its start; a situation's own script flies it where no one else does.
    ///
    /// # Errors
    /// [`Failure::Failed`] if the world is none for the situation.
    pub fn scene(&self, world: &World, date: UtcTime, scripted: bool) -> Result<Scene, Failure> {
        match self {
            Self::Track { track, aircraft: Some((model, speed_mps)), .. } => trimmed(track, model, *speed_mps, date),
            Self::Track { track, .. } => {
                let mut scene = Scene::new(AircraftState::level(DVec3::new(0.0, 5_000.0, 0.0), 0.0, SPEED_MPS), date);
                scene.fly_track(track.clone());
                Ok(scene)
            }
            Self::Situation(situation) => situation
                .scene(world, date, DEFAULT_STEP_HZ, Catalogue::default(), scripted)
                .map_err(|error| Failure::Failed(error.to_string())),
        }
    }
}

/// A body that is trimmed where a track begins, flown by its pilot.
fn trimmed(track: &Track, model: &Arc<Model>, speed_mps: f64, date: UtcTime) -> Result<Scene, Failure> {
    let failed = |why: String| Failure::Failed(format!("{}: {why}", model.file.display()));
    let refused = |why: sim::scene::Refused| failed(why.to_string());
    let begins = track.state(0.0, 0.5);
    let heading_rad = begins.angles().heading_rad;
    let mut catalogue = Catalogue::new();
    catalogue.add_model("own", (**model).clone()).map_err(refused)?;
    let level = AircraftState::level(begins.position_m, heading_rad, speed_mps);
    let around = Surroundings::default();
    let mut scene = Scene::furnished(level, date, DEFAULT_STEP_HZ, around, Arc::new(catalogue)).map_err(refused)?;
    let start = BodyStart {
        model: "own".to_owned(),
        position_m: level.position_m,
        velocity_mps: level.velocity_mps,
        attitude: level.attitude,
        rates_radps: DVec3::ZERO,
        fuel: None,
    };
    let id = scene.add_body(&start).map_err(refused)?;
    scene.order(sim::scene::Command::FlyBody { id }).map_err(refused)?;
    scene.set_levers(Levers { gear: 0.0, ..Levers::default() });
    scene.trim_flown().map_err(refused)?;
    Ok(scene)
}

/// A situation by its name, or of a file.
fn situation(named: &Path) -> Result<Situation, Failure> {
    let builtin = named.to_str().filter(|name| BUILTIN.iter().any(|(known, _)| known == name));
    let read = match builtin {
        Some(name) => Situation::builtin(name),
        None if named.is_file() => Situation::read(named),
        None => {
            let known: Vec<&str> = BUILTIN.iter().map(|(name, _)| *name).collect();
            let (known, found) = (known.join(", "), named.display());
            return Err(Failure::Misuse(format!("--scenario: expected one of {known}, or a file, found {found}")));
        }
    };
    read.map_err(|error| Failure::Failed(error.to_string()))
}

/// The body that is asked for, with the speed that it begins at.
fn aircraft(args: &FlyArgs) -> Result<Option<(Arc<Model>, f64)>, Failure> {
    let unusable = |error: FileError| Failure::Misuse(error.to_string());
    let asked = args.aircraft.as_str();
    let model = match builtin::named(asked) {
        _ if asked == "point_mass" => return Ok(None),
        Some(model) => model.map_err(unusable)?,
        None if asked.ends_with(".toml") => Model::read(Path::new(asked)).map_err(unusable)?,
        None => {
            let known = builtin::names();
            return Err(Failure::Misuse(format!(
                "--aircraft: expected point_mass, {known} or a file M.toml, found {asked}"
            )));
        }
    };
    let speed_mps = args.speed_mps.unwrap_or(0.65 * model.never_exceed_mps.unwrap_or(85.0));
    Ok(Some((Arc::new(model), speed_mps)))
}

fn scenic(world: &World) -> Result<Track, Failure> {
    let failed = |error: TrackError| Failure::while_doing("reading the built-in flight", error);
    let flight = Flight::parse(ISSYK_KUL_FLIGHT).map_err(failed)?;
    let plan = |lat_deg, lon_deg| {
        let at = world.projection.to_world(Geodetic::from_degrees(lat_deg, lon_deg));
        (at.x, at.y)
    };
    Track::through(&flight, &plan).map_err(failed)
}

fn straight(args: &FlyArgs, length: Length, hz: f64, world: &World, area: &Area) -> Result<Track, Failure> {
    let refused = |error: TrackError| Failure::while_doing("laying out the track", error);
    let height_at = stage::height_at(area);
    let grid = area.grid();
    let (wide_m, high_m) = (grid.east_m() - grid.west_m, grid.south_m() - grid.north_m);
    let speed_mps = args.speed_mps.unwrap_or(SPEED_MPS);
    let flown_m = length.seconds(hz).map(|seconds_s| (seconds_s * speed_mps).max(1.0));
    let over_ground = |clearance_m| TrackHeight::AboveHighest { clearance_m, ahead_m: AHEAD_M };

    let Some(place) = args.eye else {
        let middle_m = (0.5 * (grid.west_m + grid.east_m()), 0.5 * (grid.north_m + grid.south_m()));
        let heading_rad = args.heading_deg.map_or(wide_m.atan2(high_m), |true_deg| {
            scenery::grid_heading_rad(world, DVec3::new(middle_m.0, 0.0, middle_m.1), true_deg.to_radians())
        });
        // Of the diagonal, nine tenths: the ends are the world's corners.
        let distance_m = flown_m.unwrap_or(0.9 * wide_m.hypot(high_m)).min(sim::track::LONGEST_M);
        return Track::centred(middle_m, heading_rad, distance_m, speed_mps, over_ground(CLEARANCE_M), &*height_at)
            .map_err(refused);
    };
    let eye_m = scenery::position(world, area, place)?;
    let heading_rad = scenery::grid_heading_rad(world, eye_m, args.heading_deg.unwrap_or(0.0).to_radians());
    let distance_m = flown_m.unwrap_or(100_000.0).min(sim::track::LONGEST_M);
    let height = match place.altitude {
        Altitude::GroundM(clearance_m) if speed_mps > 0.0 => over_ground(clearance_m),
        // Standing still, the ground ahead does not matter.
        _ => TrackHeight::Msl(eye_m.y),
    };
    if let Some(ground_m) = area.height_m(eye_m.x, eye_m.z).filter(|ground_m| eye_m.y < *ground_m) {
        output::tell(format_args!(
            "poligon: {:.0} m is {:.0} m under the ground there; the flight starts above it",
            eye_m.y,
            ground_m - eye_m.y
        ));
    }
    if !(ALTITUDE_M.0..=ALTITUDE_M.1).contains(&eye_m.y) {
        return Err(Failure::Misuse(format!(
            "expected an altitude of {}..={} m to fly at, found {:.0} m",
            ALTITUDE_M.0, ALTITUDE_M.1, eye_m.y
        )));
    }
    Track::straight((eye_m.x, eye_m.z), heading_rad, distance_m, speed_mps, height, &*height_at).map_err(refused)
}
