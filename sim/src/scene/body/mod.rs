//! Rigid bodies in a scene: a state each, and one set of equations of motion a model that all bodies of it share.
//!
//! A state is that of [`crate::rigid::motion`] in north, east, down from the world's origin; a step is one of fourth
//! order, cut into pieces where the body's fastest mode asks for it. The controls of a body are held over a step. The
//! ground ends a flight: the path of the step is swept, and the body stays where it met it.
//!
//! | file | what |
//! |---|---|
//! | `mod.rs` | a body as it is |
//! | `start.rs` | how it begins, and is put elsewhere |
//! | `helm.rs` | what moves its controls: failures, their pace, an autopilot |
//! | `loads.rs` | its mass, fuel and stores in the equations of motion |
//! | `step.rs` | one step |
//! | `parts.rs` | what its parts strike beside the ground |
//! | `ending.rs` | how a flight ends |
//!
//! Invariants others rely on: a state is finite and its quaternion of length 1; a step allocates nothing.

mod ending;
mod helm;
mod loads;
pub(super) mod parts;
mod start;
mod step;

pub(super) use loads::Rig;
pub use start::BodyStart;

use super::arms::{MOST_STORES_KG, StoresLoad};
use super::codec::coded;
use super::event::EndReason;
use super::failure::{Armed, Fault, Tanks};
use super::ground::GroundTouch;
use super::gun::Carriage;
use super::{Refused, attitude, place};
use crate::aircraft::Condition;
use crate::autopilot::{Autopilot, Holds, Sight};
use crate::frame::{world_attitude_from_ned, world_from_ned};
use crate::rigid::Model;
use crate::rigid::gear::Tread;
use crate::rigid::gear::contact::{Contact, DOWN};
use crate::rigid::model::Control;
use crate::rigid::motion::{self, State};
use crate::rigid::stiffness::{MOST_PIECES, Mode, Stiffness};
use crate::turbulence::Dryden;
use glam::{DQuat, DVec3};

/// Altitudes between which bodies and shells fly, metres: below every ocean floor, above all air.
pub const ALTITUDES_M: (f64, f64) = (-12_000.0, 1_000_000.0);

/// A rigid body as it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub model: u32,
    pub state: State,
    /// Controls as commanded.
    pub controls: Vec<f64>,
    pub tanks: Option<Tanks>,
    /// What it carries beside its model.
    pub stores: StoresLoad,
    pub failures: Vec<Armed>,
    gust: Option<Dryden>,
    pub ended: Option<EndReason>,
    /// Controls that move at a rate, as they stand; empty if the model has none.
    pub moved: Vec<f64>,
    /// Speed of the engine's shaft, rad/s.
    pub shaft_radps: f64,
    /// Where its contacts hold the ground; empty far from it.
    treads: Vec<Option<Tread>>,
    /// Its autopilot, if one is engaged.
    pub autopilot: Option<Autopilot>,
    /// The aim of its selected weapon, while an attack is held.
    pub sight: Option<Sight>,
    pub jumps: u32,
    stiffness: Stiffness,
    mode: Mode,
    looks: u32,
    pieces: u32,
    look_in: u32,
}
coded!(Stiffness { speed_mps, lambda_radps, per_flow });
coded!(Mode { lambda_radps, flow });
coded!(Tread { at_m, stretch_m });
coded!(Holds { altitude_m, heading_rad, speed_mps, track, attack });
coded!(Sight { strikes_m, target_m });
coded!(Autopilot { holds, integrals });
coded!(Body {
    model,
    state,
    controls,
    tanks,
    stores,
    failures,
    gust,
    ended,
    moved,
    shaft_radps,
    treads,
    autopilot,
    sight,
    jumps,
    stiffness,
    mode,
    looks,
    pieces,
    look_in
});

/// What a step did beside moving.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Outcome {
    Flies,
    OutOfFuel,
    /// The reason, where, and at which fraction of the step.
    Ended(EndReason, GroundTouch),
}

impl Body {
    /// What a restored one must be, so that stepping it cannot fail.
    pub fn check(&self, model: &Model) -> Result<(), Refused> {
        let (controls, found) = (model.controls.len(), self.controls.len());
        if controls != found {
            return Err(Refused::new(format_args!("body.controls: expected {controls}, found {found}")));
        }
        place("body.position_m", world_from_ned(motion::position(&self.state)))?;
        attitude("body.attitude", DQuat::from_xyzw(self.state[4], self.state[5], self.state[6], self.state[3]))?;
        if !motion::is_flight(&self.state) {
            return Err(Refused::new("body.state: expected a velocity and rates that a body can have"));
        }
        let beyond = |armed: &Armed| match armed.fault {
            Fault::Stuck(control, _) | Fault::Free(control) => control as usize >= controls,
            Fault::EngineOut | Fault::Leak(_) => false,
        };
        if self.failures.iter().any(beyond) {
            return Err(Refused::new(format_args!("body.failures: expected controls below {controls}")));
        }
        if !(1..=MOST_PIECES).contains(&self.pieces) {
            return Err(Refused::new(format_args!("body.pieces: expected 1..=1000, found {}", self.pieces)));
        }
        if !(0.0..=MOST_STORES_KG).contains(&self.stores.mass_kg) {
            let found = self.stores.mass_kg;
            return Err(Refused::new(format_args!("body.stores: expected 0..={MOST_STORES_KG} kg, found {found}")));
        }
        if !self.stores.is_sound() {
            return Err(Refused::new("body.stores: expected an inertia that masses can have, and a drag of 0 or more"));
        }
        let (moved, slow) = (self.moved.len(), model.controls.iter().any(Control::is_slow));
        if moved != if slow { controls } else { 0 } {
            return Err(Refused::new(format_args!(
                "body.moved: expected {controls} of a model with slow controls, found {moved}"
            )));
        }
        let lists = [(self.treads.len(), model.contacts.len())];
        if let Some((found, expected)) = lists.into_iter().find(|(found, expected)| *found != 0 && found != expected) {
            return Err(Refused::new(format_args!("body: expected a list of 0 or {expected}, found {found}")));
        }
        if !(0.0..1e6).contains(&self.shaft_radps) {
            let found = self.shaft_radps;
            return Err(Refused::new(format_args!("body.shaft_radps: expected 0 or more, found {found}")));
        }
        self.tanks.as_ref().map_or(Ok(()), |tanks| tanks.check(model))
    }

    /// Whether it flies, stands or is broken.
    pub fn condition(&self) -> Condition {
        match self.ended {
            Some(_) => Condition::Crashed,
            None if self.is_on_ground() => Condition::OnGround,
            None => Condition::Flying,
        }
    }

    /// Whether any of it stands on the ground.
    pub fn is_on_ground(&self) -> bool {
        self.treads.iter().any(Option::is_some)
    }

    /// A control as it stands.
    fn stands(&self, place: usize) -> f64 {
        self.moved.get(place).or_else(|| self.controls.get(place)).copied().unwrap_or(0.0)
    }

    /// Whether a contact is out: one that retracts only when it is all but down.
    pub fn is_out(&self, contact: &Contact) -> bool {
        contact.lowered_by.is_none_or(|place| self.stands(place) >= DOWN)
    }

    /// Whether its gear, if that retracts, is more than half down.
    pub fn is_gear_down(&self, model: &Model) -> bool {
        let lowers = model.contacts.iter().find_map(|contact| contact.lowered_by);
        lowers.is_none_or(|place| self.stands(place) > 0.5)
    }

    /// Its pose as others see it.
    pub fn carriage(&self, planet: &crate::planet::Planet) -> Carriage {
        let turned = motion::attitude(&self.state);
        let rates = motion::rates(&self.state) - turned.conjugate() * planet.rotation();
        Carriage {
            position_m: world_from_ned(motion::position(&self.state)),
            attitude: world_attitude_from_ned(turned).normalize(),
            velocity_mps: world_from_ned(motion::velocity(&self.state)),
            rates_radps: if self.ended.is_some() { DVec3::ZERO } else { rates },
        }
    }
}

#[cfg(test)]
mod tests;
