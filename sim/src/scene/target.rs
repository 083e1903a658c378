//! Targets: a shape that stands, or drives along its route.
//!
//! World frame, metres, seconds. A bare shape keeps its reference point at a height over the ground, or at an altitude; it
//! turns at once at a waypoint, and a hit is counted and changes nothing else. A target of a kind stands by that kind's
//! rule ([`super::stance`]), turns no faster than it, takes damage, and stops for good when it is destroyed. Within a step
//! a target moves straight and turns evenly. Forward of a shape is its -Z, so an attitude of identity faces north.
//!
//! Invariant others rely on: positions are finite and within the bounds of any world; over void a target that follows
//! the ground keeps its last height.

use super::codec::{Coded, Reader, SaveError, coded, coded_choice};
use super::ground::SceneGround;
use super::route::Route;
use super::{Refused, attitude, place, stance};
use crate::ballistics::targets::Pose;
use crate::snapshot::StableId;
use crate::weapons::target_kind::Stand;
use crate::weapons::{Damage, TargetKind};
use glam::{DQuat, DVec2, DVec3};

/// Longest way driven before the start, metres: a bounded number of waypoints.
const MOST_AHEAD_M: f64 = 1e6;
/// How far a scattering target drives ahead, and then ahead and aside, metres.
const SCATTER_AHEAD_M: f64 = 10.0;
const SCATTER_ASIDE_M: f64 = 40.0;

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
    /// Name of its kind or its bare shape in the catalogue.
    pub shape: String,
    /// Plan position (x, z), metres; with a route, its first waypoint.
    pub plan_m: DVec2,
    /// Height of the shape's reference point; of a target of a kind, of where it stands (on water: of the water).
    pub height: Height,
    /// Shape to world; along the leg on a route.
    pub attitude: DQuat,
    /// Further waypoints (x, z), metres; none stands still.
    pub route_m: Vec<DVec2>,
    /// Speed in plan along the route, m/s.
    pub speed_mps: f64,
    /// Whether the route leads back to its first waypoint and goes round for ever.
    pub loops: bool,
    /// How far it has come on its route at the start, as the time that it drove, seconds.
    pub ahead_s: f64,
    /// The column that it drives in.
    pub column: Option<Column>,
}

/// A column: what its other members do when one of them is struck.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its number, the same for all members.
    pub number: u32,
    /// What they do.
    pub reaction: Reaction,
}
coded!(Column { number, reaction });

/// What a column does when a member is struck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reaction {
    /// It drives on.
    DriveOn,
    /// All stop where they are.
    #[default]
    Stop,
    /// All drive off the road, by turns to the left and to the right, and stop there.
    Scatter,
}
coded_choice!(Reaction { DriveOn, Stop, Scatter });

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
            ahead_s: 0.0,
            column: None,
        }
    }
}

/// A target as it is.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TargetState {
    pub shape: u32,
    pub position_m: DVec3,
    pub attitude: DQuat,
    pub velocity_mps: DVec3,
    height: Height,
    route: Option<Route>,
    /// Place of its kind in the catalogue.
    pub kind: Option<u32>,
    /// How it stands; `None` keeps its attitude.
    stand: Option<Stand>,
    pub column: Option<Column>,
    /// Whether it will not drive any more.
    halted: bool,
    /// 1 destroys.
    pub damage: f64,
    pub hits: u32,
    /// Owner and number of the round that hit last.
    pub last_round: Option<(StableId, u64)>,
    pub jumps: u32,
}
coded!(TargetState {
    shape,
    position_m,
    attitude,
    velocity_mps,
    height,
    route,
    kind,
    stand,
    column,
    halted,
    damage,
    hits,
    last_round,
    jumps
});

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
    /// A target of a kind, with its place in the catalogue, or of a bare shape.
    pub fn new(start: &TargetStart, shape: u32, kind: Option<(u32, &TargetKind)>) -> Result<Self, Refused> {
        let (Height::OverGround(metres) | Height::Msl(metres)) = start.height;
        let mut position_m = place("target.plan_m", DVec3::new(start.plan_m.x, metres, start.plan_m.y))?;
        let mut attitude = attitude("target.attitude", start.attitude)?;
        let (turn_radps, most_mps) =
            kind.map_or((None, f64::INFINITY), |(_, of)| (Some(of.turn_radps), of.most_speed_mps));
        let mut route = if start.route_m.is_empty() { None } else { Some(start.route(turn_radps, most_mps)?) };
        if let Some(route) = &mut route {
            route.advance(start.ahead_s);
            let (plan, facing) = route.place();
            (position_m.x, position_m.z) = (plan.x, plan.y);
            attitude = stance::upright(facing);
        }
        Ok(Self {
            shape,
            position_m,
            attitude,
            velocity_mps: DVec3::ZERO,
            height: start.height,
            route,
            kind: kind.map(|(place, _)| place),
            stand: kind.map(|(_, of)| of.stand),
            column: start.column,
            halted: false,
            damage: 0.0,
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
        if self.damage.is_nan() || self.damage < 0.0 {
            return Err(Refused::new(format_args!("target.damage: expected 0 or more, found {}", self.damage)));
        }
        self.route.as_ref().map_or(Ok(()), Route::check)
    }

    pub fn pose(&self) -> Pose {
        Pose { position_m: self.position_m, attitude: self.attitude }
    }

    /// What is left of it.
    pub fn state(&self) -> Damage {
        Damage::of(self.damage)
    }

    /// Adds damage; the new state if that changed. What is destroyed stands still.
    pub fn hurt(&mut self, amount: f64) -> Option<Damage> {
        let before = self.state();
        self.damage += amount;
        let after = self.state();
        if after == Damage::Destroyed {
            self.halted = true;
        }
        (after != before).then_some(after)
    }

    fn drives(&self) -> bool {
        !self.halted && self.route.as_ref().is_some_and(|route| !route.is_over())
    }

    /// Whether a step may move it.
    pub fn is_restless(&self) -> bool {
        self.drives() || self.velocity_mps != DVec3::ZERO
    }

    /// Whether it turns at once at a waypoint, so that the new attitude holds for the whole step.
    pub fn turns_at_once(&self) -> bool {
        self.route.as_ref().is_some_and(Route::turns_at_once)
    }

    /// Goes on by a step.
    pub fn step(&mut self, ground: &SceneGround, dt_s: f64) {
        let from_m = self.position_m;
        if self.drives()
            && let Some(route) = self.route.as_mut()
        {
            let (_, before) = route.place();
            route.advance(dt_s);
            let (plan, facing) = route.place();
            (self.position_m.x, self.position_m.z) = (plan.x, plan.y);
            if self.stand.is_some() || facing != before {
                self.attitude = stance::upright(facing);
            }
            self.settle(ground);
        }
        self.velocity_mps = (self.position_m - from_m) / dt_s;
    }

    /// Takes its place on the ground.
    pub fn settle(&mut self, ground: &SceneGround) {
        if let Some(stand) = &self.stand {
            let pose = match self.height {
                Height::Msl(metres) => Some(stance::level(stand, &self.pose(), metres)),
                Height::OverGround(metres) => stance::on_ground(stand, &self.pose(), ground, metres),
            };
            if let Some(pose) = pose {
                (self.position_m, self.attitude) = (pose.position_m, pose.attitude);
            }
            return;
        }
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
        (self.height, self.route, self.stand) = (Height::Msl(position_m.y), None, None);
        self.jumps = self.jumps.wrapping_add(1);
    }

    /// Does what its column does when another of it was struck; `number` tells left from right.
    pub fn react(&mut self, number: u64) {
        let Some(Column { reaction, .. }) = self.column.take() else { return };
        match (reaction, &self.route) {
            (Reaction::Scatter, Some(route)) if self.drives() => {
                let ahead = stance::facing(self.attitude);
                let aside = if number.is_multiple_of(2) { ahead.perp() } else { -ahead.perp() };
                let from = DVec2::new(self.position_m.x, self.position_m.z);
                let near = from + ahead * SCATTER_AHEAD_M;
                let scattered = route.elsewhere(vec![from, near, near + (ahead + aside) * SCATTER_ASIDE_M]);
                // Beyond a world's bounds there is nowhere to go: it stops.
                match scattered {
                    Ok(route) => self.route = Some(route),
                    Err(_) => self.halted = true,
                }
            }
            (Reaction::DriveOn, _) => {}
            _ => self.halted = true,
        }
    }
}

impl TargetStart {
    fn route(&self, turn_radps: Option<f64>, most_mps: f64) -> Result<Route, Refused> {
        let mut waypoints_m = Vec::with_capacity(self.route_m.len() + 2);
        waypoints_m.push(self.plan_m);
        waypoints_m.extend_from_slice(&self.route_m);
        if self.loops {
            waypoints_m.push(self.plan_m);
        }
        if self.speed_mps > most_mps {
            let found = self.speed_mps;
            return Err(Refused::new(format_args!(
                "target.speed_mps: expected at most {most_mps} of its kind, found {found}"
            )));
        }
        let route = Route::new(waypoints_m, self.speed_mps, turn_radps, self.loops)?;
        if !(self.ahead_s >= 0.0 && self.ahead_s * self.speed_mps <= MOST_AHEAD_M) {
            let found = self.ahead_s;
            return Err(Refused::new(format_args!(
                "target.ahead_s: expected seconds for up to {MOST_AHEAD_M} m, found {found}"
            )));
        }
        Ok(route)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driving(loops: bool) -> TargetState {
        let route_m = vec![DVec2::new(100.0, 0.0), DVec2::new(100.0, 50.0)];
        let start = TargetStart { route_m, speed_mps: 10.0, loops, ..TargetStart::standing("tank", DVec2::ZERO) };
        TargetState::new(&start, 0, None).unwrap()
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
        let refused = |start: TargetStart| TargetState::new(&start, 0, None).unwrap_err().to_string();
        let good = TargetStart::standing("tank", DVec2::ZERO);
        let with = |route_m: Vec<DVec2>, speed_mps| TargetStart { route_m, speed_mps, ..good.clone() };
        assert!(refused(with(vec![DVec2::ZERO], 1.0)).contains("expected legs"));
        assert!(refused(with(vec![DVec2::NAN], 1.0)).contains("route_m"));
        assert!(refused(with(vec![DVec2::X * 9.0], f64::NAN)).contains("speed_mps"));
        for ahead_s in [f64::NAN, -1.0, 2e6] {
            assert!(refused(TargetStart { ahead_s, ..with(vec![DVec2::X * 9.0], 1.0) }).contains("ahead_s"));
        }
        assert!(refused(TargetStart { plan_m: DVec2::new(f64::INFINITY, 0.0), ..good.clone() }).contains("plan_m"));
        assert!(refused(TargetStart { attitude: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..good }).contains("attitude"));
    }
}
