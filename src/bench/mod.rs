//! What `poligon bench` measures: one subject a file, each beside a yardstick in the same run.
//!
//! Rounds are interleaved and summed up in [`statistics`]. Nothing is asserted about time here or in any test: figures
//! are for people, and for a machine that does nothing else meanwhile.

pub mod bake;
pub mod cameras;
pub mod frame;
pub mod ground;
pub mod mesh;
pub mod statistics;

/// Version of a yardstick that is part of this program.
pub const OWN: &str = env!("CARGO_PKG_VERSION");

/// The version of a package that this program was built with; `unknown` if it is none of them.
pub fn locked_version(package: &str) -> &'static str {
    const LOCK: &str = include_str!("../../Cargo.lock");
    let head = format!("name = \"{package}\"");
    let mut lines = LOCK.lines().skip_while(|line| *line != head);
    let version = lines.nth(1).and_then(|line| line.strip_prefix("version = \"")?.strip_suffix('"'));
    version.unwrap_or("unknown")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lock_file_tells_versions() {
        assert!(locked_version("parry3d-f64").starts_with("0."));
        assert_eq!(locked_version("poligon"), OWN);
        assert_eq!(locked_version("no-such-package"), "unknown");
    }
}
