//! A rigid body in the air: any body, any start, any inputs, as data.
//!
//! | file | what |
//! |---|---|
//! | `quantity.rs` | what coefficients may depend on |
//! | `model_file.rs` | `M.toml` as it is written |
//! | `model_checks.rs` | every check on it |
//! | `model.rs` | the checked model |
//! | `signal.rs` | numbers that a model makes of the flight and its controls |
//! | `aero.rs` | coefficients, forces and moments |
//! | `builtin.rs` | the embedded aircraft |
//! | `gear/` | wheels, and what else meets the ground |
//! | `power/` | a piston engine and its propeller |
//! | `handbook.rs` | figures that a model is held to |
//! | `links.rs` | DAVE-ML files bound to the model and to each other |
//! | `motion.rs` | the equations of motion |
//! | `column.rs` | what is reported of a state |
//! | `start.rs` | the state that a case begins with |
//! | `trim.rs` | controls and attitude that hold it |
//! | `inputs.rs` | `I.csv` |
//! | `simulation.rs` | steps, input edges, rows, stops |
//! | `stop.rs` | what ends a flight early |
//! | `stiffness.rs` | how short a step must be |
//!
//! Body axes: x forward, y right, z down. SI; radians inside. The position is that of the centre of gravity.

pub mod aero;
pub mod builtin;
pub mod column;
pub mod gear;
pub mod handbook;
pub mod inputs;
pub mod links;
pub mod model;
mod model_checks;
mod model_file;
pub mod motion;
pub mod power;
pub mod quantity;
pub mod signal;
pub mod simulation;
pub mod start;
pub mod stiffness;
pub mod stop;
pub mod trim;

pub use inputs::Inputs;
pub use model::Model;
pub use simulation::Simulation;
