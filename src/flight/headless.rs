//! Lockstep: a fixed step a frame, every block waited for. The same input gives the same hashes.

use super::device_failed;
use super::pictures;
use super::plan::{LOCKSTEP_HZ, Length, Plan};
use super::record::{Ending, Record, RunningHash};
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::report::Fly;
use crate::scenery::{self, Look, Scenery};
use crate::stage::{self, Captions, Sun};
use sim::clock::DEFAULT_STEP_HZ;
use sim::input::Head;
use std::sync::Arc;
use std::time::Instant;
use terrain::store::World;
use visual::Gpu;
use visual::capture::{self, Offscreen};

/// Steps of the simulation a frame.
const STEPS: u32 = DEFAULT_STEP_HZ / LOCKSTEP_HZ as u32;

/// Flies the plan and takes its pictures.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn fly(args: &FlyArgs, world: Arc<World>, started: Instant) -> Result<Fly, Failure> {
    let gpu = Gpu::headless().map_err(|error| Failure::while_doing("flying headless", error))?;
    let look = Look::of(&args.view, gpu.report.kind, true);
    let target = Offscreen::new(&gpu, look.size_px).map_err(device_failed)?;
    let mut scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), look);
    scenery.use_models_of(args.world.as_deref())?;
    let length = Length::of(args, true);
    let plan = Plan::new(args, length, LOCKSTEP_HZ, &world, &scenery.area)?;
    let date = args.view.time.unwrap_or_else(|| scenery::default_moment(&world));
    let ground = scenery.scene_ground();
    let mut scene = plan.flight(date)?;
    let mut sun = Sun::new(&world, date)?;
    let head = Head::default();
    let frames = match length {
        Length::Frames(frames) => frames,
        Length::Seconds(seconds_s) => (seconds_s * LOCKSTEP_HZ).round().max(1.0) as u64,
        Length::Endless => 1,
    };

    let mut record = Record::new(started, true);
    let mut sim_hash = RunningHash::default();
    let mut steps = 0;
    let bar = Progress::new("flying");
    for frame in 0..frames {
        let mut snapshot = sim::lockstep(&mut scene, &ground, 1);
        sim_hash.add(snapshot.hash());
        for _ in 1..STEPS {
            snapshot = sim::lockstep(&mut scene, &ground, 1);
            sim_hash.add(snapshot.hash());
        }
        steps = snapshot.step;
        let view = scenery.view(stage::eye_m(&snapshot), stage::attitude(&snapshot, &head), look.size_px);
        let heavens = sun.at(&world, snapshot.date);
        record.follow(&mut scenery, &view, &snapshot, heavens);
        let captions = Captions { frame_ms: f64::NAN, ..Captions::default() };
        let hud = stage::hud(&world, &snapshot, &view, &head, captions);
        scenery.draw(&view, heavens, snapshot.time_s, hud, &target.view).map_err(device_failed)?;
        scenery.gpu.wait().map_err(device_failed)?;
        record.frame(&scenery, &view, &snapshot, None);
        bar.show((frame + 1) as f64 / frames as f64);
    }
    drop(bar);
    let last = target.read(&scenery.gpu).map_err(device_failed)?;
    let ending = Ending {
        mode: "lockstep",
        flown_s: record.frames().saturating_sub(1) as f64 / LOCKSTEP_HZ,
        steps,
        sim_hash: sim_hash.shown(),
    };
    let mut report = record.report(&scenery, &ending);
    let mut taken = pictures::take(scenery, &plan, date, &args.shots)?;
    taken.hash.add(last.hash());
    report.image_hash = Some(taken.hash.shown());
    report.shots = taken.files.iter().map(|file| file.display().to_string()).collect();
    Ok(report)
}
