//! What a burst does to loose things: a push, and what flies off a thing that breaks.
//!
//! The push is the impulse of the blast on the area that a thing shows, over its mass: `i = K W^(2/3) / r`, with W the mass
//! of TNT and r the distance, from the fireball's edge to [`FARTHEST_SCALED`]. That is Hopkinson's scaling with the impulse
//! falling as 1 / r. K = 400 Pa s m / kg^(2/3) stands for a reflected impulse of some 400 Pa s at 1 m from 1 kg (from memory
//! of Kingery's and Bulmash's curves, not checked): an estimate [E] for the picture, of no use for safety distances.
//!
//! World frame, SI. Invariant others rely on: what is random depends on the stream given alone.

use super::kind::LooseKind;
use super::piece::{Phase, Piece};
use crate::ballistics::shape::Shape;
use crate::ballistics::targets::Pose;
use crate::random::Stream;
use crate::weapons::Armour;
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// See the module.
const BLAST: f64 = 400.0;
/// Scaled distance beyond which a blast moves nothing, m/kg^(1/3).
const FARTHEST_SCALED: f64 = 20.0;
/// Scaled distance within which the push grows no more: the fireball.
const NEAREST_SCALED: f64 = 1.0;
/// Least push that is one, m/s.
const LEAST_PUSH_MPS: f64 = 0.3;
/// Most push, m/s: things thrown by a burst from nearby fly a few hundred metres, not kilometres.
const MOST_PUSH_MPS: f64 = 150.0;
/// How far under a burst its push comes from, metres: the ground throws it up.
const LIFT_M: f64 = 0.7;
/// Speed of what flies off a thing that breaks by itself (its fuel), m/s.
const BREAK_MPS: f64 = 7.0;
/// Fastest piece of a thing that breaks, m/s.
const MOST_BREAK_MPS: f64 = 45.0;

/// The speed that a blast gives a thing, m/s; 0 if it moves nothing there.
pub fn push_mps(kind: LooseKind, tnt_kg: f64, distance_m: f64) -> f64 {
    let scale = tnt_kg.max(0.0).cbrt();
    if scale <= 0.0 || distance_m.is_nan() || distance_m > FARTHEST_SCALED * scale {
        return 0.0;
    }
    let impulse = BLAST * scale * scale / distance_m.max(NEAREST_SCALED * scale);
    let speed_mps = (impulse * kind.area_m2() / kind.mass_kg()).min(MOST_PUSH_MPS);
    if speed_mps < LEAST_PUSH_MPS { 0.0 } else { speed_mps }
}

/// Pushes a thing; whether it was reached.
pub(super) fn blow(piece: &mut Piece, point_m: DVec3, tnt_kg: f64, stream: &mut Stream) -> bool {
    let speed_mps = push_mps(piece.kind, tnt_kg, piece.position_m.distance(point_m));
    if speed_mps == 0.0 {
        return false;
    }
    let way = (piece.position_m - (point_m - DVec3::Y * LIFT_M)).try_normalize().unwrap_or(DVec3::Y);
    // The foot is held back by the ground: it goes over.
    let over = DVec3::Y.cross(way) * (0.3 + 0.4 * stream.uniform());
    let spin = any_way(stream) * (0.1 * stream.uniform());
    piece.push(way * speed_mps, (over + spin) * (speed_mps / piece.kind.radius_m()).min(20.0));
    true
}

/// Something that breaks.
pub(crate) struct Broken<'a> {
    /// Its shape, where it is, and how fast.
    pub shape: &'a Shape,
    pub pose: Pose,
    pub velocity_mps: DVec3,
    /// What flies off.
    pub parts: &'a [(LooseKind, u32)],
    /// Where it was struck, and the charge that burst there, kg of TNT.
    pub point_m: DVec3,
    pub tnt_kg: f64,
}

/// What flies off a thing of this armour.
pub(crate) fn parts_of(armour: Armour, on_wheels: bool) -> &'static [(LooseKind, u32)] {
    use LooseKind::{Beam, Lump, Plate, Sheet, Wheel};
    match (armour, on_wheels) {
        (Armour::Soft, true) => &[(Sheet, 5), (Beam, 2), (Wheel, 3)],
        (Armour::Soft, false) => &[(Sheet, 10), (Beam, 6)],
        (Armour::Light, _) => &[(Plate, 3), (Sheet, 3), (Wheel, 2)],
        (Armour::Heavy, _) => &[(Plate, 4), (Wheel, 2)],
        (Armour::Hull, _) => &[(Sheet, 4)],
        (Armour::Concrete, _) => &[(Lump, 9), (Beam, 3)],
    }
}

/// What flies off an aircraft that crashes.
pub(crate) const PARTS_OF_AIRCRAFT: &[(LooseKind, u32)] =
    &[(LooseKind::Sheet, 7), (LooseKind::Beam, 3), (LooseKind::Wheel, 2)];

impl Broken<'_> {
    /// Its parts as they leave its surface, away from its middle and from where it was struck.
    pub fn pieces(&self, stream: &mut Stream) -> Vec<Piece> {
        let kinds = self.parts.iter().flat_map(|(kind, count)| (0..*count).map(|_| *kind));
        kinds.map(|kind| self.piece(kind, stream)).collect()
    }

    fn piece(&self, kind: LooseKind, stream: &mut Stream) -> Piece {
        // Any side but from below.
        let mut out = any_way(stream);
        out.y = out.y.abs() + 0.15;
        let out = out.normalize();
        let (out_here, far_m) = (self.pose.attitude.conjugate() * out, 2.0 * self.shape.radius_m());
        let edge_m =
            self.shape.enter(out_here * far_m, DVec3::ZERO).map_or(0.0, |entry| far_m * (1.0 - entry.fraction));
        let position_m = self.pose.position_m + out * (edge_m + 1.05 * kind.radius_m());
        let blast_mps = push_mps(kind, self.tnt_kg, position_m.distance(self.point_m));
        let away = (position_m - (self.point_m - DVec3::Y * LIFT_M)).try_normalize().unwrap_or(DVec3::Y);
        let own_mps = BREAK_MPS * (0.5 + stream.uniform());
        let thrown = away * (blast_mps * (0.5 + stream.uniform())) + out * own_mps;
        let thrown = thrown.clamp_length_max(MOST_BREAK_MPS);
        let attitude = DQuat::from_axis_angle(any_way(stream), TAU * stream.uniform()).normalize();
        let mut piece = Piece {
            kind,
            position_m,
            attitude,
            velocity_mps: DVec3::ZERO,
            rates_radps: DVec3::ZERO,
            phase: Phase::Moves(0.0),
        };
        piece.push(self.velocity_mps + thrown, any_way(stream) * (8.0 * stream.uniform()));
        piece
    }
}

/// An even direction: a height on the axis and an angle about it (Archimedes).
fn any_way(stream: &mut Stream) -> DVec3 {
    let (y, angle) = (2.0 * stream.uniform() - 1.0, TAU * stream.uniform());
    let across = (1.0 - y * y).max(0.0).sqrt();
    DVec3::new(across * angle.cos(), y, across * angle.sin()).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_push_falls_with_distance_and_mass_and_ends() {
        // 87 kg at 10 m: 400 * 19.6 / 10 = 785 Pa s; a drum of 0.68 m2 and 20 kg.
        let drum = push_mps(LooseKind::Barrel, 87.0, 10.0);
        assert!((drum - 785.0 * LooseKind::Barrel.area_m2() / 20.0).abs() < 0.5, "{drum}");
        let mut last = f64::INFINITY;
        for step in 0..2_000 {
            let now = push_mps(LooseKind::Crate, 87.0, 0.1 * f64::from(step));
            assert!(now <= last && now <= MOST_PUSH_MPS);
            last = now;
        }
        assert_eq!(last, 0.0);
        for (tnt_kg, distance_m) in [(0.0, 1.0), (-1.0, 1.0), (f64::NAN, 1.0), (1.0, f64::NAN), (1.0, f64::INFINITY)] {
            assert_eq!(push_mps(LooseKind::Cone, tnt_kg, distance_m), 0.0);
        }
        assert!(push_mps(LooseKind::Lump, 87.0, 10.0) < drum);
    }

    #[test]
    fn parts_leave_the_surface_outward_and_the_same_stream_gives_the_same() {
        let shape = Shape::block(DVec3::new(1.25, 1.45, 3.7)).unwrap();
        let pose = Pose { position_m: DVec3::new(100.0, 50.0, -30.0), attitude: DQuat::from_rotation_y(0.7) };
        let broken = Broken {
            shape: &shape,
            pose,
            velocity_mps: DVec3::X * 10.0,
            parts: parts_of(Armour::Soft, true),
            point_m: pose.position_m + DVec3::new(3.0, -1.0, 0.0),
            tnt_kg: 87.0,
        };
        let pieces = broken.pieces(&mut Stream::new(&[7]));
        assert_eq!((pieces.len(), &pieces), (10, &broken.pieces(&mut Stream::new(&[7]))));
        for piece in &pieces {
            let here = pose.attitude.conjugate() * (piece.position_m - pose.position_m);
            assert!(shape.distance_m(here) > 0.0 && piece.is_sound(), "{piece:?}");
            assert!(piece.velocity_mps.length() <= 10.0 + MOST_BREAK_MPS);
        }
    }
}
