//! Files that people write: read whole, checked before anything is done with them, refused with the file and the key.
//!
//! Invariant others rely on: no number that comes out of here is NaN or infinite, and no key was passed over.

use serde::de::{DeserializeOwned, Error as _};
use serde::{Deserialize, Deserializer};
use std::fmt;
use std::path::{Path, PathBuf};
use toml::Value;

/// Largest file that is read, bytes: a hundred times the largest table set that is known.
const MOST_BYTES: u64 = 64 << 20;

/// Why a file cannot be used.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileError {
    /// The file.
    pub file: PathBuf,
    /// What was expected and what was found, with the key or the line.
    pub why: String,
}

impl FileError {
    /// An error in a file.
    pub fn new(file: impl AsRef<Path>, why: impl fmt::Display) -> Self {
        Self { file: file.as_ref().to_owned(), why: why.to_string() }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.why.trim_end())
    }
}

impl std::error::Error for FileError {}

/// The text of a file.
///
/// # Errors
/// [`FileError`] if it cannot be read, is larger than 64 MiB or is not UTF-8.
pub fn text(file: &Path) -> Result<String, FileError> {
    let fail = |why: &dyn fmt::Display| FileError::new(file, why);
    let bytes = std::fs::metadata(file).map_err(|error| fail(&error))?.len();
    if bytes > MOST_BYTES {
        return Err(fail(&format_args!("expected at most {MOST_BYTES} bytes, found {bytes}")));
    }
    std::fs::read_to_string(file).map_err(|error| fail(&error))
}

/// A TOML file as data.
///
/// # Errors
/// [`FileError`] names the line, or the key whose number is not finite.
pub fn toml<T: DeserializeOwned>(file: &Path) -> Result<T, FileError> {
    toml_text(file, &text(file)?)
}

/// The same of a text; `file` is what errors call it.
///
/// # Errors
/// [`FileError`] names the line, or the key whose number is not finite.
pub fn toml_text<T: DeserializeOwned>(file: &Path, text: &str) -> Result<T, FileError> {
    let value: toml::Table = toml::from_str(text).map_err(|error| FileError::new(file, error))?;
    for (key, value) in &value {
        if let Some((key, found)) = not_finite(key, value) {
            return Err(FileError::new(file, format_args!("{key}: expected a finite number, found {found}")));
        }
    }
    toml::from_str(text).map_err(|error| {
        let told = error.to_string();
        let hint = if told.contains("invalid type: map, expected a sequence") {
            "\nhint: a table that may be there several times is written [[name]]"
        } else if told.contains("expected a sequence") {
            "\nhint: a list is written [a, b]"
        } else {
            ""
        };
        FileError::new(file, format_args!("{}{hint}", told.trim_end()))
    })
}

/// A list of exactly so many things: a longer one is refused too, which serde's arrays do not do.
fn whole<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(from: D) -> Result<[T; N], D::Error> {
    let all = Vec::<T>::deserialize(from)?;
    let found = all.len();
    all.try_into().map_err(|_| D::Error::custom(format_args!("expected a list of {N}, found {found}")))
}

/// Exactly so many numbers; for `deserialize_with`.
pub(crate) fn exactly<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[f64; N], D::Error> {
    whole(from)
}

/// The same where the key may be missing.
pub(crate) fn exactly_if<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Option<[f64; N]>, D::Error> {
    whole(from).map(Some)
}

/// A square of numbers.
pub(crate) fn square<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<[[f64; N]; N], D::Error> {
    whole::<D, Exactly<N>, N>(from).map(|rows| rows.map(|row| row.0))
}

/// Any number of rows of exactly so many numbers.
pub(crate) fn rows<'de, D: Deserializer<'de>, const N: usize>(from: D) -> Result<Vec<[f64; N]>, D::Error> {
    Vec::<Exactly<N>>::deserialize(from).map(|rows| rows.into_iter().map(|row| row.0).collect())
}

struct Exactly<const N: usize>([f64; N]);

impl<'de, const N: usize> Deserialize<'de> for Exactly<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        exactly(from).map(Self)
    }
}

/// The first number that is not finite, with the way to it.
fn not_finite(key: &str, value: &Value) -> Option<(String, f64)> {
    match value {
        Value::Float(found) if !found.is_finite() => Some((key.to_owned(), *found)),
        Value::Array(all) => all.iter().enumerate().find_map(|(i, value)| not_finite(&format!("{key}[{i}]"), value)),
        Value::Table(all) => all.iter().find_map(|(name, value)| not_finite(&format!("{key}.{name}"), value)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Sample {
        #[allow(dead_code)]
        rows: Vec<f64>,
        #[allow(dead_code)]
        #[serde(default, deserialize_with = "exactly_if")]
        pair: Option<[f64; 2]>,
    }

    #[test]
    fn what_is_wrong_is_named() {
        let read = |text| toml_text::<Sample>(Path::new("case.toml"), text).unwrap_err().to_string();
        assert!(toml_text::<Sample>(Path::new("case.toml"), "rows = [1.0, 2]").is_ok());
        assert!(read("rows = [1.0, nan]").starts_with("case.toml: rows[1]: expected a finite number"));
        assert!(read("rows = [-inf]").contains("found -inf"));
        assert!(read("rows = []\nrow = 3").contains("row"), "the unknown key is named");
        assert!(read("rows = [1.0").contains("line 1"));
        assert!(read("rows = []\npair = [1, 2, 3]").contains("expected a list of 2, found 3"));
        assert!(read("rows = []\npair = [1]").contains("expected a list of 2, found 1"));
        assert!(text(Path::new("no such file")).unwrap_err().to_string().contains("no such file"));
    }
}
