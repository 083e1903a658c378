//! How a body begins, and how it is put elsewhere.

use super::{Body, Rig};
use crate::frame::{ned_attitude_from_world, ned_from_world};
use crate::rigid::model::Control;
use crate::rigid::motion;
use crate::rigid::stiffness::{Mode, Stiffness};
use crate::scene::arms::StoresLoad;
use crate::scene::failure::{Fuel, Tanks};
use crate::scene::surroundings::Surroundings;
use crate::scene::{Refused, attitude, place, speed};
use crate::turbulence::Dryden;
use glam::{DQuat, DVec3};

/// Fastest turn taken from a caller, rad/s.
const MOST_RATE_RADPS: f64 = 1_000.0;

/// A rigid body to be added. World frame.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyStart {
    /// Name of its model in the catalogue.
    pub model: String,
    /// Position of its centre of gravity, metres.
    pub position_m: DVec3,
    /// Velocity over the ground, m/s.
    pub velocity_mps: DVec3,
    /// Body axes to the world's.
    pub attitude: DQuat,
    /// Angular velocity against the ground, body axes, rad/s.
    pub rates_radps: DVec3,
    /// Its fuel, if it is counted.
    pub fuel: Option<Fuel>,
}

impl Body {
    pub fn new(
        start: &BodyStart,
        model: u32,
        rig: &mut Rig,
        keys: &[u64],
        around: &Surroundings,
    ) -> Result<Self, Refused> {
        let of = rig.motion.model.clone();
        let mut body = Self {
            model,
            state: [0.0; motion::N],
            controls: of.initial_controls(),
            tanks: Tanks::of(start.fuel, &of)?,
            stores: StoresLoad::default(),
            failures: Vec::new(),
            gust: None,
            ended: None,
            moved: if of.controls.iter().any(Control::is_slow) { of.initial_controls() } else { Vec::new() },
            shaft_radps: 0.0,
            treads: Vec::new(),
            autopilot: None,
            sight: None,
            jumps: 0,
            stiffness: Stiffness { speed_mps: 0.0, lambda_radps: 0.0, per_flow: 0.0 },
            mode: Mode::default(),
            looks: 0,
            pieces: 1,
            look_in: 0,
        };
        if !(start.rates_radps.is_finite() && start.rates_radps.length() <= MOST_RATE_RADPS) {
            let found = start.rates_radps;
            return Err(Refused::new(format_args!(
                "body.rates_radps: expected at most {MOST_RATE_RADPS}, found {found}"
            )));
        }
        let planet = rig.motion.planet;
        body.relocate(start.position_m, start.velocity_mps, start.attitude, start.rates_radps, &planet)?;
        body.jumps = 0;
        body.set_turbulence(around.turbulence_mps, keys);
        body.start_engine(rig);
        body.stiffness = Stiffness::of(&rig.motion, &body.state);
        Ok(body)
    }

    /// Puts it into a state and lets it fly, whatever it was before.
    pub fn relocate(
        &mut self,
        position_m: DVec3,
        velocity_mps: DVec3,
        world_from_body: DQuat,
        rates_radps: DVec3,
        planet: &crate::planet::Planet,
    ) -> Result<(), Refused> {
        let position = ned_from_world(place("position_m", position_m)?);
        let velocity = ned_from_world(speed("velocity_mps", velocity_mps)?);
        let turned = ned_attitude_from_world(attitude("attitude", world_from_body)?).normalize();
        // The equations count rates against the stars.
        let rates = rates_radps + turned.conjugate() * planet.rotation();
        self.state = motion::normalised(motion::state(position, turned, 0.0, velocity, rates));
        (self.ended, self.looks, self.look_in) = (None, 0, 0);
        self.treads.clear();
        self.jumps = self.jumps.wrapping_add(1);
        Ok(())
    }

    /// Turbulence of a strength; its course goes on where there was some.
    pub fn set_turbulence(&mut self, sigma_mps: f64, keys: &[u64]) {
        match &mut self.gust {
            _ if sigma_mps == 0.0 => self.gust = None,
            Some(gust) => gust.sigma_mps = sigma_mps,
            None => self.gust = Some(Dryden::new(sigma_mps, keys)),
        }
    }

    /// Lets the engine turn as it would settle now.
    pub fn start_engine(&mut self, rig: &mut Rig) {
        self.load(rig);
        rig.motion.settle_shaft(&self.state);
        self.shaft_radps = rig.motion.shaft_radps;
    }
}
