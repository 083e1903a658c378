//! A step of all loose things: who wakes, who moves with whom, and what the ground has the last word on.
//!
//! A thing rests until something comes within a step of it faster than [`WAKE_MPS`], a burst pushes it, or the ground under
//! it changes. Things that move are stepped by window ([`super::window`]): those of two windows do not meet each other. Then
//! the way of each one's middle is swept against the exact ground and what stands on it: what would have passed is put
//! back to where it met it. A thing that has been slower than [`REST_MPS`] for [`REST_S`] rests.
//!
//! World frame, SI. Invariant others rely on: after a step no thing's middle is under the ground, over void, or no number.

use super::piece::{MOST_MPS, MOST_RADPS, Phase, Piece};
use super::window::middle_for;
use super::{Loose, Mover, engine};
use crate::ballistics::path::StepPath;
use crate::scene::{EndReason, SceneGround};
use crate::snapshot::StableId;
use glam::DVec3;
use std::collections::BTreeMap;

/// Speed from which on something wakes what rests beside its way, m/s.
const WAKE_MPS: f64 = 0.3;
/// How near that is, beside the way of a step, metres.
const NEAR_M: f64 = 0.05;
/// Speed below which a thing is slow; its turn counts by its radius.
const REST_MPS: f64 = 0.06;
/// How long it is slow before it rests, seconds.
const REST_S: f64 = 0.4;
/// How fast a thing may turn on and on, almost in place, before it is taken as rocking, m/s at its radius, and for how long.
const ROCK_MPS: f64 = 0.5;
const ROCK_S: f64 = 6.0;
/// Drag: `1/2 rho Cd` with air of 1.0 kg/m3 (1,500 to 2,000 m) and Cd = 1.1 of blunt things; an estimate, against still air.
const DRAG_KGPM3: f64 = 0.55;
/// Coefficient of rolling of drums and wheels on soil, an estimate: on slopes less than this they come to rest.
const ROLLING: f64 = 0.15;
/// Friction of what strikes the ground too fast for the engine.
const SLIDE: f64 = 0.6;

/// What a step meets.
pub struct Around<'a> {
    /// The ground.
    pub ground: &'a SceneGround,
    /// What moves by itself nearby, or stands as an obstacle.
    pub movers: &'a [Mover],
    /// Downward, m/s2.
    pub gravity_mps2: f64,
    /// The step, seconds.
    pub dt_s: f64,
}

impl Loose {
    /// Takes a step; what is gone after it, and why.
    pub fn step(&mut self, around: &Around<'_>) -> Vec<(StableId, EndReason)> {
        self.rouse(around);
        let mut groups: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (index, (_, piece)) in self.pieces.iter().enumerate().filter(|(_, (_, piece))| piece.moves()) {
            let middle = middle_for(around.ground, piece.position_m.x, piece.position_m.z);
            groups.entry(middle).or_default().push(index);
        }
        if groups.is_empty() {
            return Vec::new();
        }
        let before = self.pieces.clone();
        for (middle, members) in groups {
            let window = self.windows.about(around.ground, middle);
            let near = |at_m: DVec3, reach_m: f64| {
                members.iter().any(|member| {
                    let (_, piece) = &before[*member];
                    let reach_m = reach_m + piece.kind.radius_m() + piece.velocity_mps.length() * around.dt_s + NEAR_M;
                    piece.position_m.distance_squared(at_m) < reach_m * reach_m
                })
            };
            let movers: Vec<&Mover> = around
                .movers
                .iter()
                .filter(|mover| near(mover.position_m, mover.radius_m + mover.velocity_mps.length() * around.dt_s))
                .collect();
            let resting: Vec<&Piece> = before
                .iter()
                .map(|(_, piece)| piece)
                .filter(|piece| !piece.moves() && near(piece.position_m, piece.kind.radius_m()))
                .collect();
            let all = self.pieces.iter_mut().enumerate();
            let of_group = all.filter(|(index, _)| members.binary_search(index).is_ok());
            let mut moving: Vec<&mut Piece> = of_group.map(|(_, (_, piece))| piece).collect();
            for piece in &mut moving {
                let drag = DRAG_KGPM3 * piece.kind.area_m2() / piece.kind.mass_kg();
                piece.velocity_mps /= 1.0 + drag * piece.velocity_mps.length() * around.dt_s;
            }
            engine::step(&window, &mut moving, &resting, &movers, around.gravity_mps2, around.dt_s);
        }
        let mut gone = Vec::new();
        let counts = &mut self.counts;
        let mut was = before.iter();
        self.pieces.retain_mut(|(id, piece)| {
            let Some((_, before)) = was.next().filter(|(_, before)| before.moves()) else { return true };
            match land(piece, before, around, &mut counts.put_back) {
                Ok(()) => true,
                Err(reason) => {
                    gone.push((*id, reason));
                    false
                }
            }
        });
        gone
    }

    /// Wakes what something fast comes near to in this step.
    fn rouse(&mut self, around: &Around<'_>) {
        let dt_s = around.dt_s;
        let fast: Vec<Piece> = self
            .pieces
            .iter()
            .map(|(_, piece)| *piece)
            .filter(|piece| piece.moves() && piece.velocity_mps.length_squared() > WAKE_MPS * WAKE_MPS)
            .collect();
        let movers = || around.movers.iter().filter(|mover| mover.speed_mps() > WAKE_MPS);
        if fast.is_empty() && movers().next().is_none() {
            return;
        }
        for (_, piece) in self.pieces.iter_mut().filter(|(_, piece)| !piece.moves()) {
            let struck = |other: &Piece| {
                let way_m = other.velocity_mps.length() * dt_s;
                let reach_m = other.kind.radius_m() + piece.kind.radius_m() + way_m + NEAR_M;
                other.position_m.distance_squared(piece.position_m) < reach_m * reach_m
            };
            if fast.iter().any(struck) || movers().any(|mover| mover.comes_near(piece, dt_s, NEAR_M)) {
                piece.wake();
            }
        }
    }

    /// Lets things stand anew or fall where the ground under them is another than before.
    pub fn ground_changed(&mut self, ground: &SceneGround) {
        self.windows.forget();
        for (_, piece) in &mut self.pieces {
            match piece.phase {
                Phase::Put(over_m) => super::stand(piece, ground, over_m),
                Phase::Rests(ground_m) => {
                    if ground.height_m(piece.position_m.x, piece.position_m.z) != Some(ground_m) {
                        piece.wake();
                    }
                }
                Phase::Moves(_) => {}
            }
        }
    }
}

/// What the ground makes of a thing after its step; why it is gone, if it is.
fn land(piece: &mut Piece, before: &Piece, around: &Around<'_>, put_back: &mut u64) -> Result<(), EndReason> {
    let vectors = [piece.position_m, piece.velocity_mps, piece.rates_radps];
    if !vectors.iter().all(|vector| vector.is_finite()) || !piece.attitude.is_finite() {
        return Err(EndReason::NotFinite);
    }
    piece.velocity_mps = piece.velocity_mps.clamp_length_max(MOST_MPS);
    piece.rates_radps = piece.rates_radps.clamp_length_max(MOST_RADPS);
    let ground = around.ground;
    let path = StepPath::straight(before.position_m, piece.position_m, around.dt_s);
    if let Some(touch) = ground.touch_all(&path) {
        // It would have gone in: it lies there instead, and loses what goes into the ground.
        *put_back += 1;
        piece.position_m = touch.point_m + touch.normal * piece.kind.least_half_m();
        let into_mps = (-piece.velocity_mps.dot(touch.normal)).max(0.0);
        let along = piece.velocity_mps + touch.normal * into_mps;
        let kept = (along.length() - SLIDE * into_mps).max(0.0);
        piece.velocity_mps = along.normalize_or_zero() * kept;
    }
    let (x_m, z_m) = (piece.position_m.x, piece.position_m.z);
    let ground_m = ground.height_m(x_m, z_m).ok_or(EndReason::LeftWorld)?;
    if piece.position_m.y < ground_m {
        *put_back += 1;
        piece.position_m.y = ground_m + piece.kind.least_half_m();
        piece.velocity_mps.y = piece.velocity_mps.y.max(0.0);
    }
    let radius_m = piece.kind.radius_m();
    if piece.position_m.y - ground_m < radius_m && ground.is_water(x_m, z_m) {
        return Err(EndReason::Water);
    }
    if let Some(round_m) = piece.kind.rolls_on_m().filter(|_| piece.position_m.y - ground_m < radius_m) {
        // The moment `c m g r` against its own `m r^2 / 2`, about its axis.
        let axis = piece.attitude * DVec3::Y;
        let (spin, most) = (piece.rates_radps.dot(axis), 2.0 * ROLLING * around.gravity_mps2 / round_m * around.dt_s);
        piece.rates_radps -= axis * spin.clamp(-most, most);
    }
    let (speed_mps, turn_mps) = (piece.velocity_mps.length(), piece.rates_radps.length() * radius_m);
    let Phase::Moves(still_s) = piece.phase else { return Ok(()) };
    // Rocking counts for less, so that what never quite settles comes to rest, too.
    let counted_s = match speed_mps.max(turn_mps) {
        slow if slow < REST_MPS => around.dt_s,
        rocking if rocking < ROCK_MPS => around.dt_s * (REST_S / ROCK_S),
        _ => -still_s,
    };
    let still_s = still_s + counted_s;
    if still_s >= REST_S {
        (piece.velocity_mps, piece.rates_radps) = (DVec3::ZERO, DVec3::ZERO);
        piece.phase = Phase::Rests(ground_m);
    } else {
        piece.phase = Phase::Moves(still_s);
    }
    Ok(())
}
