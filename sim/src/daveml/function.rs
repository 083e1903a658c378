//! Functions by table: breakpoints, gridded tables and what looks them up.
//!
//! An argument is limited by its `min` and `max`, then held at the ends of its breakpoints; on a side where it may be
//! extrapolated it is not held, and the end's cell is extended in a straight line.
//!
//! Source: AIAA S-119 (DAVE-ML 2.0), `independentVarRef`.

use super::error::DavemlError;
use super::xml::Element;
use crate::table::{Interpolation, Table};
use std::collections::HashMap;

/// How a function uses one argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Argument {
    /// Index of the variable.
    pub variable: usize,
    /// Least argument; below the breakpoints, or infinite, where it may be extrapolated.
    pub low: f64,
    /// Greatest argument.
    pub high: f64,
    /// To the nearest breakpoint (a middle upwards) instead of linearly.
    pub nearest: bool,
}

/// A function by table.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// Arguments, one an axis of the table.
    pub arguments: Vec<Argument>,
    /// Index of the table.
    pub table: usize,
}

/// Breakpoints and tables of a document.
#[derive(Debug, Default)]
pub struct Tables {
    breakpoints: HashMap<String, Vec<f64>>,
    by_id: HashMap<String, usize>,
    /// All tables, with and without a name.
    pub tables: Vec<Table>,
}

impl Tables {
    /// Reads a `breakpointDef`.
    pub fn read_breakpoints(&mut self, element: &Element<'_, '_>) -> Result<(), DavemlError> {
        let id = element.required_attribute("bpID")?;
        let element = element.named(id);
        let points = element.required("bpVals")?.numbers()?;
        match self.breakpoints.insert(id.into(), points) {
            Some(_) => Err(element.duplicate("breakpoints", id)),
            None => Ok(()),
        }
    }

    /// Reads a `griddedTableDef`, at top level or inside a function; gives its index.
    pub fn read_table(&mut self, element: &Element<'_, '_>) -> Result<usize, DavemlError> {
        let id = element.attribute("gtID");
        let element = element.named(id.or(element.attribute("name")).unwrap_or("table"));
        for child in element.children() {
            match child.name() {
                "breakpointRefs" | "dataTable" | "description" | "provenance" | "provenanceRef" | "uncertainty" => {}
                _ => return Err(child.unsupported()),
            }
        }
        let mut axes = Vec::new();
        for reference in element.required("breakpointRefs")?.children() {
            if reference.name() != "bpRef" {
                return Err(reference.unsupported());
            }
            let name = reference.required_attribute("bpID")?;
            axes.push(self.breakpoints.get(name).ok_or_else(|| reference.unknown("breakpoints", name))?.clone());
        }
        let values = element.required("dataTable")?.numbers()?;
        let index = self.add(&element, axes, values)?;
        if let Some(id) = id
            && self.by_id.insert(id.into(), index).is_some()
        {
            return Err(element.duplicate("table", id));
        }
        Ok(index)
    }

    /// Reads a `function`: it and the index of the variable that it gives.
    pub fn read_function(
        &mut self,
        element: &Element<'_, '_>,
        ids: &HashMap<String, usize>,
    ) -> Result<(usize, Function), DavemlError> {
        let element = element.named(element.attribute("name").unwrap_or("function"));
        let variable = |at: &Element<'_, '_>| {
            let name = at.required_attribute("varID")?;
            ids.get(name).copied().ok_or_else(|| at.unknown("variable", name))
        };
        let (mut references, mut points) = (Vec::new(), Vec::new());
        let (mut dependent, mut short, mut definition) = (None, None, None);
        for child in element.children() {
            let place = match child.name() {
                "independentVarRef" => {
                    references.push(child);
                    continue;
                }
                "independentVarPts" => {
                    points.push(child);
                    continue;
                }
                "dependentVarRef" => &mut dependent,
                "dependentVarPts" => &mut short,
                "functionDefn" => &mut definition,
                "description" | "provenance" | "provenanceRef" => continue,
                _ => return Err(child.unsupported()),
            };
            if place.is_some() {
                return Err(child.expected(&format!("one <{}> in <function>", child.name())));
            }
            *place = Some(child);
        }
        let (given, table, arguments) = match (dependent, short, definition) {
            (Some(given), None, Some(definition)) if points.is_empty() => {
                (given, self.definition(&definition)?, references)
            }
            (None, Some(values), None) if references.is_empty() => {
                let axes = points.iter().map(Element::numbers).collect::<Result<_, _>>()?;
                let table = self.add(&element, axes, values.numbers()?)?;
                (values, table, points)
            }
            _ => {
                return Err(element.expected(
                    "independentVarRef, dependentVarRef and functionDefn, or independentVarPts and dependentVarPts",
                ));
            }
        };
        let axes = self.tables[table].axes();
        if axes.len() != arguments.len() {
            return Err(element.expected(&format!("{} arguments, one an axis, found {}", axes.len(), arguments.len())));
        }
        let arguments = arguments
            .iter()
            .zip(axes)
            .map(|(at, axis)| argument(at, variable(at)?, axis.low(), axis.high()))
            .collect::<Result<_, _>>()?;
        Ok((variable(&given)?, Function { arguments, table }))
    }

    fn definition(&mut self, element: &Element<'_, '_>) -> Result<usize, DavemlError> {
        let mut found = None;
        for child in element.children() {
            let table = match child.name() {
                // The second name is that of DAVE-ML 1.
                "griddedTableDef" | "griddedTable" => self.read_table(&child)?,
                "griddedTableRef" => {
                    let name = child.required_attribute("gtID")?;
                    self.by_id.get(name).copied().ok_or_else(|| child.unknown("table", name))?
                }
                _ => return Err(child.unsupported()),
            };
            if found.replace(table).is_some() {
                return Err(child.expected("one table in <functionDefn>"));
            }
        }
        found.ok_or_else(|| element.expected("a gridded table in <functionDefn>"))
    }

    fn add(&mut self, at: &Element<'_, '_>, axes: Vec<Vec<f64>>, values: Vec<f64>) -> Result<usize, DavemlError> {
        let table = Table::new(axes, values, Interpolation::Linear);
        self.tables.push(table.map_err(|error| DavemlError::Table { place: at.place(), error })?);
        Ok(self.tables.len() - 1)
    }
}

fn argument(at: &Element<'_, '_>, variable: usize, first: f64, last: f64) -> Result<Argument, DavemlError> {
    let (below, above) = match at.attribute("extrapolate") {
        None | Some("neither") => (false, false),
        Some("min") => (true, false),
        Some("max") => (false, true),
        Some("both") => (true, true),
        Some(other) => return Err(at.unsupported_what(format!("extrapolate {other:?}"))),
    };
    let nearest = match at.attribute("interpolate") {
        None | Some("linear") => false,
        Some("discrete") => true,
        // The standard's words for floor and ceiling contradict their names, and its splines have no stated ends.
        Some(other) => return Err(at.unsupported_what(format!("interpolate {other:?}"))),
    };
    let (min, max) = (at.number_attribute("min")?, at.number_attribute("max")?);
    let (min, max) = (min.unwrap_or(f64::NEG_INFINITY), max.unwrap_or(f64::INFINITY));
    let low = if below { min } else { min.clamp(first, last) };
    let high = if above { max } else { max.clamp(first, last) };
    if min > max || low > high {
        return Err(at.expected(&format!("min {min} not above max {max}, and a range on the breakpoints")));
    }
    Ok(Argument { variable, low, high, nearest })
}
