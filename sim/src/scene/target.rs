//! Targets: a shape that stands, or drives along straight legs at a constant speed.
//!
//! World frame, metres, seconds. The reference point of the shape keeps its height over the ground, or an altitude.
//! Within a step a target moves straight; at a waypoint it turns at once. Forward of a shape is its -Z, so an attitude
//! of identity faces north. A hit is counted and changes nothing else: damage is for a later model.
//!
//! Invariant others rely on: positions are finite and within the bounds of any world; over void a target that follows
//! the ground keeps its last height.

use super::codec::{Coded, Reader, SaveError, coded};
use super::ground::SceneGround;
use super::{Refused, attitude, place};
use crate::aircraft::MAX_SPEED_MPS;
use crate::ballistics::targets::Pose;
use crate::snapshot::StableId;
use glam::{DQuat, DVec2, DVec3};

/// Shortest leg of a route, metres: also at the highest speed a step passes a bounded number of waypoints.
pub const SHORTEST_LEG_M: f64 = 1.0;
/// Most waypoints of a route.
pub const MOST_WAYPOINTS: usize = 10_000;

/// What a target's height keeps to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Height {
    /// So far above the ground, metres.
    OverGround(f64),
    /// An altitude above mean sea level, metres.
    Msl(f64),
}

/// A target to be added.
#[derive(Debug, Clone, PartialEq)]
pub struct TargetStart {
    /// Name of its shape in the catalogue.
    pub shape: String,
    /// Plan position (x, z), metres; with a route, its first waypoint.
    pub plan_m: DVec2,
    /// Height of the shape's reference point.
    pub height: Height,
    /// Shape to world; along the leg on a route.
    pub attitude: DQuat,
    /// Further waypoints (x, z), metres; none stands still.
    pub route_m: Vec<DVec2>,
    /// Speed in plan along the route, m/s.
    pub speed_mps: f64,
    /// Whether the route leads back to its first waypoint and goes round for ever.
    pub loops: bool,
}

impl TargetStart {
    /// A target that stands upright on the ground.
    pub fn standing(shape: &str, plan_m: DVec2) -> Self {
        Self {
            shape: shape.to_owned(),
            plan_m,
            height: Height::OverGround(0.0),
            attitude: DQuat::IDENTITY,
            route_m: Vec::new(),
            speed_mps: 0.0,
            loops: false,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Route {
    waypoints_m: Vec<DVec2>,
    speed_mps: f64,
    loops: bool,
    leg: u32,
    along_m: f64,
}
coded!(Route { waypoints_m, speed_mps, loops, leg, along_m });

/// A target as it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TargetState {
    pub shape: u32,
    pub position_m: DVec3,
    pub attitude: DQuat,
    pub velocity_mps: DVec3,
    height: Height,
    route: Option<Route>,
    pub hits: u32,
    /// Owner and number of the round that hit last.
    pub last_round: Option<(StableId, u64)>,
    pub jumps: u32,
}
coded!(TargetState { shape, position_m, attitude, velocity_mps, height, route, hits, last_round, jumps });

impl Coded for Height {
    fn put(&self, out: &mut Vec<u8>) {
        let (kind, metres) = match *self {
            Self::OverGround(metres) => (0u8, metres),
            Self::Msl(metres) => (1, metres),
        };
        kind.put(out);
        metres.put(out);
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        match (from.take::<u8>()?, from.take()?) {
            (0, metres) => Ok(Self::OverGround(metres)),
            (1, metres) => Ok(Self::Msl(metres)),
            (found, _) => Err(from.refuse(format_args!("height: expected 0 or 1, found {found}"))),
        }
    }
}

impl TargetState {
    pub fn new(start: &TargetStart, shape: u32) -> Result<Self, Refused> {
        let (Height::OverGround(metres) | Height::Msl(metres)) = start.height;
        let position_m = place("target.plan_m", DVec3::new(start.plan_m.x, metres, start.plan_m.y))?;
        let mut attitude = attitude("target.attitude", start.attitude)?;
        let route = if start.route_m.is_empty() { None } else { Some(Route::new(start)?) };
        if let Some(route) = &route {
            attitude = route.facing();
        }
        Ok(Self {
            shape,
            position_m,
            attitude,
            velocity_mps: DVec3::ZERO,
            height: start.height,
            route,
            hits: 0,
            last_round: None,
            jumps: 0,
        })
    }

    /// What a restored one must be, so that stepping it cannot fail.
    pub fn check(&self) -> Result<(), Refused> {
        place("target.position_m", self.position_m)?;
        let (Height::OverGround(height_m) | Height::Msl(height_m)) = self.height;
        if height_m.is_nan() || height_m.abs() > 1e6 {
            return Err(Refused::new(format_args!("target.height: expected metres within 1e6, found {height_m}")));
        }
        self.route.as_ref().map_or(Ok(()), Route::check)
    }

    pub fn pose(&self) -> Pose {
        Pose { position_m: self.position_m, attitude: self.attitude }
    }

    /// Whether a step may move it.
    pub fn is_restless(&self) -> bool {
        self.route.as_ref().is_some_and(|route| !route.is_over()) || self.velocity_mps != DVec3::ZERO
    }

    /// Goes on by a step.
    pub fn step(&mut self, ground: &SceneGround, dt_s: f64) {
        let from_m = self.position_m;
        if let Some(route) = self.route.as_mut().filter(|route| !route.is_over()) {
            let leg = route.leg;
            let plan = route.advance(dt_s);
            (self.position_m.x, self.position_m.z) = (plan.x, plan.y);
            if route.leg != leg {
                self.attitude = route.facing();
            }
        }
        self.settle(ground);
        self.velocity_mps = (self.position_m - from_m) / dt_s;
    }

    /// Takes its height over the ground.
    pub fn settle(&mut self, ground: &SceneGround) {
        self.position_m.y = match self.height {
            Height::Msl(metres) => metres,
            Height::OverGround(metres) => ground
                .height_m(self.position_m.x, self.position_m.z)
                .map_or(self.position_m.y, |ground_m| ground_m + metres),
        };
    }

    /// Puts it elsewhere, standing: a route ends there.
    pub fn reposition(&mut self, position_m: DVec3, attitude: DQuat) {
        (self.position_m, self.attitude, self.velocity_mps) = (position_m, attitude, DVec3::ZERO);
        (self.height, self.route) = (Height::Msl(position_m.y), None);
        self.jumps = self.jumps.wrapping_add(1);
    }
}

impl Route {
    fn new(start: &TargetStart) -> Result<Self, Refused> {
        let mut waypoints_m = Vec::with_capacity(start.route_m.len() + 2);
        waypoints_m.push(start.plan_m);
        waypoints_m.extend_from_slice(&start.route_m);
        if start.loops {
            waypoints_m.push(start.plan_m);
        }
        let route = Self { waypoints_m, speed_mps: start.speed_mps, loops: start.loops, leg: 0, along_m: 0.0 };
        route.check()?;
        Ok(route)
    }

    fn check(&self) -> Result<(), Refused> {
        let count = self.waypoints_m.len();
        if !(2..=MOST_WAYPOINTS).contains(&count) {
            return Err(Refused::new(format_args!(
                "target.route_m: expected 1..{MOST_WAYPOINTS} waypoints, found {count}"
            )));
        }
        for at in &self.waypoints_m {
            place("target.route_m", DVec3::new(at.x, 0.0, at.y))?;
        }
        if let Some(leg) = self.waypoints_m.windows(2).position(|leg| leg[0].distance(leg[1]) < SHORTEST_LEG_M) {
            return Err(Refused::new(format_args!(
                "target.route_m: expected legs of at least {SHORTEST_LEG_M} m, found leg {leg} shorter"
            )));
        }
        if !(self.speed_mps >= 0.0 && self.speed_mps <= MAX_SPEED_MPS) {
            let found = self.speed_mps;
            return Err(Refused::new(format_args!(
                "target.speed_mps: expected 0..={MAX_SPEED_MPS} m/s, found {found}"
            )));
        }
        let leg = self.leg as usize;
        let most_m = if leg + 1 < count { self.waypoints_m[leg].distance(self.waypoints_m[leg + 1]) } else { 0.0 };
        if leg >= count || !(0.0..=most_m).contains(&self.along_m) || (self.is_over() && self.loops) {
            return Err(Refused::new(format_args!("target.route_m: expected a leg below {count}, found {}", self.leg)));
        }
        Ok(())
    }

    /// Whether it stands at the last waypoint.
    fn is_over(&self) -> bool {
        self.leg as usize + 1 >= self.waypoints_m.len()
    }

    fn advance(&mut self, dt_s: f64) -> DVec2 {
        let mut way_m = self.speed_mps * dt_s;
        while !self.is_over() {
            let (from, to) = (self.waypoints_m[self.leg as usize], self.waypoints_m[self.leg as usize + 1]);
            let length_m = from.distance(to);
            if self.along_m + way_m < length_m {
                self.along_m += way_m;
                return from + (to - from) * (self.along_m / length_m);
            }
            way_m -= length_m - self.along_m;
            (self.along_m, self.leg) = (0.0, self.leg + 1);
            if self.is_over() && self.loops {
                self.leg = 0;
            }
        }
        self.waypoints_m[self.leg as usize]
    }

    /// Along the leg; along the last one at its end.
    fn facing(&self) -> DQuat {
        let leg = (self.leg as usize).min(self.waypoints_m.len() - 2);
        let way = self.waypoints_m[leg + 1] - self.waypoints_m[leg];
        DQuat::from_rotation_y(-way.x.atan2(-way.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driving(loops: bool) -> TargetState {
        let route_m = vec![DVec2::new(100.0, 0.0), DVec2::new(100.0, 50.0)];
        let start = TargetStart { route_m, speed_mps: 10.0, loops, ..TargetStart::standing("tank", DVec2::ZERO) };
        TargetState::new(&start, 0).unwrap()
    }

    #[test]
    fn legs_are_driven_at_their_speed_on_the_ground_and_end() {
        let ground = SceneGround::heights(|x_m, _| Some(0.1 * x_m));
        let mut target = driving(false);
        for _ in 0..50 {
            target.step(&ground, 0.1);
        }
        // 50 sums of 1 m: a rounding of 2^-48 m each.
        assert!(target.position_m.distance(DVec3::new(50.0, 5.0, 0.0)) < 50.0 * 2f64.powi(-47));
        assert!((target.velocity_mps - DVec3::new(10.0, 1.0, 0.0)).length() < 1e-9);
        assert!((target.attitude * DVec3::NEG_Z - DVec3::X).length() < 1e-15, "faces east");
        for _ in 0..70 {
            target.step(&ground, 0.1);
        }
        assert!((target.attitude * DVec3::NEG_Z - DVec3::Z).length() < 1e-15, "faces south");
        for _ in 0..100 {
            target.step(&ground, 0.1);
        }
        assert_eq!(target.position_m, DVec3::new(100.0, 10.0, 50.0));
        assert!(target.velocity_mps == DVec3::ZERO && !target.is_restless());
    }

    #[test]
    fn a_loop_goes_round_and_over_void_the_height_stays() {
        let mut target = driving(true);
        let around_m = 150.0 + 100f64.hypot(50.0);
        for _ in 0..3 {
            target.step(&SceneGround::void(), around_m / 10.0);
        }
        // Three rounds of three legs: some ten roundings of 2^-45 m.
        assert!(target.position_m.length() < 10.0 * 2f64.powi(-44), "{}", target.position_m);
        assert!(target.is_restless());
    }

    #[test]
    fn routes_that_are_none_are_refused() {
        let refused = |start: TargetStart| TargetState::new(&start, 0).unwrap_err().to_string();
        let good = TargetStart::standing("tank", DVec2::ZERO);
        let with = |route_m: Vec<DVec2>, speed_mps| TargetStart { route_m, speed_mps, ..good.clone() };
        assert!(refused(with(vec![DVec2::ZERO], 1.0)).contains("expected legs"));
        assert!(refused(with(vec![DVec2::NAN], 1.0)).contains("route_m"));
        assert!(refused(with(vec![DVec2::X * 9.0], f64::NAN)).contains("speed_mps"));
        assert!(refused(TargetStart { plan_m: DVec2::new(f64::INFINITY, 0.0), ..good.clone() }).contains("plan_m"));
        assert!(refused(TargetStart { attitude: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..good }).contains("attitude"));
    }
}
