//! What the parts of a body strike beside the ground: buildings, masts, targets.
//!
//! World frame. Each contact of the model that is out, a wheel's hub or a part's point, is swept along its own way in the step, which the
//! body's turning bends; of a model without contacts the centre of gravity. Targets stand where they stood at the end of the
//! step before. What lies between the contacts (a wing's leading edge) strikes nothing by itself.
//!
//! Invariant others rely on: the first touch of any part counts, and a scene without things and targets pays nothing.

use super::{Body, Outcome};
use crate::ballistics::path::StepPath;
use crate::ballistics::targets::{Target, target_impact};
use crate::frame::world_from_ned;
use crate::rigid::Model;
use crate::rigid::motion::{self, State};
use crate::scene::event::EndReason;
use crate::scene::ground::{GroundTouch, SceneGround};
use crate::scene::target_grid::TargetGrid;
use glam::DVec3;

/// Where a point of a body is and how fast it moves, world.
fn point(y: &State, arm_m: DVec3) -> (DVec3, DVec3) {
    let turned = motion::attitude(y);
    let at = motion::position(y) + turned * arm_m;
    let moves = motion::velocity(y) + turned * motion::rates(y).cross(arm_m);
    (world_from_ned(at), world_from_ned(moves))
}

/// The first thing or target that a part strikes on the way from one state to another.
pub fn struck(
    body: &Body,
    model: &Model,
    cg_m: DVec3,
    from: &State,
    step_s: f64,
    ground: &SceneGround,
    (targets, grid): (&[Target], &TargetGrid),
) -> Option<GroundTouch> {
    if targets.is_empty() && !ground.has_things() {
        return None;
    }
    let to = &body.state;
    let mut first: Option<GroundTouch> = None;
    let mut earlier = |touch: GroundTouch| {
        if first.as_ref().is_none_or(|first| touch.fraction < first.fraction) {
            first = Some(touch);
        }
    };
    let mut sweep = |arm_m: DVec3| {
        let ((from_m, from_mps), (to_m, to_mps)) = (point(from, arm_m), point(to, arm_m));
        let path = StepPath { from_m, from_mps, to_m, to_mps, step_s };
        if let Some(touch) = ground.touch_thing(&path) {
            earlier(touch);
        }
        grid.near(&path, |index| {
            // Nothing of it moves in this sweep.
            let target = Target { from: targets[index].to, ..targets[index].clone() };
            if let Some(hit) = target_impact(&path, &[target], None) {
                let (fraction, point_m, normal, velocity_mps) =
                    (hit.fraction, hit.point_m, hit.normal, hit.velocity_mps);
                earlier(GroundTouch { fraction, point_m, normal, velocity_mps, object: None });
            }
        });
    };
    if model.contacts.is_empty() {
        sweep(DVec3::ZERO);
    } else {
        let out = model.contacts.iter().filter(|contact| body.is_out(contact));
        out.for_each(|contact| sweep(contact.at_m - cg_m));
    }
    first
}

impl Body {
    /// Ends where it is, for a reason that is not the ground's.
    pub fn wreck(&mut self, reason: EndReason, touch: GroundTouch) -> Outcome {
        self.state =
            motion::state(motion::position(&self.state), motion::attitude(&self.state), 0.0, DVec3::ZERO, DVec3::ZERO);
        self.treads.clear();
        self.shaft_radps = 0.0;
        self.ended = Some(reason);
        Outcome::Ended(reason, touch)
    }
}
