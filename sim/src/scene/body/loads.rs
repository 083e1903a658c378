//! The equations of motion of a model, loaded with what is a body's own: controls, mass, fuel, stores.

use super::Body;
use crate::planet::Planet;
use crate::rigid::Model;
use crate::rigid::motion::{self, RigidMotion};
use crate::scene::arms::StoresLoad;
use crate::scene::failure::Fault;
use crate::scene::surroundings::Surroundings;
use crate::turbulence::Dryden;
use glam::DVec3;
use std::sync::Arc;

/// The equations of motion of a model, loaded with one body after the other.
#[derive(Debug)]
pub(in crate::scene) struct Rig {
    pub motion: RigidMotion,
    throttle: Option<usize>,
}

impl Rig {
    pub fn new(model: &Arc<Model>, surroundings: &Surroundings) -> Self {
        let (air, wind) = (surroundings.atmosphere.clone(), surroundings.wind.clone());
        let throttle = model.control("throttle_norm");
        Self { motion: RigidMotion::new(model.clone(), surroundings.planet(), air, wind), throttle }
    }
}

impl Body {
    /// Mass and centre of gravity without stores.
    fn bare(&self, model: &Model) -> (f64, DVec3) {
        self.tanks.as_ref().map_or((model.mass_kg, model.cg_m), |tanks| tanks.mass_and_cg(model))
    }

    /// Mass and centre of gravity, with fuel and stores as they are.
    pub(super) fn mass_and_cg(&self, model: &Model) -> (f64, DVec3) {
        let (bare_kg, bare_cg_m) = self.bare(model);
        if self.stores.mass_kg == 0.0 {
            return (bare_kg, bare_cg_m);
        }
        let mass_kg = bare_kg + self.stores.mass_kg;
        (mass_kg, (bare_cg_m * bare_kg + self.stores.cg_m * self.stores.mass_kg) / mass_kg)
    }

    /// Takes other stores: what it is made of stays where it is, so the centre of gravity moves within it.
    pub fn hang(&mut self, stores: StoresLoad, model: &Model, planet: &Planet) {
        let before_m = self.mass_and_cg(model).1;
        self.stores = stores;
        let shift_m = self.mass_and_cg(model).1 - before_m;
        if shift_m == DVec3::ZERO {
            return;
        }
        let turned = motion::attitude(&self.state);
        let rates = motion::rates(&self.state) - turned.conjugate() * planet.rotation();
        let (moved, faster) = (turned * shift_m, turned * rates.cross(shift_m));
        for axis in 0..3 {
            self.state[axis] += moved[axis];
            self.state[8 + axis] += faster[axis];
        }
    }

    /// Loads the shared equations with what is this body's own.
    pub fn load(&self, rig: &mut Rig) {
        let motion = &mut rig.motion;
        motion.controls.copy_from_slice(&self.controls);
        motion.gust_mps = self.gust.as_ref().map_or(DVec3::ZERO, Dryden::gust_mps);
        motion.thrust_share = 1.0;
        motion.shaft_radps = self.shaft_radps;
        motion.treads.clone_from(&self.treads);
        motion.planes.clear();
        motion.ground_m = None;
        if self.tanks.as_ref().is_some_and(|tanks| tanks.fuel.fuel_kg == 0.0) {
            motion.thrust_share = 0.0;
        }
        (motion.mass_kg, motion.cg_m) = self.mass_and_cg(&motion.model);
        (motion.stores_drag_m2, motion.stores_at_m) = (self.stores.drag_area_m2, self.stores.cg_m);
        (motion.inertia_kgm2, motion.inverse_inertia) = (motion.model.inertia_kgm2, motion.model.inverse_inertia);
        if self.stores.mass_kg > 0.0 {
            let (bare_kg, bare_cg_m) = self.bare(&motion.model);
            motion.inertia_kgm2 += self.stores.adds_kgm2(bare_kg, bare_cg_m);
            motion.inverse_inertia = motion.inertia_kgm2.inverse();
        }
        for armed in self.failures.iter().filter(|armed| armed.active) {
            match armed.fault {
                Fault::Stuck(control, _) | Fault::Free(control) => {
                    let of = &motion.model.controls[control as usize];
                    motion.controls[control as usize] = self.acting(control).clamp(of.min, of.max);
                }
                Fault::EngineOut => motion.thrust_share = 0.0,
                Fault::Leak(_) => {}
            }
        }
        let rated = motion.model.controls.iter().enumerate().filter(|(_, of)| of.is_slow());
        for (place, _) in rated {
            // Restored ones have as many as there are controls.
            motion.controls[place] = self.moved[place];
        }
    }

    /// Fuel runs; whether it ran out just now.
    pub(super) fn burn(&mut self, rig: &Rig, dt_s: f64) -> bool {
        let Some(tanks) = self.tanks.as_mut().filter(|tanks| !tanks.frozen && tanks.fuel.fuel_kg > 0.0) else {
            return false;
        };
        let throttle = rig.throttle.map_or(0.0, |place| rig.motion.controls[place].clamp(0.0, 1.0));
        let mut flow_kgps =
            rig.motion.fuel_kgps(&self.state).unwrap_or(tanks.fuel.flow_kgps * throttle * rig.motion.thrust_share);
        for armed in self.failures.iter().filter(|armed| armed.active) {
            if let Fault::Leak(kgps) = armed.fault {
                flow_kgps += kgps;
            }
        }
        tanks.fuel.fuel_kg = (tanks.fuel.fuel_kg - flow_kgps * dt_s).max(0.0);
        tanks.fuel.fuel_kg == 0.0
    }
}
