//! A model's document: variables, how each is defined, and check data.
//!
//! Invariants: every reference is resolved; no variable depends on itself, directly or through others; a variable has
//! one definition. So compiling a [`super::Program`] can fail only by what is asked of it.

use super::error::{DavemlError, Place};
use super::function::{Function, Tables};
use super::math::Expression;
use super::shot::{self, ShotData};
use super::variable::{self, Kind, Variable};
use super::xml::{self, Element};
use crate::table::Table;
use std::collections::HashMap;
use std::fmt;

/// A model, read from DAVE-ML.
#[derive(Debug)]
pub struct Document {
    pub(super) variables: Vec<Variable>,
    pub(super) definitions: Vec<Definition>,
    pub(super) tables: Vec<Table>,
    pub(super) shots: Vec<ShotData>,
    /// Every variable after all those that it depends on.
    pub(super) order: Vec<usize>,
    names: Names,
}

/// How a variable gets its value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Definition {
    /// From outside, or its initial value.
    Given,
    /// By a calculation.
    Calculation(Expression),
    /// By a table.
    Function(Function),
}

/// Variables by varID, by name, and by both without regard to case.
#[derive(Default)]
struct Names {
    ids: HashMap<String, usize>,
    names: HashMap<String, Vec<usize>>,
    folded_names: HashMap<String, Vec<usize>>,
    folded_ids: HashMap<String, Vec<usize>>,
}

/// Says nothing: the variables are printed already, and the order of a map changes from run to run.
impl fmt::Debug for Names {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("..")
    }
}

impl Document {
    /// Reads a model.
    ///
    /// # Errors
    /// [`DavemlError`] names what is wrong, where, and in which variable or function.
    pub fn parse(text: &str) -> Result<Self, DavemlError> {
        let xml = xml::open(text)?;
        let lines = xml::Lines::of(text);
        let root = Element::root(&xml, &lines);
        if root.name() != "DAVEfunc" {
            return Err(root.expected("<DAVEfunc> as the outermost element"));
        }
        let mut names = Names::default();
        let (mut variables, mut tables, mut shots) = (Vec::new(), Tables::default(), Vec::new());
        for element in root.children() {
            match element.name() {
                "variableDef" => {
                    let variable = variable::read(&element)?;
                    if names.ids.insert(variable.id.clone(), variables.len()).is_some() {
                        return Err(element.duplicate("variable", &variable.id));
                    }
                    names.add(&variable, variables.len());
                    variables.push(variable);
                }
                "breakpointDef" => tables.read_breakpoints(&element)?,
                "checkData" => shots.append(&mut shot::read(&element)?),
                "griddedTableDef" | "function" | "fileHeader" => {}
                _ => return Err(element.unsupported()),
            }
        }
        let mut definitions = vec![Definition::Given; variables.len()];
        for element in root.children().filter(|element| element.name() == "variableDef") {
            if let Some(calculation) = variable::read_calculation(&element, &names.ids)? {
                let index = names.ids[element.required_attribute("varID")?];
                definitions[index] = Definition::Calculation(calculation);
            }
        }
        for element in root.children().filter(|element| element.name() == "griddedTableDef") {
            tables.read_table(&element)?;
        }
        for element in root.children().filter(|element| element.name() == "function") {
            let (index, function) = tables.read_function(&element, &names.ids)?;
            if variables[index].kind != Kind::Constant {
                return Err(element.duplicate("definition of variable", &variables[index].id));
            }
            variables[index].kind = Kind::Calculated;
            definitions[index] = Definition::Function(function);
        }
        // What nothing in the document gives a value to can only come from outside; one model forgets to say so.
        for (variable, definition) in variables.iter_mut().zip(&definitions) {
            if variable.initial.is_none() && *definition == Definition::Given {
                variable.kind = Kind::Input;
            }
        }
        let order = order(&variables, &definitions)?;
        Ok(Self { variables, definitions, tables: tables.tables, shots, order, names })
    }

    /// The variables, as they stand in the document.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The variable of a name or varID.
    ///
    /// An exact spelling goes before one that differs in (ASCII) case, and a name before a varID.
    ///
    /// # Errors
    /// There is none, or there are several.
    pub fn variable(&self, name: &str) -> Result<&Variable, DavemlError> {
        self.find(name).map(|index| &self.variables[index])
    }

    pub(super) fn find_id(&self, id: &str) -> Option<usize> {
        self.names.ids.get(id).copied()
    }

    pub(super) fn find(&self, name: &str) -> Result<usize, DavemlError> {
        let Names { ids, names, folded_names, folded_ids } = &self.names;
        if let Some(&[index]) = names.get(name).map(Vec::as_slice) {
            return Ok(index);
        }
        if let Some(&index) = ids.get(name) {
            return Ok(index);
        }
        let folded = name.to_ascii_lowercase();
        let candidates = names.get(name).or(folded_names.get(&folded)).or(folded_ids.get(&folded));
        match candidates.map(Vec::as_slice) {
            Some(&[index]) => Ok(index),
            Some(several) => {
                let fits = several.iter().map(|&index| self.variables[index].id.clone()).collect();
                Err(DavemlError::Ambiguous { name: name.into(), fits })
            }
            None => {
                let place = Place { line: 0, owner: String::new() };
                Err(DavemlError::Unknown { place, kind: "variable", name: name.into() })
            }
        }
    }
}

impl Names {
    fn add(&mut self, variable: &Variable, index: usize) {
        self.names.entry(variable.name.clone()).or_default().push(index);
        self.folded_names.entry(variable.name.to_ascii_lowercase()).or_default().push(index);
        self.folded_ids.entry(variable.id.to_ascii_lowercase()).or_default().push(index);
    }
}

impl Definition {
    /// Variables on which it depends, in the order of their use.
    pub(super) fn dependencies(&self) -> Vec<usize> {
        match self {
            Self::Given => Vec::new(),
            Self::Calculation(expression) => {
                let mut found = Vec::new();
                expression.each_variable(&mut |index| found.push(index));
                found
            }
            Self::Function(function) => function.arguments.iter().map(|argument| argument.variable).collect(),
        }
    }
}

/// Depth first with a stack of its own: a chain of variables may be as long as the document.
fn order(variables: &[Variable], definitions: &[Definition]) -> Result<Vec<usize>, DavemlError> {
    #[derive(Clone, Copy, PartialEq)]
    enum Mark {
        New,
        Open,
        Done,
    }
    let mut marks = vec![Mark::New; variables.len()];
    let mut order = Vec::with_capacity(variables.len());
    for start in 0..variables.len() {
        if marks[start] != Mark::New {
            continue;
        }
        marks[start] = Mark::Open;
        let mut path = vec![(start, definitions[start].dependencies().into_iter())];
        while let Some((variable, rest)) = path.last_mut() {
            let Some(next) = rest.next() else {
                marks[*variable] = Mark::Done;
                order.push(*variable);
                path.pop();
                continue;
            };
            match marks[next] {
                Mark::Done => {}
                Mark::New => {
                    marks[next] = Mark::Open;
                    path.push((next, definitions[next].dependencies().into_iter()));
                }
                Mark::Open => {
                    let circle = path.iter().map(|(index, _)| *index).skip_while(|&index| index != next);
                    return Err(DavemlError::Cycle(circle.map(|index| variables[index].id.clone()).collect()));
                }
            }
        }
    }
    Ok(order)
}
