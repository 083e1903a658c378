//! Signals: numbers that a model makes of the flight and its controls, for terms and tables to use as they use a control.
//!
//! A signal is a sum of factors, held within its limits: where a surface stands that a stick, a trim wheel and the
//! damping of a rate of rotation move together, or a lift that a governor bounds. Signals are computed in the order of the
//! file, after the tables that they ask for and before those that ask for them, anew at every evaluation: they have no
//! memory. `[[signal]]` of `M.toml`.
//!
//! Invariant others rely on: a signal is within its limits, whatever the flight.

use super::aero::{Factors, TableValues, Tables};
use super::model::Control;
use super::model_checks::{factors, names_of, slot};
use super::model_file::ModelFile;
use super::quantity::{MOST_SIGNALS, QUANTITIES, Quantity, SLOTS, unit_names, without_unit};

/// A number of a model's own, held within limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its name, which ends with its unit.
    pub name: String,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// What adds up to it.
    pub terms: Vec<Factors>,
}

/// Signals of a file, checked; their tables are found by `tables`, their names follow `controls`.
pub(super) fn signals(file: &ModelFile, controls: &[Control], tables: &[String]) -> Result<Vec<Signal>, String> {
    if file.signal.len() > MOST_SIGNALS {
        return Err(format!("signal: expected at most {MOST_SIGNALS}, found {}", file.signal.len()));
    }
    let mut names = names_of(controls);
    let first = QUANTITIES + controls.len();
    let later = |name: &String| file.signal.iter().any(|signal| signal.name == *name);
    let mut all = Vec::new();
    for (i, signal) in file.signal.iter().enumerate() {
        let (key, name) = (format!("signal[{i}]"), &signal.name);
        if without_unit(name).is_none() {
            return Err(format!("{key}.name: expected one that ends in a unit: {}, found {name}", unit_names()));
        }
        if Quantity::named(name).is_some() || names.contains(name) {
            return Err(format!(
                "{key}.name: expected another name than a quantity, a control or a signal, found {name}"
            ));
        }
        let (min, max) = (signal.min, signal.max);
        let is_range = min < max;
        if !is_range {
            return Err(format!("{key}: expected min < max, found {min}, {max}"));
        }
        let mut terms = Vec::new();
        for (at, term) in signal.term.iter().enumerate() {
            let key = format!("{key}.term[{at}]");
            for asked in [&term.table, &term.and_table].into_iter().flatten() {
                // A table over a signal is not known yet when signals are made.
                let over = file.table.get(asked).and_then(|table| table.axes.iter().find(|axis| later(axis)));
                if let Some(axis) = over {
                    return Err(format!(
                        "{key}: expected a table without the signal {axis} in its axes, found {asked}"
                    ));
                }
            }
            if term.value.is_none() && term.table.is_none() && term.times.is_empty() {
                return Err(format!("{key}: expected a value, a table or times, found none"));
            }
            let value = term.value.unwrap_or(1.0);
            terms.push(factors(
                &key,
                value,
                [term.table.as_ref(), term.and_table.as_ref()],
                &term.times,
                &names,
                tables,
            )?);
        }
        names.push(name.clone());
        debug_assert_eq!(slot(name, &names), Some(first + i));
        all.push(Signal { name: name.clone(), min, max, terms });
    }
    Ok(all)
}

/// Computes all signals into `slots`, from `first` on.
#[inline]
pub(super) fn compute(signals: &[Signal], first: usize, slots: &mut [f64; SLOTS], tables: &TableValues) {
    for (signal, place) in signals.iter().zip(first..) {
        let sum: f64 = signal.terms.iter().map(|term| term.product(slots, tables)).sum();
        slots[place] = sum.clamp(signal.min, signal.max);
    }
}

/// The value of each table at the flight's quantities, with the signals that stand between them.
#[inline]
pub(super) fn tables_and_signals(
    tables: &Tables,
    signals: &[Signal],
    first: usize,
    slots: &mut [f64; SLOTS],
) -> TableValues {
    let mut values = tables.values(slots, false);
    if !signals.is_empty() {
        compute(signals, first, slots, &values);
        tables.fill(slots, true, &mut values);
    }
    values
}

#[cfg(test)]
mod tests {
    use crate::rigid::Model;
    use crate::rigid::quantity::SLOTS;
    use std::path::Path;

    const BODY: &str = "[body]\nmass_kg = 1.0\ninertia_kgm2 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]\n\
        [controls]\nstick_norm = { min = -1.0, max = 1.0 }\n";
    const SURFACE: &str = "[[signal]]\nname = \"surface_deg\"\nmin = -20.0\nmax = 20.0\n\
        [[signal.term]]\nvalue = 30.0\ntimes = [\"stick_norm\"]\n[[signal.term]]\nvalue = 1.5\n";

    fn read(text: &str) -> Result<Model, String> {
        Model::from_text(Path::new("m.toml"), &format!("{BODY}{text}")).map_err(|error| error.to_string())
    }

    #[test]
    fn a_signal_is_its_sum_within_its_limits() {
        let model = read(SURFACE).unwrap();
        let slot = model.signal_slot("surface_deg").unwrap();
        for (stick, expected) in [(0.0, 1.5), (0.5, 16.5), (1.0, 20.0), (-1.0, -20.0)] {
            let mut slots = [0.0; SLOTS];
            slots[slot - 1] = stick;
            let nowhere = glam::DVec3::ZERO;
            model.loads(&mut slots, nowhere, 0.0, 1.0, nowhere, &mut model.memory());
            assert_eq!(slots[slot], expected);
        }
    }

    #[test]
    fn what_no_signal_can_be_is_refused_by_its_key() {
        let over = "[table.t]\naxes = [\"surface_deg\"]\nbreakpoints = [[0.0, 1.0]]\nvalues = [0.0, 1.0]\n";
        let asks = |name: &str, table: &str| {
            format!(
                "{over}{SURFACE}[[signal]]\nname = \"{name}\"\nmin = 0.0\nmax = 1.0\n[[signal.term]]\ntable = \"{table}\"\n"
            )
        };
        for (wrong, told) in [
            (SURFACE.replace("surface_deg", "surface"), "signal[0].name: expected one that ends in a unit"),
            (SURFACE.replace("surface_deg", "stick_norm"), "signal[0].name: expected another name"),
            (SURFACE.replace("max = 20.0", "max = -20.0"), "signal[0]: expected min < max"),
            (SURFACE.replace("\"stick_norm\"", "\"wheel\""), "signal[0].term[0].times: found wheel"),
            (asks("other_deg", "t"), "signal[1].term[0]: expected a table without the signal surface_deg"),
            (asks("other_deg", "u"), "expected one of [t], found u"),
        ] {
            let found = read(&wrong).unwrap_err();
            assert!(found.contains(told), "{told}: {found}");
        }
    }
}
