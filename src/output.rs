//! What goes to stdout: one report a run, as a table for a person or as one JSON object for a program.
//!
//! The table is made from the JSON, so that the two cannot differ. Numbers that are not finite are null in both. A
//! reader that has gone away (`poligon info | head -1`) is no error.

use crate::failure::Failure;
use serde::Serialize;
use serde_json::{Map, Value};
use std::fmt::{self, Write as _};
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Longest list that a table shows whole; `--json` has all of it.
pub const SHOWN_ROWS: usize = 1000;

/// How the report is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Output {
    /// A table.
    Table,
    /// One JSON object on one line.
    Json,
}

impl Output {
    /// Prints a verb's report. To be called once a run, also when the report is of a failed proof.
    ///
    /// # Errors
    /// [`Failure::Failed`] if stdout cannot be written.
    pub fn print(self, report: &impl Serialize) -> Result<(), Failure> {
        // Not by way of a tree of values: a report of a million points is printed in a second.
        let text = match self {
            Self::Json => serde_json::to_string(report).map_err(not_made)? + "\n",
            Self::Table => table(&to_value(report)?),
        };
        print_text(&text)
    }
}

/// Prints a text to stdout as it is; for verbs whose rows are their output. A reader that has gone away is no error.
///
/// # Errors
/// [`Failure::Failed`] if stdout cannot be written.
pub fn print_text(text: &str) -> Result<(), Failure> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::while_doing("writing to stdout", error))
        }
        _ => Ok(()),
    }
}

/// Writes a file beside its place and renames it into it, so that a reader finds a whole file or what was there before.
///
/// A link is followed to the file it names. What is there and is no file (a pipe, a device) is written into as it is.
///
/// # Errors
/// [`Failure::Failed`] if it cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let failed = |error: io::Error| Failure::while_doing(format_args!("writing {}", path.display()), error);
    if fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return fs::OpenOptions::new().write(true).open(path).and_then(|mut to| to.write_all(bytes)).map_err(failed);
    }
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if let Some(folder) = place.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(failed)?;
    }
    let mut beside = place.as_os_str().to_owned();
    beside.push(format!(".{}.part", std::process::id()));
    let beside = PathBuf::from(beside);
    let written = fs::OpenOptions::new().write(true).create_new(true).open(&beside);
    let written = written.and_then(|mut to| to.write_all(bytes)).and_then(|()| fs::rename(&beside, &place));
    written.map_err(|error| {
        // What was begun is of no use to anyone.
        let _ = fs::remove_file(&beside);
        failed(error)
    })
}

/// Refuses to write over a file that is read.
///
/// # Errors
/// [`Failure::Misuse`] names the file.
pub fn not_over(out: Option<&Path>, read: &[&Path]) -> Result<(), Failure> {
    let Some(place) = out.and_then(|out| fs::canonicalize(out).ok()) else { return Ok(()) };
    match read.iter().find(|read| fs::canonicalize(read).is_ok_and(|read| read == place)) {
        Some(read) => {
            Err(Failure::Misuse(format!("--out: expected another file than {}, which is read", read.display())))
        }
        None => Ok(()),
    }
}

/// Tells a person something on stderr. That no one can be told is no reason to stop.
pub fn tell(line: impl fmt::Display) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// The report as JSON. Numbers that are not finite become null.
///
/// # Errors
/// [`Failure::Failed`] if the report has a key that is no string.
pub fn to_value(report: &impl Serialize) -> Result<Value, Failure> {
    serde_json::to_value(report).map_err(not_made)
}

fn not_made(error: serde_json::Error) -> Failure {
    Failure::while_doing("making the report", error)
}

fn table(value: &Value) -> String {
    let mut rows = Vec::new();
    let mut lists = Vec::new();
    flatten("", value, &mut rows, &mut lists);
    let width = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, shown) in rows {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}", format!("{name:width$}  {shown}").trim_end());
    }
    for (name, entries) in lists {
        let _ = write!(text, "\n{name}\n{}", columns(entries));
    }
    text
}

type Lists<'v> = Vec<(String, &'v [Value])>;

fn flatten<'v>(name: &str, value: &'v Value, rows: &mut Vec<(String, String)>, lists: &mut Lists<'v>) {
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                flatten(&name, value, rows, lists);
            }
        }
        Value::Array(entries) if entries.first().is_some_and(Value::is_object) => {
            lists.push((name.to_owned(), entries))
        }
        other => rows.push((name.to_owned(), shown(other))),
    }
}

/// A list of objects, one a line, a column a field.
fn columns(entries: &[Value]) -> String {
    let lines: Vec<Vec<(String, String)>> = entries
        .iter()
        .take(SHOWN_ROWS)
        .map(|entry| {
            let mut cells = Vec::new();
            // Lists within a line are shown on it: nothing is set apart.
            for (key, value) in entry.as_object().unwrap_or(&Map::new()) {
                flatten_line(key, value, &mut cells);
            }
            cells
        })
        .collect();
    let mut heads: Vec<(&str, usize)> = Vec::new();
    for (name, cell) in lines.iter().flatten() {
        let width = name.chars().count().max(cell.chars().count());
        match heads.iter_mut().find(|(head, _)| head == name) {
            Some((_, widest)) => *widest = width.max(*widest),
            None => heads.push((name, width)),
        }
    }
    let mut text = String::new();
    let mut line = |cell: &dyn Fn(&str) -> String| {
        let cells: Vec<String> = heads.iter().map(|&(head, width)| format!("{:width$}", cell(head))).collect();
        let _ = writeln!(text, "  {}", cells.join("  ").trim_end());
    };
    line(&|head| head.to_owned());
    for cells in &lines {
        line(&|head| cells.iter().find(|(name, _)| name == head).map_or(String::new(), |(_, cell)| cell.clone()));
    }
    if entries.len() > SHOWN_ROWS {
        let _ = writeln!(text, "  ... and {} more; --json prints all", entries.len() - SHOWN_ROWS);
    }
    text
}

fn flatten_line(name: &str, value: &Value, cells: &mut Vec<(String, String)>) {
    match value {
        Value::Object(fields) => {
            fields.iter().for_each(|(key, value)| flatten_line(&format!("{name}.{key}"), value, cells))
        }
        other => cells.push((name.to_owned(), shown(other))),
    }
}

fn shown(value: &Value) -> String {
    match value {
        Value::Null => "-".to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) => match number.as_f64() {
            Some(float) if number.is_f64() => rounded(float),
            _ => number.to_string(),
        },
        Value::Array(entries) => entries.iter().map(shown).collect::<Vec<_>>().join(" "),
        other => other.to_string(),
    }
}

/// At least four digits that count; coordinates in degrees keep 0.1 m.
fn rounded(float: f64) -> String {
    let decimals = match float.abs() {
        0.0 => 0,
        size if !(1e-4..1e15).contains(&size) => return format!("{float:.3e}"),
        size if size < 0.1 => 6,
        size if size < 1000.0 => 6 - size.log10().floor().max(0.0) as usize,
        _ => 1,
    };
    let text = format!("{float:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn what_is_not_finite_becomes_null() {
        #[derive(Serialize)]
        struct Report {
            b: f64,
            a: Vec<f32>,
            c: [f64; 2],
        }
        let report = Report { b: f64::NAN, a: vec![f32::INFINITY, 1.5], c: [f64::NEG_INFINITY, -0.25] };
        assert_eq!(to_value(&report).unwrap().to_string(), r#"{"b":null,"a":[null,1.5],"c":[null,-0.25]}"#);
        assert_eq!(to_value(&report).unwrap().to_string(), serde_json::to_string(&report).unwrap());
    }

    #[test]
    fn a_table_shows_every_field_by_its_name() {
        let value = json!({"world": {"name": "W", "step_m": 200.0}, "hit": null, "limits_m": [13.9, 27.8],
                           "results": [{"name": "a", "ours": 1, "yardstick": {"name": "y"}}, {"name": "long", "extra": true}]});
        let expected = "world.name    W\nworld.step_m  200\nhit           -\nlimits_m      13.9 27.8\n\
                        \nresults\n  name  ours  yardstick.name  extra\n  a     1     y\n  long                        true\n";
        assert_eq!(table(&value), expected);
        assert_eq!(table(&json!({})), "");
    }

    #[test]
    fn a_long_list_is_cut_in_a_table_and_says_so() {
        let value = json!({"points": vec![json!({"x_m": 1}); SHOWN_ROWS + 7]});
        assert!(table(&value).ends_with("... and 7 more; --json prints all\n"));
    }

    #[test]
    fn numbers_are_short_and_keep_what_matters() {
        for (float, text) in
            [(42.123_456_78, "42.12346"), (77.0, "77"), (-77.123_456, "-77.12346"), (0.0, "0"), (0.085, "0.085")]
        {
            assert_eq!(rounded(float), text);
        }
        for (float, text) in
            [(1e-7, "1.000e-7"), (123_456.78, "123456.8"), (1e300, "1.000e300"), (0.000_25, "0.00025"), (100.0, "100")]
        {
            assert_eq!(rounded(float), text);
        }
    }
}
