//! The weapons and kinds of targets that are embedded, and the catalogue of a scene with all of them.

use super::{TargetKind, Weapon};
use crate::file::FileError;
use crate::scene::{Catalogue, Refused};
use std::path::Path;

macro_rules! embedded {
    ($folder:literal: $($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../assets/", $folder, "/", $name, ".toml")))),*]
    };
}

/// Names and files of the embedded weapons.
pub const WEAPONS: [(&str, &str); 6] = embedded!("weapons": "gsh23", "m61", "s5", "hydra70", "mk82", "fab250");

/// Names and files of the embedded kinds of targets.
pub const TARGETS: [(&str, &str); 8] =
    embedded!("targets": "truck", "apc", "tank", "radar", "bunker", "hangar", "parked_aircraft", "ship");

/// An embedded weapon.
///
/// # Errors
/// [`FileError`] names those that there are.
pub fn weapon(name: &str) -> Result<Weapon, FileError> {
    Weapon::from_text(Path::new(name), text("weapon", &WEAPONS, name)?)
}

/// An embedded kind of target.
///
/// # Errors
/// [`FileError`] names those that there are.
pub fn target_kind(name: &str) -> Result<TargetKind, FileError> {
    TargetKind::from_text(Path::new(name), text("target", &TARGETS, name)?)
}

fn text(what: &str, all: &[(&'static str, &'static str)], name: &str) -> Result<&'static str, FileError> {
    let missing = || {
        let known: Vec<&str> = all.iter().map(|(known, _)| *known).collect();
        FileError::new(name, format_args!("{what}: expected one of [{}], found {name}", known.join(", ")))
    };
    all.iter().find(|(known, _)| *known == name).map(|(_, text)| *text).ok_or_else(missing)
}

/// Adds everything embedded to a catalogue.
///
/// # Errors
/// [`Refused`] if a name is taken.
pub fn add_all(catalogue: &mut Catalogue) -> Result<(), Refused> {
    for (name, _) in WEAPONS {
        catalogue.add_weapon(name, weapon(name).map_err(Refused::new)?)?;
    }
    for (name, _) in TARGETS {
        catalogue.add_target_kind(name, target_kind(name).map_err(Refused::new)?)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_embedded_is_sound() {
        let mut catalogue = Catalogue::new();
        add_all(&mut catalogue).unwrap();
        assert!(add_all(&mut catalogue).unwrap_err().to_string().contains("not taken"));
        assert!(weapon("v2").unwrap_err().to_string().contains("expected one of [gsh23, m61"));
    }
}
