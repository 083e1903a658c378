//! A world's folder on disk: written whole or not at all, read with its sums checked.

use super::info::{FORMAT_VERSION, FileInfo, WorldInfo};
use std::fmt;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

pub(super) const INFO: &str = "world.toml";
const MAX_INFO_BYTES: u64 = 16 << 20;

/// Why a world cannot be read or written.
#[derive(Debug)]
pub enum StoreError {
    /// The disk refused.
    Io {
        /// Which file or folder.
        path: PathBuf,
        /// What it said.
        error: io::Error,
    },
    /// There is something, and it is not a world.
    NotAWorld {
        /// Which folder.
        path: PathBuf,
        /// What was found.
        found: String,
    },
    /// A file of the world is not what it must be.
    Damaged {
        /// Which file.
        path: PathBuf,
        /// What it must be.
        expected: String,
        /// What it is.
        found: String,
    },
}

impl fmt::Display for StoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io { path, error } => write!(f, "{}: {error}", path.display()),
            Self::NotAWorld { path, found } => {
                write!(f, "{}: expected a world (a folder with {INFO}), found {found}", path.display())
            }
            Self::Damaged { path, expected, found } => {
                write!(f, "{}: expected {expected}, found {found}", path.display())
            }
        }
    }
}

impl std::error::Error for StoreError {}

impl StoreError {
    pub(super) fn io(path: &Path, error: io::Error) -> Self {
        Self::Io { path: path.to_owned(), error }
    }

    pub(super) fn damaged(path: &Path, expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_owned(), expected: expected.into(), found: found.into() }
    }
}

/// Reads `world.toml`.
pub(super) fn read_info(folder: &Path) -> Result<WorldInfo, StoreError> {
    let not_a_world = |found: &str| StoreError::NotAWorld { path: folder.to_owned(), found: found.into() };
    let path = folder.join(INFO);
    let file = match fs::File::open(&path) {
        Ok(file) => file,
        Err(_) if !folder.exists() => return Err(not_a_world("nothing")),
        Err(_) if !folder.is_dir() => return Err(not_a_world("a file")),
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(not_a_world("a folder without it")),
        Err(error) => return Err(StoreError::io(&path, error)),
    };
    let mut bytes = Vec::new();
    file.take(MAX_INFO_BYTES).read_to_end(&mut bytes).map_err(|e| StoreError::io(&path, e))?;
    let text = String::from_utf8(bytes).map_err(|_| StoreError::damaged(&path, "UTF-8 text", "other bytes"))?;
    // The version first: another version may have other fields.
    let table: toml::Table =
        text.parse().map_err(|e: toml::de::Error| StoreError::damaged(&path, "TOML", e.message().to_owned()))?;
    match table.get("format_version").and_then(toml::Value::as_integer) {
        Some(version) if version == i64::from(FORMAT_VERSION) => {}
        Some(version) => {
            let expected = format!("format version {FORMAT_VERSION} (bake the world again with this program)");
            return Err(StoreError::damaged(&path, expected, format!("version {version}")));
        }
        None => return Err(StoreError::damaged(&path, "a format_version", "none")),
    }
    table
        .try_into()
        .map_err(|e: toml::de::Error| StoreError::damaged(&path, "a world's description", e.message().to_owned()))
}

/// Reads one of the other files; `bytes` is the length that it must have, if that is known.
pub(super) fn read_checked(
    folder: &Path,
    info: &WorldInfo,
    name: &str,
    bytes: Option<u64>,
) -> Result<Vec<u8>, StoreError> {
    let path = folder.join(name);
    let entry = info
        .file(name)
        .ok_or_else(|| StoreError::damaged(&folder.join(INFO), format!("an entry for {name}"), "none"))?;
    let expected = bytes.unwrap_or(entry.bytes);
    let length = match fs::metadata(&path) {
        Ok(metadata) => metadata.len(),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(StoreError::damaged(&path, format!("{expected} bytes"), "no such file"));
        }
        Err(error) => return Err(StoreError::io(&path, error)),
    };
    if length != expected || entry.bytes != expected {
        let found = format!("{length} and an entry of {}", entry.bytes);
        return Err(StoreError::damaged(&path, format!("{expected} bytes"), found));
    }
    let content = fs::read(&path).map_err(|e| StoreError::io(&path, e))?;
    let sum = crc32(&content);
    if sum != entry.crc32 {
        return Err(StoreError::damaged(&path, format!("CRC-32 {}", entry.crc32), sum));
    }
    Ok(content)
}

/// A folder that a person may put into a world, and that stays when another world takes its place.
const KEPT: &str = "models";

/// Whether all that is at a path is a world: anything else would be lost when a new one takes its place.
pub(super) fn may_be_replaced(path: &Path) -> Result<(), StoreError> {
    if path.symlink_metadata().is_err() {
        return Ok(());
    }
    let kept =
        |found: String| StoreError::NotAWorld { path: path.to_owned(), found: format!("{found}; it is not replaced") };
    if !path.join(INFO).is_file() {
        return Err(kept(if path.is_dir() { "another folder" } else { "a file" }.to_owned()));
    }
    for entry in fs::read_dir(path).map_err(|e| StoreError::io(path, e))? {
        let name = entry.map_err(|e| StoreError::io(path, e))?.file_name();
        let known = super::FILES.iter().any(|file| name == **file) || (name == KEPT && path.join(KEPT).is_dir());
        if !known {
            return Err(kept(format!("one with `{}` in it", name.to_string_lossy())));
        }
    }
    Ok(())
}

/// Writes a folder beside its place and renames it there.
pub(super) fn write_folder(path: &Path, info: &WorldInfo, files: &[(&str, &[u8])]) -> Result<(), StoreError> {
    may_be_replaced(path)?;
    let mut info = info.clone();
    info.format_version = FORMAT_VERSION;
    info.files = files
        .iter()
        .map(|(name, content)| FileInfo {
            name: (*name).to_owned(),
            bytes: content.len() as u64,
            crc32: crc32(content),
        })
        .collect();
    let text = toml::to_string_pretty(&info)
        .map_err(|e| StoreError::damaged(&path.join(INFO), "a description that TOML can hold", e.to_string()))?;

    let beside = beside(path, "new")?;
    let written = write_files(&beside, files, &text).and_then(|()| replace(&beside, path));
    if written.is_err() {
        let _ = fs::remove_dir_all(&beside);
    }
    written
}

fn write_files(folder: &Path, files: &[(&str, &[u8])], info: &str) -> Result<(), StoreError> {
    fs::create_dir_all(folder).map_err(|e| StoreError::io(folder, e))?;
    for (name, content) in files.iter().copied().chain([(INFO, info.as_bytes())]) {
        let path = folder.join(name);
        let write = || {
            let mut file = fs::File::create(&path)?;
            file.write_all(content)?;
            // The rename must not reach the disk before what it names.
            file.sync_all()
        };
        write().map_err(|e| StoreError::io(&path, e))?;
    }
    Ok(())
}

/// Puts the new folder in its place, with what of the old one is kept; the old one, if any, goes aside first and comes
/// back if that fails.
fn replace(new: &Path, path: &Path) -> Result<(), StoreError> {
    match fs::rename(new, path) {
        Ok(()) => return Ok(()),
        // A folder cannot be renamed onto one that is not empty: there is a world, perhaps another process's by now.
        Err(error) if !path.join(INFO).is_file() => return Err(StoreError::io(path, error)),
        Err(_) => {}
    }
    let old = beside(path, "old")?;
    fs::rename(path, &old).map_err(|e| StoreError::io(path, e))?;
    let (own, moved) = (old.join(KEPT), new.join(KEPT));
    let kept = if own.is_dir() { fs::rename(&own, &moved) } else { Ok(()) };
    if let Err(error) = kept.and_then(|()| fs::rename(new, path)) {
        let _ = fs::rename(&moved, &own);
        let _ = fs::rename(&old, path);
        return Err(StoreError::io(path, error));
    }
    // The new world is in place; what cannot be cleared away does no harm.
    let _ = fs::remove_dir_all(&old);
    Ok(())
}

/// A name in the same folder that no other process and no other call uses.
fn beside(path: &Path, what: &str) -> Result<PathBuf, StoreError> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let name = path.file_name().ok_or_else(|| {
        StoreError::io(path, io::Error::new(io::ErrorKind::InvalidInput, "expected a path that ends in a name"))
    })?;
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let beside = format!(".{}.{what}-{}-{number}", name.to_string_lossy(), std::process::id());
    Ok(path.with_file_name(beside))
}

fn crc32(content: &[u8]) -> String {
    format!("{:08x}", crc32fast::hash(content))
}
