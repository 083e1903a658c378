//! A model against its own check data.
//!
//! A signal passes if it differs from what is expected by no more than its tolerance, both in the signal's units. Where
//! the document gives no tolerance it is [`DEFAULT_TOLERANCE`] of the expected value, or that itself for values below 1:
//! far above the rounding of the few hundred operations of a model, far below any mistake in one.

use super::document::Document;
use super::error::DavemlError;
use super::shot::{ShotData, SignalData};
use super::units::conversion;

/// Tolerance of a signal that has none of its own, relative to the larger of its value and 1.
pub const DEFAULT_TOLERANCE: f64 = 1e-9;

/// One `staticShot`, run.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Its name.
    pub name: String,
    /// What it checks: outputs, then internal values.
    pub signals: Vec<Signal>,
    /// Whether every signal is within its tolerance.
    pub passed: bool,
}

/// A value that a shot expects, and what came out.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Name or varID, as the document spells it.
    pub name: String,
    /// The document's value.
    pub expected: f64,
    /// Ours, in the same units.
    pub found: f64,
    /// Allowed difference.
    pub tolerance: f64,
}

impl Signal {
    /// Whether the difference is within the tolerance; never for NaN.
    pub fn passed(&self) -> bool {
        (self.found - self.expected).abs() <= self.tolerance
    }
}

impl Document {
    /// Runs every static shot of the check data.
    ///
    /// # Errors
    /// A shot names what the model has not, in units that do not convert, or gives too few inputs to compute its
    /// outputs.
    pub fn check(&self) -> Result<Vec<Shot>, DavemlError> {
        self.shots.iter().map(|shot| self.run_shot(shot)).collect()
    }

    fn run_shot(&self, shot: &ShotData) -> Result<Shot, DavemlError> {
        let (inputs, values) = self.resolve(shot.inputs.iter())?;
        let given: Vec<f64> = shot.inputs.iter().zip(&values).map(|(signal, factor)| signal.value * factor).collect();
        let expected = || shot.outputs.iter().chain(&shot.internal);
        let (outputs, factors) = self.resolve(expected())?;
        let program = self.compile(&[], &inputs, &outputs)?;
        let mut found = vec![0.0; outputs.len()];
        program.run(&given, &mut program.memory(), &mut found);
        let signals: Vec<_> = expected()
            .zip(found.iter().zip(factors))
            .map(|(signal, (found, factor))| Signal {
                name: signal.name.clone(),
                expected: signal.value,
                found: found / factor,
                tolerance: signal.tolerance.unwrap_or(DEFAULT_TOLERANCE * signal.value.abs().max(1.0)),
            })
            .collect();
        Ok(Shot { name: shot.name.clone(), passed: signals.iter().all(Signal::passed), signals })
    }

    /// Variables of signals, and the factors that turn their units into the variables'.
    fn resolve<'a>(
        &self,
        signals: impl Iterator<Item = &'a SignalData>,
    ) -> Result<(Vec<usize>, Vec<f64>), DavemlError> {
        let (mut indices, mut factors) = (Vec::new(), Vec::new());
        for signal in signals {
            let by_id = if signal.is_id { self.find_id(&signal.name) } else { None };
            let index = by_id.map_or_else(|| self.find(&signal.name), Ok).map_err(|error| match error {
                DavemlError::Unknown { kind, name, .. } => {
                    DavemlError::Unknown { place: signal.place.clone(), kind, name }
                }
                other => other,
            })?;
            let own = &self.variables[index].units;
            let factor = signal.units.as_deref().map_or(Some(1.0), |units| conversion(units, own));
            factors.push(factor.ok_or_else(|| DavemlError::Units {
                place: signal.place.clone(),
                variable: own.clone(),
                signal: signal.units.clone().unwrap_or_default(),
            })?);
            indices.push(index);
        }
        Ok((indices, factors))
    }
}
