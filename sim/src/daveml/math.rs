//! Content MathML to an expression tree.
//!
//! Invariant: a tree is at most three times as deep as the document may be ([`super::xml::MAX_DEPTH`]), so recursion over
//! it is bounded; every operation has as many operands as it needs. A truth is 1, a falsehood 0; any number but 0 and NaN is true.
//!
//! Source: W3C MathML 2.0, chapter 4; AIAA S-119 for `atan2`.

use super::error::DavemlError;
use super::operation::{Binary, Unary};
use super::xml::{self, Element};
use std::collections::HashMap;

/// A calculation over variables, by their index in the document.
#[derive(Debug, Clone, PartialEq)]
pub enum Expression {
    /// A number.
    Number(f64),
    /// A variable.
    Variable(usize),
    /// A function of one operand.
    Unary(Unary, Box<Expression>),
    /// One or more operands, joined from left to right; comparisons join by holding for each neighbouring pair.
    Chain(Binary, Vec<Expression>),
    /// The value of the first piece whose condition holds, else the last; NaN where there is neither.
    Piecewise(Vec<Piece>, Box<Expression>),
}

/// A value and when it holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// The value.
    pub value: Expression,
    /// Its condition.
    pub condition: Expression,
}

impl Expression {
    /// Calls `visit` with every variable in it.
    pub fn each_variable(&self, visit: &mut impl FnMut(usize)) {
        match self {
            Self::Number(_) => {}
            Self::Variable(index) => visit(*index),
            Self::Unary(_, operand) => operand.each_variable(visit),
            Self::Chain(_, operands) => operands.iter().for_each(|operand| operand.each_variable(visit)),
            Self::Piecewise(pieces, otherwise) => {
                for piece in pieces {
                    piece.value.each_variable(visit);
                    piece.condition.each_variable(visit);
                }
                otherwise.each_variable(visit);
            }
        }
    }
}

/// Reads the children of a `math` element: one expression.
pub fn read(math: &Element<'_, '_>, ids: &HashMap<String, usize>) -> Result<Expression, DavemlError> {
    let children: Vec<_> = math.children().collect();
    match children.as_slice() {
        [one] => expression(one, ids),
        _ => Err(math.expected("one expression in <math>")),
    }
}

fn expression(element: &Element<'_, '_>, ids: &HashMap<String, usize>) -> Result<Expression, DavemlError> {
    match element.name() {
        "cn" => number(element),
        "ci" => {
            let name = element.text();
            let index = ids.get(name.trim()).copied();
            index.map(Expression::Variable).ok_or_else(|| element.unknown("variable", name.trim()))
        }
        "pi" => Ok(Expression::Number(std::f64::consts::PI)),
        "exponentiale" => Ok(Expression::Number(std::f64::consts::E)),
        "true" => Ok(Expression::Number(1.0)),
        "false" => Ok(Expression::Number(0.0)),
        "piecewise" => piecewise(element, ids),
        "apply" => apply(element, ids),
        _ => Err(element.unsupported()),
    }
}

fn number(element: &Element<'_, '_>) -> Result<Expression, DavemlError> {
    match element.attribute("type") {
        None | Some("real" | "integer" | "double") => {}
        // Mantissa and exponent on both sides of <sep/>.
        Some("e-notation") => {
            let parts = element.texts();
            let joined = parts.iter().map(|part| part.trim()).filter(|part| !part.is_empty()).collect::<Vec<_>>();
            return Ok(Expression::Number(
                xml::number(&joined.join("e")).ok_or_else(|| element.no_number(&joined.join(" ")))?,
            ));
        }
        Some(kind) => return Err(element.unsupported_what(format!("<cn type=\"{kind}\">"))),
    }
    if element.attribute("base").is_some_and(|base| base != "10") || element.children().next().is_some() {
        return Err(element.unsupported_what("<cn> with a base or parts".into()));
    }
    let text = element.text();
    xml::number(&text).map(Expression::Number).ok_or_else(|| element.no_number(&text))
}

fn piecewise(element: &Element<'_, '_>, ids: &HashMap<String, usize>) -> Result<Expression, DavemlError> {
    let (mut pieces, mut otherwise) = (Vec::new(), None);
    for child in element.children() {
        let parts: Vec<_> = child.children().collect();
        match (child.name(), parts.as_slice()) {
            ("piece", [value, condition]) => {
                pieces.push(Piece { value: expression(value, ids)?, condition: expression(condition, ids)? });
            }
            ("piece", _) => return Err(child.expected("a value and a condition in <piece>")),
            ("otherwise", [value]) if otherwise.is_none() => otherwise = Some(expression(value, ids)?),
            ("otherwise", _) => return Err(child.expected("one <otherwise> with one value")),
            _ => return Err(child.unsupported()),
        }
    }
    if pieces.is_empty() && otherwise.is_none() {
        return Err(element.expected("a <piece> or <otherwise> in <piecewise>"));
    }
    Ok(Expression::Piecewise(pieces, Box::new(otherwise.unwrap_or(Expression::Number(f64::NAN)))))
}

fn apply(element: &Element<'_, '_>, ids: &HashMap<String, usize>) -> Result<Expression, DavemlError> {
    let mut children = element.children();
    let Some(function) = children.next() else { return Err(element.expected("a function in <apply>")) };
    let name = match function.name() {
        // A degenerate form that the models use: an <apply> around a whole expression.
        "piecewise" | "apply" | "ci" | "cn" => {
            let alone = children.next().is_none();
            return if alone { expression(&function, ids) } else { Err(element.expected("a function in <apply>")) };
        }
        "csymbol" => csymbol(&function)?,
        name => name,
    };
    let mut qualifier = None;
    let mut operands = Vec::new();
    for child in children {
        match (name, child.name()) {
            ("root", "degree") | ("log", "logbase") => qualifier = Some(read(&child, ids)?),
            _ => operands.push(expression(&child, ids)?),
        }
    }
    use Expression::Number;
    if let Some(unary) = Unary::named(name) {
        let [operand] = take(operands, element, name)?;
        return Ok(Expression::Unary(unary, Box::new(operand)));
    }
    match name {
        "root" => {
            let [operand] = take(operands, element, name)?;
            Ok(match qualifier {
                None | Some(Number(2.0)) => Expression::Unary(Unary::Root, Box::new(operand)),
                Some(degree) => binary(Binary::Power, operand, binary(Binary::Divide, Number(1.0), degree)),
            })
        }
        "log" => {
            let [operand] = take(operands, element, name)?;
            let ln = |operand| Expression::Unary(Unary::Ln, Box::new(operand));
            Ok(match qualifier {
                None | Some(Number(10.0)) => Expression::Unary(Unary::Log, Box::new(operand)),
                Some(base) => binary(Binary::Divide, ln(operand), ln(base)),
            })
        }
        "minus" if operands.len() == 1 => {
            let [operand] = take(operands, element, name)?;
            Ok(Expression::Unary(Unary::Negate, Box::new(operand)))
        }
        "minus" | "divide" | "power" | "atan2" | "neq" => {
            let kind = match name {
                "minus" => Binary::Minus,
                "divide" => Binary::Divide,
                "power" => Binary::Power,
                "atan2" => Binary::Atan2,
                _ => Binary::NotEqual,
            };
            let [left, right] = take(operands, element, name)?;
            Ok(binary(kind, left, right))
        }
        "plus" => chain(Binary::Plus, Some(0.0), operands, element),
        "times" => chain(Binary::Times, Some(1.0), operands, element),
        "and" => chain(Binary::And, Some(1.0), operands, element),
        "or" => chain(Binary::Or, Some(0.0), operands, element),
        "min" => chain(Binary::Least, None, operands, element),
        "max" => chain(Binary::Greatest, None, operands, element),
        "lt" => compare(Binary::Less, operands, element),
        "gt" => compare(Binary::Greater, operands, element),
        "leq" => compare(Binary::LessOrEqual, operands, element),
        "geq" => compare(Binary::GreaterOrEqual, operands, element),
        "eq" => compare(Binary::Equal, operands, element),
        _ => Err(function.unsupported()),
    }
}

/// A function outside MathML, by the end of its address, else by its text.
fn csymbol(element: &Element<'_, '_>) -> Result<&'static str, DavemlError> {
    let text = element.text();
    let address = element.attribute("definitionURL").and_then(|url| url.rsplit_once('#')).map(|(_, name)| name);
    match address.unwrap_or(text.trim()) {
        "atan2" => Ok("atan2"),
        other => Err(element.unsupported_what(format!("<csymbol> {other:?}"))),
    }
}

fn binary(kind: Binary, left: Expression, right: Expression) -> Expression {
    Expression::Chain(kind, vec![left, right])
}

/// Any number of operands; `empty` is the value of none.
fn chain(
    kind: Binary,
    empty: Option<f64>,
    operands: Vec<Expression>,
    element: &Element<'_, '_>,
) -> Result<Expression, DavemlError> {
    match (operands.is_empty(), empty) {
        (true, None) => Err(element.expected("an operand")),
        (true, Some(value)) => Ok(Expression::Number(value)),
        (false, _) => Ok(Expression::Chain(kind, operands)),
    }
}

fn compare(kind: Binary, operands: Vec<Expression>, element: &Element<'_, '_>) -> Result<Expression, DavemlError> {
    if operands.len() < 2 {
        return Err(element.expected("at least two operands to compare"));
    }
    Ok(Expression::Chain(kind, operands))
}

fn take<const N: usize>(
    operands: Vec<Expression>,
    element: &Element<'_, '_>,
    name: &str,
) -> Result<[Expression; N], DavemlError> {
    let found = operands.len();
    operands.try_into().map_err(|_| element.expected(&format!("{N} operands of <{name}>, found {found}")))
}
