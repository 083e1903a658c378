//! A compiled model: a flat list of operations over numbered slots.
//!
//! Invariants: an operation reads only constants, inputs and what stands before it; [`Program::run`] allocates nothing
//! and its outputs depend only on its inputs. Both branches of a choice are computed and one is taken, so a NaN or an
//! infinity in the other one does not come out. Tables over the same argument and breakpoints share one search.

use super::operation::{Binary, Unary, holds};
use crate::table::{Axis, Cell, MAX_AXES, Table};

/// A compiled model, see [`super::Document::program`].
#[derive(Debug, Clone)]
pub struct Program {
    pub(super) constants: Vec<f64>,
    pub(super) inputs: usize,
    pub(super) operations: Vec<Operation>,
    /// Slots of the asked outputs.
    pub(super) outputs: Vec<u32>,
    pub(super) slots: usize,
    pub(super) cells: usize,
    pub(super) axes: Vec<Axis>,
    pub(super) tables: Vec<Table>,
    /// Cells of look-ups over more than two axes.
    pub(super) cell_lists: Vec<u32>,
}

/// What a program writes while it runs; it carries nothing from one run to the next.
#[derive(Debug, Clone)]
pub struct Memory {
    slots: Vec<f64>,
    cells: Vec<Cell>,
}

/// One operation; numbers are slots, except where said.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Operation {
    /// A function of one slot.
    Unary { function: Unary, x: u32, to: u32 },
    /// A function of two.
    Binary { function: Binary, x: u32, y: u32, to: u32 },
    /// One of two, by a truth.
    Select { condition: u32, yes: u32, no: u32, to: u32 },
    /// Held within limits; NaN stays NaN.
    Limit { x: u32, low: f64, high: f64, to: u32 },
    /// A search on an axis; `to` is a cell.
    Locate { axis: u32, x: u32, low: f64, high: f64, nearest: bool, to: u32 },
    /// A table of one axis at a cell.
    LookUp1 { table: u32, cell: u32, to: u32 },
    /// A table of two axes.
    LookUp2 { table: u32, cells: [u32; 2], to: u32 },
    /// A table of `axes` axes; its cells stand in the cell lists from `first`.
    LookUp { table: u32, first: u32, axes: u32, to: u32 },
}

impl Program {
    /// Memory for runs; one a thread is enough.
    pub fn memory(&self) -> Memory {
        Memory { slots: vec![0.0; self.slots], cells: vec![Cell::default(); self.cells] }
    }

    /// Number of inputs, as asked.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of outputs, as asked.
    pub fn outputs(&self) -> usize {
        self.outputs.len()
    }

    /// Number of operations in a run.
    pub fn operations(&self) -> usize {
        self.operations.len()
    }

    /// Computes the outputs from the inputs, both in the order asked and in their variables' own units.
    ///
    /// # Panics
    /// If a slice has not the length asked, or the memory is that of a smaller program.
    pub fn run(&self, inputs: &[f64], memory: &mut Memory, outputs: &mut [f64]) {
        assert_eq!(inputs.len(), self.inputs, "one value an input");
        assert_eq!(outputs.len(), self.outputs.len(), "one place an output");
        let (slots, cells) = (&mut memory.slots[..self.slots], &mut memory.cells[..self.cells]);
        let (constants, rest) = slots.split_at_mut(self.constants.len());
        constants.copy_from_slice(&self.constants);
        rest[..self.inputs].copy_from_slice(inputs);
        for operation in &self.operations {
            self.step(operation, slots, cells);
        }
        for (output, &slot) in outputs.iter_mut().zip(&self.outputs) {
            *output = slots[slot as usize];
        }
    }

    #[inline]
    fn step(&self, operation: &Operation, slots: &mut [f64], cells: &mut [Cell]) {
        let (value, to) = match *operation {
            Operation::Unary { function, x, to } => (function.of(slots[x as usize]), to),
            Operation::Binary { function, x, y, to } => (function.of(slots[x as usize], slots[y as usize]), to),
            Operation::Select { condition, yes, no, to } => {
                let (yes, no) = (slots[yes as usize], slots[no as usize]);
                (if holds(slots[condition as usize]) { yes } else { no }, to)
            }
            Operation::Limit { x, low, high, to } => (slots[x as usize].clamp(low, high), to),
            Operation::Locate { axis, x, low, high, nearest, to } => {
                cells[to as usize] = locate(&self.axes[axis as usize], slots[x as usize], low, high, nearest);
                return;
            }
            Operation::LookUp1 { table, cell, to } => {
                (self.tables[table as usize].at_cells(&[cells[cell as usize]]), to)
            }
            Operation::LookUp2 { table, cells: [x, y], to } => {
                (self.tables[table as usize].at_cells(&[cells[x as usize], cells[y as usize]]), to)
            }
            Operation::LookUp { table, first, axes, to } => {
                let (mut point, axes) = ([Cell::default(); MAX_AXES], axes as usize);
                for (cell, &at) in point.iter_mut().zip(&self.cell_lists[first as usize..][..axes]) {
                    *cell = cells[at as usize];
                }
                (self.tables[table as usize].at_cells(&point[..axes]), to)
            }
        };
        slots[to as usize] = value;
    }
}

/// The cell of an argument within its limits.
#[inline]
pub(super) fn locate(axis: &Axis, x: f64, low: f64, high: f64, nearest: bool) -> Cell {
    let mut cell = axis.extend(x.clamp(low, high));
    if nearest && !cell.fraction.is_nan() {
        cell.fraction = if cell.fraction < 0.5 { 0.0 } else { 1.0 };
    }
    cell
}
