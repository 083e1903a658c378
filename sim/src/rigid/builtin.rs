//! The embedded aircraft, by the names that a command line and a situation call them.

use super::Model;
use crate::file::FileError;
use std::path::Path;

/// Each name and its `M.toml`.
pub const ALL: [(&str, &str); 3] = [
    ("trainer", include_str!("../../../assets/aircraft/trainer.toml")),
    ("jet", include_str!("../../../assets/aircraft/jet.toml")),
    ("hover", include_str!("../../../assets/aircraft/hover.toml")),
];

/// The names, for a sentence.
pub fn names() -> String {
    ALL.map(|(name, _)| name).join(", ")
}

/// The embedded aircraft of a name; `None` if there is none.
///
/// # Errors
/// [`FileError`] never: a test reads them all.
pub fn named(name: &str) -> Option<Result<Model, FileError>> {
    let (_, text) = ALL.iter().find(|(known, _)| *known == name)?;
    Some(Model::from_text(Path::new(&format!("{name}.toml")), text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_one_is_sound_and_leaves_nothing_to_say() {
        for (name, _) in ALL {
            let model = named(name).unwrap().unwrap();
            assert!(model.notes.is_empty(), "{name}: {:?}", model.notes);
        }
        assert!(named("airship").is_none());
    }
}
