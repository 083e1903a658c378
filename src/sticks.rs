//! Where a pilot's own bindings of sticks lie, and how they are read and kept.
//!
//! `$XDG_CONFIG_HOME/poligon/sticks.toml`, or `~/.config/poligon/sticks.toml`. What is there comes before the embedded
//! bindings; a file that is not understood is refused, never overwritten.

use crate::failure::Failure;
use crate::output;
use sim::input::profile::{self, Profile};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::{env, fs, io};

/// The pilot's file, whether it is there or not; `None` where there is no home.
pub fn own_file() -> Option<PathBuf> {
    let given = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let config = given("XDG_CONFIG_HOME").or_else(|| given("HOME").map(|home| home.join(".config")))?;
    Some(config.join("poligon").join("sticks.toml"))
}

/// Bindings of a file that is named, else of the pilot's own if there is one, and the embedded ones after them.
///
/// # Errors
/// [`Failure::Failed`] names the file that is not there or not understood.
pub fn bindings(named: Option<&Path>) -> Result<Arc<[Profile]>, Failure> {
    let own = own_file().filter(|file| file.is_file());
    let Some(file) = named.map(Path::to_owned).or(own) else { return Ok(profile::embedded()) };
    profile::with_embedded(&text(&file)?).map_err(|error| unread(&file, error))
}

/// Puts a profile into a file, in the place of one of the same device.
///
/// # Errors
/// [`Failure::Failed`] if what is there is not understood, or the file cannot be written.
pub fn keep(file: &Path, new: Profile) -> Result<(), Failure> {
    let there =
        if file.exists() { profile::parse(&text(file)?).map_err(|error| unread(file, error))? } else { Vec::new() };
    let others = there.into_iter().filter(|old| old.device != new.device).collect::<Vec<_>>();
    let profiles: Vec<Profile> = std::iter::once(new).chain(others).collect();
    output::write_whole(file, profile::written(&profiles).as_bytes())
}

fn text(file: &Path) -> Result<String, Failure> {
    let long = |bytes: u64| io::Error::other(format!("expected at most {} bytes, found {bytes}", profile::MOST_BYTES));
    fs::metadata(file)
        .and_then(|about| if about.len() > profile::MOST_BYTES as u64 { Err(long(about.len())) } else { Ok(()) })
        .and_then(|()| fs::read_to_string(file))
        .map_err(|error| unread(file, error))
}

fn unread(file: &Path, error: impl std::fmt::Display) -> Failure {
    Failure::Failed(format!("{}: {error}", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_takes_the_place_of_its_devices_and_what_is_not_understood_stays() {
        let folder = env::temp_dir().join(format!("poligon-sticks-{}", std::process::id()));
        let file = folder.join("sticks.toml");
        let of =
            |device, name: &str| Profile { device: Some((device, 1)), name: name.to_owned(), ..Profile::default() };
        keep(&file, of(1, "first")).unwrap();
        keep(&file, of(2, "second")).unwrap();
        keep(&file, of(1, "again")).unwrap();
        let names: Vec<String> = bindings(Some(&file)).unwrap().iter().map(|profile| profile.name.clone()).collect();
        assert_eq!(names[..2], ["again", "second"]);
        assert_eq!(names.len(), 2 + profile::embedded().len());
        fs::write(&file, "wheels = 3").unwrap();
        assert!(keep(&file, of(3, "third")).is_err() && bindings(Some(&file)).is_err());
        assert_eq!(fs::read_to_string(&file).unwrap(), "wheels = 3");
        assert!(bindings(Some(&folder.join("none"))).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }
}
