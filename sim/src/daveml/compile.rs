//! From definitions to a program: only what the asked outputs depend on, constants folded, equal operations once.
//!
//! Invariants: folding computes with the very functions that a run uses, so it changes no bit. Two rewrites do not keep
//! the bits of `powf` but those of plainer functions: a power of 2 is a product, a power of 1/2 a square root.
//!
//! Steps are made in the document's order of dependence, so nothing here recurses but over one calculation.

use super::document::{Definition, Document};
use super::error::{DavemlError, Place};
use super::function::Function;
use super::math::Expression;
use super::operation::{Binary, Unary, holds};
use super::program::{Program, locate};
use super::step::{Operand, Step, Steps};
use super::variable::{Kind, Variable};
use crate::table::Axis;
use std::collections::HashMap;

impl Document {
    /// Compiles what computes `outputs` from `inputs`, all by name or varID (see [`Document::variable`]).
    ///
    /// `set` gives an input or a constant another value, in its own units. Inputs in neither list keep their initial
    /// value. Any variable may be an output. Limits of a variable hold for whatever value it gets.
    ///
    /// # Errors
    /// A name is unknown, ambiguous or there twice; a given variable is calculated; a value is not finite; an output
    /// depends on a variable without a value.
    pub fn program(&self, set: &[(&str, f64)], inputs: &[&str], outputs: &[&str]) -> Result<Program, DavemlError> {
        let set = set.iter().map(|&(name, value)| Ok((self.find(name)?, value))).collect::<Result<Vec<_>, _>>()?;
        let inputs = inputs.iter().map(|name| self.find(name)).collect::<Result<Vec<_>, _>>()?;
        let outputs = outputs.iter().map(|name| self.find(name)).collect::<Result<Vec<_>, _>>()?;
        self.compile(&set, &inputs, &outputs)
    }

    pub(super) fn compile(
        &self,
        set: &[(usize, f64)],
        inputs: &[usize],
        outputs: &[usize],
    ) -> Result<Program, DavemlError> {
        let mut given = HashMap::new();
        for (place, &index) in inputs.iter().enumerate() {
            let variable = self.giveable(index)?;
            if given.insert(index, Operand::Input(place as u32)).is_some() {
                return Err(twice("input", variable));
            }
        }
        for &(index, value) in set {
            let variable = self.giveable(index)?;
            if !value.is_finite() {
                return Err(DavemlError::NotFinite { name: variable.id.clone(), value });
            }
            if given.insert(index, Operand::constant(value)).is_some() {
                return Err(twice("setting", variable));
            }
        }
        let needed = self.needed(outputs);
        let mut compiler =
            Compiler { document: self, values: vec![Operand::constant(0.0); needed.len()], steps: Steps::default() };
        for &index in self.order.iter().filter(|&&index| needed[index]) {
            let value = match &self.definitions[index] {
                Definition::Given => given.get(&index).copied().unwrap_or_else(|| {
                    self.variables[index].initial.map_or(Operand::Missing(index), Operand::constant)
                }),
                Definition::Calculation(expression) => compiler.expression(expression),
                Definition::Function(function) => compiler.function(function),
            };
            compiler.values[index] = compiler.limit(value, &self.variables[index]);
        }
        for &output in outputs {
            if let Operand::Missing(index) = compiler.values[output] {
                let name = |index: usize| self.variables[index].id.clone();
                return Err(DavemlError::NoValue { output: name(output), variable: name(index) });
            }
        }
        let wanted: Vec<_> = outputs.iter().map(|&output| compiler.values[output]).collect();
        Ok(compiler.steps.finish(inputs.len(), &wanted, &self.tables))
    }

    fn giveable(&self, index: usize) -> Result<&Variable, DavemlError> {
        let variable = &self.variables[index];
        if variable.kind == Kind::Calculated { Err(DavemlError::Calculated(variable.id.clone())) } else { Ok(variable) }
    }

    fn needed(&self, outputs: &[usize]) -> Vec<bool> {
        let mut needed = vec![false; self.variables.len()];
        let mut open = outputs.to_vec();
        while let Some(index) = open.pop() {
            if !std::mem::replace(&mut needed[index], true) {
                open.extend(self.definitions[index].dependencies());
            }
        }
        needed
    }
}

fn twice(kind: &'static str, variable: &Variable) -> DavemlError {
    let place = Place { line: 0, owner: String::new() };
    DavemlError::Duplicate { place, kind, name: variable.id.clone() }
}

struct Compiler<'a> {
    document: &'a Document,
    /// Of the variables compiled so far.
    values: Vec<Operand>,
    steps: Steps,
}

impl Compiler<'_> {
    fn expression(&mut self, expression: &Expression) -> Operand {
        match expression {
            Expression::Number(value) => Operand::constant(*value),
            Expression::Variable(index) => self.values[*index],
            Expression::Unary(function, operand) => {
                let x = self.expression(operand);
                self.unary(*function, x)
            }
            Expression::Chain(function, operands) => {
                let operands: Vec<_> = operands.iter().map(|operand| self.expression(operand)).collect();
                self.chain(*function, &operands)
            }
            Expression::Piecewise(pieces, otherwise) => {
                let mut choices = Vec::new();
                let mut value = None;
                for piece in pieces {
                    let condition = self.expression(&piece.condition);
                    match condition.value() {
                        // A condition that is known leaves out what can never be taken.
                        Some(known) if !holds(known) => {}
                        Some(_) => {
                            value = Some(self.expression(&piece.value));
                            break;
                        }
                        None => choices.push((condition, self.expression(&piece.value))),
                    }
                }
                let mut value = match value {
                    Some(value) => value,
                    None => self.expression(otherwise),
                };
                for (condition, yes) in choices.into_iter().rev() {
                    value = if yes == value { yes } else { self.steps.add(Step::Select { condition, yes, no: value }) };
                }
                value
            }
        }
    }

    fn chain(&mut self, function: Binary, operands: &[Operand]) -> Operand {
        let (mut whole, join) = match (function.compares(), operands) {
            (true, [x, y, ..]) => (self.binary(function, *x, *y), Binary::And),
            // A chain of one: `and` and `or` still give a truth.
            (_, [x]) if matches!(function, Binary::And | Binary::Or) => (self.binary(function, *x, *x), function),
            (_, operands) => (operands[0], function),
        };
        for pair in operands.windows(2).skip(usize::from(function.compares())) {
            let next = if function.compares() { self.binary(function, pair[0], pair[1]) } else { pair[1] };
            whole = self.binary(join, whole, next);
        }
        whole
    }

    fn unary(&mut self, function: Unary, x: Operand) -> Operand {
        match x.value() {
            Some(x) => Operand::constant(function.of(x)),
            None => self.steps.add(Step::Unary { function, x }),
        }
    }

    fn binary(&mut self, function: Binary, x: Operand, y: Operand) -> Operand {
        match (function, x.value(), y.value()) {
            (_, Some(x), Some(y)) => Operand::constant(function.of(x, y)),
            (Binary::Power, _, Some(2.0)) => self.steps.add(Step::Binary { function: Binary::Times, x, y: x }),
            (Binary::Power, _, Some(0.5)) => self.unary(Unary::Root, x),
            _ => self.steps.add(Step::Binary { function, x, y }),
        }
    }

    fn limit(&mut self, x: Operand, variable: &Variable) -> Operand {
        let (low, high) = (variable.min.unwrap_or(f64::NEG_INFINITY), variable.max.unwrap_or(f64::INFINITY));
        if variable.min.is_none() && variable.max.is_none() {
            return x;
        }
        match x.value() {
            Some(x) => Operand::constant(x.clamp(low, high)),
            None => self.steps.add(Step::Limit { x, low: low.to_bits(), high: high.to_bits() }),
        }
    }

    fn function(&mut self, function: &Function) -> Operand {
        let table = &self.document.tables[function.table];
        let arguments: Vec<_> = function.arguments.iter().map(|argument| self.values[argument.variable]).collect();
        if let Some(known) = arguments.iter().map(|operand| operand.value()).collect::<Option<Vec<_>>>() {
            let sides = function.arguments.iter().zip(table.axes()).zip(known);
            let cells: Vec<_> =
                sides.map(|((side, axis), x)| locate(axis, x, side.low, side.high, side.nearest)).collect();
            return Operand::constant(table.at_cells(&cells));
        }
        let mut cells = Vec::new();
        for ((side, axis), x) in function.arguments.iter().zip(table.axes()).zip(arguments) {
            let axis = self.steps.axis(axis);
            let (low, high) = (side.low.to_bits(), side.high.to_bits());
            match self.steps.add(Step::Locate { axis, x, low, high, nearest: side.nearest }) {
                Operand::Step(cell) => cells.push(cell),
                missing => return missing,
            }
        }
        self.steps.add(Step::LookUp { table: function.table, cells })
    }
}

impl Steps {
    /// The number of an axis in the program; equal ones share it.
    fn axis(&mut self, axis: &Axis) -> usize {
        let bits = axis.breakpoints().iter().map(|point| point.to_bits()).collect();
        let next = self.axes.len();
        let number = *self.axis_numbers.entry(bits).or_insert(next);
        if number == next {
            self.axes.push(axis.clone());
        }
        number
    }
}
