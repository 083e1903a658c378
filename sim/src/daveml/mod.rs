//! Models of aircraft in DAVE-ML 2.0 (AIAA S-119-2011): read, compiled, run, and checked against their own check data.
//!
//! [`Document::parse`] reads variables, calculations, tables and check data; [`Document::program`] compiles what the
//! asked outputs depend on; [`Program::run`] computes them. Values are in each variable's own units; [`si_factor`]
//! turns those into SI.
//!
//! What is read: `variableDef` with limits and content MathML, `breakpointDef`, `griddedTableDef`, `function` (linear or
//! nearest), `checkData`. Ungridded tables, splines and array variables are refused by name.
//!
//! Invariant: no text, however wrong, does anything but give a [`DavemlError`]; it is bounded in depth and size.

mod check;
mod compile;
mod document;
mod error;
mod function;
mod math;
mod operation;
mod program;
mod shot;
mod step;
mod units;
mod variable;
mod xml;

pub use check::{DEFAULT_TOLERANCE, Shot, Signal};
pub use document::Document;
pub use error::{DavemlError, Place};
pub use program::{Memory, Program};
pub use units::{conversion, si_factor};
pub use variable::{Kind, Variable};
