//! One step of a body: its helm, its loads, the equations of motion in pieces, the ground.

use super::{ALTITUDES_M, Body, Outcome, Rig};
use crate::aircraft::FARTHEST_M;
use crate::ballistics::path::StepPath;
use crate::frame::world_from_ned;
use crate::integrate::{self, Integrator};
use crate::rigid::gear::{Met, near};
use crate::rigid::motion::{self, State};
use crate::rigid::quantity::Quantity;
use crate::rigid::stiffness::{self, Mode, STEPS_A_MODE};
use crate::scene::Freeze;
use crate::scene::event::EndReason;
use crate::scene::ground::SceneGround;
use crate::snapshot::StableId;

/// Steps between two looks at how stiff the flow makes a body.
const STEPS_A_LOOK: u32 = 16;

impl Body {
    /// A step near the ground; `None` where it is not near.
    fn step_near(
        &mut self,
        rig: &mut Rig,
        ground: &SceneGround,
        dt_s: f64,
    ) -> Option<Result<(State, Option<Met>), EndReason>> {
        if rig.motion.model.contacts.is_empty() {
            return None;
        }
        let footing = |north_m, east_m| ground.footing(north_m, east_m);
        if !near::is_near(&rig.motion, &self.state, dt_s, &footing) {
            self.treads.clear();
            return None;
        }
        let stepped = near::step(&mut rig.motion, &self.state, dt_s, self.pieces, &footing);
        self.treads.clone_from(&rig.motion.treads);
        Some(stepped.ok_or(EndReason::Stiff))
    }

    /// How many pieces the state of now asks for.
    pub fn look(&mut self, rig: &Rig, dt_s: f64) -> Result<(), EndReason> {
        let sample = rig.motion.sample(&self.state, false);
        let airspeed = sample.slots[Quantity::TasMps.slot()];
        let flow = sample.air.density_kgpm3 * airspeed;
        if self.looks.is_multiple_of(STEPS_A_MODE / STEPS_A_LOOK) {
            self.mode = Mode::of(&rig.motion, &self.state, flow, airspeed);
        }
        self.looks = self.looks.wrapping_add(1);
        let lambda = self.mode.lambda_radps(&self.stiffness, flow);
        let spin = motion::rates(&self.state).length();
        self.pieces = stiffness::pieces(Integrator::Rk4, lambda, spin, dt_s).ok_or(EndReason::Stiff)?;
        self.look_in = STEPS_A_LOOK;
        Ok(())
    }

    /// Takes the fastest mode anew before the next step: something may have changed it.
    pub fn look_anew(&mut self) {
        (self.looks, self.look_in) = (0, 0);
    }

    /// Spreads the looks of bodies that were added together over steps: one body in 16 looks at a time.
    pub fn stagger(&mut self, id: StableId) {
        self.looks = 1 + (id.0 / u64::from(STEPS_A_LOOK) % u64::from(STEPS_A_MODE / STEPS_A_LOOK)) as u32;
        self.look_in = (id.0 % u64::from(STEPS_A_LOOK)) as u32;
    }

    /// Whether a table of the model refuses the state of now.
    fn is_outside(&self, rig: &Rig) -> bool {
        let model = &rig.motion.model;
        model.refuses() && model.refused(&rig.motion.sample(&self.state, false).slots).is_some()
    }

    /// Goes on by a step.
    pub fn step(&mut self, rig: &mut Rig, ground: &SceneGround, freeze: Freeze, dt_s: f64) -> Outcome {
        if self.autopilot.is_some() {
            self.fly_by_itself(&rig.motion, dt_s);
        }
        if !self.moved.is_empty() {
            let model = rig.motion.model.clone();
            // A lever on the ground is locked: gear does not fold under what stands on it, nor lift what lies on its belly.
            let locked = model.contacts.iter().find_map(|contact| contact.lowered_by).filter(|_| self.is_on_ground());
            let gear = locked.map(|place| (place, self.moved[place]));
            self.move_controls(&model, dt_s);
            if let Some((place, as_it_was)) = gear {
                self.moved[place] = as_it_was;
            }
        }
        self.load(rig);
        if rig.motion.model.uses(Quantity::AglM) {
            let at = world_from_ned(motion::position(&self.state));
            rig.motion.ground_m = ground.height_m(at.x, at.z);
        }
        if self.is_outside(rig) {
            return self.end(EndReason::OutsideTable, None);
        }
        if self.look_in == 0
            && let Err(reason) = self.look(rig, dt_s)
        {
            return self.end(reason, None);
        }
        self.look_in -= 1;
        let from = self.state;
        let mut y = from;
        match self.step_near(rig, ground, dt_s) {
            None => {
                let piece_s = dt_s / f64::from(self.pieces);
                for _ in 0..self.pieces {
                    y = motion::normalised(integrate::step(Integrator::Rk4, &rig.motion, 0.0, &y, piece_s, &mut None));
                }
            }
            Some(Err(reason)) => return self.end(reason, None),
            Some(Ok((after, None))) => y = after,
            Some(Ok((after, Some(met)))) => return self.break_up(&after, &met),
        }
        rig.motion.turn_shaft(&y, dt_s);
        self.shaft_radps = rig.motion.shaft_radps;
        if !motion::is_flight(&y) {
            return self.end(EndReason::NotFinite, None);
        }
        if freeze == Freeze::Position {
            (y[0], y[1]) = (from[0], from[1]);
            self.treads.clear();
        }
        let path = StepPath {
            from_m: world_from_ned(motion::position(&from)),
            from_mps: world_from_ned(motion::velocity(&from)),
            to_m: world_from_ned(motion::position(&y)),
            to_mps: world_from_ned(motion::velocity(&y)),
            step_s: dt_s,
        };
        if let Some(touch) = ground.touch_all(&path) {
            self.state = y;
            return self.end(EndReason::Ground, Some(touch));
        }
        let (north, east, altitude) = (y[0], y[1], -y[2]);
        if north.abs() > FARTHEST_M || east.abs() > FARTHEST_M || altitude < ALTITUDES_M.0 || altitude > ALTITUDES_M.1 {
            return self.end(EndReason::LeftWorld, None);
        }
        self.state = y;
        if let Some(gust) = &mut self.gust {
            let wind = rig.motion.wind.ned_mps(altitude);
            gust.step(dt_s, (motion::velocity(&y) - wind).length());
        }
        if self.burn(rig, dt_s) { Outcome::OutOfFuel } else { Outcome::Flies }
    }
}
