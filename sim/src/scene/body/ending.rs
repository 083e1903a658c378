//! How a body's flight ends: where it is, or where it met the ground.

use super::{Body, Outcome};
use crate::frame::{ned_from_world, world_from_ned};
use crate::rigid::gear::{Met, Part};
use crate::rigid::motion::{self, State};
use crate::scene::event::EndReason;
use crate::scene::ground::GroundTouch;
use glam::DVec3;

impl Body {
    /// Stops where it is, or where it touched.
    pub(super) fn end(&mut self, reason: EndReason, touch: Option<GroundTouch>) -> Outcome {
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
    pub(super) fn break_up(&mut self, y: &State, met: &Met) -> Outcome {
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
}
