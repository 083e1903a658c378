//! One step of a body near the ground: pieces short enough for its springs, a plane a contact, and what breaks.
//!
//! Far from the ground nothing of this is done. Near it a step is cut so that the fastest mode of the contacts that can
//! touch within it holds; at the start of each piece every contact takes the plane that it is deepest in, and a contact
//! that meets the ground faster than it stands ends the flight before its spring sees it.
//!
//! North, east, down; seconds. Invariant: a step costs as many ground queries as the body has contacts and pieces, times 5.

use super::contact::{Contact, Part, Pose};
use super::surface::Footing;
use crate::integrate::{self, Integrator};
use crate::rigid::Model;
use crate::rigid::motion::{self, RigidMotion, State};
use crate::rigid::stiffness;
use glam::DVec3;

/// The ground by north and east; `None` over void.
pub type FootingAt<'a> = dyn Fn(f64, f64) -> Option<Footing> + 'a;

/// A contact that ends a flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Met {
    /// The part.
    pub part: Part,
    /// Whether it met water.
    pub is_water: bool,
    /// Where, north, east, down.
    pub point_m: DVec3,
    /// Normal of the ground there.
    pub normal: DVec3,
    /// Velocity of the contact.
    pub velocity_mps: DVec3,
    /// Part of the step that had passed.
    pub fraction: f64,
}

/// How far a plane's foot may lie under the ground and still be of it, metres.
const SAME_PLANE_M: f64 = 1e-3;
/// Height over the ground under it, beside its reach and a step's way, above which a body is not near, metres.
const NEAR_M: f64 = 2.0;

/// Farthest that any contact reaches from the centre of gravity.
pub(crate) fn reach_m(model: &Model, cg_m: DVec3) -> f64 {
    model.contacts.iter().map(|one| (one.at_m - cg_m).length() + one.radius_m).fold(0.0, f64::max)
}

/// Greatest rate of a mode of contacts, 1/s: what a spring of their sum with their damping would have.
pub(crate) fn mode_radps<'a>(model: &Model, cg_m: DVec3, contacts: impl Iterator<Item = &'a Contact>) -> f64 {
    let inertia = model.inertia_kgm2;
    let least = inertia.x_axis.x.min(inertia.y_axis.y).min(inertia.z_axis.z);
    let [spring, damping] =
        contacts.map(|one| one.modes(model.mass_kg, least, cg_m)).fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    0.5 * (damping + (damping * damping + 4.0 * spring).sqrt())
}

/// Pieces that a step takes with every contact on the ground; `None` if it is more than [`stiffness::MOST_PIECES`].
pub(crate) fn most_pieces(model: &Model, dt_s: f64) -> Option<u32> {
    let lambda = mode_radps(model, model.cg_m, model.contacts.iter());
    stiffness::pieces(Integrator::Rk4, lambda, 0.0, dt_s)
}

/// The pose of a state.
pub(crate) fn pose(motion: &RigidMotion, y: &State) -> Pose {
    let frame_from_body = glam::DMat3::from_quat(motion::attitude(y));
    let rates = motion::rates(y);
    let earth = motion.planet.rotation();
    Pose {
        position_m: motion::position(y),
        velocity_mps: motion::velocity(y),
        frame_from_body,
        rates_radps: if earth == DVec3::ZERO { rates } else { rates - frame_from_body.transpose() * earth },
        cg_m: motion.cg_m,
    }
}

/// Whether any contact may touch within a step.
pub(crate) fn is_near(motion: &RigidMotion, y: &State, dt_s: f64, ground: &FootingAt<'_>) -> bool {
    let at = motion::position(y);
    let reach = reach_m(&motion.model, motion.cg_m) + NEAR_M;
    let way = motion::velocity(y).length() * dt_s * 1.5 + reach;
    let low = |north: f64, east: f64| ground(north, east).is_some_and(|footing| footing.point_m.z <= at.z + way);
    let around = [(0.0, 0.0), (reach, 0.0), (-reach, 0.0), (0.0, reach), (0.0, -reach)];
    around.iter().any(|(north, east)| low(at.x + north, at.y + east))
}

/// The plane that a contact is deepest in: that under its hub, or another that its round reaches, as where two triangles
/// make a valley. A plane counts where its foot is not above the ground: else it is the far side of a ridge.
pub(crate) fn deepest(hub: DVec3, radius_m: f64, ground: &FootingAt<'_>) -> Option<Footing> {
    let under = ground(hub.x, hub.y);
    let r = radius_m.max(0.05);
    let mut best: Option<(f64, Footing)> = None;
    let over = |footing: &Footing| (hub - footing.point_m).dot(footing.normal);
    if let Some(footing) = under {
        best = Some((over(&footing), footing));
    }
    for (north, east) in [(r, 0.0), (-r, 0.0), (0.0, r), (0.0, -r)] {
        let Some(other) = ground(hub.x + north, hub.y + east) else { continue };
        if best.is_some_and(|(_, first)| first.normal == other.normal) {
            continue;
        }
        let away = over(&other);
        let foot = hub - other.normal * away;
        let is_ground = ground(foot.x, foot.y).is_some_and(|there| there.point_m.z <= foot.z + SAME_PLANE_M);
        if is_ground && best.is_none_or(|(least, _)| away < least) {
            best = Some((away, other));
        }
    }
    best.map(|(_, footing)| footing)
}

/// A step of a body near the ground, `pieces` at the least; the state after it, and what met the ground too hard.
///
/// `None` if its springs ask for more than [`stiffness::MOST_PIECES`].
pub(crate) fn step(
    motion: &mut RigidMotion,
    y: &State,
    dt_s: f64,
    pieces: u32,
    ground: &FootingAt<'_>,
) -> Option<(State, Option<Met>)> {
    let model = motion.model.clone();
    let count = model.contacts.len();
    motion.treads.resize(count, None);
    motion.planes.resize(count, None);
    let most_n = super::contact::MOST_WEIGHTS * motion.mass_kg * crate::planet::STANDARD_GRAVITY_MPS2;
    let way = motion::velocity(y).length() * dt_s * 1.5 + 0.5;
    let first = pose(motion, y);
    let touching = model.contacts.iter().filter(|one| {
        let hub = first.point_m(one.at_m);
        ground(hub.x, hub.y).is_some_and(|under| under.point_m.z - hub.z < way + one.radius_m)
    });
    let lambda = mode_radps(&model, motion.cg_m, touching);
    let pieces = stiffness::pieces(Integrator::Rk4, lambda, 0.0, dt_s)?.max(pieces);
    let piece_s = dt_s / f64::from(pieces);
    let mut y = *y;
    for piece in 0..pieces {
        let before = pose(motion, &y);
        let met = |one: &Contact, footing: &Footing, point_m: DVec3| Met {
            part: one.part,
            is_water: footing.surface.is_water,
            point_m,
            normal: footing.normal,
            velocity_mps: before.velocity_of(point_m),
            fraction: f64::from(piece) / f64::from(pieces),
        };
        for (one, plane) in model.contacts.iter().zip(&mut motion.planes) {
            *plane = deepest(before.point_m(one.at_m), one.radius_m, ground);
        }
        let good = y;
        y = motion::normalised(integrate::step(Integrator::Rk4, motion, 0.0, &y, piece_s, &mut None));
        let after = pose(motion, &y);
        let mut broken: Option<(f64, Met)> = None;
        for (place, one) in model.contacts.iter().enumerate() {
            let Some(footing) = motion.planes[place] else {
                motion.treads[place] = None;
                continue;
            };
            let Some(press) = one.press(&after, &footing, &motion.controls, most_n) else {
                motion.treads[place] = None;
                continue;
            };
            // As it came, before its spring could slow it.
            let closing_mps = -before.velocity_of(before.point_m(one.at_m)).dot(footing.normal);
            let is_new = motion.treads[place].is_none();
            // A strut driven past its stop is as broken as one that met the ground too fast.
            let is_through = press.travel_m > 1.5 * one.travel_m + 0.5 * one.radius_m + 0.3;
            if footing.surface.is_water || is_through || (is_new && closing_mps > one.breaks_mps) {
                // Of several in one piece the deepest was the first.
                if broken.is_none_or(|(depth_m, _)| press.depth_m > depth_m) {
                    broken = Some((press.depth_m, met(one, &footing, press.point_m)));
                }
            }
            motion.treads[place] = Some(one.tread_after(&press, &footing, motion.treads[place], &motion.controls));
        }
        if let Some((_, met)) = broken {
            motion.planes.clear();
            return Some((good, Some(met)));
        }
    }
    motion.planes.clear();
    Some((y, None))
}
