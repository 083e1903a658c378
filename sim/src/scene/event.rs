//! What happened in a scene: impacts, crashes, failures, refusals, in order and numbered.
//!
//! World frame, metres, seconds. A snapshot carries the events of the last [`KEPT_S`]; each has its number, so a reader
//! that looks less often takes those from its last number on, and sees by a gap that it missed some.
//!
//! Invariant others rely on: numbers count from 0 without a gap; the log's chain is a hash over every event there ever
//! was, so two runs that ended alike but struck elsewhere do not look the same.

use super::codec::{Coded, FNV_BASIS, Reader, SaveError, coded, coded_choice, fnv};
use crate::snapshot::StableId;
use crate::weapons::{Damage, Score};
use glam::DVec3;
use terrain::features::index::ObjectId;

/// How long an event stays in snapshots, simulated seconds.
pub const KEPT_S: f64 = 0.5;
/// Most events that stay, whatever their age: a barrage does not make snapshots dear.
pub const MOST_KEPT: usize = 4_096;

/// Why an entity's flight ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EndReason {
    /// It met the ground.
    Ground,
    /// A number of its state was no longer finite, or had run away; what is shown is the last good state.
    NotFinite,
    /// The flow or its spin made it too stiff for the scene's step.
    Stiff,
    /// A table of its model refuses what lies outside.
    OutsideTable,
    /// It left the bounds of any world.
    LeftWorld,
    /// A wheel met the ground faster than its strut stands, or was driven through it.
    Gear,
    /// The hull struck the ground.
    Hull,
    /// A wing's tip struck the ground.
    WingTip,
    /// The tail struck the ground.
    Tail,
    /// The propeller struck the ground.
    Propeller,
    /// It met water.
    Water,
    /// A part of it struck a building, a mast or a target.
    Struck,
    /// A warhead burst beside it.
    Blast,
}
coded_choice!(EndReason {
    Ground,
    NotFinite,
    Stiff,
    OutsideTable,
    LeftWorld,
    Gear,
    Hull,
    WingTip,
    Tail,
    Propeller,
    Water,
    Struck,
    Blast
});

impl EndReason {
    /// The cause in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Ground => "flew into the ground or what stands on it",
            Self::NotFinite => "its numbers ran away",
            Self::Stiff => "too fast or stiff for the step",
            Self::OutsideTable => "outside the tables of its model",
            Self::LeftWorld => "left the world",
            Self::Gear => "landed too hard: the gear broke",
            Self::Hull => "the hull struck the ground",
            Self::WingTip => "a wing tip struck the ground",
            Self::Tail => "the tail struck the ground",
            Self::Propeller => "the propeller struck the ground",
            Self::Water => "came down on water",
            Self::Struck => "struck a building, a mast or a vehicle",
            Self::Blast => "a warhead burst beside it",
        }
    }
}

/// Where a projectile struck.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strike {
    /// The projectile.
    pub projectile: StableId,
    /// Its place in the catalogue.
    pub kind: u32,
    /// Who fired it.
    pub owner: StableId,
    /// Which of the owner's rounds it was, from 0.
    pub round: u64,
    /// The target; `None` is the ground or what stands on it.
    pub target: Option<StableId>,
    /// The building or other standing thing of the world; `None` is the ground or a target.
    pub object: Option<ObjectId>,
    /// Where.
    pub point_m: DVec3,
    /// The same in the target's own frame; the point itself on the ground.
    pub point_in_target_m: DVec3,
    /// Outward unit normal of what was struck.
    pub normal: DVec3,
    /// Velocity relative to what was struck, m/s.
    pub velocity_mps: DVec3,
}
coded!(Strike { projectile, kind, owner, round, target, object, point_m, point_in_target_m, normal, velocity_mps });

impl Coded for ObjectId {
    fn put(&self, out: &mut Vec<u8>) {
        let (kind, numbers) = match *self {
            Self::Building(number) => (0_u8, [number, 0]),
            Self::Placed(number) => (1, [number, 0]),
            Self::Mast(number) => (2, [number, 0]),
            Self::PowerTower { line, point } => (3, [line, point]),
        };
        kind.put(out);
        numbers.iter().for_each(|number| number.put(out));
    }

    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        let (kind, number, point): (u8, u32, u32) = (from.take()?, from.take()?, from.take()?);
        Ok(match kind {
            0 => Self::Building(number),
            1 => Self::Placed(number),
            2 => Self::Mast(number),
            3 => Self::PowerTower { line: number, point },
            found => return Err(from.refuse(format_args!("standing thing: expected 0..=3, found {found}"))),
        })
    }
}

/// What happened.
#[derive(Debug, Clone, PartialEq)]
pub enum Happening {
    /// A projectile struck.
    Impact(Strike),
    /// A body ended its flight.
    Crash {
        /// The body.
        id: StableId,
        /// Why.
        reason: EndReason,
        /// Where.
        point_m: DVec3,
        /// Normal of the ground; zero where it was none.
        normal: DVec3,
        /// Its velocity there, m/s.
        velocity_mps: DVec3,
    },
    /// A projectile was taken out without an impact.
    Lost {
        /// The projectile.
        id: StableId,
        /// Why.
        reason: EndReason,
    },
    /// A failure set in.
    Failure {
        /// Whose.
        id: StableId,
        /// Its name.
        name: String,
    },
    /// The tanks ran dry.
    OutOfFuel {
        /// Whose.
        id: StableId,
    },
    /// A warhead burst.
    Burst {
        /// The projectile that carried it.
        projectile: StableId,
        /// Its weapon's place among the catalogue's.
        weapon: u32,
        /// Who released it.
        owner: StableId,
        /// Which of the owner's rounds it was, from 0.
        round: u64,
        /// Where.
        point_m: DVec3,
        /// Its charge, kg of TNT.
        tnt_kg: f64,
        /// Whether it burst in the ground.
        buried: bool,
        /// Whether it burst above it.
        in_air: bool,
    },
    /// A target's state of damage changed.
    Damage {
        /// The target.
        id: StableId,
        /// What is left of it.
        state: Damage,
        /// Who did it.
        owner: StableId,
        /// With which of its rounds, from 0.
        round: u64,
    },
    /// A burst left a crater.
    Crater {
        /// Its middle, on the ground as it was.
        centre_m: DVec3,
        /// Of its rim in plan, metres.
        radius_m: f64,
        /// Below the ground, metres.
        depth_m: f64,
        /// Whether the posts can show it: a smaller one is a decal.
        changes_posts: bool,
    },
    /// What a rocket or a bomb came to.
    Score(Score),
    /// A command that was due was refused.
    Refused {
        /// What was expected and what was found.
        why: String,
    },
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Its number, from 0.
    pub number: u64,
    /// Scene time, seconds; within the step that it happened in.
    pub time_s: f64,
    /// What.
    pub what: Happening,
}
coded!(Event { number, time_s, what });

impl Coded for Happening {
    fn put(&self, out: &mut Vec<u8>) {
        match self {
            Self::Impact(strike) => {
                out.push(0);
                strike.put(out);
            }
            Self::Crash { id, reason, point_m, normal, velocity_mps } => {
                out.push(1);
                id.put(out);
                reason.put(out);
                [*point_m, *normal, *velocity_mps].put(out);
            }
            Self::Lost { id, reason } => {
                out.push(2);
                id.put(out);
                reason.put(out);
            }
            Self::Failure { id, name } => {
                out.push(3);
                id.put(out);
                name.put(out);
            }
            Self::OutOfFuel { id } => {
                out.push(4);
                id.put(out);
            }
            Self::Refused { why } => {
                out.push(5);
                why.put(out);
            }
            Self::Burst { projectile, weapon, owner, round, point_m, tnt_kg, buried, in_air } => {
                (6u8, (*projectile, *weapon)).put(out);
                (*owner, *round).put(out);
                (*point_m, *tnt_kg).put(out);
                (*buried, *in_air).put(out);
            }
            Self::Damage { id, state, owner, round } => {
                (7u8, (*id, *state)).put(out);
                (*owner, *round).put(out);
            }
            Self::Crater { centre_m, radius_m, depth_m, changes_posts } => {
                (8u8, *centre_m).put(out);
                ([*radius_m, *depth_m], *changes_posts).put(out);
            }
            Self::Score(score) => (9u8, *score).put(out),
        }
    }
    fn take(from: &mut Reader<'_>) -> Result<Self, SaveError> {
        Ok(match from.take::<u8>()? {
            0 => Self::Impact(from.take()?),
            1 => {
                let (id, reason) = (from.take()?, from.take()?);
                let [point_m, normal, velocity_mps] = from.take()?;
                Self::Crash { id, reason, point_m, normal, velocity_mps }
            }
            2 => Self::Lost { id: from.take()?, reason: from.take()? },
            3 => Self::Failure { id: from.take()?, name: from.take()? },
            4 => Self::OutOfFuel { id: from.take()? },
            5 => Self::Refused { why: from.take()? },
            6 => {
                let (projectile, weapon) = from.take()?;
                let (owner, round) = from.take()?;
                let (point_m, tnt_kg) = from.take()?;
                let (buried, in_air) = from.take()?;
                Self::Burst { projectile, weapon, owner, round, point_m, tnt_kg, buried, in_air }
            }
            7 => {
                let (id, state) = from.take()?;
                let (owner, round) = from.take()?;
                Self::Damage { id, state, owner, round }
            }
            8 => {
                let centre_m = from.take()?;
                let ([radius_m, depth_m], changes_posts): ([f64; 2], bool) = from.take()?;
                Self::Crater { centre_m, radius_m, depth_m, changes_posts }
            }
            9 => Self::Score(from.take()?),
            found => return Err(from.refuse(format_args!("event: expected 0..=9, found {found}"))),
        })
    }
}

/// The events so far.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Log {
    pub recent: Vec<Event>,
    pub counted: u64,
    pub chain: u64,
}
coded!(Log { recent, counted, chain });

impl Log {
    pub fn new() -> Self {
        Self { recent: Vec::new(), counted: 0, chain: FNV_BASIS }
    }

    pub fn add(&mut self, time_s: f64, what: Happening) {
        let event = Event { number: self.counted, time_s, what };
        let mut bytes = Vec::new();
        event.put(&mut bytes);
        self.chain = fnv(self.chain, &bytes);
        self.counted += 1;
        self.recent.push(event);
    }

    /// Drops what is older than it is kept.
    pub fn forget(&mut self, now_s: f64) {
        // Events of a step stand in the order of entities, not of time: the first young one ends the old ones.
        let old = self.recent.iter().position(|event| event.time_s >= now_s - KEPT_S).unwrap_or(self.recent.len());
        let old = old.max(self.recent.len().saturating_sub(MOST_KEPT));
        if old > 0 {
            self.recent.drain(..old);
        }
    }
}
