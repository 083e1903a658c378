//! Shapes of a world's own: `models/NAME.glb` in its folder replaces the generated shape of that name.
//!
//! Names are those of [`Model::name`], such as `truck` or `control_tower`. A texture that a file names is looked for
//! beside it and nowhere else.

use crate::failure::Failure;
use std::path::{Component, Path};
use visual::models::things::{MODELS, Model};
use visual::models::{Mesh, glb};

/// The folder's shapes; none where there is no such folder.
///
/// # Errors
/// [`Failure::Failed`] names the file that is no shape, what was expected and what was found.
pub fn own(world: Option<&Path>) -> Result<Vec<(Model, Mesh)>, Failure> {
    let Some(folder) = world.map(|world| world.join("models")).filter(|folder| folder.is_dir()) else {
        return Ok(Vec::new());
    };
    let mut found = Vec::new();
    for model in MODELS {
        let path = folder.join(format!("{}.glb", model.name()));
        if !path.is_file() {
            continue;
        }
        let failed = |error: String| Failure::Failed(format!("{}: {error}", path.display()));
        let bytes = bounded(&path).map_err(failed)?;
        let mesh = glb::from_glb(&bytes, |name| beside(&folder, name)).map_err(|error| failed(error.to_string()))?;
        found.push((model, mesh));
    }
    Ok(found)
}

fn bounded(path: &Path) -> Result<Vec<u8>, String> {
    let length = std::fs::metadata(path).map_err(|error| error.to_string())?.len();
    if length > glb::MAX_BYTES as u64 {
        return Err(format!("expected at most {} bytes, found {length}", glb::MAX_BYTES));
    }
    std::fs::read(path).map_err(|error| error.to_string())
}

fn beside(folder: &Path, name: &str) -> Option<Vec<u8>> {
    let inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    inside.then(|| bounded(&folder.join(name)).ok()).flatten()
}
