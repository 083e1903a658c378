//! Check data as a document gives it: `staticShot`s of signals.

use super::error::{DavemlError, Place};
use super::xml::{self, Element};

/// A static shot.
#[derive(Debug, Clone, PartialEq)]
pub struct ShotData {
    /// Its name.
    pub name: String,
    /// What is given.
    pub inputs: Vec<SignalData>,
    /// What variables inside must be.
    pub internal: Vec<SignalData>,
    /// What comes out.
    pub outputs: Vec<SignalData>,
}

/// A value of one variable.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalData {
    /// Name or varID.
    pub name: String,
    /// Whether it is said to be a varID.
    pub is_id: bool,
    /// Units of value and tolerance, if they are said.
    pub units: Option<String>,
    /// The value.
    pub value: f64,
    /// Allowed difference, if it is said.
    pub tolerance: Option<f64>,
    /// Where it stands.
    pub place: Place,
}

/// Reads a `checkData`.
pub fn read(element: &Element<'_, '_>) -> Result<Vec<ShotData>, DavemlError> {
    let mut shots = Vec::new();
    for child in element.children() {
        match child.name() {
            "staticShot" => shots.push(read_shot(&child)?),
            "description" | "provenance" | "provenanceRef" => {}
            _ => return Err(child.unsupported()),
        }
    }
    Ok(shots)
}

fn read_shot(element: &Element<'_, '_>) -> Result<ShotData, DavemlError> {
    let name = element.attribute("name").unwrap_or("staticShot");
    let element = element.named(name);
    let mut shot = ShotData { name: name.into(), inputs: Vec::new(), internal: Vec::new(), outputs: Vec::new() };
    for child in element.children() {
        let signals = match child.name() {
            "checkInputs" => &mut shot.inputs,
            "internalValues" => &mut shot.internal,
            "checkOutputs" => &mut shot.outputs,
            "description" | "provenance" | "provenanceRef" => continue,
            _ => return Err(child.unsupported()),
        };
        for signal in child.children() {
            if signal.name() != "signal" {
                return Err(signal.unsupported());
            }
            signals.push(read_signal(&signal)?);
        }
    }
    Ok(shot)
}

fn read_signal(element: &Element<'_, '_>) -> Result<SignalData, DavemlError> {
    for child in element.children() {
        // signalID is the old spelling of varID.
        if !matches!(child.name(), "signalName" | "varID" | "signalID" | "signalUnits" | "signalValue" | "tol") {
            return Err(child.unsupported());
        }
    }
    let text = |name: &str| Ok(element.child(name)?.map(|child| child.text().trim().to_string()));
    let number = |child: &Element<'_, '_>| {
        let text = child.text();
        xml::number(&text).ok_or_else(|| child.no_number(&text))
    };
    let (name, is_id) = match (text("signalName")?, text("varID")?, text("signalID")?) {
        (_, Some(id), _) | (_, None, Some(id)) => (id, true),
        (Some(name), None, None) => (name, false),
        (None, None, None) => return Err(element.expected("signalName or varID in <signal>")),
    };
    Ok(SignalData {
        name,
        is_id,
        units: text("signalUnits")?,
        value: number(&element.required("signalValue")?)?,
        tolerance: element.child("tol")?.map(|child| number(&child)).transpose()?,
        place: element.place(),
    })
}
