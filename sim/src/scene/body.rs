//! Rigid bodies in a scene: a state each, and one set of equations of motion a model that all bodies of it share.
//!
//! A state is that of [`crate::rigid::motion`] in north, east, down from the world's origin; a step is one of fourth
//! order, cut into pieces where the body's fastest mode asks for it. The controls of a body are held over a step. The
//! ground ends a flight: the path of the step is swept, and the body stays where it met it.
//!
//! Invariants others rely on: a state is finite and its quaternion of length 1; a step allocates nothing.

use super::arms::{MOST_STORES_KG, StoresLoad};
use super::codec::coded;
use super::event::EndReason;
use super::failure::{Armed, Fault, Fuel, Tanks};
use super::ground::{GroundTouch, SceneGround};
use super::gun::Carriage;
use super::surroundings::Surroundings;
use super::{Freeze, Refused, attitude, place, speed};
use crate::aircraft::{Condition, FARTHEST_M};
use crate::autopilot::{Autopilot, Holds, Moves, Seen};
use crate::ballistics::path::StepPath;
use crate::frame::{ned_attitude_from_world, ned_from_world, world_attitude_from_ned, world_from_ned};
use crate::integrate::{self, Integrator};
use crate::rigid::Model;
use crate::rigid::gear::{Met, Part, Tread, near};
use crate::rigid::motion::{self, RigidMotion, State};
use crate::rigid::quantity::Quantity;
use crate::rigid::stiffness::{self, MOST_PIECES, Mode, STEPS_A_MODE, Stiffness};
use crate::snapshot::StableId;
use crate::turbulence::Dryden;
use glam::{DQuat, DVec3};
use std::sync::Arc;

/// Steps between two looks at how stiff the flow makes a body.
const STEPS_A_LOOK: u32 = 16;
/// Altitudes between which bodies and shells fly, metres: below every ocean floor, above all air.
pub const ALTITUDES_M: (f64, f64) = (-12_000.0, 1_000_000.0);
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

/// The equations of motion of a model, loaded with one body after the other.
#[derive(Debug)]
pub(super) struct Rig {
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
coded!(Holds { altitude_m, heading_rad, speed_mps, track });
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
            moved: if of.controls.iter().any(|one| one.per_s.is_some()) { of.initial_controls() } else { Vec::new() },
            shaft_radps: 0.0,
            treads: Vec::new(),
            autopilot: None,
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
        let lists = [(self.moved.len(), controls), (self.treads.len(), model.contacts.len())];
        if let Some((found, expected)) = lists.into_iter().find(|(found, expected)| *found != 0 && found != expected) {
            return Err(Refused::new(format_args!("body: expected a list of 0 or {expected}, found {found}")));
        }
        if !(0.0..1e6).contains(&self.shaft_radps) {
            let found = self.shaft_radps;
            return Err(Refused::new(format_args!("body.shaft_radps: expected 0 or more, found {found}")));
        }
        self.tanks.as_ref().map_or(Ok(()), |tanks| tanks.check(model))
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

    /// Lets the failures that are due set in, and names each to `told`.
    pub fn set_in(&mut self, step: u64, mut told: impl FnMut(&str)) {
        for place in 0..self.failures.len() {
            if self.failures[place].active || self.failures[place].at_step > step {
                continue;
            }
            if let Fault::Stuck(control, _) = self.failures[place].fault {
                let held = self.acting(control);
                self.failures[place].fault = Fault::Stuck(control, held);
            }
            self.failures[place].active = true;
            self.look_anew();
            told(&self.failures[place].name);
        }
    }

    /// What a control is at, failures counted.
    fn acting(&self, control: u32) -> f64 {
        let commanded = self.controls[control as usize];
        self.failures.iter().filter(|armed| armed.active).fold(commanded, |value, armed| match armed.fault {
            Fault::Stuck(of, held) if of == control => held,
            Fault::Free(of) if of == control => 0.0,
            _ => value,
        })
    }

    /// Loads the shared equations with what is this body's own.
    fn load(&self, rig: &mut Rig) {
        let motion = &mut rig.motion;
        motion.controls.copy_from_slice(&self.controls);
        motion.gust_mps = self.gust.as_ref().map_or(DVec3::ZERO, Dryden::gust_mps);
        motion.thrust_share = 1.0;
        motion.shaft_radps = self.shaft_radps;
        motion.treads.clone_from(&self.treads);
        motion.planes.clear();
        motion.ground_m = None;
        (motion.mass_kg, motion.cg_m) = (motion.model.mass_kg, motion.model.cg_m);
        if let Some(tanks) = &self.tanks {
            (motion.mass_kg, motion.cg_m) = tanks.mass_and_cg(&motion.model);
            if tanks.fuel.fuel_kg == 0.0 {
                motion.thrust_share = 0.0;
            }
        }
        motion.mass_kg += self.stores.mass_kg;
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
        let rated = motion.model.controls.iter().enumerate().filter(|(_, of)| of.per_s.is_some());
        for (place, _) in rated {
            // Restored ones have as many as there are controls.
            motion.controls[place] = self.moved[place];
        }
    }

    /// What its autopilot sees.
    pub fn seen(&self, motion: &RigidMotion) -> Seen {
        let at = self.carriage(&motion.planet);
        let wind = motion.wind.ned_mps(motion.planet.altitude_m(motion::position(&self.state)));
        Seen {
            position_m: at.position_m,
            velocity_mps: at.velocity_mps,
            angles: crate::frame::angles(at.attitude),
            rates_radps: at.rates_radps,
            airspeed_mps: (motion::velocity(&self.state) - wind).length(),
        }
    }

    /// The autopilot's step.
    fn fly_by_itself(&mut self, motion: &RigidMotion, dt_s: f64) {
        let seen = self.seen(motion);
        let Some(autopilot) = &mut self.autopilot else { return };
        let Moves { elevator, aileron, throttle } = autopilot.step(&seen, dt_s);
        let moves = [("elevator_norm", elevator), ("aileron_norm", aileron), ("throttle_norm", throttle)];
        for (name, part) in moves {
            if let (Some(place), Some(part)) = (motion.model.control(name), part) {
                let of = &motion.model.controls[place];
                let value = if part < 0.0 { -part * of.min } else { part * of.max };
                self.controls[place] = value.clamp(of.min, of.max);
            }
        }
    }

    /// Engages an autopilot that starts from the flight as it is, or takes it out.
    pub fn engage(&mut self, holds: Option<Holds>, model: &Model) -> Result<(), Refused> {
        let Some(holds) = holds else {
            self.autopilot = None;
            return Ok(());
        };
        if !holds.is_sound() {
            return Err(Refused::new("autopilot: expected finite numbers, and a heading or a track, not both"));
        }
        let lateral = holds.heading_rad.is_some() || holds.track.is_some();
        let needs = [
            ("elevator_norm", holds.altitude_m.is_some()),
            ("aileron_norm", lateral),
            ("throttle_norm", holds.speed_mps.is_some()),
        ];
        if let Some((name, _)) = needs.iter().find(|(name, needed)| *needed && model.control(name).is_none()) {
            return Err(Refused::new(format_args!("autopilot: expected a model with a control {name}, found none")));
        }
        let part = |name: &str| model.control(name).map_or(0.0, |place| self.controls[place]);
        let pitch_rad = crate::frame::angles(world_attitude_from_ned(motion::attitude(&self.state))).pitch_rad;
        let (elevator, throttle) = (part("elevator_norm"), part("throttle_norm"));
        self.autopilot = Some(Autopilot::engaged(holds, pitch_rad.clamp(-0.17, 0.21), elevator, throttle));
        Ok(())
    }

    /// Lets the engine turn as it would settle now.
    pub fn start_engine(&mut self, rig: &mut Rig) {
        self.load(rig);
        rig.motion.settle_shaft(&self.state);
        self.shaft_radps = rig.motion.shaft_radps;
    }

    /// Moves the controls that take their time by a step.
    fn move_controls(&mut self, model: &Model, dt_s: f64) {
        for place in 0..self.moved.len() {
            let of = &model.controls[place];
            let wanted = self.acting(place as u32).clamp(of.min, of.max);
            let most = of.per_s.map_or(f64::INFINITY, |per_s| per_s * dt_s);
            self.moved[place] += (wanted - self.moved[place]).clamp(-most, most);
        }
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
            self.move_controls(&rig.motion.model.clone(), dt_s);
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

    /// Fuel runs; whether it ran out just now.
    fn burn(&mut self, rig: &Rig, dt_s: f64) -> bool {
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

    /// Stops where it is, or where it touched.
    fn end(&mut self, reason: EndReason, touch: Option<GroundTouch>) -> Outcome {
        let touch = touch.unwrap_or_else(|| GroundTouch {
            fraction: 0.0,
            point_m: world_from_ned(motion::position(&self.state)),
            normal: DVec3::ZERO,
            velocity_mps: world_from_ned(motion::velocity(&self.state)),
            object: None,
        });
        let turned = motion::attitude(&self.state);
        self.state = motion::state(ned_from_world(touch.point_m), turned, 0.0, DVec3::ZERO, DVec3::ZERO);
        self.ended = Some(reason);
        Outcome::Ended(reason, touch)
    }

    /// Ends where it is: a part met the ground too hard.
    fn break_up(&mut self, y: &State, met: &Met) -> Outcome {
        let reason = match met.part {
            _ if met.is_water => EndReason::Water,
            Part::Wheel => EndReason::Gear,
            Part::Hull => EndReason::Hull,
            Part::WingTip => EndReason::WingTip,
            Part::Tail => EndReason::Tail,
            Part::Propeller => EndReason::Propeller,
        };
        self.state = motion::state(motion::position(y), motion::attitude(y), 0.0, DVec3::ZERO, DVec3::ZERO);
        self.treads.clear();
        self.shaft_radps = 0.0;
        self.ended = Some(reason);
        let touch = GroundTouch {
            fraction: met.fraction,
            point_m: world_from_ned(met.point_m),
            normal: world_from_ned(met.normal),
            velocity_mps: world_from_ned(met.velocity_mps),
            object: None,
        };
        Outcome::Ended(reason, touch)
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
mod tests {
    use super::*;
    use std::path::Path;

    fn rig(text: &str) -> Rig {
        let body = "[body]\nmass_kg = 10.0\ninertia_kgm2 = [[1.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 0.0, 2.0]]\n";
        let reference = "[reference]\narea_m2 = 1.0\nspan_m = 1.0\nchord_m = 1.0\n";
        let model = Model::from_text(Path::new("body.toml"), &format!("{body}{reference}{text}")).unwrap();
        Rig::new(&Arc::new(model), &Surroundings::default().weightless())
    }

    fn body(rig: &mut Rig, velocity_mps: DVec3, rates_radps: DVec3) -> Body {
        let start = BodyStart {
            model: String::new(),
            position_m: DVec3::Y * 1_000.0,
            velocity_mps,
            attitude: DQuat::IDENTITY,
            rates_radps,
            fuel: None,
        };
        Body::new(&start, 0, rig, &[1], &Surroundings::default().weightless()).unwrap()
    }

    #[test]
    fn a_million_steps_at_rest_or_of_decay_leave_no_denormal_number() {
        let damps = |to: &str, hat: &str| format!("[[aero.term]]\nto = \"{to}\"\nvalue = -9.0\ntimes = [\"{hat}\"]\n");
        let damped = [("Cl", "p_hat"), ("Cm", "q_hat"), ("Cn", "r_hat")].map(|(to, hat)| damps(to, hat)).concat();
        let (ground, dt_s) = (SceneGround::void(), 1.0 / 120.0);
        let spinning = DVec3::new(1.0, 0.5, 0.2);
        for (steps, velocity_mps, rates) in [(1_000_000, DVec3::ZERO, DVec3::ZERO), (200_000, DVec3::X * 5.0, spinning)]
        {
            let mut rig = rig(&damped);
            let mut body = body(&mut rig, velocity_mps, rates);
            let mut subnormal = 0;
            for _ in 0..steps {
                assert_eq!(body.step(&mut rig, &ground, Freeze::None, dt_s), Outcome::Flies);
                subnormal += body.state.iter().filter(|number| number.is_subnormal()).count();
            }
            assert_eq!(subnormal, 0);
            assert_eq!(motion::rates(&body.state), DVec3::ZERO, "what decays is at rest in the end");
        }
    }

    #[test]
    fn numbers_that_run_away_end_a_flight_at_its_last_good_state() {
        let growing = "[[aero.term]]\nto = \"CX\"\nvalue = 1e200\n";
        let mut rig = rig(growing);
        let mut body = body(&mut rig, DVec3::NEG_Z * 50.0, DVec3::ZERO);
        let outcome = (0..100).map(|_| body.step(&mut rig, &SceneGround::void(), Freeze::None, 0.01));
        let ended = outcome.into_iter().find(|outcome| *outcome != Outcome::Flies);
        assert!(matches!(ended, Some(Outcome::Ended(..))), "{ended:?}");
        assert!(body.state.iter().all(|number| number.is_finite()));
    }
}
