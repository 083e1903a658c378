//! A variable of a model, as its `variableDef` gives it.

use super::error::DavemlError;
use super::math::{self, Expression};
use super::xml::Element;
use std::collections::HashMap;

/// Where a variable's value comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// From outside: `isInput`, `isControl`, `isDisturbance`, a state without a calculation, or whatever has neither a
    /// definition nor an initial value.
    Input,
    /// Its initial value, unless it is set.
    Constant,
    /// A calculation or a table.
    Calculated,
}

/// A variable of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name, in the models of S-119 a standard one.
    pub name: String,
    /// varID: the name inside the document.
    pub id: String,
    /// Units in S-119's spelling, see [`super::si_factor`].
    pub units: String,
    /// Where its value comes from.
    pub kind: Kind,
    /// Whether the model offers it as an output; a constant can be one.
    pub is_output: bool,
    /// Initial value, in its units; of no effect on a calculated one.
    pub initial: Option<f64>,
    /// Least value: what is given or calculated below it is taken as it.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
}

/// Reads a `variableDef`; the calculation is read later, when all varIDs are known.
pub fn read(element: &Element<'_, '_>) -> Result<Variable, DavemlError> {
    let id = element.required_attribute("varID")?;
    let element = element.named(id);
    let (min, max) = (element.number_attribute("minValue")?, element.number_attribute("maxValue")?);
    if let (Some(min), Some(max)) = (min, max)
        && min > max
    {
        return Err(element.expected(&format!("minValue {min} not above maxValue {max}")));
    }
    let (mut is_input, mut is_state, mut is_output, mut calculated) = (false, false, false, false);
    for child in element.children() {
        match child.name() {
            "isInput" | "isControl" | "isDisturbance" => is_input = true,
            "isState" => is_state = true,
            "isOutput" | "isStateDeriv" => is_output = true,
            "calculation" => calculated = true,
            // What is said about a variable, and does not change its value.
            "description" | "provenance" | "provenanceRef" | "uncertainty" | "isStdAIAA" => {}
            _ => return Err(child.unsupported()),
        }
    }
    if is_input && calculated {
        return Err(element.expected("an input without a calculation"));
    }
    Ok(Variable {
        name: element.required_attribute("name")?.into(),
        id: id.into(),
        units: element.attribute("units").unwrap_or("nd").trim().into(),
        kind: match (calculated, is_input || is_state) {
            (true, _) => Kind::Calculated,
            (false, true) => Kind::Input,
            (false, false) => Kind::Constant,
        },
        is_output,
        initial: element.number_attribute("initialValue")?,
        min,
        max,
    })
}

/// The calculation of a `variableDef`, if it has one.
pub fn read_calculation(
    element: &Element<'_, '_>,
    ids: &HashMap<String, usize>,
) -> Result<Option<Expression>, DavemlError> {
    let element = element.named(element.required_attribute("varID")?);
    let Some(calculation) = element.child("calculation")? else { return Ok(None) };
    for child in calculation.children() {
        if child.name() != "math" {
            return Err(child.unsupported());
        }
    }
    math::read(&calculation.required("math")?, ids).map(Some)
}
