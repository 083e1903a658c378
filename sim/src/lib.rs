//! The small simulation under the picture: what flies, what the pilot commands, and time.
//!
//! This crate has no GPU and runs without a screen. State is f64 in the world's frame (X east, Y up, Z south, metres);
//! a step has one fixed length; what a step gives depends only on the state and the commands before it, so two runs with
//! the same inputs give the same [`Snapshot::hash`]. Bad input is refused at the edge ([`input`]), never stepped.
//!
//! Two things are built on one core ([`integrate`], [`planet`], [`atmosphere`], [`wind`], [`table`]): flights and shots from
//! files, over any Earth, for proofs and long ranges ([`rigid`], [`ballistics`], [`daveml`], [`case`]); and scenes of many
//! entities over a world's plane, for the picture ([`scene`]). The core's flat frame is north, east, down; [`frame`] turns
//! it into the world's.
//!
//! The ground of a scene is a [`SceneGround`]: exact where it is made of an area of posts, else a function of plan
//! position, [`HeightAt`], that answers `None` where there is no data.
#![forbid(unsafe_code)]

pub mod air_data;
pub mod aircraft;
pub mod atmosphere;
pub mod autopilot;
pub mod ballistics;
pub mod case;
pub mod clock;
pub mod daveml;
pub mod file;
pub mod frame;
pub mod ground_contact;
pub mod handling;
pub mod input;
pub mod integrate;
pub mod limit;
pub mod loose;
pub mod planet;
pub mod random;
pub mod rigid;
pub mod run;
pub mod scene;
pub mod situation;
pub mod slew;
pub mod snapshot;
pub mod table;
pub mod track;
pub mod turbulence;
pub mod utc;
pub mod weapons;
pub mod wind;
pub mod world_ground;

pub use aircraft::{AircraftState, Condition};
pub use clock::Clock;
pub use input::{Command, Controls, Levers};
pub use run::{SimThread, advance, lockstep};
pub use scene::{Scene, SceneGround};
pub use snapshot::{Flags, Mode, Snapshot};
pub use track::Track;
pub use utc::UtcTime;

/// Ground height in metres above mean sea level over a plan point (x, z) of the world; `None` where there is no data.
pub type HeightAt = dyn Fn(f64, f64) -> Option<f64> + Send + Sync;

/// Lowest height of an aircraft's reference point over the ground, metres: its landing gear, without a model of one.
pub const GEAR_HEIGHT_M: f64 = 2.0;
