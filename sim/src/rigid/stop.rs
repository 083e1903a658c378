//! What ends a run early: `ground`, or a column below or above a value, as `altitude_m<0`.
//!
//! `ground` is the height above the ground falling below 0: over a world by the swept path, so that no ridge is
//! passed through; elsewhere the height itself.

use super::column;
use super::motion::RigidMotion;

/// A condition that ends a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Its words.
    pub words: String,
    place: usize,
    below: bool,
    value: f64,
    ground: bool,
}

impl Stop {
    /// The stop of its words.
    ///
    /// # Errors
    /// A sentence that says what was expected and what was found.
    pub fn parse(words: &str, motion: &RigidMotion) -> Result<Self, String> {
        let expected = || format!("run.stop: expected ground, NAME<value or NAME>value, found {words}");
        if words.trim() == "ground" {
            return Ok(Self { words: words.to_owned(), place: column::AGL, below: true, value: 0.0, ground: true });
        }
        let at = words.find(['<', '>']).ok_or_else(expected)?;
        let (name, value) = (words[..at].trim(), words[at + 1..].trim());
        let value = value.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(expected)?;
        let place = column::place_of(motion, name)
            .ok_or_else(|| format!("run.stop: expected a column of the output, found {name}"))?;
        Ok(Self { words: words.to_owned(), place, below: words.as_bytes()[at] == b'<', value, ground: false })
    }

    /// Whether it is the ground.
    pub fn is_ground(&self) -> bool {
        self.ground
    }

    /// Whether it holds by more than `margin`; `column` gives the value of a column.
    pub fn holds(&self, margin: f64, column: impl Fn(usize) -> f64) -> bool {
        let beyond = column(self.place) - self.value;
        if self.below { -beyond > margin } else { beyond > margin }
    }
}
