//! Making the default world: the whole bake beside `gdalwarp -et 0` to the same posts with the same kernel.
//!
//! Both read the same GeoTIFF file and write their result to disk. Ours also fills voids, sets the lake and makes the
//! masks. GDAL runs as a process of its own, once as it comes (one thread) and once on all cores; ours uses all cores.
//! At 200 m the posts are finer than the source (15 arc seconds), where our kernel is bilinear interpolation.

use super::statistics::{Against, Better, alone, beside};
use crate::failure::Failure;
use crate::report::{BenchResult, Skipped};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use terrain::bake::{self, Input};
use terrain::store::World;

/// The stages that the bake names, in order.
const STAGES: [&str; 5] = ["reading", "resampling", "filling voids", "lakes", "masks"];

/// Results, or why GDAL could not be compared with.
pub struct Baked {
    /// Ours, beside GDAL's where it is there.
    pub results: Vec<BenchResult>,
    /// What is missing.
    pub skipped: Vec<Skipped>,
}

/// Bakes the default world in turns with GDAL, `rounds` times after one that does not count.
///
/// # Errors
/// [`Failure::Failed`] if the folder for results cannot be written or the bake fails.
pub fn bench(rounds: u32) -> Result<Baked, Failure> {
    let folder = Scratch::new()?;
    let request = bake::default_request();
    let Some((Input::Embedded(elevation), _)) = request.sources.first() else {
        return Err(Failure::Failed("the default world has no embedded elevation".into()));
    };
    let source = folder.0.join(elevation.name);
    fs::write(&source, elevation.content).map_err(|e| Failure::while_doing(source.display(), e))?;
    let mut request = request.clone();
    request.sources = vec![(Input::File(source.clone()), 1.0)];
    let version = gdal_version();

    let (mut ours, mut one, mut many) = (Vec::new(), Vec::new(), Vec::new());
    let mut stages = vec![Vec::new(); STAGES.len()];
    for round in 0..=rounds {
        let place = folder.0.join("ours.world");
        let start = Instant::now();
        let mut begun: Vec<(usize, f64)> = Vec::new();
        let world = bake::bake(&request, &mut |stage, _| {
            if let Some(at) = STAGES.iter().position(|name| *name == stage)
                && begun.last().is_none_or(|last| last.0 != at)
            {
                begun.push((at, start.elapsed().as_secs_f64()));
            }
        })
        .map_err(|error| Failure::while_doing("baking the default world", error))?;
        let baked_s = start.elapsed().as_secs_f64();
        world.write(&place).map_err(|error| Failure::while_doing("writing the default world", error))?;
        let ours_s = start.elapsed().as_secs_f64();
        let warps = version
            .is_ok()
            .then(|| {
                let out = folder.0.join("gdal.tif");
                Ok::<_, Failure>((warp_s(&source, &out, &world, false)?, warp_s(&source, &out, &world, true)?))
            })
            .transpose()?;
        if round == 0 {
            continue;
        }
        ours.push(ours_s);
        for (which, &(stage, from_s)) in begun.iter().enumerate() {
            stages[stage].push(begun.get(which + 1).map_or(baked_s, |next| next.1) - from_s);
        }
        if let Some((one_s, many_s)) = warps {
            one.push(one_s);
            many.push(many_s);
        }
    }

    let note = "400 x 400 km at 200 m from the GeoTIFF, written to disk; all cores";
    let mut results = Vec::new();
    let mut skipped = Vec::new();
    match &version {
        Ok(version) => {
            let name = "gdalwarp -et 0 -r bilinear";
            let against = Against { name, version, values: &one };
            results.push(beside("bake", "s", Better::Less, &ours, against, note));
            let name = "gdalwarp -et 0 -r bilinear -multi -wo NUM_THREADS=ALL_CPUS";
            let against = Against { name, version, values: &many };
            results.push(beside("bake, GDAL on all cores too", "s", Better::Less, &ours, against, note));
        }
        Err(reason) => {
            results.push(alone("bake", "s", &ours, note));
            skipped.push(Skipped { name: "bake beside gdalwarp".into(), reason: reason.clone() });
        }
    }
    for (name, times_s) in STAGES.iter().zip(&stages).filter(|(_, times)| !times.is_empty()) {
        results.push(alone(&format!("bake, {name}"), "s", times_s, ""));
    }
    Ok(Baked { results, skipped })
}

/// A folder of this process's own among the temporary ones; gone when dropped.
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> Result<Self, Failure> {
        let path = std::env::temp_dir().join(format!("poligon-bench-{}", std::process::id()));
        fs::create_dir_all(&path).map_err(|e| Failure::while_doing(path.display(), e))?;
        Ok(Self(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The version of the installed GDAL, or why there is none.
fn gdal_version() -> Result<String, String> {
    let output = Command::new("gdalwarp")
        .arg("--version")
        .output()
        .map_err(|error| format!("expected gdalwarp on the path (Debian: gdal-bin), found none: {error}"))?;
    // "GDAL 3.6.2, released 2023/01/02"
    let text = String::from_utf8_lossy(&output.stdout);
    let version = text.trim().strip_prefix("GDAL ").and_then(|rest| rest.split(',').next());
    version.map(str::to_owned).ok_or_else(|| format!("expected gdalwarp to tell its version, found `{}`", text.trim()))
}

/// Seconds that gdalwarp takes to the same posts: they are pixel centres, so its area is half a step wider.
fn warp_s(source: &Path, out: &Path, world: &World, all_cores: bool) -> Result<f64, Failure> {
    let grid = world.field.grid();
    let centre = world.projection.centre();
    let half_m = 0.5 * grid.step_m;
    let system =
        format!("+proj=tmerc +lat_0={} +lon_0={} +k=1 +datum=WGS84 +units=m", centre.lat_deg(), centre.lon_deg());
    let mut command = Command::new("gdalwarp");
    command.args(["-q", "-overwrite", "-et", "0", "-r", "bilinear", "-ot", "Float32", "-t_srs", &system]);
    let extent = [grid.west_m - half_m, -grid.south_m() - half_m, grid.east_m() + half_m, -grid.north_m + half_m];
    command.arg("-te").args(extent.map(|edge_m| edge_m.to_string()));
    command.arg("-ts").args([grid.columns().to_string(), grid.rows().to_string()]);
    if all_cores {
        command.args(["-multi", "-wo", "NUM_THREADS=ALL_CPUS"]);
    }
    command.arg(source).arg(out).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
    let start = Instant::now();
    let output = command.output().map_err(|error| Failure::while_doing("running gdalwarp", error))?;
    let seconds = start.elapsed().as_secs_f64();
    if !output.status.success() {
        let told = String::from_utf8_lossy(&output.stderr);
        return Err(Failure::Failed(format!("gdalwarp: expected success, found {}: {}", output.status, told.trim())));
    }
    Ok(seconds)
}
