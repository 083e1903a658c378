//! What commands do to a scene, and the record of those that were done.
//!
//! Invariant others rely on: a command is checked whole before anything changes; what is refused changes nothing. If it
//! had been scheduled, an event tells it, and it stands in the record.

use super::arms::{Arms, Load, MOST_STATIONS, MOST_STORES_KG, Station, StoresLoad};
use super::body::{Body, Rig};
use super::codec::{Coded, Reader};
use super::event::Happening;
use super::failure::{Armed, MOST_FAILURES, control_of};
use super::gun::Burst;
use super::shell::Shell;
use super::surroundings::Surroundings;
use super::target::TargetState;
use super::{Command, Refused, Scene, Stamped, attitude, found, place, speed};
use crate::aircraft::AircraftState;
use crate::rigid::Model;
use crate::snapshot::StableId;
use crate::weapons::{Aim, Fuze, WeaponKind};
use glam::{DQuat, DVec2, DVec3};
use std::collections::VecDeque;
use std::sync::Arc;

/// Most bursts at a time: guns of a scene that fire at once.
const MOST_BURSTS: usize = 100_000;

/// Between two bombs that are jettisoned, seconds.
const JETTISON_S: f64 = 0.1;

/// Rounds that leave one after the other.
struct Lot {
    rounds: u32,
    together: u32,
    interval_s: f64,
    aim: Aim,
    fuze: Fuze,
}

impl Scene {
    /// Does a command now, between two steps.
    ///
    /// # Errors
    /// [`Refused`] says what was expected and what was found; the scene is as it was.
    pub fn order(&mut self, command: Command) -> Result<(), Refused> {
        if !command.concerns_scene() {
            return Ok(());
        }
        sound(&command)?;
        self.apply(&command)?;
        if let Some(record) = &mut self.record {
            record.push(Stamped { step: self.clock.step(), command });
        }
        Ok(())
    }

    /// Does a command before the step that follows the given number of steps. Those for one step keep their order.
    ///
    /// Whether there is such an entity is seen when it is due; a refusal is then an event.
    ///
    /// # Errors
    /// [`Refused`] if that step was taken already or a number of the command is none.
    pub fn schedule(&mut self, stamped: Stamped) -> Result<(), Refused> {
        if stamped.step < self.clock.step() {
            let (expected, found) = (self.clock.step(), stamped.step);
            return Err(Refused::new(format_args!("command: expected a step of {expected} or later, found {found}")));
        }
        sound(&stamped.command)?;
        if stamped.command.concerns_scene() {
            let place = self.pending.partition_point(|other| other.step <= stamped.step);
            self.pending.insert(place, stamped);
        }
        Ok(())
    }

    /// Keeps from now on every command that is done, with its step.
    pub fn start_record(&mut self) {
        self.record = Some(Vec::new());
    }

    /// The commands since the record was started, in order, also those that were due and refused; scheduled on a scene as this one was then, they give
    /// the same again.
    pub fn record(&self) -> &[Stamped] {
        self.record.as_deref().unwrap_or_default()
    }

    /// Commands that are not yet due.
    pub fn pending(&self) -> &VecDeque<Stamped> {
        &self.pending
    }

    /// Does what is due.
    pub(super) fn obey(&mut self) {
        while self.pending.front().is_some_and(|stamped| stamped.step <= self.clock.step()) {
            let Some(Stamped { command, .. }) = self.pending.pop_front() else { return };
            if let Err(why) = self.apply(&command) {
                self.log.add(self.clock.time_s(), Happening::Refused { why: shown(&why) });
            }
            // Refused or not: a replay must refuse it again, as the event counts.
            if let Some(record) = &mut self.record {
                record.push(Stamped { step: self.clock.step(), command });
            }
        }
    }

    fn apply(&mut self, command: &Command) -> Result<(), Refused> {
        match command {
            Command::Pilot(command) => self.pilot(*command),
            Command::Controls(controls) => self.controls = controls.checked(),
            Command::Levers(levers) => self.levers = levers.checked(),
            Command::FlyBody { id } => self.fly(*id)?,
            Command::Autopilot { id, holds } => self.change_body(*id, |body, model| body.engage(*holds, model))?,
            Command::Place(state) => self.put(**state),
            Command::SeekTrack(distance_m) => self.seek(*distance_m),
            Command::Date(date) => self.clock.set_date(*date),
            Command::DayRate(rate) => self.clock.set_day_rate(*rate),
            Command::Freeze(freeze) => self.freeze = *freeze,
            Command::Reposition { id, position_m, velocity_mps, attitude } => {
                self.reposition(*id, *position_m, *velocity_mps, *attitude)?;
            }
            Command::Wind(rows) => {
                self.surroundings.wind = Surroundings::checked_wind(rows)?;
                let models = self.catalogue.models.iter();
                self.rigs = models.map(|named| Rig::new(&named.thing, &self.surroundings)).collect();
                for &(_, entity) in &self.bodies {
                    if let Ok(mut body) = self.ecs.get::<&mut Body>(entity) {
                        body.look_anew();
                    }
                }
            }
            Command::Turbulence(sigma_mps) => {
                self.surroundings.turbulence_mps = Surroundings::checked_turbulence(*sigma_mps)?;
                for &(id, entity) in &self.bodies {
                    let keys = self.turbulence_keys(id);
                    if let Ok(mut body) = self.ecs.get::<&mut Body>(entity) {
                        body.set_turbulence(*sigma_mps, &keys);
                    }
                }
            }
            Command::Control { id, control, value } => {
                self.change_body(*id, |body, model| {
                    let place = control_of(model, control)? as usize;
                    let of = &model.controls[place];
                    body.controls[place] = value.clamp(of.min, of.max);
                    Ok(())
                })?;
            }
            Command::Fuel { id, change } => {
                let why = || Refused::new(format_args!("fuel: expected a body with fuel, found {} without", id.0));
                self.change_body(*id, |body, _| body.tanks.as_mut().ok_or_else(why)?.change(*change))?;
            }
            Command::Fail { id, name, failure, in_steps } => {
                let at_step = self.clock.step().saturating_add(*in_steps);
                self.change_body(*id, |body, model| {
                    let armed = Armed::new(name, failure, at_step, model)?;
                    let others = body.failures.iter().filter(|other| other.name != *name).count();
                    if others >= MOST_FAILURES {
                        return Err(Refused::new(format_args!("failure: expected at most {MOST_FAILURES} of a body")));
                    }
                    body.failures.retain(|other| other.name != *name);
                    body.failures.push(armed);
                    Ok(())
                })?;
            }
            Command::Clear { id, name } => {
                self.change_body(*id, |body, _| {
                    let place = body.failures.iter().position(|armed| armed.name == *name);
                    let missing = || Refused::new(format_args!("failure: expected one of the body's, found {name}"));
                    body.failures.remove(place.ok_or_else(missing)?);
                    Ok(())
                })?;
            }
            Command::Fire { owner, projectile, muzzle, rounds, per_minute } => {
                let kind = self.catalogue.projectile(projectile)?;
                if self.carriage(*owner).is_none() {
                    let found = owner.0;
                    return Err(Refused::new(format_args!(
                        "fire.owner: expected an entity that can fire, found {found}"
                    )));
                }
                if self.bursts.len() >= MOST_BURSTS {
                    return Err(Refused::new(format_args!("fire: expected at most {MOST_BURSTS} bursts at a time")));
                }
                self.bursts.push(Burst::new(*owner, kind, *muzzle, *rounds, *per_minute, self.clock.time_s())?);
            }
            Command::Load { owner, weapon, rounds, at_m } => self.load_station(*owner, weapon, *rounds, *at_m)?,
            Command::Arm { owner, master, weapon, fuze } => {
                let selected = weapon.as_deref().map(|weapon| self.catalogue.weapon(weapon)).transpose()?;
                if let Some(fuze) = fuze {
                    fuze.check().map_err(Refused::new)?;
                }
                let arms = self.arms_of(*owner)?;
                (arms.master, arms.selected, arms.fuze) = (*master, selected, *fuze);
            }
            Command::Release { owner, weapon, rounds, together, interval_s, aim } => {
                self.release(*owner, weapon, *rounds, *together, *interval_s, *aim)?;
            }
            Command::Jettison { owner, weapon } => self.jettison(*owner, weapon.as_deref())?,
            Command::CeaseFire { owner } => self.bursts.retain(|burst| burst.owner != *owner),
        }
        Ok(())
    }

    fn arms_of(&mut self, owner: StableId) -> Result<&mut Arms, Refused> {
        let missing = || Refused::new(format_args!("owner: expected one with stations, found {}", owner.0));
        self.arms.get_mut(&owner).ok_or_else(missing)
    }

    fn load_station(&mut self, owner: StableId, weapon: &str, rounds: u32, at_m: DVec3) -> Result<(), Refused> {
        let weapon = self.catalogue.weapon(weapon)?;
        self.catalogue.weapons[weapon as usize].thing.muzzle(at_m).check()?;
        if self.carriage(owner).is_none() {
            let found = owner.0;
            return Err(Refused::new(format_args!("load.owner: expected an entity that can fire, found {found}")));
        }
        let hung = self.arms.get(&owner).map_or(0, |arms| arms.stations.len());
        if hung >= MOST_STATIONS {
            return Err(Refused::new(format_args!("load: expected at most {MOST_STATIONS} stations")));
        }
        let more_kg = self.catalogue.weapons[weapon as usize].thing.carried_kg * f64::from(rounds);
        // The own aircraft's stations and those of the body that it is hang on one body.
        let is_own = owner == self.own_id || self.flown == Some(owner);
        let together = [Some(self.own_id), self.flown];
        let carriers = if is_own { together } else { [Some(owner), None] };
        let hung_kg: f64 = carriers.into_iter().flatten().map(|id| self.stores_load(id).mass_kg).sum();
        let mass_kg = hung_kg + more_kg;
        if mass_kg > MOST_STORES_KG {
            return Err(Refused::new(format_args!(
                "load: expected stores of up to {MOST_STORES_KG} kg, found {mass_kg}"
            )));
        }
        let station = Station { weapon, at_m, loaded: rounds, left: rounds };
        self.arms.entry(owner).or_default().stations.push(station);
        self.weigh(owner);
        Ok(())
    }

    fn release(
        &mut self,
        owner: StableId,
        weapon: &str,
        rounds: u32,
        together: u32,
        interval_s: f64,
        aim: Aim,
    ) -> Result<(), Refused> {
        let of = self.catalogue.weapons[self.catalogue.weapon(weapon)? as usize].thing.clone();
        if let Aim::Place(at_m) = aim {
            place("release.aim", at_m)?;
        }
        if let Aim::Target(id) = aim
            && found(&self.targets, id).is_none()
        {
            return Err(Refused::new(format_args!("release.aim: expected a target of the scene, found {}", id.0)));
        }
        let arms = self.arms_of(owner)?;
        if !arms.master {
            return Err(Refused::new("release: expected the master arm to be on, found it off"));
        }
        let fuze = arms.fuze.unwrap_or(of.fuze);
        let interval_s = if interval_s == 0.0 { 60.0 / of.per_minute } else { interval_s };
        self.let_go(owner, weapon, Lot { rounds, together, interval_s, aim, fuze })
    }

    /// Lets rounds go with a fuze, whatever the master arm.
    fn let_go(&mut self, owner: StableId, name: &str, lot: Lot) -> Result<(), Refused> {
        let (weapon, projectile) = (self.catalogue.weapon(name)?, self.catalogue.projectile(name)?);
        let of = self.catalogue.weapons[weapon as usize].thing.clone();
        let Lot { rounds, together, interval_s, aim, fuze } = lot;
        let at_m = {
            let arms = self.arms_of(owner)?;
            let none = || Refused::new(format_args!("release: expected a round of {name}, found none left"));
            arms.stations[arms.next(weapon).ok_or_else(none)?].at_m
        };
        if self.carriage(owner).is_none() {
            return Err(Refused::new(format_args!("release.owner: expected one that can fire, found {}", owner.0)));
        }
        if self.bursts.len() >= MOST_BURSTS {
            return Err(Refused::new(format_args!("release: expected at most {MOST_BURSTS} bursts at a time")));
        }
        let load = Load { weapon, fuze, aim, way: DVec2::ZERO };
        let burst = Burst::new(owner, projectile, of.muzzle(at_m), rounds, of.per_minute, self.clock.time_s())?;
        self.bursts.push(burst.of_weapon(load, together, interval_s)?);
        Ok(())
    }

    fn jettison(&mut self, owner: StableId, weapon: Option<&str>) -> Result<(), Refused> {
        let only = weapon.map(|name| self.catalogue.weapon(name)).transpose()?;
        let kinds = self.arms_of(owner)?.kinds().into_iter().filter(|kind| only.is_none_or(|only| only == *kind));
        let kinds: Vec<u32> = kinds.collect();
        // All that could be refused on the way is refused before anything goes.
        if self.carriage(owner).is_none() {
            return Err(Refused::new(format_args!("jettison: expected one that can let go, found {}", owner.0)));
        }
        if self.bursts.len() + kinds.len() > MOST_BURSTS {
            return Err(Refused::new(format_args!("jettison: expected at most {MOST_BURSTS} bursts at a time")));
        }
        for weapon in kinds {
            let named = &self.catalogue.weapons[weapon as usize];
            let (name, of) = (named.name.clone(), named.thing.clone());
            match of.kind {
                WeaponKind::Gun => {}
                WeaponKind::Bomb => {
                    let rounds = self.arms_of(owner)?.rounds(weapon).0;
                    if rounds > 0 {
                        let lot =
                            Lot { rounds, together: 1, interval_s: JETTISON_S, aim: Aim::Nearest, fuze: Fuze::SAFE };
                        self.let_go(owner, &name, lot)?;
                    }
                }
                WeaponKind::Rocket => {
                    // A pod is not followed to the ground: nothing of it bursts there.
                    let stations = &mut self.arms_of(owner)?.stations;
                    stations.iter_mut().filter(|one| one.weapon == weapon).for_each(|one| one.left = 0);
                }
            }
        }
        self.weigh(owner);
        Ok(())
    }

    /// Lets a body feel what its stores are now: its own, and the own aircraft's if it is that.
    pub(super) fn weigh(&mut self, owner: StableId) {
        let is_own = owner == self.own_id || self.flown == Some(owner);
        let carrier = if is_own { self.flown } else { Some(owner) };
        let Some(id) = carrier else { return };
        let carriers = [Some(id), is_own.then_some(self.own_id)];
        let arms = carriers.iter().flatten().filter_map(|id| self.arms.get(id));
        let stores = StoresLoad::of(arms.flat_map(|arms| arms.points(&self.catalogue)));
        let planet = self.surroundings.planet();
        if let Some(entity) = found(&self.bodies, id)
            && let Ok(mut body) = self.ecs.get::<&mut Body>(entity)
        {
            let model = self.catalogue.models[body.model as usize].thing.clone();
            body.hang(stores, &model, &planet);
            body.look_anew();
        }
        self.views.bodies.take();
        if is_own {
            self.join_flown();
        }
    }

    fn reposition(
        &mut self,
        id: StableId,
        position_m: DVec3,
        velocity_mps: DVec3,
        given: DQuat,
    ) -> Result<(), Refused> {
        let (position_m, velocity_mps) = (place("position_m", position_m)?, speed("velocity_mps", velocity_mps)?);
        let attitude = attitude("attitude", given)?;
        if id == self.own_id {
            let heading_rad = crate::frame::angles(attitude).heading_rad;
            let level = AircraftState::level(position_m, heading_rad, velocity_mps.length());
            self.put(AircraftState { velocity_mps, attitude, throttle: self.controls.throttle, ..level });
        } else if let Some(entity) = found(&self.targets, id) {
            if let Ok(mut target) = self.ecs.get::<&mut TargetState>(entity) {
                target.reposition(position_m, attitude);
            }
            self.views.targets.take();
        } else if let Some(entity) = found(&self.shells, id) {
            if let Ok(mut shell) = self.ecs.get::<&mut Shell>(entity) {
                shell.relocate(position_m, velocity_mps);
            }
            self.views.shells.take();
        } else {
            let planet = self.surroundings.planet();
            self.change_body(id, |body, _| body.relocate(position_m, velocity_mps, attitude, DVec3::ZERO, &planet))?;
        }
        Ok(())
    }

    fn change_body(
        &mut self,
        id: StableId,
        change: impl FnOnce(&mut Body, &Arc<Model>) -> Result<(), Refused>,
    ) -> Result<(), Refused> {
        let missing = || Refused::new(format_args!("id: expected a rigid body of the scene, found {}", id.0));
        let entity = found(&self.bodies, id).ok_or_else(missing)?;
        let mut body = self.ecs.get::<&mut Body>(entity).map_err(|_| missing())?;
        let model = &self.catalogue.models[body.model as usize].thing;
        change(&mut body, model)?;
        // It may have another fastest mode now.
        body.look_anew();
        self.views.bodies.take();
        Ok(())
    }
}

/// A refusal as an event keeps it: a list of names would make it longer than a save takes.
fn shown(why: &Refused) -> String {
    why.to_string().chars().take(300).collect()
}

/// Refuses a command with a number that is not finite or a text that is too long: what a save would not read back.
fn sound(command: &Command) -> Result<(), Refused> {
    let mut bytes = Vec::new();
    if command.concerns_scene() {
        command.put(&mut bytes);
        let mut reader = Reader::new(&bytes);
        reader.take::<Command>().map_err(|error| Refused::new(format_args!("command: {}", error.why)))?;
    }
    Ok(())
}
