//! Scores: how far from its target a weapon struck, on which side, and what came of it; and sums of them.
//!
//! World frame, metres. A miss is measured in plan, from the target's reference point *at the instant of the impact* (a
//! burst in the air counts where it burst) to the point of the impact; its clock code has 12 along the attack, the
//! owner's way over the ground at the release, and 3 to the right of it. The point is the impact's own, to the bit.

use crate::scene::codec::{Coded, Reader, SaveError, coded, coded_choice};
use crate::snapshot::StableId;
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::f64::consts::PI;

/// What a weapon is meant for, as its score counts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Aim {
    /// The target that is nearest to where it struck.
    #[default]
    Nearest,
    /// This target.
    Target(StableId),
    /// This place of the world.
    Place(DVec3),
}

/// What came of a weapon.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It burst, or struck as a solid shot, and hurt nothing.
    Miss,
    /// It struck a target, or hurt one.
    Hit,
    /// It destroyed at least one target.
    Kill,
    /// It struck before it was armed.
    Dud,
}
coded_choice!(Outcome { Miss, Hit, Kill, Dud });

/// The score of one weapon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Its place among the catalogue's weapons.
    pub weapon: u32,
    /// The projectile that it was.
    pub projectile: StableId,
    /// Who released it.
    pub owner: StableId,
    /// Which of the owner's rounds it was, from 0.
    pub round: u64,
    /// The target that it is scored against.
    pub target: Option<StableId>,
    /// Where it struck or burst.
    pub point_m: DVec3,
    /// Distance in plan from the aim, metres; `None` where there is nothing to aim at.
    pub miss_m: Option<f64>,
    /// On which side of the aim, 1 to 12.
    pub clock: Option<u32>,
    /// What came of it.
    pub outcome: Outcome,
    /// Targets that it destroyed.
    pub kills: u32,
}
coded!(Score { weapon, projectile, owner, round, target, point_m, miss_m, clock, outcome, kills });

/// Sums over one weapon of one owner.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Tally {
    /// Released or fired.
    pub released: u64,
    /// Struck or hurt a target.
    pub hits: u64,
    /// Targets destroyed.
    pub kills: u64,
    /// Struck before they were armed.
    pub duds: u64,
    /// Left the world.
    pub lost: u64,
    /// That have a miss distance.
    pub measured: u64,
    /// Sum of the miss distances, metres.
    pub miss_sum_m: f64,
    /// The least, metres.
    pub least_miss_m: Option<f64>,
}
coded!(Tally { released, hits, kills, duds, lost, measured, miss_sum_m, least_miss_m });

/// A row of the table of scores: plain data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TallyRow {
    /// The owner's id.
    pub owner: u64,
    /// The weapon's name in the catalogue.
    pub weapon: String,
    /// Its sums.
    pub tally: Tally,
    /// Mean miss distance, metres.
    pub mean_miss_m: Option<f64>,
}

impl Tally {
    /// Counts a score in.
    pub fn add(&mut self, score: &Score) {
        self.hits += u64::from(matches!(score.outcome, Outcome::Hit | Outcome::Kill));
        self.kills += u64::from(score.kills);
        self.duds += u64::from(score.outcome == Outcome::Dud);
        if let Some(miss_m) = score.miss_m {
            self.measured += 1;
            self.miss_sum_m += miss_m;
            self.least_miss_m = Some(self.least_miss_m.map_or(miss_m, |least| least.min(miss_m)));
        }
    }
}

/// Distance in plan and clock code of a point from an aim; `way` is the direction of the attack in plan (x, z).
pub fn miss(point_m: DVec3, aim_m: DVec3, way: DVec2) -> (f64, u32) {
    let off = DVec2::new(point_m.x - aim_m.x, point_m.z - aim_m.z);
    let way = way.try_normalize().unwrap_or(DVec2::NEG_Y);
    // Looking along the attack, right is a quarter turn from x towards z.
    let angle_rad = off.dot(way.perp()).atan2(off.dot(way));
    let hour = (angle_rad * 6.0 / PI).round().rem_euclid(12.0) as u32;
    (off.length(), if hour == 0 { 12 } else { hour })
}

impl Coded for Aim {
    fn put(&self, out: &mut Vec<u8>) {
        match self {
            Self::Nearest => out.push(0),
            Self::Target(id) => (1u8, *id).put(out),
            Self::Place(at_m) => (2u8, *at_m).put(out),
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        Ok(match from.take::<u8>()? {
            0 => Self::Nearest,
            1 => Self::Target(from.take()?),
            2 => Self::Place(from.take()?),
            found => return Err(from.refuse(format_args!("aim: expected 0..=2, found {found}"))),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_clock_has_12_along_the_attack_and_3_to_its_right() {
        // Attacking east: beyond is east, right is south (+z).
        let clock = |x: f64, z: f64| miss(DVec3::new(x, 7.0, z), DVec3::ZERO, DVec2::X * 200.0);
        assert_eq!(clock(10.0, 0.0), (10.0, 12));
        assert_eq!(clock(0.0, 10.0), (10.0, 3));
        assert_eq!(clock(-10.0, 0.0), (10.0, 6));
        assert_eq!(clock(0.0, -10.0), (10.0, 9));
        let (sin, cos) = (PI / 6.0).sin_cos();
        assert_eq!(clock(cos, sin).1, 1);
        assert_eq!(clock(cos, -sin).1, 11);
        assert_eq!(clock(0.0, 0.0), (0.0, 12));
    }
}
