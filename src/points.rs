//! The points that `height` is asked about: a CSV file with one of two headers.
//!
//! `lat_deg,lon_deg` (geodetic, degrees) or `x_m,z_m` (world, metres). Lines end with LF or CRLF; blank ones are
//! skipped; a byte order mark is taken. A value that is not a finite number is an error that names its line and column.

use std::fmt;

/// Points as they were asked.
#[derive(Debug, Clone, PartialEq)]
pub enum Points {
    /// Latitude and longitude, degrees.
    Geodetic(Vec<[f64; 2]>),
    /// X and Z in the world, metres.
    World(Vec<[f64; 2]>),
}

/// Why a file of points cannot be read. Lines are counted from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PointsError {
    /// The bytes are not UTF-8.
    Encoding,
    /// The first line is not one of the two headers.
    Header(String),
    /// A line has not two values.
    Count {
        /// The line.
        line: usize,
        /// Values found.
        found: usize,
    },
    /// A value is not a finite number, or an angle is out of range.
    Value {
        /// The line.
        line: usize,
        /// The column's name.
        column: &'static str,
        /// What was expected.
        expected: &'static str,
        /// What was found.
        found: String,
    },
}

impl fmt::Display for PointsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Encoding => write!(f, "expected UTF-8 text, found other bytes"),
            Self::Header(found) => {
                write!(f, "expected the header `lat_deg,lon_deg` or `x_m,z_m` on line 1, found `{found}`")
            }
            Self::Count { line, found } => write!(f, "expected 2 values on line {line}, found {found}"),
            Self::Value { line, column, expected, found } => {
                write!(f, "expected {expected} on line {line}, column `{column}`, found `{found}`")
            }
        }
    }
}

impl std::error::Error for PointsError {}

/// Reads points from a file's bytes.
///
/// # Errors
/// [`PointsError`] names the first line that is wrong.
pub fn parse(bytes: &[u8]) -> Result<Points, PointsError> {
    let text = std::str::from_utf8(bytes).map_err(|_| PointsError::Encoding)?;
    let mut lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines().enumerate();
    let header = lines.next().map_or("", |(_, line)| line);
    let geodetic = match header.split(',').map(str::trim).collect::<Vec<_>>().as_slice() {
        ["lat_deg", "lon_deg"] => true,
        ["x_m", "z_m"] => false,
        _ => return Err(PointsError::Header(shown(header))),
    };
    let (columns, names, ranges) = if geodetic {
        let names = ["a latitude within -90..=90", "a longitude within -180..=180"];
        (["lat_deg", "lon_deg"], names, [90.0, 180.0])
    } else {
        (["x_m", "z_m"], ["a finite number of metres"; 2], [f64::MAX, f64::MAX])
    };
    let mut points = Vec::new();
    for (index, text) in lines.filter(|(_, text)| !text.trim().is_empty()) {
        let line = index + 1;
        let Some((first, second)) = text.split_once(',').filter(|(_, second)| !second.contains(',')) else {
            return Err(PointsError::Count { line, found: text.split(',').count() });
        };
        let value = |text: &str, which: usize| match text.trim().parse::<f64>() {
            Ok(value) if value.abs() <= ranges[which] => Ok(value),
            _ => Err(PointsError::Value { line, column: columns[which], expected: names[which], found: shown(text) }),
        };
        points.push([value(first, 0)?, value(second, 1)?]);
    }
    Ok(if geodetic { Points::Geodetic(points) } else { Points::World(points) })
}

fn shown(text: &str) -> String {
    text.chars().take(60).flat_map(char::escape_debug).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_headers_are_read() {
        assert_eq!(
            parse(b"lat_deg,lon_deg\n42.5,77\n\n-1,-180\n"),
            Ok(Points::Geodetic(vec![[42.5, 77.0], [-1.0, -180.0]]))
        );
        assert_eq!(parse(b"\xef\xbb\xbfx_m, z_m\r\n1e5 , -2\r\n"), Ok(Points::World(vec![[1e5, -2.0]])));
        assert_eq!(parse(b"x_m,z_m"), Ok(Points::World(vec![])));
    }

    #[test]
    fn the_wrong_line_is_named() {
        let said = |text: &str| parse(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(
            said("x_m,z_m\n1,2\n1,nan\n"),
            "expected a finite number of metres on line 3, column `z_m`, found `nan`"
        );
        assert_eq!(
            said("lat_deg,lon_deg\n91,0\n"),
            "expected a latitude within -90..=90 on line 2, column `lat_deg`, found `91`"
        );
        assert_eq!(said("x_m,z_m\n1,2,3\n"), "expected 2 values on line 2, found 3");
        assert_eq!(said("x_m,z_m\n1\n"), "expected 2 values on line 2, found 1");
        assert_eq!(
            said("x_m,z_m\n1e999,0\n"),
            "expected a finite number of metres on line 2, column `x_m`, found `1e999`"
        );
        for header in ["", "lon_deg,lat_deg\n1,2", "1,2\n3,4", "x,z\n"] {
            assert!(matches!(parse(header.as_bytes()), Err(PointsError::Header(_))), "{header}");
        }
        assert_eq!(parse(b"x_m,z_m\n\xff,1\n"), Err(PointsError::Encoding));
    }

    #[test]
    fn no_bytes_make_it_panic() {
        // A fixed xorshift stream over the format's own alphabet, after a good header.
        let (alphabet, mut state) = (b"0123456789,.-+eE\n\r naif\xef\xbb\xff", 0x9e37_79b9_u32);
        for length in 0..2000 {
            let mut bytes = b"x_m,z_m\n".to_vec();
            for _ in 0..length % 40 {
                state ^= state << 13;
                state ^= state >> 17;
                state ^= state << 5;
                bytes.push(alphabet[state as usize % alphabet.len()]);
            }
            if let Ok(Points::World(points)) = parse(&bytes) {
                assert!(points.iter().flatten().all(|value| value.is_finite()));
            }
        }
    }
}
