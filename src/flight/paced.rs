//! Paced: frames against the wall clock, headless. Nothing is waited for but the device, as with a window.
//!
//! The simulation runs on its own thread, so 300 m/s are 300 m/s however long a frame takes. A frame's time is from
//! sampling the eye to the device's completion; what is measured about it comes after, and then the rest of its period
//! is slept. Every [`SEARCHED`]th frame is searched for holes.

use super::device_failed;
use super::holes;
use super::pictures;
use super::plan::{Length, Plan};
use super::record::{Ending, Record};
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::report::{self, Fly};
use crate::scenery::{self, Look, Scenery};
use crate::stage::{self, Captions, Sun};
use sim::SimThread;
use sim::input::Head;
use sim::run::Message;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrain::store::World;
use visual::Gpu;
use visual::capture::{self, Offscreen};

/// One frame in this many is searched for holes; the first is.
const SEARCHED: u64 = 100;

/// Flies the plan at a pace and takes its pictures.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn fly(args: &FlyArgs, hz: f64, world: Arc<World>, started: Instant) -> Result<Fly, Failure> {
    let gpu = Gpu::headless().map_err(|error| Failure::while_doing("flying headless", error))?;
    let look = Look::of(&args.view, gpu.report.kind, false);
    // Several samples a pixel have no depth that could be read: holes are then not counted.
    let look = Look { keep_depth: look.msaa == 1, ..look };
    let target = Offscreen::new(&gpu, look.size_px).map_err(device_failed)?;
    let mut scenery = Scenery::new(gpu, capture::FORMAT, world.clone(), look);
    scenery.use_models_of(args.world.as_deref())?;
    let length = Length::of(args, true);
    let plan = Plan::new(args, length, hz, &world, &scenery.area)?;
    let date = args.view.time.unwrap_or_else(|| scenery::default_moment(&world));
    let ground = scenery.scene_ground();
    let mut scene = plan.flight(date)?;
    sim::lockstep(&mut scene, &ground, 1);
    // Held until the first picture, which takes as long as filling the window does.
    scene.clock.set_paused(true);
    let sim =
        SimThread::start(scene, ground).map_err(|error| Failure::while_doing("starting the simulation", error))?;
    let mut sun = Sun::new(&world, date)?;
    let head = Head::default();
    let period = Duration::from_secs_f64(1.0 / hz);

    let mut record = Record::new(started, false);
    let mut frame_ms = f64::NAN;
    let mut begun = Instant::now();
    let bar = Progress::new("flying");
    loop {
        let frame_start = Instant::now();
        let snapshot = sim.now();
        let view = scenery.view(stage::eye_m(&snapshot), stage::attitude(&snapshot, &head), look.size_px);
        let heavens = sun.at(&world, snapshot.date);
        record.follow(&mut scenery, &view, &snapshot, heavens);
        let hud = stage::hud(&world, &snapshot, &view, &head, Captions { frame_ms, ..Captions::default() });
        scenery.draw(&view, heavens, snapshot.time_s, hud, &target.view).map_err(device_failed)?;
        scenery.gpu.wait().map_err(device_failed)?;
        let took = frame_start.elapsed();
        frame_ms = took.as_secs_f64() * 1e3;
        record.frame(&scenery, &view, &snapshot, Some(took));
        if record.frames() % SEARCHED == 1
            && let Some(found) = holes::count(&scenery, &view)?
        {
            record.add_holes(found);
        }
        if record.frames() == 1 {
            sim.send(Message::Paused(false));
            begun = Instant::now();
        }
        let share = match length {
            Length::Frames(frames) => record.frames() as f64 / frames as f64,
            Length::Seconds(seconds_s) => begun.elapsed().as_secs_f64() / seconds_s,
            Length::Endless => 1.0,
        };
        bar.show(share);
        if share >= 1.0 {
            break;
        }
        if !sim.is_running() {
            break;
        }
        std::thread::sleep(period.saturating_sub(frame_start.elapsed()));
    }
    drop(bar);
    let flown_s = begun.elapsed().as_secs_f64();
    let scene = sim.stop().map_err(|error| Failure::Failed(error.to_string()))?;
    let last = scene.snapshot();
    if last.slowed_s > 0.05 {
        output::tell(format_args!(
            "poligon: the simulation was slowed by {:.1} s of {flown_s:.1} s: this machine is too busy",
            last.slowed_s
        ));
    }
    let ending = Ending { mode: "paced", flown_s, steps: last.step, sim_hash: report::hash(last.hash()) };
    let mut report = record.report(&scenery, &ending);
    let taken = pictures::take(scenery, &plan, date, &args.shots)?;
    report.image_hash = Some(taken.hash.shown());
    report.shots = taken.files.iter().map(|file| file.display().to_string()).collect();
    Ok(report)
}
