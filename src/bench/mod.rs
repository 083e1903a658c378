//! What `poligon bench` measures: one subject a file, each beside a yardstick in the same run.
//!
//! Rounds are interleaved and summed up in [`statistics`]. Nothing is asserted about time here or in any test: figures
//! are for people, and for a machine that does nothing else meanwhile.

pub mod bake;
pub mod cameras;
pub mod flight;
pub mod frame;
pub mod ground;
pub mod mesh;
pub mod plants;
pub mod scene;
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
pub mod tests {
    use super::*;
    use glam::DVec2;
    use terrain::bake::{self, BakeRequest, Bytes, Input};
    use terrain::store::World;

    /// What a world of 24 x 24 km is baked from: an SRTM file made up here, ridges to some 3,000 m.
    pub fn tiny_request() -> BakeRequest {
        const SIDE: usize = 1201;
        let ridge = |at: DVec2| 1_500.0 * (1.0 + (at.x * 0.05).sin() * (at.y * 0.07).cos());
        let content: Vec<u8> = (0..SIDE * SIDE)
            .flat_map(|at| (ridge(DVec2::new((at % SIDE) as f64, (at / SIDE) as f64)) as i16).to_be_bytes())
            .collect();
        // Embedded input is static; a test's few megabytes may stay.
        let bytes = Bytes { name: "N42E078.hgt", content: content.leak() };
        BakeRequest {
            name: "tiny".into(),
            sources: vec![(Input::Embedded(bytes), 1.0)],
            features: Vec::new(),
            imagery: Vec::new(),
            step_m: 200.0,
            centre: None,
            size_km: Some([24.0, 24.0]),
        }
    }

    /// The world of that.
    pub fn tiny_world() -> World {
        bake::bake(&tiny_request(), &mut |_, _| ()).unwrap()
    }

    #[test]
    fn the_lock_file_tells_versions() {
        assert!(locked_version("parry3d-f64").starts_with("0."));
        assert_eq!(locked_version("poligon"), OWN);
        assert_eq!(locked_version("no-such-package"), "unknown");
    }
}
