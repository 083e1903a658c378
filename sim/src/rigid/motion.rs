//! The equations of motion of a rigid body over the Earth.
//!
//! State: position and velocity over the rotating Earth in the planet's frame; attitude as a quaternion (w, x, y, z) from
//! body axes to the frame; inertial angular velocity in body axes; and the cross-track, the integral of the velocity
//! across the commanded course, for autopilots that follow one.
//!
//! dr = v; dv = R F / m + fall(r, v); dq = q (0, w - R' Omega) / 2; I dw = M - w x I w. Aerodynamic rates are the inertial
//! ones less the Earth's rotation, not less the turn of the local axes: the air turns with the Earth.
//!
//! The quaternion is normalised after each step; inside a step only its direction counts.
//!
//! Source: B. L. Stevens, F. L. Lewis, Aircraft Control and Simulation, 2003, section 1.5 (oblate rotating Earth).

use super::gear::contact::MOST_WEIGHTS;
use super::gear::{Footing, Tread, near};
use super::links::LinkMemory;
use super::model::{Course, Loads, Model};
use super::power::engine::Setting;
use super::power::shaft::PowerPlant;
use super::quantity::{QUANTITIES, Quantity, SLOTS};
use crate::atmosphere::{AirSample, Atmosphere, SEA_LEVEL_DENSITY_KGPM3};
use crate::integrate::Motion;
use crate::planet::{Place, Planet, STANDARD_GRAVITY_MPS2, Shape};
use crate::wind::Wind;
use glam::{DMat3, DQuat, DVec3};
use std::cell::RefCell;
use std::sync::Arc;

/// Numbers of a state.
pub const N: usize = 14;

/// A state, see the module: position, attitude, cross-track; velocity, rates.
pub type State = [f64; N];

/// A body in its surroundings, with its controls as they stand.
#[derive(Debug, Clone)]
pub struct RigidMotion {
    /// The body.
    pub model: Arc<Model>,
    /// The Earth.
    pub planet: Planet,
    /// The air.
    pub atmosphere: Atmosphere,
    /// Its motion.
    pub wind: Wind,
    /// Controls, in their own units.
    pub controls: Vec<f64>,
    /// Velocity of a gust along body axes, m/s, held over a step.
    pub gust_mps: DVec3,
    /// Mass of now, kg: the model's unless the caller burns fuel or hangs stores on it.
    pub mass_kg: f64,
    /// Centre of gravity of now from the reference point.
    pub cg_m: DVec3,
    /// Inertia tensor of now about it, kg m2: the model's unless the caller hangs stores on it.
    pub inertia_kgm2: DMat3,
    /// Its inverse.
    pub inverse_inertia: DMat3,
    /// Drag area of stores, m2, and where their drag acts, from the reference point.
    pub stores_drag_m2: f64,
    /// See above.
    pub stores_at_m: DVec3,
    /// Speed of the engine's shaft, rad/s, held over a piece of a step; 0 without an engine of its own.
    pub shaft_radps: f64,
    /// Altitude of the ground under it, metres, held over a step; `None` is far below.
    pub ground_m: Option<f64>,
    /// Where its contacts hold the ground.
    pub treads: Vec<Option<Tread>>,
    /// The ground as contacts see it over a piece of a step; none in the air.
    pub(crate) planes: Vec<Option<Footing>>,
    /// What the engines give of their thrust: 1, or 0 when they are out.
    pub thrust_share: f64,
    memory: RefCell<LinkMemory>,
    still: bool,
}

/// What is known of a state in flight.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Body axes to the frame's.
    pub frame_from_body: DMat3,
    /// Height above the surface, metres; 0 where nothing depends on it.
    pub altitude_m: f64,
    /// The air.
    pub air: AirSample,
    /// Velocity through the air, body axes, m/s.
    pub through_air: DVec3,
    /// Angular velocity against the rotating Earth, body axes, rad/s.
    pub earth_rates: DVec3,
    /// Velocity north, east, down; nil where nothing depends on it.
    pub ned_mps: DVec3,
    /// Force and moment without gravity.
    pub loads: Loads,
    /// Quantities and controls.
    pub slots: [f64; SLOTS],
}

/// Position of a state.
pub fn position(y: &State) -> DVec3 {
    DVec3::new(y[0], y[1], y[2])
}

/// Attitude of a state, a unit quaternion.
pub fn attitude(y: &State) -> DQuat {
    let raw = DQuat::from_xyzw(y[4], y[5], y[6], y[3]);
    let length = raw.length();
    if length > 0.0 { raw * (1.0 / length) } else { DQuat::IDENTITY }
}

/// Velocity of a state over the Earth, in the frame.
pub fn velocity(y: &State) -> DVec3 {
    DVec3::new(y[8], y[9], y[10])
}

/// Inertial angular velocity of a state, in body axes.
pub fn rates(y: &State) -> DVec3 {
    DVec3::new(y[11], y[12], y[13])
}

/// A state of its parts.
pub fn state(position: DVec3, attitude: DQuat, cross_track_m: f64, velocity: DVec3, rates: DVec3) -> State {
    let (q, [x, y, z]) = (attitude, position.to_array());
    let ([vx, vy, vz], [p, qr, r]) = (velocity.to_array(), rates.to_array());
    [x, y, z, q.w, q.x, q.y, q.z, cross_track_m, vx, vy, vz, p, qr, r]
}

/// Fastest flight, m/s, and fastest turn, rad/s: beyond them a state has run away.
const FASTEST: (f64, f64) = (1e6, 1e5);

/// Whether a state is one that a body can have: finite, and not run away.
pub fn is_flight(y: &State) -> bool {
    y.iter().all(|x| x.is_finite()) && velocity(y).length() <= FASTEST.0 && rates(y).length() <= FASTEST.1
}

/// Height over the ground that is told where there is none, metres.
const FAR_ABOVE_M: f64 = 1e6;

/// Components of velocity (m/s) and rates (rad/s) below this are rest: what only decays would end in denormal numbers,
/// which are slow, and no output shows thirty digits.
const REST: f64 = 1e-30;

/// The state with its quaternion of length 1, and at rest where it hardly moves.
pub fn normalised(mut y: State) -> State {
    let q = attitude(&y);
    (y[3], y[4], y[5], y[6]) = (q.w, q.x, q.y, q.z);
    for component in &mut y[8..] {
        if component.abs() < REST {
            *component = 0.0;
        }
    }
    y
}

impl RigidMotion {
    /// A body in its surroundings, controls at their initial values.
    pub fn new(model: Arc<Model>, planet: Planet, atmosphere: Atmosphere, wind: Wind) -> Self {
        let (controls, memory, still) = (model.initial_controls(), RefCell::new(model.memory()), wind.is_still());
        let mass_kg = model.mass_kg;
        let cg_m = model.cg_m;
        let (inertia_kgm2, inverse_inertia) = (model.inertia_kgm2, model.inverse_inertia);
        Self {
            model,
            planet,
            atmosphere,
            wind,
            controls,
            gust_mps: DVec3::ZERO,
            mass_kg,
            cg_m,
            inertia_kgm2,
            inverse_inertia,
            stores_drag_m2: 0.0,
            stores_at_m: DVec3::ZERO,
            shaft_radps: 0.0,
            ground_m: None,
            treads: Vec::new(),
            planes: Vec::new(),
            thrust_share: 1.0,
            memory,
            still,
        }
    }

    /// Takes another model with the same controls.
    pub fn set_model(&mut self, model: Arc<Model>) {
        self.memory = RefCell::new(model.memory());
        (self.mass_kg, self.cg_m) = (model.mass_kg, model.cg_m);
        (self.inertia_kgm2, self.inverse_inertia) = (model.inertia_kgm2, model.inverse_inertia);
        self.model = model;
    }

    fn flat(&self) -> bool {
        matches!(self.planet.shape, Shape::Flat { .. })
    }

    /// Everything that is known of a state; with `all`, also what the model does not ask for.
    #[inline]
    pub fn sample(&self, y: &State, all: bool) -> Sample {
        let model = &*self.model;
        let uses = |quantity: Quantity| all || model.uses(quantity);
        let frame_from_body = DMat3::from_quat(attitude(y));
        let velocity_mps = velocity(y);
        let in_body = |v: DVec3| frame_from_body.transpose() * v;

        let course = model.course();
        let angles = uses(Quantity::RollRad) || uses(Quantity::PitchRad) || uses(Quantity::YawRad);
        let local = angles || course != Course::None || uses(Quantity::LatRad) || uses(Quantity::LonRad);
        // Latitude and longitude cost a cosine or an arc tangent; mostly the height alone is asked.
        let place = if local || !(self.still || self.flat()) {
            self.planet.place(position(y))
        } else if !self.still
            || uses(Quantity::AltitudeM)
            || uses(Quantity::AglM)
            || self.atmosphere.depends_on_height()
        {
            Place { altitude_m: self.planet.altitude_m(position(y)), ..Place::default() }
        } else {
            Place::default()
        };
        let frame_from_ned =
            if self.flat() || (self.still && !local) { None } else { Some(self.planet.frame_from_ned(place)) };
        let to_ned = |v: DVec3| frame_from_ned.map_or(v, |m| m.transpose() * v);
        let air = self.atmosphere.at(place.altitude_m);

        let mut through_air = in_body(velocity_mps) - self.gust_mps;
        if !self.still {
            let wind = self.wind.ned_mps(place.altitude_m);
            through_air -= in_body(frame_from_ned.map_or(wind, |m| m * wind));
        }
        let earth_rates =
            if self.planet.rotation_radps == 0.0 { rates(y) } else { rates(y) - in_body(self.planet.rotation()) };

        let tas = through_air.length();
        let dynamic_pressure_pa = 0.5 * air.density_kgpm3 * tas * tas;
        let mut slots = [0.0; SLOTS];
        slots[QUANTITIES..QUANTITIES + self.controls.len()].copy_from_slice(&self.controls);
        let mut set = |quantity: Quantity, value: f64| slots[quantity.slot()] = value;
        if uses(Quantity::AlphaRad) {
            set(Quantity::AlphaRad, through_air.z.atan2(through_air.x));
        }
        if uses(Quantity::BetaRad) {
            set(Quantity::BetaRad, through_air.y.atan2(through_air.x.hypot(through_air.z)));
        }
        set(Quantity::Mach, if air.sound_mps > 0.0 { tas / air.sound_mps } else { 0.0 });
        set(Quantity::AltitudeM, place.altitude_m);
        let half = 0.5 / tas.max(model.min_speed_mps);
        set(Quantity::PHat, earth_rates.x * model.span_m * half);
        set(Quantity::QHat, earth_rates.y * model.chord_m * half);
        set(Quantity::RHat, earth_rates.z * model.span_m * half);
        set(Quantity::TasMps, tas);
        if uses(Quantity::EasMps) {
            set(Quantity::EasMps, tas * (air.density_kgpm3 / SEA_LEVEL_DENSITY_KGPM3).sqrt());
        }
        set(Quantity::PRadps, earth_rates.x);
        set(Quantity::QRadps, earth_rates.y);
        set(Quantity::RRadps, earth_rates.z);
        if angles {
            let [roll, pitch, yaw] =
                angles_of(&frame_from_ned.map_or(frame_from_body, |m| m.transpose() * frame_from_body));
            set(Quantity::RollRad, roll);
            set(Quantity::PitchRad, pitch);
            set(Quantity::YawRad, yaw);
        }
        set(Quantity::LatRad, place.lat_rad);
        set(Quantity::LonRad, place.lon_rad);
        set(Quantity::CrossTrackM, y[7]);
        set(Quantity::DensityKgpm3, air.density_kgpm3);
        set(Quantity::DynamicPressurePa, dynamic_pressure_pa);
        set(Quantity::AheadMps, through_air.x);
        set(Quantity::RightMps, through_air.y);
        set(Quantity::DownMps, through_air.z);
        set(Quantity::AglM, self.ground_m.map_or(FAR_ABOVE_M, |ground_m| place.altitude_m - ground_m));

        let mut memory = self.memory.borrow_mut();
        let share = self.thrust_share;
        let mut loads = model.loads(&mut slots, through_air, dynamic_pressure_pa, share, self.cg_m, &mut memory);
        if let Some(power) = &model.power {
            let (thrust_n, _) = power.propeller.thrust_and_torque(air.density_kgpm3, through_air.x, self.shaft_radps);
            let force = DVec3::X * thrust_n;
            loads.force_n += force;
            loads.moment_nm += (power.at_m - self.cg_m).cross(force);
        }
        if self.stores_drag_m2 > 0.0 {
            // Dynamic pressure times area, along the wind.
            let force = through_air * (-0.5 * air.density_kgpm3 * tas * self.stores_drag_m2);
            loads.force_n += force;
            loads.moment_nm += (self.stores_at_m - self.cg_m).cross(force);
        }
        Sample {
            frame_from_body,
            altitude_m: place.altitude_m,
            air,
            through_air,
            earth_rates,
            ned_mps: if local || self.flat() { to_ned(velocity_mps) } else { DVec3::ZERO },
            loads,
            slots,
        }
    }

    /// Force and moment of the ground on the contacts, body axes.
    fn ground_loads(&self, y: &State) -> (DVec3, DVec3) {
        let pose = near::pose(self, y);
        let most_n = MOST_WEIGHTS * self.mass_kg * STANDARD_GRAVITY_MPS2;
        let (mut force, mut moment) = (DVec3::ZERO, DVec3::ZERO);
        for ((one, plane), tread) in self.model.contacts.iter().zip(&self.planes).zip(&self.treads) {
            let Some(footing) = plane else { continue };
            let Some(press) = one.press(&pose, footing, &self.controls, most_n) else { continue };
            let pushed = one.force_n(&press, footing, tread.as_ref(), &self.controls);
            force += pushed;
            moment += (press.point_m - pose.position_m).cross(pushed);
        }
        let in_body = pose.frame_from_body.transpose();
        (in_body * force, in_body * moment)
    }

    /// Takes the engine's shaft on by a piece of a step.
    pub fn turn_shaft(&mut self, y: &State, dt_s: f64) {
        if let Some((power, set, density, ahead_mps)) = self.shaft(y) {
            self.shaft_radps = power.stepped_radps(&set, density, ahead_mps, self.shaft_radps, dt_s);
        }
    }

    /// Gives the engine's shaft the speed at which it settles in a state.
    pub fn settle_shaft(&mut self, y: &State) {
        if let Some((power, set, density, ahead_mps)) = self.shaft(y) {
            self.shaft_radps = power.settled_radps(&set, density, ahead_mps);
        }
    }

    /// Fuel that the engine takes, kg/s; `None` without one of its own and without a flow of the model's.
    pub fn fuel_kgps(&self, y: &State) -> Option<f64> {
        if let Some(slot) = self.model.tank.and_then(|tank| tank.flow_slot) {
            return Some(self.sample(y, false).slots[slot].max(0.0) * self.thrust_share);
        }
        let (power, set, ..) = self.shaft(y)?;
        Some(power.engine.fuel_kgps(&set, self.shaft_radps))
    }

    /// The engine, what it is told, the air's density and its speed along the shaft.
    fn shaft(&self, y: &State) -> Option<(&PowerPlant, Setting, f64, f64)> {
        let power = self.model.power.as_ref()?;
        let altitude_m = self.planet.altitude_m(position(y));
        let air = self.atmosphere.at(altitude_m);
        let wind = if self.flat() { self.wind.ned_mps(altitude_m) } else { DVec3::ZERO };
        let ahead_mps = (attitude(y).inverse() * (velocity(y) - wind)).x - self.gust_mps.x;
        let ratio = air.density_kgpm3 / SEA_LEVEL_DENSITY_KGPM3;
        let set = power.setting(&self.controls, ratio, self.thrust_share > 0.0);
        Some((power, set, air.density_kgpm3, ahead_mps))
    }

    /// Rate of the attitude's quaternion (w, x, y, z).
    fn turning(y: &State, earth_rates: DVec3) -> [f64; 4] {
        let ([w, x, yy, z], DVec3 { x: p, y: q, z: r }) = ([y[3], y[4], y[5], y[6]], earth_rates);
        [
            -0.5 * (x * p + yy * q + z * r),
            0.5 * (w * p + yy * r - z * q),
            0.5 * (w * q - x * r + z * p),
            0.5 * (w * r + x * q - yy * p),
        ]
    }

    /// Velocity across the commanded course, positive to the right, m/s.
    fn across(&self, ned_mps: DVec3) -> f64 {
        match self.model.course() {
            Course::None => 0.0,
            Course::Fixed(course_rad) => ned_mps.y * course_rad.cos() - ned_mps.x * course_rad.sin(),
            Course::Control(place, si) => {
                let course_rad = self.controls[place] * si;
                ned_mps.y * course_rad.cos() - ned_mps.x * course_rad.sin()
            }
        }
    }
}

/// Roll, pitch and yaw of an attitude (body to north, east, down), radians; straight up or down, roll is taken as 0.
pub fn angles_of(ned_from_body: &DMat3) -> [f64; 3] {
    let (x, y, z) = (ned_from_body.x_axis, ned_from_body.y_axis, ned_from_body.z_axis);
    let level = x.x.hypot(x.y);
    let pitch = (-x.z).atan2(level);
    // Below this the nose's heading is rounding noise; the right wing still has one.
    if level > 1e-9 { [y.z.atan2(z.z), pitch, x.y.atan2(x.x)] } else { [0.0, pitch, (-y.x).atan2(y.y)] }
}

impl Motion<f64, N> for RigidMotion {
    #[inline]
    fn rate(&self, _: f64, y: &State) -> State {
        let sample = self.sample(y, false);
        let fall = self.planet.fall_mps2(position(y), velocity(y));
        let v = velocity(y);
        let (mut force, mut moment) = (sample.loads.force_n, sample.loads.moment_nm);
        if !self.planes.is_empty() {
            let (ground_n, ground_nm) = self.ground_loads(y);
            force += ground_n;
            moment += ground_nm;
        }
        let a = sample.frame_from_body * (force / self.mass_kg) + fall;
        let w = rates(y);
        let turn = self.inverse_inertia * (moment - w.cross(self.inertia_kgm2 * w));
        let [qw, qx, qy, qz] = Self::turning(y, sample.earth_rates);
        let across = self.across(sample.ned_mps);
        [v.x, v.y, v.z, qw, qx, qy, qz, across, a.x, a.y, a.z, turn.x, turn.y, turn.z]
    }

    fn drift(&self, y: &State) -> State {
        let v = velocity(y);
        let mut earth_rates = rates(y);
        if self.planet.rotation_radps != 0.0 {
            earth_rates -= attitude(y).inverse() * self.planet.rotation();
        }
        let [qw, qx, qy, qz] = Self::turning(y, earth_rates);
        let ned_mps = if self.model.course() == Course::None || self.flat() {
            v
        } else {
            self.planet.frame_from_ned(self.planet.place(position(y))).transpose() * v
        };
        [v.x, v.y, v.z, qw, qx, qy, qz, self.across(ned_mps), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
}
