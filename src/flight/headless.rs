//! Lockstep: a fixed step a frame, every block waited for. The same input gives the same hashes.

use super::device_failed;
use super::inputs;
use super::pictures;
use super::plan::{LOCKSTEP_HZ, Length, Plan};
use super::record::{Ending, Record, RunningHash};
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::report::Fly;
use crate::scenery::{Look, Scenery};
use crate::stage::marks::Marks;
use crate::stage::{self, Captions, Seat, Sun};
use sim::clock::DEFAULT_STEP_HZ;
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
    let length = length.scripted(args, &plan);
    let date = plan.date(args, &world)?;
    let mut ground = scenery.scene_ground();
    let mut marks = Marks::default();
    let mut scene = plan.scene(&world, date, args.inputs.is_none())?;
    inputs::prepare(args, &mut scene)?;
    let mut seat = Seat::new(&world, &scene, args.camera);
    let mut sun = Sun::new(&world, date)?;
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
        let mut step = || {
            let snapshot = sim::advance(&mut scene, &mut ground);
            sim_hash.add(snapshot.hash());
            marks.leave(&snapshot.events, &snapshot, &mut scenery);
            snapshot
        };
        let mut snapshot = step();
        for _ in 1..STEPS {
            snapshot = step();
        }
        steps = snapshot.step;
        let seen = seat.view(&mut scenery, &snapshot, look.size_px);
        let view = &seen.view;
        let heavens = sun.at(&world, snapshot.date);
        record.follow(&mut scenery, view, &snapshot, heavens);
        let captions = Captions { frame_ms: f64::NAN, ..Captions::default() };
        let hud = stage::hud(&world, &snapshot, &seen, &heavens, captions);
        scenery.draw(view, heavens, snapshot.time_s, hud, &target.view).map_err(device_failed)?;
        scenery.gpu.wait().map_err(device_failed)?;
        record.frame(&scenery, view, &snapshot, None);
        bar.show((frame + 1) as f64 / frames as f64);
    }
    drop(bar);
    inputs::keep(args, &scene)?;
    let last = target.read(&scenery.gpu).map_err(device_failed)?;
    let ending = Ending {
        mode: "lockstep",
        flown_s: record.frames().saturating_sub(1) as f64 / LOCKSTEP_HZ,
        steps,
        sim_hash: sim_hash.shown(),
    };
    let mut report = record.report(&scenery, &ending);
    let mut taken = pictures::take(scenery, &plan, args, date)?;
    taken.hash.add(last.hash());
    report.image_hash = Some(taken.hash.shown());
    report.shots = taken.files.iter().map(|file| file.display().to_string()).collect();
    Ok(report)
}
