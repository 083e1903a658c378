//! What can be ordered of a scene, as data, and what was: a record that flies the same scene again.
//!
//! A command takes effect between two steps, whole or not at all: one with a number that is not finite, or for an entity
//! that there is none of, is refused with what was expected and found, and the scene stays as it was. World frame, SI.
//!
//! Invariant others rely on: the scene at its start and the stamped commands give the scene at any later step, to the
//! bit ([`super::Scene::schedule`]).

use super::codec::{Coded, Reader, SaveError, coded, coded_choice};
use super::failure::{Failure, FuelChange};
use super::gun::Muzzle;
use crate::aircraft::{AircraftState, Condition};
use crate::autopilot::Holds;
use crate::input::{self, Controls, Levers};
use crate::snapshot::StableId;
use crate::utc::UtcTime;
use crate::weapons::{Aim, Fuze};
use glam::{DQuat, DVec3};

/// What stands still.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Freeze {
    /// Nothing.
    #[default]
    None,
    /// Places in plan: aircraft and bodies fly, climb and turn, and stay over where they are.
    Position,
    /// The flight of aircraft and bodies; shells, targets and the date go on.
    Flight,
    /// Everything, the date too; steps are counted, so that commands have their time.
    Total,
}
coded_choice!(Freeze { None, Position, Flight, Total });

/// An order.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// A key or button of the pilot.
    Pilot(input::Command),
    /// What the pilot of the own aircraft commands from now on.
    Controls(Controls),
    /// Puts the own aircraft into a state.
    Place(Box<AircraftState>),
    /// Moves along the track to a distance, metres.
    SeekTrack(f64),
    /// Date and time of day.
    Date(UtcTime),
    /// How fast the date runs against the simulation.
    DayRate(f64),
    /// What stands still from now on.
    Freeze(Freeze),
    /// Puts any entity elsewhere. A body that had crashed flies again; a target stands there.
    Reposition {
        /// Which.
        id: StableId,
        /// Where to, metres.
        position_m: DVec3,
        /// Velocity over the ground, m/s.
        velocity_mps: DVec3,
        /// Its axes to the world's; nothing to a projectile.
        attitude: DQuat,
    },
    /// The air's velocity: height in metres, and north, east, down in m/s; heights rise.
    Wind(Vec<(f64, DVec3)>),
    /// Standard deviation of turbulence, m/s.
    Turbulence(f64),
    /// A control of a rigid body, in its own unit; held within its limits.
    Control {
        /// Whose.
        id: StableId,
        /// Its name.
        control: String,
        /// Its value.
        value: f64,
    },
    /// Fuel of a rigid body.
    Fuel {
        /// Whose.
        id: StableId,
        /// What of it.
        change: FuelChange,
    },
    /// Arms a failure of a rigid body; one of the same name is replaced.
    Fail {
        /// Whose.
        id: StableId,
        /// The name that clears it.
        name: String,
        /// What fails.
        failure: Failure,
        /// Steps until it sets in; 0 is at once.
        in_steps: u64,
    },
    /// Ends a failure, or takes it back before it sets in.
    Clear {
        /// Whose.
        id: StableId,
        /// Its name.
        name: String,
    },
    /// Fires rounds: the first at once.
    Fire {
        /// Who. Its own rounds never strike it.
        owner: StableId,
        /// Name of the projectile in the catalogue.
        projectile: String,
        /// Where and how they leave.
        muzzle: Muzzle,
        /// How many.
        rounds: u32,
        /// Rate of fire; 0 for a single round.
        per_minute: f64,
    },
    /// Hangs rounds of a weapon on an owner: one more station.
    Load {
        /// Whose.
        owner: StableId,
        /// The weapon's name in the catalogue.
        weapon: String,
        /// How many.
        rounds: u32,
        /// Where: metres from its reference point, its axes.
        at_m: DVec3,
    },
    /// What the crew sets of its weapons.
    Arm {
        /// Whose.
        owner: StableId,
        /// Whether anything may be released.
        master: bool,
        /// The selected weapon.
        weapon: Option<String>,
        /// The fuze of all that is released from now on; `None` leaves every weapon its own.
        fuze: Option<Fuze>,
    },
    /// Releases or fires rounds of a weapon from the owner's stations: a ripple, a salvo or a burst.
    Release {
        /// Who.
        owner: StableId,
        /// The weapon's name.
        weapon: String,
        /// How many in all; fewer if fewer are left.
        rounds: u32,
        /// How many leave at the same time.
        together: u32,
        /// Between one lot and the next, seconds; 0 is the weapon's own rate.
        interval_s: f64,
        /// What they are meant for.
        aim: Aim,
    },
    /// Levers of the own aircraft from now on.
    Levers(Levers),
    /// Makes a body the own aircraft, flown by the pilot's controls and levers; the own id makes it the point mass.
    FlyBody {
        /// Which.
        id: StableId,
    },
    /// Engages the autopilot of a body, or takes it out.
    Autopilot {
        /// Whose.
        id: StableId,
        /// What it holds.
        holds: Option<Holds>,
    },
    /// Drops what hangs on an owner's stations, whatever its master arm: bombs fall as duds, rockets go with their pods.
    Jettison {
        /// Whose.
        owner: StableId,
        /// The weapon's name; `None` is all bombs and rockets.
        weapon: Option<String>,
    },
    /// Ends all bursts of an owner.
    CeaseFire {
        /// Whose.
        owner: StableId,
    },
}

/// A command and the step that it came before, counted from the scene's first.
#[derive(Debug, Clone, PartialEq)]
pub struct Stamped {
    /// Steps that had been taken.
    pub step: u64,
    /// The command.
    pub command: Command,
}
coded!(Stamped { step, command });

coded!(Levers { mixture, flaps, gear, brakes, parking_brake, trim, starter, altimeter_pa });
coded!(Controls { pitch, roll, yaw, throttle });
coded_choice!(Condition { Flying, OnGround, Crashed });
coded!(UtcTime { unix_ns });
coded!(AircraftState {
    position_m,
    velocity_mps,
    attitude,
    rates_radps,
    load_factor,
    alpha_rad,
    airspeed_mps,
    throttle,
    condition
});

/// The pilot's commands that change a scene, by their number in a save; the others concern the picture alone.
const PILOT: [input::Command; 29] = [
    input::Command::Pause,
    input::Command::Freeze,
    input::Command::Reset,
    input::Command::Slew,
    input::Command::Track,
    input::Command::TimeForward,
    input::Command::TimeBack,
    input::Command::DateForward,
    input::Command::DateBack,
    input::Command::RateUp,
    input::Command::RateDown,
    input::Command::FlapsDown,
    input::Command::FlapsUp,
    input::Command::Gear,
    input::Command::Brake,
    input::Command::BrakeEnd,
    input::Command::ParkingBrake,
    input::Command::TrimUp,
    input::Command::TrimDown,
    input::Command::MixtureRich,
    input::Command::MixtureLean,
    input::Command::MasterArm,
    input::Command::NextWeapon,
    input::Command::NextRipple,
    input::Command::Trigger,
    input::Command::TriggerEnd,
    input::Command::AltimeterUp,
    input::Command::AltimeterDown,
    input::Command::Jettison,
];

impl Command {
    /// Whether it changes a scene at all: screenshots, overlays and looks do not.
    pub fn concerns_scene(&self) -> bool {
        !matches!(self, Self::Pilot(command) if !PILOT.contains(command))
    }
}

impl Coded for Command {
    fn put(&self, out: &mut Vec<u8>) {
        match self {
            Self::Pilot(command) => {
                // Those of the picture never get here; were one to, it would read back as an error.
                let place = PILOT.iter().position(|known| known == command).map_or(u8::MAX, |place| place as u8);
                (0u8, place).put(out);
            }
            Self::Controls(controls) => (1u8, *controls).put(out),
            Self::Place(state) => (2u8, **state).put(out),
            Self::SeekTrack(distance_m) => (3u8, *distance_m).put(out),
            Self::Date(date) => (4u8, *date).put(out),
            Self::DayRate(rate) => (5u8, *rate).put(out),
            Self::Freeze(freeze) => (6u8, *freeze).put(out),
            Self::Reposition { id, position_m, velocity_mps, attitude } => {
                (7u8, *id).put(out);
                ([*position_m, *velocity_mps], attitude.to_array()).put(out);
            }
            Self::Wind(rows) => {
                out.push(8);
                rows.put(out);
            }
            Self::Turbulence(sigma_mps) => (9u8, *sigma_mps).put(out),
            Self::Control { id, control, value } => {
                (10u8, *id).put(out);
                control.put(out);
                value.put(out);
            }
            Self::Fuel { id, change } => (11u8, (*id, *change)).put(out),
            Self::Fail { id, name, failure, in_steps } => {
                (12u8, *id).put(out);
                name.put(out);
                failure.put(out);
                in_steps.put(out);
            }
            Self::Clear { id, name } => {
                (13u8, *id).put(out);
                name.put(out);
            }
            Self::Fire { owner, projectile, muzzle, rounds, per_minute } => {
                (14u8, *owner).put(out);
                projectile.put(out);
                muzzle.put(out);
                (*rounds, *per_minute).put(out);
            }
            Self::CeaseFire { owner } => (15u8, *owner).put(out),
            Self::Load { owner, weapon, rounds, at_m } => {
                (16u8, *owner).put(out);
                weapon.put(out);
                (*rounds, *at_m).put(out);
            }
            Self::Arm { owner, master, weapon, fuze } => {
                (17u8, *owner).put(out);
                master.put(out);
                weapon.put(out);
                fuze.put(out);
            }
            Self::Release { owner, weapon, rounds, together, interval_s, aim } => {
                (18u8, *owner).put(out);
                weapon.put(out);
                ([*rounds, *together], *interval_s).put(out);
                aim.put(out);
            }
            Self::Levers(levers) => (19u8, *levers).put(out),
            Self::FlyBody { id } => (20u8, *id).put(out),
            Self::Autopilot { id, holds } => (21u8, (*id, *holds)).put(out),
            Self::Jettison { owner, weapon } => {
                (22u8, *owner).put(out);
                weapon.put(out);
            }
        }
    }

    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        Ok(match from.take::<u8>()? {
            0 => {
                let found = from.take::<u8>()?;
                let command = PILOT.get(usize::from(found)).copied();
                Self::Pilot(command.ok_or_else(|| {
                    from.refuse(format_args!("pilot: expected 0..={}, found {found}", PILOT.len() - 1))
                })?)
            }
            1 => Self::Controls(from.take()?),
            2 => Self::Place(Box::new(from.take()?)),
            3 => Self::SeekTrack(from.take()?),
            4 => Self::Date(from.take()?),
            5 => Self::DayRate(from.take()?),
            6 => Self::Freeze(from.take()?),
            7 => {
                let id = from.take()?;
                let ([position_m, velocity_mps], attitude): ([DVec3; 2], [f64; 4]) = from.take()?;
                Self::Reposition { id, position_m, velocity_mps, attitude: DQuat::from_array(attitude) }
            }
            8 => Self::Wind(from.take()?),
            9 => Self::Turbulence(from.take()?),
            10 => Self::Control { id: from.take()?, control: from.take()?, value: from.take()? },
            11 => Self::Fuel { id: from.take()?, change: from.take()? },
            12 => Self::Fail { id: from.take()?, name: from.take()?, failure: from.take()?, in_steps: from.take()? },
            13 => Self::Clear { id: from.take()?, name: from.take()? },
            14 => {
                let (owner, projectile, muzzle) = (from.take()?, from.take()?, from.take()?);
                let (rounds, per_minute) = from.take()?;
                Self::Fire { owner, projectile, muzzle, rounds, per_minute }
            }
            15 => Self::CeaseFire { owner: from.take()? },
            16 => {
                let (owner, weapon) = (from.take()?, from.take()?);
                let (rounds, at_m) = from.take()?;
                Self::Load { owner, weapon, rounds, at_m }
            }
            17 => {
                let (owner, master) = (from.take()?, from.take()?);
                Self::Arm { owner, master, weapon: from.take()?, fuze: from.take()? }
            }
            18 => {
                let (owner, weapon) = (from.take()?, from.take()?);
                let ([rounds, together], interval_s): ([u32; 2], f64) = from.take()?;
                Self::Release { owner, weapon, rounds, together, interval_s, aim: from.take()? }
            }
            19 => Self::Levers(from.take()?),
            20 => Self::FlyBody { id: from.take()? },
            21 => {
                let (id, holds) = from.take()?;
                Self::Autopilot { id, holds }
            }
            22 => Self::Jettison { owner: from.take()?, weapon: from.take()? },
            found => return Err(from.refuse(format_args!("command: expected 0..=22, found {found}"))),
        })
    }
}
