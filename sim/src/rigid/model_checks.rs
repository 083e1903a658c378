//! Every check between `M.toml` as it is written and a [`super::Model`].

use super::aero::{BoundTable, Coefficient, Factors, MOST_TABLES, Tables, Term, Thrust};
use super::links::Source;
use super::model::{Control, FuelTank, StallCues};
use super::model_file::{AxesFile, ControlFile, DavemlFile, FuelFile, ModelFile, OutsideFile, StallFile, ThrustFile};
use super::quantity::{MOST_CONTROLS, QUANTITIES, Quantity, unit_names, without_unit};
use crate::daveml::Document;
use crate::file::{self, FileError};
use crate::table::Table;
use glam::{DMat3, DVec3};
use std::path::Path;
use std::sync::Arc;

/// Whether a term or a thrust asks for a table.
pub(super) fn is_asked(file: &ModelFile, name: &String) -> bool {
    let asked = |of: &Option<String>| of.as_ref() == Some(name);
    let signals = file.signal.iter().flat_map(|signal| &signal.term);
    file.aero.term.iter().any(|term| asked(&term.table) || asked(&term.and_table))
        || signals.into_iter().any(|term| asked(&term.table) || asked(&term.and_table))
        || file.thrust.iter().any(|thrust| asked(&thrust.table))
}

/// Tables that nothing asks for, and angles in radians that are more than a turn.
pub(super) fn notes(file: &ModelFile) -> Vec<String> {
    let mut notes = Vec::new();
    for (name, table) in &file.table {
        if !is_asked(file, name) {
            notes.push(format!("table.{name}: no term, no thrust and no signal asks for it"));
        }
        for (axis, breakpoints) in table.axes.iter().zip(&table.breakpoints) {
            let most = breakpoints.iter().fold(0.0f64, |most, x| most.max(x.abs()));
            if axis.ends_with("_rad") && most > std::f64::consts::TAU {
                notes.push(format!("table.{name}: {axis} reaches {most} rad; are these degrees?"));
            }
        }
    }
    notes
}

/// Whether a reference length counts for any coefficient of the file.
pub(super) fn needs(key: &str, terms: &[Term], file: &ModelFile) -> bool {
    let moment = |c: Coefficient| terms.iter().any(|t| t.to == c as usize);
    let hat = |name: &str| {
        let in_terms = file.aero.term.iter().flat_map(|t| &t.times);
        let in_signals = file.signal.iter().flat_map(|s| &s.term).flat_map(|t| &t.times);
        in_terms.chain(in_signals).chain(file.table.values().flat_map(|t| &t.axes)).any(|used| used == name)
    };
    match key {
        "area_m2" => true,
        "span_m" => moment(Coefficient::Cl) || moment(Coefficient::Cn) || hat("p_hat") || hat("r_hat"),
        _ => moment(Coefficient::Cm) || hat("q_hat"),
    }
}

pub(super) fn sources(path: &Path, file: &ModelFile) -> Result<Vec<Source>, FileError> {
    let one = |daveml: &DavemlFile| {
        let file = path.parent().map_or_else(|| daveml.file.clone(), |folder| folder.join(&daveml.file));
        let document = Document::parse(&file::text(&file)?).map_err(|error| FileError::new(&file, error))?;
        Ok(Source { file, document: Arc::new(document), set: daveml.set.clone() })
    };
    file.daveml.iter().map(one).collect()
}

pub(super) fn controls(file: &[(String, ControlFile)]) -> Result<Vec<Control>, String> {
    if file.len() > MOST_CONTROLS {
        return Err(format!("controls: expected at most {MOST_CONTROLS}, found {}", file.len()));
    }
    let one = |(name, control): &(String, ControlFile)| {
        if without_unit(name).is_none() {
            return Err(format!("controls.{name}: expected a name that ends in a unit: {}", unit_names()));
        }
        if Quantity::named(name).is_some() {
            return Err(format!("controls.{name}: expected another name, this is a quantity of the flight"));
        }
        let ControlFile { min, max, initial, per_s, lag_s } = *control;
        if !(min <= initial && initial <= max) {
            return Err(format!("controls.{name}: expected min <= initial <= max, found {min}, {initial}, {max}"));
        }
        if let Some(found) = per_s.filter(|per_s| !(*per_s > 0.0 && *per_s < 1e9)) {
            return Err(format!("controls.{name}.per_s: expected a number above 0, found {found}"));
        }
        if let Some(found) = lag_s.filter(|lag_s| !(*lag_s > 0.0 && *lag_s < 1e4)) {
            return Err(format!("controls.{name}.lag_s: expected seconds above 0, found {found}"));
        }
        Ok(Control { name: name.clone(), min, max, initial, per_s, lag_s })
    };
    file.iter().map(one).collect()
}

pub(super) fn tensor(rows: [[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(&rows).transpose()
}

/// Checks that a body of this mass and inertia can exist.
///
/// The second moments of mass are half the trace less the tensor; no moment of a body can be negative, so they must not
/// be, whatever the axes. That says too that no principal moment is greater than the sum of the two others.
pub(super) fn check_body(mass_kg: f64, inertia: DMat3) -> Result<(), String> {
    if !(mass_kg > 0.0 && mass_kg < 1e12) {
        return Err(format!("body.mass_kg: expected a number above 0, found {mass_kg}"));
    }
    let i = |row: usize, column: usize| inertia.col(column)[row];
    let trace = i(0, 0) + i(1, 1) + i(2, 2);
    let asymmetry = (i(0, 1) - i(1, 0)).abs() + (i(0, 2) - i(2, 0)).abs() + (i(1, 2) - i(2, 1)).abs();
    if asymmetry > 1e-9 * trace.abs() {
        return Err("body.inertia_kgm2: expected a symmetric tensor".to_owned());
    }
    // A tensor printed with nine digits may be off by that much.
    let slack = 1e-9 * trace;
    let positive = |m: DMat3, least: f64| {
        let e = |row: usize, column: usize| m.col(column)[row];
        let pair = |a: usize, b: usize| e(a, a) * e(b, b) - e(a, b) * e(b, a) >= least * trace;
        (0..3).all(|a| e(a, a) >= least)
            && pair(0, 1)
            && pair(0, 2)
            && pair(1, 2)
            && m.determinant() >= least * trace * trace
    };
    if !(trace > 0.0 && positive(inertia, 1e-12 * trace)) {
        return Err(format!(
            "body.inertia_kgm2: expected positive principal moments, found the tensor singular or negative: {:?}",
            inertia.to_cols_array_2d()
        ));
    }
    if !positive(DMat3::from_diagonal(DVec3::splat(0.5 * trace)) - inertia, -slack) {
        return Err(format!(
            "body.inertia_kgm2: expected no principal moment above the sum of the others, found {:?}",
            inertia.to_cols_array_2d()
        ));
    }
    Ok(())
}

/// Names of controls, in order; signals are added behind them.
pub(super) fn names_of(controls: &[Control]) -> Vec<String> {
    controls.iter().map(|control| control.name.clone()).collect()
}

/// The slot of a name that a term or table multiplies with: a quantity's or, of those behind them, a control's or signal's.
pub(super) fn slot(name: &str, behind: &[String]) -> Option<usize> {
    let of_control = || behind.iter().position(|known| known == name).map(|place| QUANTITIES + place);
    Quantity::named(name).map(Quantity::slot).or_else(of_control)
}

pub(super) fn slots(key: &str, names: &[String], behind: &[String]) -> Result<Vec<usize>, String> {
    let one = |name: &String| {
        slot(name, behind).ok_or_else(|| {
            let known: Vec<&str> =
                super::quantity::ALL.iter().map(|q| q.1).chain(behind.iter().map(String::as_str)).collect();
            format!("{key}: found {name}, expected one of {}", known.join(", "))
        })
    };
    names.iter().map(one).collect()
}

/// The tables of a file; `first_signal` is the slot of the first signal.
pub(super) fn bound_tables(file: &ModelFile, behind: &[String], first_signal: usize) -> Result<Tables, String> {
    if file.table.len() > MOST_TABLES {
        return Err(format!("table: expected at most {MOST_TABLES}, found {}", file.table.len()));
    }
    let mut all = Vec::new();
    for (name, table) in &file.table {
        let key = format!("table.{name}");
        if table.axes.len() != table.breakpoints.len() {
            let (axes, breakpoints) = (table.axes.len(), table.breakpoints.len());
            return Err(format!("{key}.breakpoints: expected one list an axis, {axes}, found {breakpoints}"));
        }
        let built = Table::new(table.breakpoints.clone(), table.values.clone(), table.interpolation.into());
        let slots = slots(&format!("{key}.axes"), &table.axes, behind)?;
        all.push(BoundTable {
            name: name.clone(),
            table: built.map_err(|error| format!("{key}: {error}"))?,
            is_late: slots.iter().any(|slot| *slot >= first_signal),
            slots,
            arguments: table.axes.clone(),
            refuse_outside: table.outside == OutsideFile::Error && is_asked(file, name),
        });
    }
    Ok(Tables(all))
}

pub(super) fn factors(
    key: &str,
    value: f64,
    [table, and_table]: [Option<&String>; 2],
    times: &[String],
    behind: &[String],
    tables: &[String],
) -> Result<Factors, String> {
    let place = |name: &String| {
        let missing = || format!("{key}.table: expected one of [{}], found {name}", tables.join(", "));
        tables.iter().position(|known| known == name).ok_or_else(missing)
    };
    let (table, and_table) = (table.map(place).transpose()?, and_table.map(place).transpose()?);
    Ok(Factors { value, table, and_table, times: slots(&format!("{key}.times"), times, behind)? })
}

pub(super) fn terms(file: &ModelFile, behind: &[String], tables: &[String]) -> Result<Vec<Term>, String> {
    let mut all = Vec::new();
    for (i, term) in file.aero.term.iter().enumerate() {
        let key = format!("aero.term[{i}]");
        let to = Coefficient::place(&term.to)
            .ok_or_else(|| format!("{key}.to: expected one of {}, found {}", Coefficient::NAMES.join(", "), term.to))?;
        if file.aero.axes == AxesFile::Body && matches!(term.to.as_str(), "CD" | "CL") {
            return Err(format!("{key}.to: expected CX, CY or CZ in body axes, found {}", term.to));
        }
        if term.value.is_none() && term.table.is_none() {
            return Err(format!("{key}: expected a value or a table, found neither"));
        }
        let value = term.value.unwrap_or(1.0);
        let both = [term.table.as_ref(), term.and_table.as_ref()];
        all.push(Term { to, of: factors(&key, value, both, &term.times, behind, tables)? });
    }
    Ok(all)
}

pub(super) fn thrusts(file: &[ThrustFile], behind: &[String], tables: &[String]) -> Result<Vec<Thrust>, String> {
    let mut all = Vec::new();
    for (i, thrust) in file.iter().enumerate() {
        let key = format!("thrust[{i}]");
        if thrust.force_N.is_none() && thrust.table.is_none() {
            return Err(format!("{key}: expected force_N or a table, found neither"));
        }
        all.push(Thrust {
            // A table alone is newtons forward.
            force_n: DVec3::from_array(thrust.force_N.unwrap_or([1.0, 0.0, 0.0])),
            at_m: DVec3::from_array(thrust.at_m.unwrap_or_default()),
            of: factors(&key, 1.0, [thrust.table.as_ref(), None], &thrust.times, behind, tables)?,
        });
    }
    Ok(all)
}

/// The tank of a file; `behind` are the names of controls and signals.
pub(super) fn tank(file: &FuelFile, mass_kg: f64, behind: &[String]) -> Result<FuelTank, String> {
    let capacity_kg = file.capacity_kg;
    let flow = |name: &String| {
        let known = || behind.iter().filter(|name| name.ends_with("_kgps")).cloned().collect::<Vec<_>>().join(", ");
        let of = slot(name, behind).filter(|_| name.ends_with("_kgps"));
        of.ok_or_else(|| format!("fuel.flow: expected a signal in kg/s, one of [{}], found {name}", known()))
    };
    if !(capacity_kg > 0.0 && capacity_kg < mass_kg) {
        return Err(format!("fuel.capacity_kg: expected a number within 0 and {mass_kg}, found {capacity_kg}"));
    }
    let flow_slot = file.flow.as_ref().map(flow).transpose()?;
    Ok(FuelTank { at_m: DVec3::from_array(file.at_m), capacity_kg, flow_slot })
}

pub(super) fn stall_cues(file: &StallFile) -> Result<StallCues, String> {
    let StallFile { warning_rad, buffet_rad, full_buffet_rad } = *file;
    if 0.0 < warning_rad && warning_rad <= buffet_rad && buffet_rad < full_buffet_rad && full_buffet_rad < 3.2 {
        return Ok(StallCues { warning_rad, buffet_rad, full_buffet_rad });
    }
    Err(format!(
        "stall: expected 0 < warning_rad <= buffet_rad < full_buffet_rad < 3.2, found {warning_rad}, {buffet_rad}, {full_buffet_rad}"
    ))
}
