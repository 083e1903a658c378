//! The world that is there without any file: Issyk-Kul, baked once into the user's cache.
//!
//! The elevation, the lake's outline and the airfields are embedded; see `assets/README.md` for their sources. The cache folder is
//! named for the program's version of the format and a sum of the input, so a new one never reads an old world. Two
//! processes that bake at once both succeed: each writes beside and renames, and the second takes what it finds.

use super::bake_world::{BakeRequest, Bytes, Input, bake};
use super::error::BakeError;
use crate::projection::Geodetic;
use crate::store::{FORMAT_VERSION, World};
use std::path::{Path, PathBuf};

const ELEVATION: Bytes = Bytes {
    name: "gebco2023_15s_tianshan_400km.tif",
    content: include_bytes!("../../../assets/worlds/issyk_kul/gebco2023_15s_tianshan_400km.tif"),
};
const LAKES: Bytes =
    Bytes { name: "lakes.geojson", content: include_bytes!("../../../assets/worlds/issyk_kul/lakes.geojson") };
const AIRFIELDS: Bytes =
    Bytes { name: "airfields.csv", content: include_bytes!("../../../assets/worlds/issyk_kul/airfields.csv") };

/// To be raised when the bake makes other posts, or another description, from the same input.
const BAKE_VERSION: u32 = 5;

/// The default world and where it is kept.
pub struct DefaultWorld {
    /// The world.
    pub world: World,
    /// Its folder, or why it could not be kept and must be baked again next time.
    pub kept: Result<PathBuf, String>,
}

/// The default world from the user's cache (`$XDG_CACHE_HOME/poligon`, else `~/.cache/poligon`), baked if it is not
/// there. If the cache cannot be used the world is in memory only and `kept` says why.
///
/// # Errors
/// [`BakeError`] as [`bake`].
pub fn default_world(progress: &mut dyn FnMut(&str, f32)) -> Result<DefaultWorld, BakeError> {
    match cache_folder() {
        Ok(folder) => default_world_in(&folder, progress),
        Err(reason) => Ok(DefaultWorld { world: bake(&default_request(), progress)?, kept: Err(reason) }),
    }
}

/// The default world from a cache folder.
fn default_world_in(folder: &Path, progress: &mut dyn FnMut(&str, f32)) -> Result<DefaultWorld, BakeError> {
    let path = folder.join(folder_name());
    if let Ok(world) = World::read(&path) {
        return Ok(DefaultWorld { world, kept: Ok(path) });
    }
    let world = bake(&default_request(), progress)?;
    let refused = |error: &dyn std::fmt::Display| format!("the default world cannot be kept for next time: {error}");
    let kept = match std::fs::create_dir_all(folder) {
        Err(error) => Err(refused(&format!("{}: {error}", folder.display()))),
        Ok(()) => match world.write(&path) {
            Ok(()) => Ok(path),
            // Another process may have been first.
            Err(_) if World::read(&path).is_ok() => Ok(path),
            Err(error) => Err(refused(&error)),
        },
    };
    Ok(DefaultWorld { world, kept })
}

/// What the default world is baked from: everything is embedded.
pub fn default_request() -> BakeRequest {
    BakeRequest {
        name: "Issyk-Kul".into(),
        sources: vec![(Input::Embedded(ELEVATION), 1.0)],
        features: vec![Input::Embedded(LAKES), Input::Embedded(AIRFIELDS)],
        imagery: Vec::new(),
        step_m: 200.0,
        centre: Some(Geodetic::from_degrees(42.425, 78.35)),
        size_km: Some([400.0, 400.0]),
    }
}

fn folder_name() -> String {
    let mut sum = crc32fast::Hasher::new();
    sum.update(ELEVATION.content);
    sum.update(LAKES.content);
    sum.update(AIRFIELDS.content);
    format!("issyk_kul-{FORMAT_VERSION}.{BAKE_VERSION}-{:08x}.world", sum.finalize())
}

/// Where caches lie by the XDG base directory specification: a relative path there is to be ignored.
fn cache_folder() -> Result<PathBuf, String> {
    let folder = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    folder("XDG_CACHE_HOME")
        .or_else(|| folder("HOME").map(|home| home.join(".cache")))
        .map(|cache| cache.join("poligon"))
        .ok_or_else(|| {
            "the default world cannot be kept: expected a folder in XDG_CACHE_HOME or HOME, found none".into()
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_at_once_both_get_it() {
        let folder = std::env::temp_dir().join(format!("poligon-twice-{}", std::process::id()));
        let make = || default_world_in(&folder, &mut |_, _| ()).unwrap().kept.unwrap();
        let (a, b) = std::thread::scope(|scope| {
            let (a, b) = (scope.spawn(make), scope.spawn(make));
            (a.join().unwrap(), b.join().unwrap())
        });
        assert_eq!(a, b);
        let started = std::time::Instant::now();
        let world = World::read(&a).unwrap();
        println!("read in {:.1} ms", started.elapsed().as_secs_f64() * 1e3);
        assert_eq!(world.projection, bake(&default_request(), &mut |_, _| ()).unwrap().projection);
        // The lake is flat, and its posts are the level to the bit.
        assert_eq!(world.info.lakes[0].level_m, 1607.0);
        let level = world.field.heights_m().iter().filter(|h| **h == 1607.0).count();
        assert!(level >= world.info.lakes[0].posts && world.info.lakes[0].posts > 100_000);
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn it_is_baked_once_kept_and_made_again_if_damaged() {
        let folder = std::env::temp_dir().join(format!("poligon-default-{}", std::process::id()));
        let mut stages = 0;
        let first = default_world_in(&folder, &mut |_, _| stages += 1).unwrap();
        assert!(stages > 10);
        let path = first.kept.unwrap();
        stages = 0;
        let again = default_world_in(&folder, &mut |_, _| stages += 1).unwrap();
        assert_eq!(stages, 0);
        let bits = |world: &World| world.field.heights_m().iter().map(|h| h.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&first.world), bits(&again.world));
        std::fs::write(path.join("lakes.json"), "[]").unwrap();
        let mended = default_world_in(&folder, &mut |_, _| stages += 1).unwrap();
        assert!(stages > 10 && mended.kept.is_ok());
        // Not assert_eq: nobody wants to read the outlines.
        assert!(World::read(&path).unwrap().lakes == first.world.lakes);
        // A cache that cannot be made: the path goes through a file.
        let blocked = default_world_in(&path.join("world.toml"), &mut |_, _| ()).unwrap();
        assert!(blocked.kept.unwrap_err().contains("cannot be kept"));
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
