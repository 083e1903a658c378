//! Failures of a rigid body, and its fuel.
//!
//! A failure is armed under a name and sets in so many steps later; it lasts until it is cleared. A stuck control stays
//! at what it was when the failure set in; a free one trails at 0, or at its limit next to it. Fuel changes the mass
//! only: the model's mass is that with the fuel it starts with, and the inertia tensor stays the model's.
//!
//! kg, seconds. Invariant others rely on: fuel is finite and never below 0, so the mass stays above 0.

use super::Refused;
use super::codec::{Coded, LONGEST_TEXT, Reader, SaveError, coded};
use crate::rigid::Model;
use glam::DVec3;

/// Most failures of one body at a time.
pub const MOST_FAILURES: usize = 64;

/// What fails.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// A control stays where it is.
    ControlStuck(String),
    /// A control no longer answers and trails.
    ControlFree(String),
    /// No thrust, and no fuel for it.
    EngineOut,
    /// Fuel runs out at this rate, kg/s.
    FuelLeak(f64),
}

/// The fuel of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fuel {
    /// What is left.
    pub fuel_kg: f64,
    /// Flow at full throttle, kg/s; it goes with the control `throttle_norm`.
    pub flow_kgps: f64,
}
coded!(Fuel { fuel_kg, flow_kgps });

/// A change of fuel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FuelChange {
    /// So much is in the tanks from now on, kg.
    Set(f64),
    /// So much less, kg, down to none.
    Consume(f64),
    /// Whether it no longer runs out.
    Freeze(bool),
}

/// Fuel as it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tanks {
    pub fuel: Fuel,
    /// What was there at the start and counts in the model's mass.
    pub first_kg: f64,
    pub frozen: bool,
}
coded!(Tanks { fuel, first_kg, frozen });

/// A failure resolved against a model: controls by their place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    /// The control, and what it is stuck at once it has set in.
    Stuck(u32, f64),
    Free(u32),
    EngineOut,
    Leak(f64),
}

/// A failure of a body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Armed {
    pub name: String,
    pub fault: Fault,
    /// The step before which it sets in.
    pub at_step: u64,
    pub active: bool,
}
coded!(Armed { name, fault, at_step, active });

impl Tanks {
    pub fn new(fuel: Fuel, model_mass_kg: f64) -> Result<Self, Refused> {
        let Fuel { fuel_kg, flow_kgps } = fuel;
        if !(fuel_kg >= 0.0 && fuel_kg < model_mass_kg) {
            return Err(Refused::new(format_args!(
                "fuel.fuel_kg: expected 0 or more and less than the model's mass of {model_mass_kg} kg, found {fuel_kg}"
            )));
        }
        if !(0.0..1e6).contains(&flow_kgps) {
            return Err(Refused::new(format_args!("fuel.flow_kgps: expected 0 or more, found {flow_kgps}")));
        }
        Ok(Self { fuel, first_kg: fuel_kg, frozen: false })
    }

    /// The tanks that a body of a model starts with: those of its start, or the model's own, full.
    pub fn of(fuel: Option<Fuel>, model: &Model) -> Result<Option<Self>, Refused> {
        let Some(tank) = model.tank else {
            return fuel.map(|fuel| Self::new(fuel, model.mass_kg)).transpose();
        };
        let fuel = fuel.unwrap_or(Fuel { fuel_kg: tank.capacity_kg, flow_kgps: 0.0 });
        if fuel.fuel_kg > tank.capacity_kg {
            let (most, found) = (tank.capacity_kg, fuel.fuel_kg);
            return Err(Refused::new(format_args!("fuel.fuel_kg: expected at most {most} kg, found {found}")));
        }
        Ok(Some(Self { first_kg: tank.capacity_kg, ..Self::new(fuel, model.mass_kg)? }))
    }

    /// Mass and centre of gravity with what is left.
    pub fn mass_and_cg(&self, model: &Model) -> (f64, DVec3) {
        match model.tank {
            // To the bit what it was before tanks had a place.
            None => ((model.mass_kg - self.first_kg) + self.fuel.fuel_kg, model.cg_m),
            Some(_) => model.lighter(self.first_kg - self.fuel.fuel_kg),
        }
    }

    pub fn check(&self, model: &Model) -> Result<(), Refused> {
        Self::new(Fuel { fuel_kg: self.first_kg, ..self.fuel }, model.mass_kg)?;
        Self::checked_kg(self.fuel.fuel_kg).map(|_| ())
    }

    fn checked_kg(kg: f64) -> Result<f64, Refused> {
        let good = (0.0..1e9).contains(&kg);
        if good { Ok(kg) } else { Err(Refused::new(format_args!("fuel: expected 0 or more kg, found {kg}"))) }
    }

    pub fn change(&mut self, change: FuelChange) -> Result<(), Refused> {
        match change {
            FuelChange::Set(kg) => self.fuel.fuel_kg = Self::checked_kg(kg)?,
            FuelChange::Consume(kg) => self.fuel.fuel_kg = (self.fuel.fuel_kg - Self::checked_kg(kg)?).max(0.0),
            FuelChange::Freeze(frozen) => self.frozen = frozen,
        }
        Ok(())
    }
}

impl Armed {
    pub fn new(name: &str, failure: &Failure, at_step: u64, model: &Model) -> Result<Self, Refused> {
        if name.is_empty() || name.len() > LONGEST_TEXT {
            let found = name.len();
            return Err(Refused::new(format_args!(
                "failure: expected a name of 1 to {LONGEST_TEXT} bytes, found {found}"
            )));
        }
        let fault = match failure {
            Failure::ControlStuck(control) => Fault::Stuck(control_of(model, control)?, 0.0),
            Failure::ControlFree(control) => Fault::Free(control_of(model, control)?),
            Failure::EngineOut => Fault::EngineOut,
            Failure::FuelLeak(kgps) if (0.0..1e6).contains(kgps) => Fault::Leak(*kgps),
            Failure::FuelLeak(found) => {
                return Err(Refused::new(format_args!("failure: expected a leak of 0 or more kg/s, found {found}")));
            }
        };
        Ok(Self { name: name.to_owned(), fault, at_step, active: false })
    }
}

/// The place of a control by name.
pub(super) fn control_of(model: &Model, name: &str) -> Result<u32, Refused> {
    let missing = || {
        let known: Vec<&str> = model.controls.iter().map(|control| control.name.as_str()).collect();
        Refused::new(format_args!("control: expected one of [{}], found {name}", known.join(", ")))
    };
    model.control(name).map(|place| place as u32).ok_or_else(missing)
}

impl Coded for Fault {
    fn put(&self, out: &mut Vec<u8>) {
        let (kind, control, number) = match *self {
            Self::Stuck(control, held) => (0u8, control, held),
            Self::Free(control) => (1, control, 0.0),
            Self::EngineOut => (2, 0, 0.0),
            Self::Leak(kgps) => (3, 0, kgps),
        };
        (kind, (control, number)).put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let (kind, (control, number)): (u8, (u32, f64)) = from.take()?;
        match kind {
            0 => Ok(Self::Stuck(control, number)),
            1 => Ok(Self::Free(control)),
            2 => Ok(Self::EngineOut),
            3 if number >= 0.0 => Ok(Self::Leak(number)),
            found => Err(from.refuse(format_args!("failure: expected 0..=3, found {found} with {number}"))),
        }
    }
}

impl Coded for Failure {
    fn put(&self, out: &mut Vec<u8>) {
        match self {
            Self::ControlStuck(control) => (0u8, control.clone()).put(out),
            Self::ControlFree(control) => (1u8, control.clone()).put(out),
            Self::EngineOut => out.push(2),
            Self::FuelLeak(kgps) => (3u8, *kgps).put(out),
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        match from.take::<u8>()? {
            0 => from.take().map(Self::ControlStuck),
            1 => from.take().map(Self::ControlFree),
            2 => Ok(Self::EngineOut),
            3 => from.take().map(Self::FuelLeak),
            found => Err(from.refuse(format_args!("failure: expected 0..=3, found {found}"))),
        }
    }
}

impl Coded for FuelChange {
    fn put(&self, out: &mut Vec<u8>) {
        match *self {
            Self::Set(kg) => (0u8, kg).put(out),
            Self::Consume(kg) => (1u8, kg).put(out),
            Self::Freeze(frozen) => (2u8, frozen).put(out),
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        match from.take::<u8>()? {
            0 => from.take().map(Self::Set),
            1 => from.take().map(Self::Consume),
            2 => from.take().map(Self::Freeze),
            found => Err(from.refuse(format_args!("fuel: expected 0..=2, found {found}"))),
        }
    }
}
