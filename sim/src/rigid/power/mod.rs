//! A piston engine and its fixed-pitch propeller: the shaft that both turn, thrust, fuel.
//!
//! | file | what |
//! |---|---|
//! | `engine.rs` | torque and fuel by shaft speed, throttle, mixture and density |
//! | `propeller.rs` | thrust and torque by advance ratio |
//! | `shaft.rs` | the shaft's speed, a step on or settled |
//! | `file.rs` | `[engine]` and `[propeller]` of `M.toml`, checked |
//!
//! The shaft's speed is held over a piece of a step and then taken on by the implicit rule of Euler, so that no engine is
//! too stiff for a step. Left out: the torque's reaction on the body, the slipstream on tail and wing, the propeller's side
//! force; the magnetos, carburettor ice, temperatures.

pub mod engine;
pub(super) mod file;
pub mod propeller;
pub mod shaft;

pub use engine::Engine;
pub use propeller::Propeller;
pub use shaft::PowerPlant;
