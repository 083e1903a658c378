//! What of a body meets the ground: wheels on struts, and the parts that should not.
//!
//! | file | what |
//! |---|---|
//! | `surface.rs` | what the ground is like under a contact |
//! | `contact.rs` | a wheel or a part, and the force on it |
//! | `file.rs` | `[[wheel]]` and `[[skid]]` of `M.toml`, checked |
//! | `tread.rs` | where a contact holds the ground |
//! | `near.rs` | one step of a body near the ground |
//!
//! A contact is a point with a spring and a damper along the ground's normal, and a spring and a damper along the
//! ground that give way at the friction's limit (stick and slip about an anchor). Each piece of a step sees the ground
//! as one plane a contact, the plane that it is deepest in. Only for flat frames: position is north, east, down.
//!
//! Invariants others rely on: a contact pushes, never pulls; a body at rest on its anchors has no force that changes
//! with time, so it stays; no force is greater than [`contact::MOST_WEIGHTS`] times the weight.

pub mod contact;
pub(super) mod file;
pub mod near;
pub mod surface;
pub mod tread;

pub use contact::{Contact, Part};
pub use near::Met;
pub use surface::{Footing, Surface};
pub use tread::Tread;
