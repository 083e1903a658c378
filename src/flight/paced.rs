//! Paced: frames against the wall clock, headless. Nothing is waited for but the device, as with a window.
//!
//! The simulation runs on its own thread, so 300 m/s are 300 m/s however long a frame takes. A frame's time is from
//! sampling the eye to the device's completion; what is measured about it comes after, and then the rest of its period
//! is slept. Every [`SEARCHED`]th frame is searched for holes.

use super::device_failed;
use super::holes;
use super::inputs;
use super::pictures;
use super::plan::{Length, Plan};
use super::record::{Ending, Record};
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::output;
use crate::progress::Progress;
use crate::report::{self, Fly};
use crate::scenery::{Look, Scenery};
use crate::stage::marks::Marks;
use crate::stage::{self, Captions, Seat, Sun};
use sim::SimThread;
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
    let length = length.scripted(args, &plan);
    let date = plan.date(args, &world)?;
    let ground = scenery.scene_ground();
    let mut scene = plan.scene(&world, date, args.inputs.is_none())?;
    inputs::prepare(args, &mut scene)?;
    let mut seat = Seat::new(&world, &scene, args.camera);
    sim::lockstep(&mut scene, &ground, 1);
    // Held until the first picture, which takes as long as filling the window does.
    scene.clock.set_paused(true);
    let sim =
        SimThread::start(scene, ground).map_err(|error| Failure::while_doing("starting the simulation", error))?;
    let mut sun = Sun::new(&world, date)?;
    let period = Duration::from_secs_f64(1.0 / hz);

    let mut record = Record::new(started, false);
    let mut marks = Marks::default();
    let mut frame_ms = f64::NAN;
    let mut begun = Instant::now();
    let bar = Progress::new("flying");
    loop {
        let frame_start = Instant::now();
        // Before the snapshot, which then knows of all of them.
        let events = sim.take_events();
        let snapshot = sim.now();
        marks.leave(&events, &snapshot, &mut scenery);
        let seen = seat.view(&mut scenery, &snapshot, look.size_px);
        let view = &seen.view;
        let heavens = sun.at(&world, snapshot.date);
        record.follow(&mut scenery, view, &snapshot, heavens);
        let hud = stage::hud(&world, &snapshot, &seen, &heavens, Captions { frame_ms, ..Captions::default() });
        scenery.draw(view, heavens, snapshot.time_s, hud, &target.view).map_err(device_failed)?;
        scenery.gpu.wait().map_err(device_failed)?;
        let took = frame_start.elapsed();
        frame_ms = took.as_secs_f64() * 1e3;
        record.frame(&scenery, view, &snapshot, Some(took));
        if record.frames() % SEARCHED == 1
            && let Some(found) = holes::count(&scenery, view)?
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
    inputs::keep(args, &scene)?;
    let last = scene.snapshot();
    if last.slowed_s > 0.05 {
        output::tell(format_args!(
            "poligon: the simulation was slowed by {:.1} s of {flown_s:.1} s: this machine is too busy",
            last.slowed_s
        ));
    }
    let ending = Ending { mode: "paced", flown_s, steps: last.step, sim_hash: report::hash(last.hash()) };
    let mut report = record.report(&scenery, &ending);
    let taken = pictures::take(scenery, &plan, args, date)?;
    report.image_hash = Some(taken.hash.shown());
    report.shots = taken.files.iter().map(|file| file.display().to_string()).collect();
    Ok(report)
}
