//! Why a model cannot be read, compiled or checked.

use crate::table::TableError;
use std::fmt;

/// A place in a document: line, and the variable or function around it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: u32,
    /// varID of the variable, or name of the function or shot; empty outside any.
    pub owner: String,
}

/// Why a model cannot be read, compiled or checked.
#[derive(Debug, Clone, PartialEq)]
pub enum DavemlError {
    /// The text is no XML, or goes beyond a bound of this reader; the message has the place.
    Xml(String),
    /// Elements lie deeper in one another than the bound.
    Depth {
        /// Line of the element.
        line: u32,
        /// The bound.
        limit: usize,
    },
    /// An element lacks something, or has it twice.
    Element {
        /// Where.
        place: Place,
        /// What was expected.
        expected: String,
    },
    /// An element, attribute or function that this reader does not know.
    Unsupported {
        /// Where.
        place: Place,
        /// What.
        what: String,
    },
    /// Text that should be a finite number.
    Number {
        /// Where.
        place: Place,
        /// It.
        text: String,
    },
    /// A reference to something that is not defined.
    Unknown {
        /// Where; line 0 if it was asked for from outside the document.
        place: Place,
        /// `variable`, `breakpoints` or `table`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// Something defined twice.
    Duplicate {
        /// Where the second one is; line 0 if it was asked for from outside the document.
        place: Place,
        /// `variable`, `breakpoints`, `table`, `definition of variable`, `input` or `setting`.
        kind: &'static str,
        /// Its name.
        name: String,
    },
    /// A name that fits several variables.
    Ambiguous {
        /// The name.
        name: String,
        /// The varIDs that it fits.
        fits: Vec<String>,
    },
    /// Variables that depend on one another in a circle; the last depends on the first.
    Cycle(Vec<String>),
    /// Numbers that are no table.
    Table {
        /// Where.
        place: Place,
        /// Why.
        error: TableError,
    },
    /// A variable on which an asked output depends has no value and is not among the inputs.
    NoValue {
        /// The output.
        output: String,
        /// The variable.
        variable: String,
    },
    /// A value was given for a variable that is calculated.
    Calculated(String),
    /// A value given from outside is not finite.
    NotFinite {
        /// The variable.
        name: String,
        /// The value.
        value: f64,
    },
    /// Two units of one signal cannot be converted.
    Units {
        /// Where.
        place: Place,
        /// The variable's units.
        variable: String,
        /// The signal's.
        signal: String,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.owner.as_str()) {
            (0, "") => write!(f, "as asked"),
            (0, owner) => write!(f, "{owner}"),
            (line, "") => write!(f, "line {line}"),
            (line, owner) => write!(f, "line {line}, {owner}"),
        }
    }
}

impl fmt::Display for DavemlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Xml(message) => write!(f, "not a model in XML: {message}"),
            Self::Depth { line, limit } => write!(f, "line {line}: elements lie more than {limit} deep"),
            Self::Element { place, expected } => write!(f, "{place}: expected {expected}"),
            Self::Unsupported { place, what } => write!(f, "{place}: {what} is not supported"),
            Self::Number { place, text } => write!(f, "{place}: expected a finite number, found {text:?}"),
            Self::Unknown { place, kind, name } => write!(f, "{place}: there is no {kind} {name:?}"),
            Self::Duplicate { place, kind, name } => write!(f, "{place}: a second {kind} {name:?}"),
            Self::Ambiguous { name, fits } => write!(f, "{name:?} fits several variables: {}", fits.join(", ")),
            Self::Cycle(ids) => write!(f, "variables depend on one another in a circle: {}", ids.join(" -> ")),
            Self::Table { place, error } => write!(f, "{place}: {error}"),
            Self::NoValue { output, variable } => {
                write!(f, "{output} depends on {variable}, which is not given and has no initial value")
            }
            Self::Calculated(name) => write!(f, "{name} is calculated: expected an input or a constant"),
            Self::NotFinite { name, value } => write!(f, "{name}: expected a finite number, found {value}"),
            Self::Units { place, variable, signal } => {
                write!(f, "{place}: cannot convert {signal:?} to the variable's {variable:?}")
            }
        }
    }
}

impl std::error::Error for DavemlError {}
