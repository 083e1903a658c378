//! `I.csv`: what the controls do, over time.
//!
//! The first column is `t_s`, the others are controls by name, in their own units. Times rise. A value holds from its
//! time on (right-continuous) until the next; an empty cell leaves the control as it is. Values beyond a control's limits
//! are held at them. Lines that begin with `#` and empty lines are passed over.

use super::model::Control;
use crate::file::FileError;
use std::path::Path;

/// A row: its time, and the controls that it changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Edge {
    /// Seconds.
    pub t_s: f64,
    /// Places of controls and their new values.
    pub changes: Vec<(usize, f64)>,
}

/// What the controls do, by rising time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Inputs {
    edges: Vec<Edge>,
    /// The first value of each control that is beyond its limits and held there; sentences.
    pub notes: Vec<String>,
}

impl Inputs {
    /// Reads inputs for a model's controls.
    ///
    /// # Errors
    /// [`FileError`] names the line, what was expected and what was found.
    pub fn read(file: &Path, controls: &[Control]) -> Result<Self, FileError> {
        Self::from_text(file, &crate::file::text(file)?, controls)
    }

    /// The same of a text; `file` is what errors call it.
    ///
    /// # Errors
    /// [`FileError`] names the line, what was expected and what was found.
    pub fn from_text(file: &Path, text: &str, controls: &[Control]) -> Result<Self, FileError> {
        let fail = |line: usize, why: String| FileError::new(file, format_args!("line {}: {why}", line + 1));
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = text.lines().map(str::trim).enumerate().filter(|(_, l)| !l.is_empty() && !l.starts_with('#'));
        let Some((at, header)) = lines.next() else {
            return Err(FileError::new(file, "expected a header t_s,<control>.., found nothing"));
        };
        let mut names = header.split(',').map(str::trim);
        if names.next() != Some("t_s") {
            return Err(fail(at, format!("expected a header that begins with t_s, found {header}")));
        }
        let mut columns = Vec::new();
        for name in names {
            let Some(place) = controls.iter().position(|control| control.name == name) else {
                let known: Vec<&str> = controls.iter().map(|control| control.name.as_str()).collect();
                return Err(fail(at, format!("expected controls of the model [{}], found {name}", known.join(", "))));
            };
            if columns.contains(&place) {
                return Err(fail(at, format!("expected each control once, found {name} again")));
            }
            columns.push(place);
        }
        let (mut edges, mut notes, mut noted): (Vec<Edge>, Vec<String>, Vec<usize>) = Default::default();
        for (at, line) in lines {
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            if cells.len() != columns.len() + 1 {
                let found = cells.len();
                return Err(fail(at, format!("expected {} cells, found {found}", columns.len() + 1)));
            }
            let number = |name: &str, cell: &str| match cell.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(value),
                _ => Err(fail(at, format!("{name}: expected a finite number, found {cell}"))),
            };
            let t_s = number("t_s", cells[0])?;
            if let Some(before) = edges.last().filter(|before| before.t_s >= t_s) {
                return Err(fail(at, format!("t_s: expected a time above {}, found {t_s}", before.t_s)));
            }
            let mut changes = Vec::new();
            for (&place, cell) in columns.iter().zip(&cells[1..]).filter(|(_, cell)| !cell.is_empty()) {
                let control = &controls[place];
                let given = number(&control.name, cell)?;
                let value = given.clamp(control.min, control.max);
                if value != given && !noted.contains(&place) {
                    noted.push(place);
                    let name = &control.name;
                    notes.push(format!("line {}: {name} {given} is beyond its limits and held at {value}", at + 1));
                }
                changes.push((place, value));
            }
            edges.push(Edge { t_s, changes });
        }
        Ok(Self { edges, notes })
    }

    /// The rows.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn controls() -> Vec<Control> {
        ["elevator_rad", "throttle_norm"]
            .map(|name| Control { name: name.to_owned(), min: -1.0, max: 1.0, initial: 0.0, per_s: None, lag_s: None })
            .to_vec()
    }

    fn read(text: &str) -> Result<Inputs, String> {
        Inputs::from_text(Path::new("i.csv"), text, &controls()).map_err(|error| error.to_string())
    }

    #[test]
    fn empty_cells_hold_and_limits_hold_too() {
        let inputs = read("# stick\nt_s,throttle_norm,elevator_rad\n0,0.5,\n\n1.5,,-7\r\n").unwrap();
        assert_eq!(inputs.edges()[0], Edge { t_s: 0.0, changes: vec![(1, 0.5)] });
        assert_eq!(inputs.edges()[1], Edge { t_s: 1.5, changes: vec![(0, -1.0)] });
        assert_eq!(inputs.notes, ["line 5: elevator_rad -7 is beyond its limits and held at -1"]);
        assert!(read("t_s\n0\n1").unwrap().edges()[1].changes.is_empty());
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, told) in [
            ("", "found nothing"),
            ("time,elevator_rad", "line 1: expected a header that begins with t_s"),
            ("t_s,aileron_rad", "found aileron_rad"),
            ("t_s,elevator_rad,elevator_rad", "again"),
            ("t_s,elevator_rad\n0,nan", "line 2: elevator_rad: expected a finite number, found nan"),
            ("t_s,elevator_rad\n0,inf", "line 2"),
            ("t_s,elevator_rad\n0,1\n#\n0,1", "line 4: t_s: expected a time above 0"),
            ("t_s,elevator_rad\nNaN,1", "line 2: t_s"),
            ("t_s,elevator_rad\n0", "expected 2 cells, found 1"),
            ("t_s,elevator_rad\n0,1,2", "expected 2 cells, found 3"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with("i.csv: ") && error.contains(told), "{text}: {error}");
        }
    }
}
