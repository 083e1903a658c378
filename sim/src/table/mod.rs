//! Gridded tables: numbers over the nodes of any number of axes, and the function between them.
//!
//! Values lie with the last axis fastest. Outside an axis its end value is held; a caller whose policy is to refuse asks
//! [`Table::outside`] first. Units are the caller's.
//!
//! Invariants: a built table is finite everywhere (no NaN, no infinity for finite arguments), equals its values at the
//! nodes to the bit, and never leaves the range of the values around the cell in which it is asked. A look-up allocates
//! nothing.
//!
//! Source of the cubic: F. N. Fritsch, J. Butland. A method for constructing local monotone piecewise cubic interpolants.
//! 1984; the end slopes are those of SciPy's `PchipInterpolator`, with which one axis agrees to rounding.

mod axis;
mod error;
mod pchip;

pub use axis::{Axis, Cell};
pub use error::{Place, TableError};

/// Most axes of a table. The look-up of a point visits up to 2 (linear) or 4 (cubic) values an axis, so more is no table.
pub const MAX_AXES: usize = 16;

/// Largest magnitude of a breakpoint or value: differences of two and their products with a few stay finite.
const LARGEST: f64 = 1e300;

/// The function between the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight along each axis.
    Linear,
    /// Monotone cubic along each axis: smooth, without overshoot. Over several axes: the last axis first.
    Pchip,
}

/// An argument that lies outside its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outside {
    /// Which axis, from 0.
    pub axis: usize,
    /// The argument.
    pub value: f64,
    /// First breakpoint.
    pub low: f64,
    /// Last breakpoint.
    pub high: f64,
}

/// A function given by its values on a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    axes: Vec<Axis>,
    /// Values between two neighbours along each axis.
    strides: Vec<usize>,
    values: Vec<f64>,
    /// Slopes along the last axis at each node; empty if linear.
    slopes: Vec<f64>,
    interpolation: Interpolation,
}

impl Table {
    /// A table over the nodes of `breakpoints`, `values` with the last axis fastest.
    ///
    /// An axis of one breakpoint is allowed: the table does not depend on it.
    ///
    /// # Errors
    /// [`TableError`] says which number or axis is wrong.
    pub fn new(breakpoints: Vec<Vec<f64>>, values: Vec<f64>, interpolation: Interpolation) -> Result<Self, TableError> {
        if breakpoints.is_empty() || breakpoints.len() > MAX_AXES {
            return Err(TableError::Axes { found: breakpoints.len() });
        }
        let axes = breakpoints
            .into_iter()
            .enumerate()
            .map(|(index, points)| Axis::new(points).map_err(|error| error.on_axis(index)))
            .collect::<Result<Vec<_>, _>>()?;
        let expected = axes.iter().try_fold(1usize, |nodes, axis| nodes.checked_mul(axis.breakpoints().len()));
        if expected != Some(values.len()) {
            return Err(TableError::Count { expected: expected.unwrap_or(usize::MAX), found: values.len() });
        }
        if let Some(index) = values.iter().position(|v| !v.is_finite() || v.abs() > LARGEST) {
            return Err(TableError::Number { place: Place::Value(index), value: values[index] });
        }
        let mut strides = vec![1; axes.len()];
        for axis in (1..axes.len()).rev() {
            strides[axis - 1] = strides[axis] * axes[axis].breakpoints().len();
        }
        let slopes = match interpolation {
            Interpolation::Linear => Vec::new(),
            Interpolation::Pchip => {
                pchip::refuse_steep(&axes, &values)?;
                let points = axes[axes.len() - 1].breakpoints();
                values.chunks_exact(points.len()).flat_map(|row| pchip::slopes(points, row)).collect()
            }
        };
        Ok(Self { axes, strides, values, slopes, interpolation })
    }

    /// The axes, slowest first.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The values at the nodes, the last axis fastest.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value at a point, one argument an axis; held at the ends outside.
    ///
    /// Finite for finite arguments. A NaN gives NaN, unless its axis has one breakpoint.
    ///
    /// # Panics
    /// If the number of arguments is not that of the axes.
    pub fn at(&self, point: &[f64]) -> f64 {
        assert_eq!(point.len(), self.axes.len(), "one argument an axis");
        match (point, self.axes.as_slice()) {
            ([x], [axis]) => self.at_cells(&[axis.locate(*x)]),
            ([x, y], [first, second]) => self.at_cells(&[first.locate(*x), second.locate(*y)]),
            _ => {
                let mut cells = [Cell::default(); MAX_AXES];
                for ((cell, axis), &x) in cells.iter_mut().zip(&self.axes).zip(point) {
                    *cell = axis.locate(x);
                }
                self.at_cells(&cells[..point.len()])
            }
        }
    }

    /// The value at cells found by each axis' [`Axis::locate`], so that tables over the same axis share one search.
    ///
    /// A fraction beyond 0..1 extends the cell's function: the caller's way to extrapolate a linear table.
    ///
    /// # Panics
    /// If the number of cells is not that of the axes, or a cell is not of its axis.
    pub fn at_cells(&self, cells: &[Cell]) -> f64 {
        assert_eq!(cells.len(), self.axes.len(), "one cell an axis");
        match (self.interpolation, cells) {
            (Interpolation::Linear, [x]) => self.line(x, 0),
            (Interpolation::Linear, [x, y]) => {
                let low = x.index() * self.strides[0];
                if x.fraction == 0.0 {
                    return self.line(y, low);
                }
                blend(self.line(y, low), self.line(y, low + self.strides[0]), x.fraction)
            }
            (Interpolation::Linear, _) => self.linear(cells, 0, 0),
            (Interpolation::Pchip, _) => self.cubic(cells, 0, 0),
        }
    }

    /// The first argument outside its axis; NaN is outside.
    pub fn outside(&self, point: &[f64]) -> Option<Outside> {
        point.iter().zip(&self.axes).enumerate().find_map(|(axis, (&value, points))| {
            let (low, high) = (points.low(), points.high());
            (!(low..=high).contains(&value)).then_some(Outside { axis, value, low, high })
        })
    }

    /// Linear along the last axis, in the row of values that begins at `row`.
    #[inline]
    fn line(&self, cell: &Cell, row: usize) -> f64 {
        let low = row + cell.index();
        if cell.fraction == 0.0 {
            self.values[low]
        } else {
            blend(self.values[low], self.values[low + 1], cell.fraction)
        }
    }

    fn linear(&self, cells: &[Cell], axis: usize, from: usize) -> f64 {
        let cell = &cells[axis];
        if axis + 1 == cells.len() {
            return self.line(cell, from);
        }
        let low = from + cell.index() * self.strides[axis];
        // On a node the neighbour has no say; an axis of one point has none.
        if cell.fraction == 0.0 {
            return self.linear(cells, axis + 1, low);
        }
        let high = low + self.strides[axis];
        blend(self.linear(cells, axis + 1, low), self.linear(cells, axis + 1, high), cell.fraction)
    }

    fn cubic(&self, cells: &[Cell], axis: usize, from: usize) -> f64 {
        let (cell, points) = (&cells[axis], self.axes[axis].breakpoints());
        let (index, stride) = (cell.index(), self.strides[axis]);
        let last = axis + 1 == cells.len();
        let value = |node: usize| {
            let at = from + node * stride;
            if last { self.values[at] } else { self.cubic(cells, axis + 1, at) }
        };
        if cell.fraction == 0.0 {
            return value(index);
        }
        let step = points[index + 1] - points[index];
        if last {
            let (low, high) = (from + index, from + index + 1);
            let (slope_low, slope_high) = (self.slopes[low], self.slopes[high]);
            return pchip::hermite(self.values[low], self.values[high], slope_low, slope_high, step, cell.fraction);
        }
        // A slope depends on the node's two neighbours at most (three at an end), so on these of the axis:
        let first = index.saturating_sub(1);
        let end = (index + 3).min(points.len());
        let mut near = [0.0; 4];
        for (at, slot) in near.iter_mut().enumerate().take(end - first) {
            *slot = value(first + at);
        }
        let (points, near, low) = (&points[first..end], &near[..end - first], index - first);
        let (slope_low, slope_high) = (pchip::slope(points, near, low), pchip::slope(points, near, low + 1));
        pchip::hermite(near[low], near[low + 1], slope_low, slope_high, step, cell.fraction)
    }
}

/// From `low` at 0 to `high` at 1: exact at both, and constant if they are equal.
#[inline]
fn blend(low: f64, high: f64, fraction: f64) -> f64 {
    let rise = high - low;
    if fraction < 0.5 { low + fraction * rise } else { high - (1.0 - fraction) * rise }
}

#[cfg(test)]
mod tests;
