//! Why numbers are no table.

use super::{LARGEST, MAX_AXES};
use std::fmt;

/// Which number of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A breakpoint.
    Breakpoint {
        /// Of which axis, from 0.
        axis: usize,
        /// Which of them, from 0.
        index: usize,
    },
    /// A value, from 0, in the order given.
    Value(usize),
}

/// Why numbers are no table; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TableError {
    /// No axis, or more than [`MAX_AXES`].
    Axes {
        /// Axes given.
        found: usize,
    },
    /// An axis without breakpoints, or with more than can be numbered.
    Points {
        /// Which axis.
        axis: usize,
        /// Breakpoints given.
        found: usize,
    },
    /// A breakpoint is not above the one before.
    NotRising {
        /// Of which axis.
        axis: usize,
        /// Which breakpoint.
        index: usize,
        /// The one before.
        before: f64,
        /// It.
        value: f64,
    },
    /// There are not as many values as nodes.
    Count {
        /// Nodes of the grid.
        expected: usize,
        /// Values given.
        found: usize,
    },
    /// A number is not finite, or too large to be subtracted from another.
    Number {
        /// Which.
        place: Place,
        /// It.
        value: f64,
    },
    /// Breakpoints so close, for values so far apart, that a cubic's slopes overflow.
    Steep {
        /// Of which axis.
        axis: usize,
    },
}

impl TableError {
    /// The same error, on another axis.
    pub(super) fn on_axis(self, on: usize) -> Self {
        match self {
            Self::Points { found, .. } => Self::Points { axis: on, found },
            Self::NotRising { index, before, value, .. } => Self::NotRising { axis: on, index, before, value },
            Self::Number { place: Place::Breakpoint { index, .. }, value } => {
                Self::Number { place: Place::Breakpoint { axis: on, index }, value }
            }
            other => other,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Breakpoint { axis, index } => write!(f, "breakpoint {index} of axis {axis}"),
            Self::Value(index) => write!(f, "value {index}"),
        }
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axes { found } => write!(f, "expected 1 to {MAX_AXES} axes, found {found}"),
            Self::Points { axis, found } => write!(f, "axis {axis}: expected at least 1 breakpoint, found {found}"),
            Self::NotRising { axis, index, before, value } => {
                write!(f, "axis {axis}: breakpoint {index} must be above {before}, the one before, found {value}")
            }
            Self::Count { expected, found } => write!(f, "expected {expected} values, one a node, found {found}"),
            Self::Number { place, value } => {
                write!(f, "{place} must be a finite number up to {LARGEST:e}, found {value}")
            }
            Self::Steep { axis } => {
                write!(f, "axis {axis}: breakpoints are too close for such values, a cubic's slope overflows")
            }
        }
    }
}

impl std::error::Error for TableError {}
