//! What a state of a shot looks like: every column as a number, spin drift included.
//!
//! Invariant others rely on: rows, ends and the ground all see the same position, the integrated one moved to the right by
//! the drift; see [`super::drift`].

use super::column::Column;
use super::drift::SpinDrift;
use super::geodesic;
use super::launch::Launch;
use super::motion::{ShellMotion, State, parts, state};
use crate::case::Case;
use crate::limit::Limit;
use crate::planet::Place;
use crate::world_ground::WorldGround;
use glam::DVec3;

/// Sees the states of one shot.
#[derive(Debug, Clone)]
pub struct Observer<'a> {
    /// The case.
    pub case: &'a Case,
    /// The start.
    pub launch: Launch,
    /// Its spin drift.
    pub drift: Option<SpinDrift>,
    /// A world's ground.
    pub ground: Option<&'a WorldGround>,
}

impl Observer<'_> {
    /// The state as it is seen: moved to the right by the drift.
    #[inline]
    pub fn seen(&self, t_s: f64, y: &State) -> State {
        let Some(drift) = &self.drift else { return *y };
        let (position, velocity) = parts(y);
        let right = self.launch.axes.z_axis;
        state(position + right * drift.right_m(t_s), velocity + right * drift.right_mps(t_s))
    }

    /// The place of a seen state.
    pub fn place(&self, seen: &State) -> Place {
        let (position, _) = parts(seen);
        self.ground.map_or_else(|| self.case.planet.place(position), |ground| ground.place(position))
    }

    /// Altitude of a seen state, metres.
    #[inline]
    pub fn altitude_m(&self, seen: &State) -> f64 {
        self.case.planet.altitude_m(parts(seen).0)
    }

    /// Upward speed over the surface of a seen state, m/s.
    pub fn climb_mps(&self, seen: &State) -> f64 {
        -self.ned_mps(seen).z
    }

    fn ned_mps(&self, seen: &State) -> DVec3 {
        let (position, velocity) = parts(seen);
        self.case.planet.frame_from_ned(self.case.planet.place(position)).transpose() * velocity
    }

    fn range_m(&self, seen: &State) -> f64 {
        let (position, _) = parts(seen);
        let to = self.case.planet.place(position);
        match geodesic::inverse(self.case.planet.shape, self.launch.place, to) {
            Some((length_m, bearing_rad)) => length_m * (bearing_rad - self.launch.azimuth_rad).cos(),
            None => self.launch.local_m(position).x,
        }
    }

    /// A column of a seen state. `motion` knows the air.
    pub fn value(&self, column: Column, motion: &ShellMotion, t_s: f64, seen: &State) -> f64 {
        let (position, velocity) = parts(seen);
        let launch = &self.launch;
        let local = || launch.local_m(position);
        let along = || launch.axes.transpose() * velocity;
        match column {
            Column::Time => t_s,
            Column::X => local().x,
            Column::Y => local().y,
            Column::Z => local().z,
            Column::Drop => {
                let local = local();
                local.x * launch.elevation_rad.tan() - local.y
            }
            Column::Path => {
                let (local, (sin, cos)) = (local(), launch.look_rad.sin_cos());
                local.y * cos - local.x * sin - launch.sight_height_m
            }
            Column::Vx => along().x,
            Column::Vy => along().y,
            Column::Vz => along().z,
            Column::Speed => velocity.length(),
            Column::Mach => motion.mach(seen),
            Column::Lat => self.place(seen).lat_rad.to_degrees(),
            Column::Lon => self.place(seen).lon_rad.to_degrees(),
            Column::Altitude => self.altitude_m(seen),
            Column::Range => self.range_m(seen),
            Column::Fall => {
                let ned = self.ned_mps(seen);
                ned.z.atan2(ned.x.hypot(ned.y)).to_degrees()
            }
        }
    }

    /// How far a seen state is from a limit.
    pub fn beyond(&self, limit: &Limit<Column>, motion: &ShellMotion, t_s: f64, seen: &State) -> f64 {
        limit.beyond(self.value(limit.column, motion, t_s, seen))
    }
}
