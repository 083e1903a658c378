//! The scene: its entities and its time.
//!
//! | file | what |
//! |---|---|
//! | `flown.rs` | the own aircraft as one of the bodies |
//! | `own.rs` | the own aircraft: piloted, on its track, slewed |
//! | `body.rs`, `failure.rs` | rigid bodies, their failures and fuel |
//! | `shell.rs`, `gun.rs` | projectiles, and how they are fired |
//! | `arms.rs`, `effects.rs` | stations of an owner; what weapons do where they end |
//! | `target.rs`, `route.rs`, `stance.rs` | targets, how they drive and stand |
//! | `target_grid.rs` | which targets a path comes near |
//! | `loose.rs` | what lies about ([`crate::loose`]): who pushes it, what becomes debris |
//! | `ground.rs`, `surroundings.rs` | the ground; Earth, air, wind, seed |
//! | `command.rs`, `orders.rs` | commands as data, and what they do |
//! | `step.rs` | one fixed step of everything |
//! | `event.rs`, `view.rs` | what a snapshot tells |
//! | `catalogue.rs`, `codec.rs`, `save.rs` | what entities are made of; saving and restoring |
//!
//! Entities live in a hecs world, loose things in a list of their own; each has a [`StableId`], given in order of creation and never twice. All are stepped
//! in the order of their ids, so nothing depends on how hecs stores them. World frame (X east, Y up, Z south), SI;
//! models and shells fly in north, east, down from the same origin ([`crate::frame`] turns one into the other).
//!
//! Invariant others rely on: a scene and the commands after it give the same [`Scene::hash`] at every later step, on
//! any machine with the same arithmetic; saving and restoring in between changes nothing.

mod arms;
mod body;
mod catalogue;
mod cockpit;
pub(crate) mod codec;
mod command;
mod crew;
mod effects;
mod event;
mod failure;
mod flown;
mod ground;
mod gun;
mod loose;
mod orders;
mod own;
mod route;
mod save;
mod shell;
mod stance;
mod step;
mod surroundings;
mod target;
mod target_grid;
mod view;

pub use arms::{Hanging, MOST_STATIONS, MOST_STORES_KG, PageRow, StoresLoad, WeaponPage};
pub use body::{ALTITUDES_M, BodyStart};
pub use catalogue::Catalogue;
pub use codec::SaveError;
pub use command::{Command, Freeze, Stamped};
pub use crew::RIPPLE_S;
pub use event::{EndReason, Event, Happening, KEPT_S, MOST_KEPT, Strike};
pub use failure::{Failure, Fuel, FuelChange, MOST_FAILURES};
pub use flown::Instruments;
pub use ground::{GroundTouch, LOOK_M, SceneGround};
pub use gun::{MOST_PER_MINUTE, Muzzle};
pub use loose::LooseStart;
pub use route::{MOST_WAYPOINTS, SHORTEST_LEG_M};
pub use stance::CONTACT_M;
pub use surroundings::{MOST_WIND_MPS, Surroundings};
pub use target::{Column, Height, Reaction, TargetStart};
pub use view::{EntityKind, EntityView};

pub(crate) use codec::{FNV_BASIS, fnv};
pub(crate) use view::interpolated;

use crate::aircraft::point_mass::PointMass;
use crate::aircraft::{self, AircraftState, FARTHEST_M};
use crate::ballistics::targets::Target;
use crate::clock::{Clock, DEFAULT_STEP_HZ};
use crate::input::{Controls, Levers};
use crate::loose::Loose;
use crate::rigid::gear::near;
use crate::snapshot::{Mode, StableId};
use crate::track::Track;
use crate::utc::UtcTime;
use crate::weapons::Tally;
use arms::Arms;
use body::{Body, Rig};
use effects::Ended;
use event::Log;
use glam::{DQuat, DVec3};
use gun::Burst;
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::sync::Arc;
use target::TargetState;
use target_grid::TargetGrid;
use view::Views;

/// Highest speed that a caller may give, m/s.
pub const MOST_SPEED_MPS: f64 = aircraft::MAX_SPEED_MPS;

/// Why something cannot be done: what was expected and what was found. The scene is as it was.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused(String);

impl Refused {
    pub(crate) fn new(why: impl fmt::Display) -> Self {
        Self(why.to_string())
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refused {}

/// Entities of a kind, by id.
type Roster = Vec<(StableId, hecs::Entity)>;

/// A scene and its time.
pub struct Scene {
    ecs: hecs::World,
    own: hecs::Entity,
    own_id: StableId,
    /// Time.
    pub clock: Clock,
    model: PointMass,
    start: AircraftState,
    controls: Controls,
    levers: Levers,
    /// Force to the right over weight in the last step; shown, never flown with.
    side_g: f64,
    /// The body that is the own aircraft, if it is one.
    flown: Option<StableId>,
    track: Option<Track>,
    track_m: f64,
    mode: Mode,
    freeze: Freeze,
    height_above_ground_m: Option<f64>,
    jumps: u32,
    catalogue: Arc<Catalogue>,
    surroundings: Surroundings,
    next_id: u64,
    bodies: Roster,
    shells: Roster,
    targets: Roster,
    /// What lies about.
    loose: Loose,
    /// The equations of motion of each model of the catalogue.
    rigs: Vec<Rig>,
    /// Targets as a step sweeps them, in the order of `targets`.
    swept: Vec<Target>,
    /// Whether `grid` does not know all of `swept`.
    swept_anew: bool,
    /// Whether targets wait for their height over the ground.
    unsettled: bool,
    /// Version of the ground of the last step, once there was one. The ground itself is the caller's: it is not saved.
    ground_version: Option<u32>,
    grid: TargetGrid,
    bursts: Vec<Burst>,
    /// Rounds that each owner has fired.
    fired: BTreeMap<StableId, u64>,
    /// What owners carry.
    arms: BTreeMap<StableId, Arms>,
    /// Projectiles that struck and whose delay runs.
    resting: Vec<Ended>,
    /// Sums of scores, by owner and weapon.
    tallies: BTreeMap<(StableId, u32), Tally>,
    /// The own aircraft's weapons as its crew sees them; follows from the rest.
    page: Option<Arc<WeaponPage>>,
    log: Log,
    pending: VecDeque<Stamped>,
    record: Option<Vec<Stamped>>,
    views: Views,
}

impl Scene {
    /// A scene with one aircraft, flown by the pilot, over a plain flat Earth with standard air.
    pub fn new(start: AircraftState, date: UtcTime) -> Self {
        Self::with_step_hz(start, date, DEFAULT_STEP_HZ)
    }

    /// The same with another number of steps a second.
    pub fn with_step_hz(start: AircraftState, date: UtcTime, step_hz: u32) -> Self {
        Self::within(start, date, step_hz, Surroundings::default(), Arc::default())
    }

    /// A scene in its surroundings, with what its entities may be made of.
    ///
    /// # Errors
    /// [`Refused`] if a number of the wind or the turbulence is none.
    pub fn furnished(
        start: AircraftState,
        date: UtcTime,
        step_hz: u32,
        surroundings: Surroundings,
        catalogue: Arc<Catalogue>,
    ) -> Result<Self, Refused> {
        surroundings.check()?;
        Ok(Self::within(start, date, step_hz, surroundings, catalogue))
    }

    fn within(
        start: AircraftState,
        date: UtcTime,
        step_hz: u32,
        surroundings: Surroundings,
        catalogue: Arc<Catalogue>,
    ) -> Self {
        let safe = AircraftState::level(DVec3::new(0.0, 5_000.0, 0.0), 0.0, 150.0);
        let start = if start.is_finite() { aircraft::checked(&safe, start) } else { safe };
        let mut ecs = hecs::World::new();
        let own_id = StableId(1);
        let own = ecs.spawn((own_id, start));
        let controls = Controls { throttle: start.throttle, ..Controls::default() }.checked();
        let rigs = catalogue.models.iter().map(|named| Rig::new(&named.thing, &surroundings)).collect();
        Self {
            ecs,
            own,
            own_id,
            clock: Clock::new(step_hz, date),
            model: PointMass::default(),
            start,
            controls,
            levers: Levers::default(),
            side_g: 0.0,
            flown: None,
            track: None,
            track_m: 0.0,
            mode: Mode::Pilot,
            freeze: Freeze::None,
            height_above_ground_m: None,
            jumps: 0,
            catalogue,
            surroundings,
            next_id: own_id.0 + 1,
            bodies: Roster::new(),
            shells: Roster::new(),
            targets: Roster::new(),
            loose: Loose::default(),
            rigs,
            swept: Vec::new(),
            swept_anew: false,
            unsettled: false,
            ground_version: None,
            grid: TargetGrid::default(),
            bursts: Vec::new(),
            fired: BTreeMap::new(),
            arms: BTreeMap::new(),
            resting: Vec::new(),
            tallies: BTreeMap::new(),
            page: None,
            log: Log::new(),
            pending: VecDeque::new(),
            record: None,
            views: Views::default(),
        }
    }

    /// Adds a rigid body.
    ///
    /// # Errors
    /// [`Refused`] if a number is none, there is no such model, or the body is too stiff for the scene's step.
    pub fn add_body(&mut self, start: &BodyStart) -> Result<StableId, Refused> {
        let model = self.catalogue.model(&start.model)?;
        let (id, step_s) = (StableId(self.next_id), self.clock.step_s());
        let keys = self.turbulence_keys(id);
        if near::most_pieces(&self.catalogue.models[model as usize].thing, step_s).is_none() {
            return Err(Refused::new(format_args!(
                "body: expected wheels and skids that a step of {step_s} s holds in 1,000 pieces, found stiffer ones"
            )));
        }
        let mut body = Body::new(start, model, &mut self.rigs[model as usize], &keys, &self.surroundings)?;
        body.look(&self.rigs[model as usize], step_s).map_err(|reason| {
            Refused::new(format_args!("body: expected one that steps of {step_s} s hold, found it {reason:?}"))
        })?;
        body.stagger(id);
        let entity = self.ecs.spawn((id, body));
        self.bodies.push((id, entity));
        self.next_id += 1;
        self.views.bodies.take();
        Ok(id)
    }

    /// Adds a target.
    ///
    /// # Errors
    /// [`Refused`] if a number is none or there is no such kind or shape.
    pub fn add_target(&mut self, start: &TargetStart) -> Result<StableId, Refused> {
        let shape = self.catalogue.shape(&start.shape)?;
        let kind = self.catalogue.kind(&start.shape).map(|kind| (kind, &*self.catalogue.kinds[kind as usize].thing));
        let target = TargetState::new(start, shape, kind)?;
        let id = StableId(self.next_id);
        self.enlist_targets(vec![(id, target)]);
        self.next_id += 1;
        Ok(id)
    }

    /// The target of a kind, by its name, that stands nearest to the own aircraft.
    ///
    /// # Errors
    /// [`Refused`] names the kind if the scene has no target of it.
    pub fn nearest_target(&self, kind: &str) -> Result<StableId, Refused> {
        let wanted = self.catalogue.kind(kind);
        let from_m = self.aircraft().position_m;
        let of = |&(id, entity): &(StableId, hecs::Entity)| {
            let target = self.ecs.get::<&TargetState>(entity).ok()?;
            (target.kind.is_some() && target.kind == wanted).then(|| (id, target.position_m.distance_squared(from_m)))
        };
        let nearest = self.targets.iter().filter_map(of).min_by(|(_, a), (_, b)| a.total_cmp(b));
        let missing = || Refused::new(format_args!("target: expected a kind that stands in the scene, found {kind}"));
        nearest.map(|(id, _)| id).ok_or_else(missing)
    }

    fn enlist_targets(&mut self, targets: Vec<(StableId, TargetState)>) {
        for (id, target) in targets {
            let (shape, pose) = (self.catalogue.shapes[target.shape as usize].thing.clone(), target.pose());
            self.swept.push(Target { id, shape, from: pose, to: pose });
            let entity = self.ecs.spawn((id, target));
            self.targets.push((id, entity));
        }
        self.views.targets.take();
        (self.swept_anew, self.unsettled) = (true, true);
    }

    /// The own aircraft's id.
    pub fn own_id(&self) -> StableId {
        self.own_id
    }

    /// What surrounds the entities.
    pub fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// What the entities are made of.
    pub fn catalogue(&self) -> &Arc<Catalogue> {
        &self.catalogue
    }

    /// Numbers of bodies, projectiles and targets.
    pub fn counts(&self) -> [usize; 3] {
        [self.bodies.len(), self.shells.len(), self.targets.len()]
    }

    /// Fuel that a body has left, kg; `None` if it has no tanks or there is no such body.
    pub fn fuel_kg(&self, id: StableId) -> Option<f64> {
        let body = self.ecs.get::<&Body>(found(&self.bodies, id)?).ok()?;
        body.tanks.as_ref().map(|tanks| tanks.fuel.fuel_kg)
    }

    fn turbulence_keys(&self, id: StableId) -> [u64; 3] {
        // No round has this number.
        [self.surroundings.seed, id.0, u64::MAX]
    }
}

/// The entity of an id in a roster.
fn found(roster: &Roster, id: StableId) -> Option<hecs::Entity> {
    roster.binary_search_by_key(&id, |(id, _)| *id).ok().map(|place| roster[place].1)
}

/// A place within the bounds of any world.
fn place(key: &str, at: DVec3) -> Result<DVec3, Refused> {
    let inside = at.is_finite()
        && at.x.abs() <= FARTHEST_M
        && at.z.abs() <= FARTHEST_M
        && (ALTITUDES_M.0..=ALTITUDES_M.1).contains(&at.y);
    let refuse = || Refused::new(format_args!("{key}: expected a place within a world, found {at}"));
    if inside { Ok(at) } else { Err(refuse()) }
}

/// A velocity that may be given.
fn speed(key: &str, velocity: DVec3) -> Result<DVec3, Refused> {
    let good = velocity.is_finite() && velocity.length() <= MOST_SPEED_MPS;
    let refuse = || Refused::new(format_args!("{key}: expected at most {MOST_SPEED_MPS} m/s, found {velocity}"));
    if good { Ok(velocity) } else { Err(refuse()) }
}

/// An attitude of length 1; one that is off by a tenth was not meant as one.
fn attitude(key: &str, given: DQuat) -> Result<DQuat, Refused> {
    let good = given.is_finite() && (given.length() - 1.0).abs() < 0.1;
    let refuse = || Refused::new(format_args!("{key}: expected an attitude of length 1, found {given}"));
    if good { Ok(given.normalize()) } else { Err(refuse()) }
}
