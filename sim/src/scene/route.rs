//! Routes: straight legs at a constant speed, and rounded corners where what drives can turn only so fast.
//!
//! Plan (x, z) of the world, metres, seconds, radians. At a waypoint the way is an arc that touches both legs. Its radius
//! is speed over rate of turn, so the rate is never above the given one; where half of a leg is too short for it the
//! radius is smaller and the arc is driven slower, down to a turn on the spot where the way leads straight back. Without a
//! rate the turn is at once, at the waypoint.
//!
//! Invariant others rely on: place and direction are continuous in time where a rate of turn is given.

use super::codec::coded;
use super::{Refused, place};
use crate::aircraft::MAX_SPEED_MPS;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Shortest leg of a route, metres: also at the highest speed a step passes a bounded number of waypoints.
pub const SHORTEST_LEG_M: f64 = 1.0;
/// Most waypoints of a route.
pub const MOST_WAYPOINTS: usize = 10_000;

/// A route and how far it is driven.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Route {
    waypoints_m: Vec<DVec2>,
    speed_mps: f64,
    turn_radps: Option<f64>,
    loops: bool,
    leg: u32,
    along_m: f64,
    turned_rad: f64,
}
coded!(Route { waypoints_m, speed_mps, turn_radps, loops, leg, along_m, turned_rad });

/// The arc at the end of a leg.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Corner {
    /// Of either leg that it takes the place of.
    trim_m: f64,
    radius_m: f64,
    /// From x towards z positive.
    angle_rad: f64,
}

impl Route {
    pub fn new(waypoints_m: Vec<DVec2>, speed_mps: f64, turn_radps: Option<f64>, loops: bool) -> Result<Self, Refused> {
        let route = Self { waypoints_m, speed_mps, turn_radps, loops, leg: 0, along_m: 0.0, turned_rad: 0.0 };
        route.check()?;
        Ok(route)
    }

    pub fn check(&self) -> Result<(), Refused> {
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
        if let Some(found) = self.turn_radps.filter(|rate| !(1e-3..=100.0).contains(rate)) {
            return Err(Refused::new(format_args!("target.turn_radps: expected 0.001..=100, found {found}")));
        }
        let leg = self.leg as usize;
        let most_m = if leg + 1 < count { self.waypoints_m[leg].distance(self.waypoints_m[leg + 1]) } else { 0.0 };
        let off = !(0.0..=most_m).contains(&self.along_m) || !(0.0..=PI).contains(&self.turned_rad);
        if leg >= count || off || (self.is_over() && self.loops) {
            return Err(Refused::new(format_args!("target.route_m: expected a leg below {count}, found {}", self.leg)));
        }
        Ok(())
    }

    /// Another way at the same speed and rate of turn.
    pub fn elsewhere(&self, waypoints_m: Vec<DVec2>) -> Result<Self, Refused> {
        Self::new(waypoints_m, self.speed_mps, self.turn_radps, false)
    }

    /// Whether it stands at the last waypoint.
    pub fn is_over(&self) -> bool {
        self.leg as usize + 1 >= self.waypoints_m.len()
    }

    /// Whether it turns at once.
    pub fn turns_at_once(&self) -> bool {
        self.turn_radps.is_none()
    }

    fn way_m(&self, leg: usize) -> DVec2 {
        self.waypoints_m[leg + 1] - self.waypoints_m[leg]
    }

    /// The leg after a leg; `None` after the last.
    fn next_leg(&self, leg: usize) -> Option<usize> {
        if leg + 2 < self.waypoints_m.len() { Some(leg + 1) } else { self.loops.then_some(0) }
    }

    fn corner(&self, leg: usize) -> Corner {
        let (Some(rate), Some(next)) = (self.turn_radps, self.next_leg(leg)) else { return Corner::default() };
        let (a, b) = (self.way_m(leg), self.way_m(next));
        let angle_rad = a.perp_dot(b).atan2(a.dot(b));
        let half = (0.5 * angle_rad.abs()).tan();
        if half == 0.0 {
            return Corner::default();
        }
        let trim_m = (self.speed_mps / rate * half).min(0.5 * a.length().min(b.length()));
        Corner { trim_m, radius_m: trim_m / half, angle_rad }
    }

    /// Goes on for a time.
    pub fn advance(&mut self, dt_s: f64) {
        let mut left_s = dt_s;
        while !self.is_over() && self.speed_mps > 0.0 {
            let leg = self.leg as usize;
            let corner = self.corner(leg);
            let end_m = self.way_m(leg).length() - corner.trim_m;
            if self.along_m < end_m {
                let way_m = self.speed_mps * left_s;
                if self.along_m + way_m < end_m {
                    self.along_m += way_m;
                    return;
                }
                left_s -= (end_m - self.along_m) / self.speed_mps;
                self.along_m = end_m;
            }
            if let Some(rate) = self.turn_radps.filter(|_| corner.angle_rad != 0.0) {
                // The radius may have been cut to what the legs hold: then it goes slower, not round faster.
                let rate = if corner.radius_m > 0.0 { rate.min(self.speed_mps / corner.radius_m) } else { rate };
                let turned_rad = self.turned_rad + rate * left_s.max(0.0);
                if turned_rad < corner.angle_rad.abs() {
                    self.turned_rad = turned_rad;
                    return;
                }
                left_s -= (corner.angle_rad.abs() - self.turned_rad) / rate;
            }
            self.turned_rad = 0.0;
            match self.next_leg(leg) {
                Some(next) => (self.leg, self.along_m) = (next as u32, corner.trim_m),
                None => (self.leg, self.along_m) = (self.leg + 1, 0.0),
            }
        }
    }

    /// Where it is, and the unit direction that it faces.
    pub fn place(&self) -> (DVec2, DVec2) {
        let leg = (self.leg as usize).min(self.waypoints_m.len() - 2);
        let way = self.way_m(leg);
        let length_m = way.length();
        let facing = way / length_m;
        if self.is_over() {
            return (self.waypoints_m[self.leg as usize], facing);
        }
        if self.turned_rad == 0.0 {
            return (self.waypoints_m[leg] + way * (self.along_m / length_m), facing);
        }
        let corner = self.corner(leg);
        let aside = facing.perp() * corner.angle_rad.signum();
        let (sin, cos) = self.turned_rad.sin_cos();
        let start = self.waypoints_m[leg + 1] - facing * corner.trim_m;
        let at = start + facing * (corner.radius_m * sin) + aside * (corner.radius_m * (1.0 - cos));
        (at, facing * cos + aside * sin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn route(corners: &[[f64; 2]], speed_mps: f64, loops: bool) -> Route {
        let waypoints_m = corners.iter().map(|at| DVec2::from_array(*at)).collect();
        Route::new(waypoints_m, speed_mps, Some(0.5), loops).unwrap()
    }

    #[test]
    fn place_and_direction_never_jump_and_the_turn_keeps_its_rate() {
        let corners = [[0.0, 0.0], [300.0, 0.0], [300.0, 200.0], [310.0, 190.0], [0.0, 0.0], [100.0, 0.0], [50.0, 0.0]];
        for (speed_mps, dt_s) in [(10.0, 0.01), (10.0, 0.1), (100.0, 0.01)] {
            let mut route = route(&corners, speed_mps, false);
            let (mut from, mut turned, mut steps) = (route.place(), 0.0, 0);
            while !route.is_over() {
                route.advance(dt_s);
                let to = route.place();
                // Coordinates below 2^9 m: roundings of 2^-44 m.
                assert!(to.0.distance(from.0) <= speed_mps * dt_s + 1e-9, "{from:?} {to:?}");
                let turn = from.1.angle_to(to.1).abs();
                // The angle comes from an atan2 of products: some 1e-15, and 1e-8 where it is about 0 by an acos.
                assert!(turn <= 0.5 * dt_s + 1e-7, "{turn} in {dt_s} s");
                assert!((to.1.length() - 1.0).abs() < 1e-12);
                turned += turn;
                (from, steps) = (to, steps + 1);
                assert!(steps < 100_000);
            }
            assert_eq!(from.0, DVec2::new(50.0, 0.0));
            assert!(turned > 6.0, "{turned}");
        }
    }

    #[test]
    fn a_corner_that_is_rounded_keeps_to_the_legs_outside_its_arc() {
        // 10 m/s and 0.5 rad/s: an arc of 20 m, which leaves the first leg 20 m before the corner.
        let mut route = route(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]], 10.0, false);
        route.advance(8.0);
        assert!(route.place().0.distance(DVec2::new(80.0, 0.0)) < 1e-12);
        // A quarter of a circle: pi seconds at 0.5 rad/s.
        route.advance(PI);
        assert!(route.place().0.distance(DVec2::new(100.0, 20.0)) < 1e-9, "{:?}", route.place());
        route.advance(1.0);
        assert!(route.place().0.distance(DVec2::new(100.0, 30.0)) < 1e-9);
        assert!(route.place().1.distance(DVec2::Y) < 1e-12);
    }

    #[test]
    fn a_loop_goes_round_for_ever() {
        let mut route = route(&[[0.0, 0.0], [100.0, 0.0], [100.0, 100.0], [0.0, 0.0]], 10.0, true);
        for _ in 0..10_000 {
            route.advance(0.37);
            route.check().unwrap();
            let at = route.place().0;
            assert!(at.x >= -1e-9 && at.x <= 100.0 + 1e-9 && at.y >= -1e-9 && at.y <= 100.0 + 1e-9, "{at}");
        }
    }
}
