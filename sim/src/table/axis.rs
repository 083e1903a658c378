//! One axis of a table: rising breakpoints, and the search for the cell between two of them.
//!
//! Invariant: at least one breakpoint, all finite and strictly rising.

use super::LARGEST;
use super::error::{Place, TableError};

/// Rising breakpoints of one argument.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    breakpoints: Vec<f64>,
}

/// Where an argument lies on an axis: behind which breakpoint, and what part of the way to the next.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cell {
    index: u32,
    /// 0 on the breakpoint, 1 on the next one; within 0..1 unless extrapolating.
    pub fraction: f64,
}

impl Cell {
    /// The breakpoint at the cell's lower end.
    #[inline]
    pub fn index(&self) -> usize {
        self.index as usize
    }
}

impl Axis {
    /// An axis of rising breakpoints.
    ///
    /// # Errors
    /// [`TableError`], as if it were axis 0.
    pub fn new(breakpoints: Vec<f64>) -> Result<Self, TableError> {
        if breakpoints.is_empty() || u32::try_from(breakpoints.len()).is_err() {
            return Err(TableError::Points { axis: 0, found: breakpoints.len() });
        }
        for (index, &value) in breakpoints.iter().enumerate() {
            if !value.is_finite() || value.abs() > LARGEST {
                return Err(TableError::Number { place: Place::Breakpoint { axis: 0, index }, value });
            }
            if index > 0 && value <= breakpoints[index - 1] {
                return Err(TableError::NotRising { axis: 0, index, before: breakpoints[index - 1], value });
            }
        }
        Ok(Self { breakpoints })
    }

    /// The breakpoints, rising.
    #[inline]
    pub fn breakpoints(&self) -> &[f64] {
        &self.breakpoints
    }

    /// The first breakpoint.
    pub fn low(&self) -> f64 {
        self.breakpoints[0]
    }

    /// The last breakpoint.
    pub fn high(&self) -> f64 {
        self.breakpoints[self.breakpoints.len() - 1]
    }

    /// The cell of an argument, which is held at the ends outside. NaN gives a fraction of NaN.
    #[inline]
    pub fn locate(&self, x: f64) -> Cell {
        self.extend(x.clamp(self.low(), self.high()))
    }

    /// The cell of an argument; beyond an end that of the end's cell, with a fraction below 0 or above 1.
    #[inline]
    pub fn extend(&self, x: f64) -> Cell {
        let points = self.breakpoints.as_slice();
        let Some(last) = points.len().checked_sub(2) else { return Cell::default() };
        // The last breakpoint belongs to the cell before it, at fraction 1.
        let index = points[1..=last].partition_point(|&point| point <= x);
        let (low, high) = (points[index], points[index + 1]);
        Cell { index: index as u32, fraction: (x - low) / (high - low) }
    }
}
