//! A wheel on its strut, or a part that should not touch: the force of the ground on it.
//!
//! A wheel's strut works along the body's vertical: the tyre's way into the ground over the cosine between strut and normal
//! is its travel; beyond its travel a stop ten times as stiff takes over. A part has no strut: its way into the ground is
//! that along the normal. Along the ground a wheel gives way at its rolling friction and brakes, across at its grip; a part
//! slides alike every way. Metres, newtons, body axes from the model's reference point.
//!
//! Source: stick and slip about an anchor: P. R. Dahl, Solid Friction Damping of Mechanical Vibrations, AIAA J. 14, 1976;
//! from static to sliding friction with speed: R. Stribeck, 1902.

use super::surface::Footing;
use super::tread::Tread;
use glam::{DMat3, DVec2, DVec3};

/// Most force of a contact, in weights of the body.
pub const MOST_WEIGHTS: f64 = 60.0;
/// How much stiffer the stop at the end of a strut's travel is.
const STOP: f64 = 10.0;
/// Way over which a damper comes in, metres, so that a touch is no blow.
const DAMPER_IN_M: f64 = 0.01;
/// Sliding speed at which friction has come down from static to sliding, m/s.
const STRIBECK_MPS: f64 = 0.1;
/// Part of the way at which a wheel that retracts is down and locked.
pub const DOWN: f64 = 0.99;
/// Least cosine between a strut and the ground's normal.
const LEAST_COSINE: f64 = 0.3;

/// What of the body it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// A wheel.
    Wheel,
    /// The hull: belly, nose, cabin.
    Hull,
    /// A wing's tip.
    WingTip,
    /// The tail.
    Tail,
    /// The propeller.
    Propeller,
}

/// How a contact turns with a control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steer {
    /// The control's place.
    pub control: usize,
    /// Radians to the right at 1 of the control.
    pub gain_rad: f64,
}

/// Rolling, of a wheel.
#[derive(Debug, Clone, PartialEq)]
pub struct Rolling {
    /// Coefficient of rolling on dry concrete.
    pub friction: f64,
    /// Relaxation length of the tyre, metres.
    pub relaxation_m: f64,
    /// Coefficient that full brakes add.
    pub brake_friction: f64,
    /// Controls that brake, by place; the greatest counts.
    pub brakes: Vec<usize>,
    /// Whether it turns.
    pub steer: Option<Steer>,
}

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Its name.
    pub name: String,
    /// What it is.
    pub part: Part,
    /// Hub of a wheel with its strut out, or the part's point.
    pub at_m: DVec3,
    /// Radius of a wheel, else 0.
    pub radius_m: f64,
    /// Travel of the strut; nil for a part.
    pub travel_m: f64,
    /// Stiffness, N/m.
    pub spring_npm: f64,
    /// Damping while it goes in, N s/m.
    pub compress_nspm: f64,
    /// Damping while it comes out, N s/m.
    pub extend_nspm: f64,
    /// Static and sliding coefficient of friction on dry concrete.
    pub friction: [f64; 2],
    /// Stiffness along the ground, N/m.
    pub grip_npm: f64,
    /// Damping along the ground at rest, N s/m.
    pub grip_nspm: f64,
    /// Rolling, if it is a wheel.
    pub rolling: Option<Rolling>,
    /// The control that lowers it, by place, if it retracts: it meets the ground only when that is all but down.
    pub lowered_by: Option<usize>,
    /// Closing speed that it stands, m/s.
    pub breaks_mps: f64,
}

/// A body at an instant, for its contacts. North, east, down.
#[derive(Debug, Clone, Copy)]
pub struct Pose {
    /// Position of the centre of gravity.
    pub position_m: DVec3,
    /// Velocity.
    pub velocity_mps: DVec3,
    /// Body axes to the frame's.
    pub frame_from_body: DMat3,
    /// Rates against the ground, body axes.
    pub rates_radps: DVec3,
    /// Centre of gravity from the model's reference point.
    pub cg_m: DVec3,
}

impl Pose {
    /// A point of the body.
    pub fn point_m(&self, at_m: DVec3) -> DVec3 {
        self.position_m + self.frame_from_body * (at_m - self.cg_m)
    }

    /// Velocity of a point that moves with the body.
    pub fn velocity_of(&self, point_m: DVec3) -> DVec3 {
        let arm = self.frame_from_body.transpose() * (point_m - self.position_m);
        self.velocity_mps + self.frame_from_body * self.rates_radps.cross(arm)
    }
}

/// A contact that is in the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Where.
    pub point_m: DVec3,
    /// Its velocity.
    pub velocity_mps: DVec3,
    /// Way into the ground along the normal.
    pub depth_m: f64,
    /// Travel of the strut, or the depth.
    pub travel_m: f64,
    /// Force along the normal, newtons.
    pub normal_n: f64,
    along: DVec3,
    across: DVec3,
}

impl Contact {
    fn relaxation_m(&self) -> Option<f64> {
        self.rolling.as_ref().map(|rolling| rolling.relaxation_m)
    }

    /// The contact in the ground, `None` above it.
    pub fn press(&self, pose: &Pose, footing: &Footing, controls: &[f64], most_n: f64) -> Option<Press> {
        if self.lowered_by.is_some_and(|place| controls[place] < DOWN) {
            return None;
        }
        let hub = pose.point_m(self.at_m);
        let normal = footing.normal;
        let over_m = (hub - footing.point_m).dot(normal);
        let depth_m = self.radius_m - over_m;
        if depth_m.is_nan() || depth_m <= 0.0 {
            return None;
        }
        let strut = -(pose.frame_from_body * DVec3::Z);
        let cosine = if self.rolling.is_some() { strut.dot(normal).max(LEAST_COSINE) } else { 1.0 };
        let travel_m = depth_m / cosine;
        let point_m = hub - normal * over_m;
        let velocity_mps = pose.velocity_of(point_m);
        let rate_mps = -velocity_mps.dot(normal) / cosine;
        let damping = if rate_mps > 0.0 { self.compress_nspm } else { self.extend_nspm };
        let stop_m = if self.rolling.is_some() { (travel_m - self.travel_m).max(0.0) } else { 0.0 };
        let strut_n =
            self.spring_npm * (travel_m + STOP * stop_m) + damping * rate_mps * travel_m / (travel_m + DAMPER_IN_M);
        let steer = self.rolling.as_ref().and_then(|rolling| rolling.steer);
        let turned = steer.map_or(DVec3::X, |steer| {
            let angle = steer.gain_rad * controls[steer.control];
            DVec3::new(angle.cos(), angle.sin(), 0.0)
        });
        let across = (pose.frame_from_body * turned).cross(normal);
        let across = across.try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        Some(Press {
            point_m,
            velocity_mps,
            depth_m,
            travel_m,
            normal_n: (strut_n / cosine).clamp(0.0, most_n),
            along: normal.cross(across),
            across,
        })
    }

    /// Limits of the force along and across, newtons, at a sliding speed.
    fn limits_n(&self, press: &Press, footing: &Footing, controls: &[f64], sliding_mps: f64) -> [f64; 2] {
        let [fixed, sliding] = self.friction;
        let slower = sliding_mps / STRIBECK_MPS;
        let friction = (sliding + (fixed - sliding) * (-slower * slower).exp()) * footing.surface.grip;
        let grip_n = friction * press.normal_n;
        let along_n = self.rolling.as_ref().map_or(grip_n, |rolling| {
            let brake = rolling.brakes.iter().map(|place| controls[*place].clamp(0.0, 1.0)).fold(0.0, f64::max);
            let rolls = rolling.friction + footing.surface.rolling;
            (rolls * press.normal_n + brake * rolling.brake_friction * footing.surface.grip * press.normal_n)
                .min(grip_n)
        });
        [along_n, grip_n]
    }

    /// The force of the ground, newtons.
    pub fn force_n(&self, press: &Press, footing: &Footing, tread: Option<&Tread>, controls: &[f64]) -> DVec3 {
        let Press { along, across, velocity_mps, point_m, normal_n, .. } = *press;
        let [rolls_mps, slides_mps] = [velocity_mps.dot(along), velocity_mps.dot(across)];
        let stretch = tread.map_or([0.0; 2], |tread| tread.stretch_m(point_m, along, across, self.relaxation_m()));
        let is_wheel = self.rolling.is_some();
        let slip_mps = if is_wheel { slides_mps } else { rolls_mps.hypot(slides_mps) };
        // A tyre that rolls makes its side force by slip alone.
        let damping = if is_wheel { self.grip_nspm / (1.0 + rolls_mps * rolls_mps) } else { self.grip_nspm };
        let [along_n, across_n] = self.limits_n(press, footing, controls, slip_mps.abs());
        let pull =
            |stretch: f64, speed: f64, most: f64| (-self.grip_npm * stretch - damping * speed).clamp(-most, most);
        let pulled = DVec2::new(pull(stretch[0], rolls_mps, along_n), pull(stretch[1], slides_mps, across_n));
        let held = pulled.clamp_length_max(across_n);
        footing.normal * normal_n + along * held.x + across * held.y
    }

    /// The tread after a piece of a step: as it was while it holds, dragged along where it slides or rolls.
    pub fn tread_after(&self, press: &Press, footing: &Footing, tread: Option<Tread>, controls: &[f64]) -> Tread {
        let Some(tread) = tread else { return Tread::new(press.point_m) };
        let Press { along, across, velocity_mps, point_m, .. } = *press;
        let stretch = tread.stretch_m(point_m, along, across, self.relaxation_m());
        let [rolls_mps, slides_mps] = [velocity_mps.dot(along), velocity_mps.dot(across)];
        let slip_mps = if self.rolling.is_some() { slides_mps } else { rolls_mps.hypot(slides_mps) };
        let [along_n, across_n] = self.limits_n(press, footing, controls, slip_mps.abs());
        let [most_along, most_across] = [along_n / self.grip_npm, across_n / self.grip_npm];
        let held = DVec2::new(stretch[0].clamp(-most_along, most_along), stretch[1].clamp(-most_across, most_across))
            .clamp_length_max(most_across);
        let slides = held.x != stretch[0] || held.y != stretch[1];
        if slides || tread.is_worn(point_m, along, self.relaxation_m()) {
            Tread { at_m: point_m, stretch_m: held.to_array() }
        } else {
            tread
        }
    }

    /// Its stiffness (1/s2) and damping (1/s) in a body: what its strut, the stop at its end and its grip can do to it.
    pub fn modes(&self, mass_kg: f64, least_inertia_kgm2: f64, cg_m: DVec3) -> [f64; 2] {
        let arm = (self.at_m - cg_m).length() + self.radius_m;
        let moves = 1.0 / mass_kg + arm * arm / least_inertia_kgm2;
        let damping = self.compress_nspm.max(self.extend_nspm);
        let spring_npm = if self.rolling.is_some() { (1.0 + STOP) * self.spring_npm } else { self.spring_npm };
        [spring_npm.max(self.grip_npm) * moves, damping.max(self.grip_nspm) * moves]
    }
}
