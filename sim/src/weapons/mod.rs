//! Weapons and what they do to targets: data from files, and plain functions of it.
//!
//! | file | what |
//! |---|---|
//! | `weapon.rs`, `builtin.rs` | a gun, rocket or bomb: `W.toml`, and those that are embedded |
//! | `fuze.rs`, `penetration.rs` | when it bursts, how deep in the ground |
//! | `warhead.rs`, `crater.rs` | what that does, what is left in the ground |
//! | `armour.rs` | classes of armour, states of damage |
//! | `target_kind.rs` | a kind of target: `T.toml` |
//! | `ccip.rs` | where it would strike if it were released now |
//! | `score.rs` | miss distance, clock code, tallies |
//!
//! Bodies: x forward, y right, z down. Targets: forward is -Z, up +Y. World: X east, Y up, Z south. Metres, seconds, SI.
//! What flies, strikes and is struck in time is the scene's business ([`crate::scene`]); nothing here has a state.

pub mod armour;
pub mod builtin;
pub mod ccip;
pub mod crater;
pub mod fuze;
pub mod penetration;
pub mod score;
pub mod target_kind;
pub mod warhead;
pub mod weapon;

pub use armour::{Armour, Damage};
pub use ccip::{NoSolution, Solution};
pub use fuze::{Fuze, Trigger};
pub use score::{Aim, Outcome, Score, Tally};
pub use target_kind::TargetKind;
pub use warhead::Warhead;
pub use weapon::{Weapon, WeaponKind};
