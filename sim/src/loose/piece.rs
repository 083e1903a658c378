//! One loose thing as it is.
//!
//! World frame, metres, m/s, rad/s about the world's axes. Invariant others rely on: its numbers are finite, and what
//! rests has no velocity.

use super::kind::LooseKind;
use crate::scene::codec::{Coded, Reader, SaveError, coded};
use glam::{DQuat, DVec3};

/// Fastest that a thing moves, m/s; what is faster is held to it.
pub const MOST_MPS: f64 = 1_000.0;
/// Fastest that it turns, rad/s: the engine turns nothing by more than an eighth of a turn a step, 94 rad/s at 120 Hz.
pub const MOST_RADPS: f64 = 90.0;

/// Whether it moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Phase {
    /// It stands as it was put, so far above the ground, metres; above 0 until it is let go.
    Put(f64),
    /// It came to rest, over ground of this height, metres.
    Rests(f64),
    /// It moves; for so long it did so slowly, seconds.
    Moves(f64),
}

/// See the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// What it is.
    pub kind: LooseKind,
    /// Its middle.
    pub position_m: DVec3,
    /// Its axes to the world's.
    pub attitude: DQuat,
    /// Velocity.
    pub velocity_mps: DVec3,
    /// How fast it turns.
    pub rates_radps: DVec3,
    /// Whether it moves.
    pub phase: Phase,
}
coded!(Piece { kind, position_m, attitude, velocity_mps, rates_radps, phase });

impl Coded for Phase {
    fn put(&self, out: &mut Vec<u8>) {
        match *self {
            Self::Put(over_m) => (0u8, over_m).put(out),
            Self::Rests(ground_m) => (1u8, ground_m).put(out),
            Self::Moves(still_s) => (2u8, still_s).put(out),
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        match from.take::<(u8, f64)>()? {
            (0, over_m) => Ok(Self::Put(over_m)),
            (1, ground_m) => Ok(Self::Rests(ground_m)),
            (2, still_s) => Ok(Self::Moves(still_s)),
            (found, _) => Err(from.refuse(format_args!("loose: expected 0..=2, found {found}"))),
        }
    }
}

impl Piece {
    /// Whether it moves.
    pub fn moves(&self) -> bool {
        matches!(self.phase, Phase::Moves(_))
    }

    /// Lets it move.
    pub fn wake(&mut self) {
        if !self.moves() {
            self.phase = Phase::Moves(0.0);
        }
    }

    /// Pushes it: velocity and turn are added, within what a thing may have.
    pub fn push(&mut self, velocity_mps: DVec3, rates_radps: DVec3) {
        self.phase = Phase::Moves(0.0);
        self.velocity_mps = (self.velocity_mps + velocity_mps).clamp_length_max(MOST_MPS);
        self.rates_radps = (self.rates_radps + rates_radps).clamp_length_max(MOST_RADPS);
    }

    /// Whether its numbers are ones that a thing may have.
    pub fn is_sound(&self) -> bool {
        let (Phase::Put(number) | Phase::Rests(number) | Phase::Moves(number)) = self.phase;
        // Lengths are held to their bounds within a few roundings.
        self.position_m.is_finite()
            && (self.attitude.length() - 1.0).abs() < 1e-9
            && self.velocity_mps.length() <= 1.001 * MOST_MPS
            && self.rates_radps.length() <= 1.001 * MOST_RADPS
            && number.abs() <= 1e6
            && (self.moves() || (self.velocity_mps == DVec3::ZERO && self.rates_radps == DVec3::ZERO))
    }
}
