//! What ends a flight early: the ground, or a column that reaches a value (see [`crate::limit`]).
//!
//! `ground` is the height above the ground falling below 0: over a world by the swept path, so that no ridge is passed
//! through; elsewhere the height itself.

use super::column::{self, COLUMNS};
use super::motion::RigidMotion;
use crate::limit::{Limit, Relation};

/// A condition that ends a flight.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// The column, by its place, and its value.
    pub limit: Limit<usize>,
    /// Whether it is the ground.
    pub is_ground: bool,
}

impl Stop {
    /// The stop of its words.
    ///
    /// # Errors
    /// A sentence that says what was expected and what was found.
    pub fn parse(words: &str, motion: &RigidMotion) -> Result<Self, String> {
        let names = || {
            let controls = motion.model.controls.iter().map(|control| control.name.as_str());
            COLUMNS.iter().copied().chain(controls).collect::<Vec<_>>().join(", ")
        };
        let read = Limit::parse(words, |name| column::place_of(motion, name), names);
        let limit = read.map_err(|why| format!("run.stop: {why}"))?;
        let is_ground = limit.is_none();
        let ground = || Limit { column: column::AGL, relation: Relation::Below, value: 0.0, text: "ground".to_owned() };
        Ok(Self { limit: limit.unwrap_or_else(ground), is_ground })
    }
}
