//! `poligon bake`: elevation data in, a world out.

use crate::args::BakeArgs;
use crate::failure::Failure;
use crate::output::{self, Output};
use crate::progress::Progress;
use crate::report;
use crate::verbs::info;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;
use std::time::Instant;
use terrain::Geodetic;
use terrain::bake::{BakeRequest, Input};
use terrain::store::{FeatureCount, World};

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &BakeArgs, output: Output) -> Result<(), Failure> {
    let name = world_name(&args.out)?;
    let failed = |error: &dyn std::fmt::Display| Failure::while_doing("baking", error);
    // Asked before the work, so that a mistyped --out does not cost it.
    World::may_be_written(&args.out).map_err(|error| failed(&error))?;

    let started = Instant::now();
    let request = BakeRequest {
        name,
        sources: args.dem.iter().map(|path| source(path)).collect(),
        features: args.features.iter().cloned().map(Input::File).collect(),
        imagery: args.imagery.clone(),
        step_m: args.step_m,
        centre: args.centre.map(|centre| Geodetic::from_degrees(centre.lat_deg, centre.lon_deg)),
        size_km: args.size_km.map(|size| [size.width_km, size.height_km]),
    };
    let bar = Progress::new("baking");
    let world = terrain::bake::bake(&request, &mut |stage, share| bar.show_stage(stage, share.into()))
        .map_err(|error| failed(&error))?;
    bar.show_stage("writing", 1.0);
    world.write(&args.out).map_err(|error| failed(&error))?;
    drop(bar);

    for source in world.info.sources.iter().filter(|source| !source.note.is_empty()) {
        output::tell(format_args!("poligon: {}: {}", source.file, source.note));
    }
    for (kind, count) in world.info.features.iter().filter(|(_, count)| count.read > 0) {
        output::tell(format_args!("poligon: {}", told(kind, count)));
    }
    let described = info::describe(&world.info);
    output.print(&report::WorldReport { wall_s: Some(started.elapsed().as_secs_f64()), ..described })
}

/// What became of the features of a kind, in a line.
fn told(kind: &str, count: &FeatureCount) -> String {
    let list = |numbers: &BTreeMap<String, usize>| {
        let all: Vec<String> = numbers.iter().map(|(what, number)| format!("{number} {what}")).collect();
        all.join(", ")
    };
    let mut line = format!("{kind}: {} of {} kept", count.kept, count.read);
    if count.skipped > 0 {
        line += &format!("; left out: {}", list(&count.skipped_for));
    }
    if !count.notes.is_empty() {
        line += &format!("; {}", list(&count.notes));
    }
    line
}

/// A source, with the height scale that may follow its name. A path that is not UTF-8 has none.
fn source(path: &Path) -> (Input, f64) {
    path.to_str().map_or_else(|| (Input::File(path.to_owned()), 1.0), Input::parse)
}

/// The world's name out of `NAME.world`.
fn world_name(out: &Path) -> Result<String, Failure> {
    let named = out.extension() == Some(OsStr::new("world"));
    out.file_stem().filter(|_| named).map(|stem| stem.to_string_lossy().into_owned()).ok_or_else(|| {
        Failure::Misuse(format!("--out: expected a folder name that ends in .world, found `{}`", out.display()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_world_is_named_for_its_folder() {
        assert_eq!(world_name(Path::new("a/Tian Shan.world")), Ok("Tian Shan".into()));
        assert_eq!(world_name(Path::new("a/b.c.world/")), Ok("b.c".into()));
        for wrong in ["", "a", "a.World", "a.world.d", ".world", "a.world/.."] {
            let Err(Failure::Misuse(said)) = world_name(Path::new(wrong)) else { panic!("{wrong} was taken") };
            assert!(said.contains("ends in .world, found `"), "{said}");
        }
    }
}
