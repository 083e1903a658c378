//! One step of the physics engine for things in one window.
//!
//! The engine's world is made for the step and dropped after it: bodies go in with place, attitude, velocity and turn, and
//! come out with them. Nothing is kept between steps (no sleeping, no impulses of the step before), so a scene that was
//! saved and restored goes on to the bit, and a scene that has nothing loose has no engine. What that costs is in the
//! bench (`loose, ..`); what a step without the last impulses loses, sleep by our own rule makes up ([`super::step`]).
//!
//! Frame: the world's axes, from the window's middle post in plan and from sea level in height, so that numbers stay
//! small. The ground, what moves by itself and what rests are not moved by it.
//!
//! Invariant others rely on: the same things in the same order give the same numbers on the same binary.
//!
//! Source: rapier3d-f64 0.36.1; its step of first order is good enough for what lies about.

use super::Mover;
use super::piece::{MOST_MPS, Piece};
use super::window::Window;
use glam::{DQuat, DVec3};
use rapier3d::prelude::{
    ColliderBuilder, IntegrationParameters, PhysicsWorld, Pose, RigidBody, RigidBodyBuilder, RigidBodyHandle,
};

/// Friction of loose things on each other and on the ground: rough ground and steel, an estimate.
const FRICTION: f64 = 0.8;
/// How much of the closing speed a bounce gives back: drums and plates on soil, an estimate.
const RESTITUTION: f64 = 0.1;
/// Loss of turn a second, by air and soil, an estimate.
const TURNING_PER_S: f64 = 0.4;
/// Iterations of the solver a step, twice the engine's own, since none is carried over from the step before.
const ITERATIONS: usize = 8;
/// How deep things may lie in each other, metres.
const SLACK_M: f64 = 0.001;

/// Steps things that move, among those that rest and movers that are near; all share a window.
pub(super) fn step(
    window: &Window,
    pieces: &mut [&mut Piece],
    resting: &[&Piece],
    movers: &[&Mover],
    gravity_mps2: f64,
    dt_s: f64,
) {
    let origin_m = DVec3::new(window.middle_m.x, 0.0, window.middle_m.y);
    let mut world = PhysicsWorld::new();
    world.gravity = DVec3::Y * -gravity_mps2;
    world.integration_parameters = IntegrationParameters {
        dt: dt_s,
        num_solver_iterations: ITERATIONS,
        normalized_max_linear_velocity: MOST_MPS,
        normalized_allowed_linear_error: SLACK_M,
        // Paths of things are swept against the exact ground instead ([`super::step`]).
        max_ccd_substeps: 0,
        ..IntegrationParameters::default()
    };
    let collider = |shape| ColliderBuilder::new(shape).friction(FRICTION).restitution(RESTITUTION);
    if let Some(field) = window.collider() {
        world.insert_collider(collider(field), None);
    }
    let at = |position_m: DVec3, attitude: DQuat| Pose::from_parts(position_m - origin_m, attitude);
    for mover in movers {
        let body = RigidBodyBuilder::kinematic_velocity_based()
            .pose(at(mover.position_m, mover.attitude))
            .linvel(mover.velocity_mps)
            .angvel(mover.rates_radps);
        world.insert(body, collider(mover.shape.clone()));
    }
    for piece in resting {
        let body = RigidBodyBuilder::fixed().pose(at(piece.position_m, piece.attitude));
        world.insert(body, collider(piece.kind.collider()));
    }
    let handles: Vec<RigidBodyHandle> = pieces
        .iter()
        .map(|piece| {
            let body = RigidBodyBuilder::dynamic()
                .pose(at(piece.position_m, piece.attitude))
                .linvel(piece.velocity_mps)
                .angvel(piece.rates_radps)
                .angular_damping(TURNING_PER_S)
                .can_sleep(false);
            world.insert(body, collider(piece.kind.collider()).mass(piece.kind.mass_kg())).0
        })
        .collect();
    world.step();
    for (piece, handle) in pieces.iter_mut().zip(handles) {
        let Some(body) = world.bodies.get(handle) else { continue };
        take(piece, body, origin_m);
    }
}

/// What the engine makes of a thing. One that it has put out of action (a number was none) shows by its velocity.
fn take(piece: &mut Piece, body: &RigidBody, origin_m: DVec3) {
    piece.position_m = body.translation() + origin_m;
    piece.attitude = body.rotation().normalize();
    (piece.velocity_mps, piece.rates_radps) = (body.linvel(), body.angvel());
    if !body.is_enabled() {
        piece.velocity_mps = DVec3::NAN;
    }
}
