//! Steps while a program is being made, and their final form.
//!
//! A step is a value that is made once and never changed. Equal steps are one; those that no output needs are dropped at
//! the end, and the rest get their slots.

use super::operation::{Binary, Unary};
use super::program::{Operation, Program};
use crate::table::{Axis, Table};
use std::collections::HashMap;

/// Where a step's number comes from. f64 are kept as bits, so that equal is the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Operand {
    /// A number known now.
    Constant(u64),
    /// An input, by its place.
    Input(u32),
    /// A step before.
    Step(u32),
    /// There is no value, for want of one of this variable.
    Missing(usize),
}

impl Operand {
    /// A number known now.
    pub fn constant(value: f64) -> Self {
        Self::Constant(value.to_bits())
    }

    /// The number, if it is known now.
    pub fn value(self) -> Option<f64> {
        if let Self::Constant(bits) = self { Some(f64::from_bits(bits)) } else { None }
    }
}

/// An operation; see [`Operation`].
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Step {
    /// A function of one operand.
    Unary { function: Unary, x: Operand },
    /// A function of two.
    Binary { function: Binary, x: Operand, y: Operand },
    /// One of two.
    Select { condition: Operand, yes: Operand, no: Operand },
    /// Held within limits, as bits.
    Limit { x: Operand, low: u64, high: u64 },
    /// A search on an axis of the program.
    Locate { axis: usize, x: Operand, low: u64, high: u64, nearest: bool },
    /// A table of the document at the cells that these steps find.
    LookUp { table: usize, cells: Vec<u32> },
}

impl Step {
    fn operands(&self) -> Vec<Operand> {
        match self {
            Self::Unary { x, .. } | Self::Limit { x, .. } | Self::Locate { x, .. } => vec![*x],
            Self::Binary { x, y, .. } => vec![*x, *y],
            Self::Select { condition, yes, no } => vec![*condition, *yes, *no],
            Self::LookUp { cells, .. } => cells.iter().map(|&cell| Operand::Step(cell)).collect(),
        }
    }
}

/// Steps in order.
#[derive(Debug, Default)]
pub struct Steps {
    steps: Vec<Step>,
    numbers: HashMap<Step, u32>,
    pub(super) axes: Vec<Axis>,
    pub(super) axis_numbers: HashMap<Vec<u64>, usize>,
}

impl Steps {
    /// Adds a step, unless an equal one is there; what has no value for want of something stays so.
    pub fn add(&mut self, step: Step) -> Operand {
        let missing = step.operands().into_iter().find(|operand| matches!(operand, Operand::Missing(_)));
        if let Some(missing) = missing {
            return missing;
        }
        let next = self.steps.len() as u32;
        let number = *self.numbers.entry(step).or_insert_with_key(|step| {
            self.steps.push(step.clone());
            next
        });
        Operand::Step(number)
    }

    /// The program that gives `wanted`.
    pub fn finish(self, inputs: usize, wanted: &[Operand], tables: &[Table]) -> Program {
        let mut live = vec![false; self.steps.len()];
        let mark = |operand: &Operand, live: &mut Vec<bool>| {
            if let Operand::Step(number) = operand {
                live[*number as usize] = true;
            }
        };
        wanted.iter().for_each(|operand| mark(operand, &mut live));
        for number in (0..self.steps.len()).rev() {
            if live[number] {
                self.steps[number].operands().iter().for_each(|operand| mark(operand, &mut live));
            }
        }
        let mut layout = Layout::new(&self.steps, &live, inputs, wanted);
        let operations = (0..self.steps.len())
            .filter(|&number| live[number])
            .map(|number| layout.operation(&self.steps[number], number, tables))
            .collect();
        Program {
            operations,
            inputs,
            outputs: wanted.iter().map(|&operand| layout.slot(operand)).collect(),
            slots: layout.slots,
            cells: layout.cells,
            axes: self.axes,
            tables: layout.tables,
            cell_lists: layout.cell_lists,
            constants: layout.constants,
        }
    }
}

/// Which slot or cell each live value has: constants, then inputs, then steps.
struct Layout {
    constants: Vec<f64>,
    constant_slots: HashMap<u64, u32>,
    /// Slot or, for a search, cell of each step.
    places: Vec<u32>,
    slots: usize,
    cells: usize,
    tables: Vec<Table>,
    table_numbers: HashMap<usize, u32>,
    cell_lists: Vec<u32>,
}

impl Layout {
    fn new(steps: &[Step], live: &[bool], inputs: usize, wanted: &[Operand]) -> Self {
        let mut layout = Self {
            constants: Vec::new(),
            constant_slots: HashMap::new(),
            places: vec![0; steps.len()],
            slots: 0,
            cells: 0,
            tables: Vec::new(),
            table_numbers: HashMap::new(),
            cell_lists: Vec::new(),
        };
        let used = steps.iter().zip(live).filter(|(_, live)| **live).flat_map(|(step, _)| step.operands());
        for bits in used.chain(wanted.iter().copied()).filter_map(|o| o.value().map(f64::to_bits)) {
            let next = layout.constants.len() as u32;
            if *layout.constant_slots.entry(bits).or_insert(next) == next {
                layout.constants.push(f64::from_bits(bits));
            }
        }
        layout.slots = layout.constants.len() + inputs;
        for (number, step) in steps.iter().enumerate().filter(|(number, _)| live[*number]) {
            let count = if matches!(step, Step::Locate { .. }) { &mut layout.cells } else { &mut layout.slots };
            layout.places[number] = *count as u32;
            *count += 1;
        }
        layout
    }

    fn slot(&self, operand: Operand) -> u32 {
        match operand {
            Operand::Constant(bits) => self.constant_slots[&bits],
            Operand::Input(place) => self.constants.len() as u32 + place,
            Operand::Step(number) => self.places[number as usize],
            Operand::Missing(_) => unreachable!("no step is made of what has no value"),
        }
    }

    fn operation(&mut self, step: &Step, number: usize, tables: &[Table]) -> Operation {
        let to = self.places[number];
        match step {
            Step::Unary { function, x } => Operation::Unary { function: *function, x: self.slot(*x), to },
            Step::Binary { function, x, y } => {
                Operation::Binary { function: *function, x: self.slot(*x), y: self.slot(*y), to }
            }
            Step::Select { condition, yes, no } => {
                Operation::Select { condition: self.slot(*condition), yes: self.slot(*yes), no: self.slot(*no), to }
            }
            Step::Limit { x, low, high } => {
                Operation::Limit { x: self.slot(*x), low: f64::from_bits(*low), high: f64::from_bits(*high), to }
            }
            Step::Locate { axis, x, low, high, nearest } => Operation::Locate {
                axis: *axis as u32,
                x: self.slot(*x),
                low: f64::from_bits(*low),
                high: f64::from_bits(*high),
                nearest: *nearest,
                to,
            },
            Step::LookUp { table, cells } => {
                let next = self.tables.len() as u32;
                let number = *self.table_numbers.entry(*table).or_insert(next);
                if number == next {
                    self.tables.push(tables[*table].clone());
                }
                let cells: Vec<u32> = cells.iter().map(|&cell| self.places[cell as usize]).collect();
                match *cells.as_slice() {
                    [cell] => Operation::LookUp1 { table: number, cell, to },
                    [x, y] => Operation::LookUp2 { table: number, cells: [x, y], to },
                    _ => {
                        let first = self.cell_lists.len() as u32;
                        self.cell_lists.extend_from_slice(&cells);
                        Operation::LookUp { table: number, first, axes: cells.len() as u32, to }
                    }
                }
            }
        }
    }
}
