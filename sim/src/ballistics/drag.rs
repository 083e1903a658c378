//! Drag curves: the drag coefficient of a shape as a function of the Mach number.
//!
//! Both are plain numbers. Between the rows a curve is a monotone cubic (the default) or straight; outside it holds the
//! first or the last value. Nine curves of standard projectiles are built in, others come from a file `mach,cd`.
//!
//! Invariant others rely on: a curve is finite and not negative for every Mach number, also infinity; only NaN gives NaN.
//!
//! Source of the built-in curves: see assets/README.md. Standard shapes and the form factor: R. L. McCoy, Modern Exterior
//! Ballistics, 1999, chapters 4 and 5.

use crate::file::{self, FileError};
use crate::table::{Interpolation, Table};
use std::fmt;
use std::path::Path;

/// Largest coefficient that is taken: a parachute has 2, a flat plate across the flow less.
const MOST_CD: f64 = 1_000.0;

/// A standard projectile: the name that files use, and its curve.
const STANDARD: [(&str, &str); 9] = [
    ("G1", include_str!("../../../assets/ballistics/drag_G1.csv")),
    ("G2", include_str!("../../../assets/ballistics/drag_G2.csv")),
    ("G5", include_str!("../../../assets/ballistics/drag_G5.csv")),
    ("G6", include_str!("../../../assets/ballistics/drag_G6.csv")),
    ("G7", include_str!("../../../assets/ballistics/drag_G7.csv")),
    ("G8", include_str!("../../../assets/ballistics/drag_G8.csv")),
    ("GI", include_str!("../../../assets/ballistics/drag_GI.csv")),
    ("GS", include_str!("../../../assets/ballistics/drag_GS.csv")),
    ("RA4", include_str!("../../../assets/ballistics/drag_RA4.csv")),
];

/// The names of the built-in curves.
pub const NAMES: [&str; 9] = ["G1", "G2", "G5", "G6", "G7", "G8", "GI", "GS", "RA4"];

/// A drag coefficient by Mach number.
#[derive(Debug, Clone, PartialEq)]
pub struct DragCurve {
    table: Table,
    steepest: f64,
}

/// Why rows are no curve. Lines are counted from 1.
#[derive(Debug, Clone, PartialEq)]
struct Wrong {
    line: usize,
    expected: String,
    found: String,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: expected {}, found `{}`", self.line, self.expected, self.found)
    }
}

impl DragCurve {
    /// A built-in curve by its name, such as `G7`.
    pub fn standard(name: &str, interpolation: Interpolation) -> Option<Self> {
        let (_, text) = STANDARD.iter().find(|(known, _)| *known == name)?;
        Self::from_text(Path::new(name), text, interpolation).ok()
    }

    /// Reads a curve from a file whose first line is `mach,cd`.
    ///
    /// # Errors
    /// [`FileError`] names the line, what was expected and what was found.
    pub fn read(path: &Path, interpolation: Interpolation) -> Result<Self, FileError> {
        Self::from_text(path, &file::text(path)?, interpolation)
    }

    /// The same of a text; `path` is what errors call it.
    ///
    /// # Errors
    /// [`FileError`] names the line, what was expected and what was found.
    pub fn from_text(path: &Path, text: &str, interpolation: Interpolation) -> Result<Self, FileError> {
        let rows = rows(text).map_err(|wrong| FileError::new(path, wrong))?;
        Self::new(&rows, interpolation).map_err(|why| FileError::new(path, why))
    }

    /// A curve through rows of Mach number and coefficient.
    ///
    /// # Errors
    /// A sentence, if there are no rows, Mach numbers do not rise, or a number is negative or not finite.
    pub fn new(rows: &[[f64; 2]], interpolation: Interpolation) -> Result<Self, String> {
        if let Some(wrong) = rows.iter().flatten().find(|number| !(0.0..=MOST_CD).contains(*number)) {
            return Err(format!("expected numbers within 0 and {MOST_CD}, found {wrong}"));
        }
        let (machs, coefficients): (Vec<f64>, Vec<f64>) = rows.iter().map(|&[mach, cd]| (mach, cd)).unzip();
        let most = coefficients.iter().copied().fold(0.0, f64::max);
        // A monotone cubic is nowhere steeper than 3 times its cell's secant (Fritsch and Carlson, 1980).
        let slope =
            |pair: &[[f64; 2]]| pair[1][0] * 3.0 * ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).abs();
        let steepest = 2.0 * most + rows.windows(2).map(slope).fold(0.0, f64::max);
        let table = Table::new(vec![machs], coefficients, interpolation).map_err(|error| error.to_string())?;
        if !steepest.is_finite() {
            return Err("expected Mach numbers that are not so close, found an infinitely steep curve".to_owned());
        }
        Ok(Self { table, steepest })
    }

    /// The coefficient at a Mach number.
    #[inline]
    pub fn cd(&self, mach: f64) -> f64 {
        self.table.at(&[mach])
    }

    /// A bound of `2 Cd + M |dCd/dM|` over all Mach numbers `M`.
    ///
    /// The force of drag goes with `u2 Cd(u / c)`: by so much its rate of change with speed exceeds that of `u2 / 2`.
    pub fn steepest(&self) -> f64 {
        self.steepest
    }
}

/// The rows of a text: a header, then two numbers a line. Blank lines, CRLF and a byte order mark are taken.
fn rows(text: &str) -> Result<Vec<[f64; 2]>, Wrong> {
    let said = |(_, line): &(usize, &str)| !line.trim().is_empty() && !line.trim_start().starts_with('#');
    let mut lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines().enumerate().filter(said);
    let (first, header) = lines.next().unwrap_or((0, ""));
    if header.split(',').map(str::trim).ne(["mach", "cd"]) {
        return Err(Wrong { line: first + 1, expected: "the header `mach,cd`".to_owned(), found: shown(header) });
    }
    let mut rows: Vec<[f64; 2]> = Vec::new();
    let mut last = first + 1;
    for (index, text) in lines {
        last = index + 1;
        let wrong = |expected: String, found: &str| Wrong { line: index + 1, expected, found: shown(found) };
        let Some((mach, cd)) = text.split_once(',').filter(|(_, cd)| !cd.contains(',')) else {
            return Err(wrong("two numbers, `mach,cd`".to_owned(), text));
        };
        let number = |what: &str, text: &str| match text.trim().parse::<f64>() {
            Ok(number) if (0.0..=MOST_CD).contains(&number) => Ok(number),
            _ => Err(wrong(format!("{what} within 0 and {MOST_CD}"), text)),
        };
        let row = [number("a Mach number", mach)?, number("a drag coefficient", cd)?];
        match rows.last() {
            Some(before) if row[0] <= before[0] => {
                return Err(wrong(format!("a Mach number above {}, the one before", before[0]), mach));
            }
            _ => rows.push(row),
        }
    }
    if rows.is_empty() {
        return Err(Wrong { line: last, expected: "rows after the header".to_owned(), found: String::new() });
    }
    Ok(rows)
}

fn shown(text: &str) -> String {
    text.trim().chars().take(60).flat_map(char::escape_debug).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_curve_is_met_at_its_rows_and_held_outside() {
        assert_eq!(NAMES, STANDARD.map(|(name, _)| name));
        for (name, text) in STANDARD {
            for interpolation in [Interpolation::Pchip, Interpolation::Linear] {
                let curve = DragCurve::standard(name, interpolation).unwrap();
                let rows = rows(text).unwrap();
                assert!(rows.len() > 70, "{name}");
                for [mach, cd] in &rows {
                    assert_eq!(curve.cd(*mach), *cd, "{name} at {mach}");
                }
                let last = rows[rows.len() - 1][1];
                assert_eq!((curve.cd(1e9), curve.cd(f64::INFINITY), curve.cd(-1.0)), (last, last, rows[0][1]));
            }
        }
        assert!(DragCurve::standard("G3", Interpolation::Pchip).is_none());
    }

    #[test]
    fn the_bound_of_steepness_holds() {
        for name in NAMES {
            let curve = DragCurve::standard(name, Interpolation::Pchip).unwrap();
            let mut most: f64 = 0.0;
            for i in 0..60_000 {
                let mach = f64::from(i) * 1e-4;
                // A one-sided difference over 1e-6: its error is far below the bound's own slack.
                let slope = (curve.cd(mach + 1e-6) - curve.cd(mach)) / 1e-6;
                most = most.max(2.0 * curve.cd(mach) + mach * slope.abs());
            }
            assert!(most <= curve.steepest() && curve.steepest() < 5.0 * most, "{name}: {most} {}", curve.steepest());
        }
    }

    #[test]
    fn hostile_files_are_refused_with_their_line() {
        let read = |text: &str| {
            DragCurve::from_text(Path::new("d.csv"), text, Interpolation::Pchip).map_err(|error| error.to_string())
        };
        assert!(read("\u{feff}mach , cd\r\n0,0.2\r\n\r\n 1.5 , 0.3 \r\n").is_ok());
        assert_eq!(read("mach,cd\n1,0.25\n").unwrap().cd(7.0), 0.25, "one row is the same everywhere");
        for (text, told) in [
            ("", "line 1: expected the header"),
            ("cd,mach\n0,1", "line 1"),
            ("mach,cd\n", "expected rows"),
            ("mach,cd\n0,0.2\n0,0.3", "line 3: expected a Mach number above 0"),
            ("mach,cd\n1,0.2\n\n0.5,0.3", "line 4"),
            ("mach,cd\n0,-0.2", "line 2: expected a drag coefficient"),
            ("mach,cd\n0,nan", "found `nan`"),
            ("mach,cd\ninf,0.2", "found `inf`"),
            ("mach,cd\n0,1e999", "line 2"),
            ("mach,cd\n0", "line 2: expected two numbers"),
            ("mach,cd\n0,1,2", "line 2: expected two numbers"),
            ("mach,cd\n0;1", "line 2"),
            ("mach,cd\n\0,\u{1b}[1m", "line 2"),
            ("mach,cd\n0,1\n1e-320,2", "too close"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.starts_with("d.csv: ") && error.contains(told), "{text:?}: {error}");
            assert!(error.chars().all(|c| !c.is_control()), "{error:?}");
        }
    }
}
