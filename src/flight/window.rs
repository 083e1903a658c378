//! A window: the pilot's flight, against the wall clock, with keyboard, mouse and stick.
//!
//! It begins on the built-in track, so that there is something to see at once; the first move of a stick or an arrow key
//! takes over. The devices are asked by the simulation's thread each time it wakes to step, so a stick's axis waits for a step
//! and not for a picture; keys, the mouse and the commands of a stick's buttons come between pictures. The eye is sampled after
//! the next image has been waited for, right before the frame is encoded. A frame's time is from one frame's beginning to the
//! next's. Latency is measured from an input that moves controls which were at rest.

use super::inputs;
use super::plan::{LOCKSTEP_HZ, Length, Plan};
use super::record::{Ending, Record};
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::output;
use crate::report::{self, Fly};
use crate::scenery::{Heavens, Look, Scenery};
use crate::stage::cameras::Camera;
use crate::stage::marks::Marks;
use crate::stage::{self, Captions, Seat, Sun};
use crate::sticks;
use sim::input::joystick::Joystick;
use sim::input::{Hands, Input};
use sim::run::Message;
use sim::{Command, Controls, Mode, SimThread, Snapshot};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrain::store::World;
use visual::camera::View;
use visual::capture::Offscreen;
use visual::passes::lines::Stroke;
use visual::window::{self, Call, Event, Flow, WindowError};
use visual::{Gpu, TextureFormat, TextureView};

/// A stick moved farther than this takes over from the track.
const TAKES_OVER: f64 = 0.15;
/// How long a message stays on the display.
const MESSAGE: Duration = Duration::from_secs(3);
/// How long a new pilot is told the keys.
const HELPED: Duration = Duration::from_secs(60);
/// How long each line of what a situation tells stays on the display.
const TOLD: Duration = Duration::from_secs(8);
/// An input that shows no effect this long has none (time stands still).
const NO_EFFECT: Duration = Duration::from_secs(1);
/// How far the head turns with half the window's height of the mouse, radians.
const LOOK_RAD: f64 = 1.2;
/// Weight of the last frame in the frame time shown: figures that can be read.
const SMOOTHING: f64 = 0.1;

const HINT_TRACK: &str = "STICK OR ARROW KEYS: FLY YOURSELF   P PAUSE   C CAMERA   H DISPLAY   F12 PICTURE   ESC QUIT";
const HINT_PILOT: &str = "PGUP PGDN THRUST   F4 MOUSE   C CAMERA   R RESET   T TRACK   Y SLEW   [ ] HOUR   , . MONTH";
const HINT_CRASHED: &str = "R RESET   Y SLEW";
const HINT_SLEW: &str = "ARROWS MOVE AND TURN   PGUP PGDN CLIMB   Y FLY FROM HERE";

/// Flies in a window until the pilot quits or the length asked for is flown.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn fly(args: &FlyArgs, world: Arc<World>, started: Instant) -> Result<Fly, Failure> {
    let joystick = match Joystick::bound(sticks::bindings(args.sticks.as_deref())?) {
        Ok(joystick) => Some(joystick),
        Err(error) => {
            output::tell(format_args!("poligon: flying by keyboard: {error}"));
            None
        }
    };
    let mut cockpit = Cockpit::new(args, world, started, joystick);
    let size_px = [args.view.size.width_px, args.view.size.height_px];
    match window::run("Poligon", size_px, |call| cockpit.answer(call)) {
        Ok(()) => cockpit.report(),
        Err(WindowError::Caller(error)) => Err(match error.downcast::<Failure>() {
            Ok(failure) => *failure,
            Err(other) => Failure::while_doing("flying", other),
        }),
        // Where there is nothing to draw with, the window system's complaint would hide it.
        Err(error) => Err(match Gpu::headless() {
            Err(nothing) => Failure::while_doing("opening a window", nothing),
            Ok(_) => Failure::Failed(format!("opening a window: {error}; `poligon fly --headless` needs none")),
        }),
    }
}

/// What lives as long as the flight.
struct Cockpit<'a> {
    args: &'a FlyArgs,
    length: Length,
    world: Arc<World>,
    /// Made anew with each device.
    stage: Option<(Scenery, TextureFormat)>,
    flown: Option<Flown>,
    hands: Hands,
    /// Whether the mouse holds the trigger.
    fires: bool,
    size_px: [u32; 2],
    hud_shown: bool,
    record: Record,
    last_frame: Option<Instant>,
    frame_ms: f64,
    /// Controls that the last picture showed.
    seen: Option<Controls>,
    /// An input whose picture is on its way to the screen.
    shown: Option<Instant>,
    picture_wanted: bool,
    pictures: Vec<PathBuf>,
    message: Option<(String, Instant)>,
    /// What a situation tells its pilot.
    say: Vec<String>,
}

/// What begins with the first device.
struct Flown {
    sim: SimThread,
    seat: Seat,
    sun: Sun,
    marks: Marks,
    /// When the first picture was there.
    begun: Option<Instant>,
    /// When the pilot took over from the track.
    taken_over: Option<Instant>,
    /// Taking over is under way.
    taking_over: bool,
    slowed: (f64, Option<Instant>),
}

impl<'a> Cockpit<'a> {
    fn new(args: &'a FlyArgs, world: Arc<World>, started: Instant, joystick: Option<Joystick>) -> Self {
        Self {
            args,
            length: Length::of(args, false),
            world,
            stage: None,
            flown: None,
            hands: Hands::new(Input::new(joystick, Controls::default().throttle)),
            fires: false,
            size_px: [args.view.size.width_px, args.view.size.height_px],
            hud_shown: true,
            record: Record::new(started, false),
            last_frame: None,
            frame_ms: f64::NAN,
            seen: None,
            shown: None,
            picture_wanted: false,
            pictures: Vec::new(),
            message: None,
            say: Vec::new(),
        }
    }

    fn answer(&mut self, call: Call<'_>) -> window::Answer {
        // Whatever comes after a frame's callback comes after that frame was presented.
        if let Some(input) = self.shown.take() {
            self.record.add_latency(input.elapsed());
        }
        match call {
            Call::Ready { gpu, format, size_px, .. } => self.ready(gpu, format, size_px)?,
            Call::Event(event) => return Ok(self.event(event)),
            Call::Frame { gpu, target, size_px, slept } => {
                if slept {
                    self.last_frame = None;
                }
                return Ok(self.frame(gpu, target, size_px)?);
            }
        }
        Ok(Flow::Continue)
    }

    /// Makes what lives on the device; the flight itself outlives it.
    fn ready(&mut self, gpu: &Gpu, format: TextureFormat, size_px: [u32; 2]) -> Result<(), Failure> {
        let before = self.stage.take().map(|(scenery, _)| scenery.look.ground);
        let mut look = Look { size_px, ..Look::of(&self.args.view, gpu.report.kind, false) };
        look.ground = before.unwrap_or(look.ground);
        let mut scenery = Scenery::new(gpu.clone(), format, self.world.clone(), look);
        scenery.use_models_of(self.args.world.as_deref())?;
        if let Some(flown) = &self.flown {
            // A new device: what the flight left on the ground is left again.
            flown.marks.again(&mut scenery);
        }
        if self.flown.is_none() {
            let plan = Plan::new(self.args, self.length, LOCKSTEP_HZ, &self.world, &scenery.area)?;
            let date = plan.date(self.args, &self.world)?;
            let ground = scenery.scene_ground();
            let mut scene = plan.scene(&self.world, date, false)?;
            self.say = plan.say().to_vec();
            inputs::prepare(self.args, &mut scene)?;
            let seat = Seat::new(&self.world, &scene, self.args.camera);
            // The lever begins where the flight has it: an aircraft that stands on a runway stays there.
            let throttle = scene.controls().throttle;
            self.hands.with(|input| input.keyboard.set_throttle(throttle));
            sim::lockstep(&mut scene, &ground, 1);
            // Held until the first picture is there.
            scene.clock.set_paused(true);
            self.flown = Some(Flown {
                // Inputs that are played have the controls to themselves.
                sim: SimThread::start_with(scene, ground, self.args.inputs.is_none().then(|| self.hands.clone()))
                    .map_err(|error| Failure::while_doing("starting the simulation", error))?,
                seat,
                sun: Sun::new(&self.world, date)?,
                marks: Marks::default(),
                begun: None,
                taken_over: None,
                taking_over: false,
                slowed: (0.0, None),
            });
        }
        self.stage = Some((scenery, format));
        Ok(())
    }

    fn event(&mut self, event: Event) -> Flow {
        match event {
            Event::CloseRequested => return Flow::Close,
            Event::Key { name, down, repeat: false } => {
                if let Some(command) = self.hands.with(|input| input.keyboard.key(&name, down)) {
                    return self.command(command);
                }
            }
            Event::MouseMoved { x_px, y_px } => {
                let [width_px, height_px] = self.size_px.map(|edge| 0.5 * f64::from(edge.max(1)));
                let at = [(x_px - width_px) / height_px, (y_px - height_px) / height_px];
                let [right, up] = self.hands.with(|input| {
                    input.mouse.moved(at[0], at[1]);
                    input.mouse.take_turn()
                });
                if let Some(flown) = self.flown.as_mut().filter(|_| right != 0.0 || up != 0.0) {
                    flown.seat.head.turn(right * LOOK_RAD, up * LOOK_RAD);
                }
            }
            Event::MouseButton { number: 0, down: true } if self.hands.look(|input| input.mouse.flies()) => {
                self.fires = true;
                return self.command(Command::Trigger);
            }
            Event::MouseButton { number: 0, down: false } if std::mem::take(&mut self.fires) => {
                return self.command(Command::TriggerEnd);
            }
            Event::MouseButton { number: 1, down } => {
                self.hands.with(|input| input.mouse.look(down));
                if !down {
                    return self.command(Command::LookEnd);
                }
            }
            Event::MouseButton { number: 2, down: true } => return self.command(Command::MouseStick),
            Event::Wheel { lines } => self.hands.with(|input| input.mouse.wheel(f64::from(lines))),
            Event::Focused(false) => {
                // Keys and buttons let go elsewhere are not told of.
                let mut ended = self.hands.with(|input| {
                    input.mouse.release();
                    input.keyboard.release_all()
                });
                ended.extend(std::mem::take(&mut self.fires).then_some(Command::TriggerEnd));
                for command in ended {
                    self.command(command);
                }
                if let Some(flown) = &mut self.flown {
                    flown.seat.head.command(Command::LookEnd);
                }
            }
            _ => {}
        }
        Flow::Continue
    }

    fn command(&mut self, command: Command) -> Flow {
        if let Some(flown) = &mut self.flown {
            flown.seat.head.command(command);
            let cameras = &mut flown.seat.cameras;
            match command {
                Command::NextCamera => cameras.set(cameras.now().next()),
                Command::CockpitCamera => cameras.set(Camera::Cockpit),
                _ => {}
            }
        }
        let ground = |cockpit: &mut Self, change: fn(&mut visual::passes::terrain::TerrainLook)| {
            if let Some((scenery, _)) = &mut cockpit.stage {
                let mut look = scenery.look.ground;
                change(&mut look);
                scenery.set_ground_look(look);
            }
        };
        match command {
            Command::Quit => return Flow::Close,
            Command::Hud => self.hud_shown = !self.hud_shown,
            Command::MouseStick => {
                let flies = self.hands.with(|input| input.mouse.take_or_give_back());
                let told = if flies { "MOUSE FLIES: WHEEL THRUST, LEFT FIRES" } else { "MOUSE LET GO" };
                self.message = Some((told.to_owned(), Instant::now()));
            }
            Command::Screenshot => self.picture_wanted = true,
            Command::Wireframe => ground(self, |look| look.wireframe = !look.wireframe),
            Command::BlockOverlay => ground(self, |look| look.overlay = !look.overlay),
            other => {
                if let Some(flown) = &self.flown {
                    flown.sim.send(Message::Command(other));
                }
            }
        }
        Flow::Continue
    }

    fn frame(&mut self, gpu: &Gpu, target: &TextureView, size_px: [u32; 2]) -> Result<Flow, Failure> {
        let now = Instant::now();
        let took = self.last_frame.replace(now).map(|last| now - last);
        let wall_s = took.unwrap_or_default().as_secs_f64();
        if let Some(took) = took {
            self.record.add_interval(took);
            let ms = took.as_secs_f64() * 1e3;
            self.frame_ms =
                if self.frame_ms.is_finite() { self.frame_ms + SMOOTHING * (ms - self.frame_ms) } else { ms };
        }
        self.size_px = size_px;
        let is_played = self.args.inputs.is_some();
        if is_played {
            // Nobody else asks them; what they command of the picture counts all the same.
            self.hands.poll(&sim::input::Levers::default());
        }
        for command in self.hands.take_commands() {
            if self.command(command) == Flow::Close {
                return Ok(Flow::Close);
            }
        }
        let (Some((scenery, format)), Some(flown)) = (&mut self.stage, &mut self.flown) else {
            return Ok(Flow::Continue);
        };
        if !flown.sim.is_running() {
            return Err(Failure::Failed("the simulation stopped by itself".to_owned()));
        }
        if !is_played {
            flown.hear(self.hands.controls());
        }
        flown.seat.head.update(wall_s);

        // Before the snapshot, which then knows of all of them.
        let events = flown.sim.take_events();
        let snapshot = flown.sim.now();
        let moved =
            self.seen.replace(snapshot.controls).is_some_and(|before| before != snapshot.controls) && !is_played;
        // What came before time ran waited for that.
        let counts = |input: &Instant| input.elapsed() < NO_EFFECT && flown.begun.is_some_and(|begun| *input > begun);
        if let Some(input) = self.hands.take_moved_if(moved).filter(counts) {
            self.record.add_sampled(input.elapsed());
            self.shown = Some(input);
        }
        flown.marks.leave(&events, &snapshot, scenery);
        let seen = flown.seat.view(scenery, &snapshot, size_px);
        let view = &seen.view;
        let heavens = flown.sun.at(&self.world, snapshot.date);
        self.record.follow(scenery, view, &snapshot, heavens);
        let hud = if self.hud_shown {
            let slowed = flown.is_slowed(&snapshot);
            let message = self.message.as_ref().filter(|(_, since)| since.elapsed() < MESSAGE);
            let mut status = Vec::new();
            status.extend(slowed.then_some("SLOWED"));
            status.extend(message.map(|(text, _)| text.as_str()));
            let captions = Captions {
                frame_ms: self.frame_ms,
                status: &status,
                mouse: self.hands.look(|input| input.mouse.flies().then(|| input.mouse.stick())),
                hint: flown.told(&self.say).unwrap_or_else(|| flown.hint(&snapshot)),
            };
            stage::hud(&self.world, &snapshot, &seen, &heavens, captions)
        } else {
            Vec::new()
        };
        let picture = self.picture_wanted.then(|| hud.clone());
        scenery.draw(view, heavens, snapshot.time_s, hud, target).map_err(super::device_failed)?;
        if self.record.frames() == 0 {
            // The first picture counts when it is there, and time runs from then.
            gpu.wait().map_err(super::device_failed)?;
            flown.sim.send(Message::Paused(false));
            flown.begun = Some(Instant::now());
        }
        self.record.frame(scenery, view, &snapshot, None);
        scenery.look.size_px = size_px;
        if let Some(hud) = picture {
            self.picture_wanted = false;
            let format = *format;
            self.take_picture(view, &snapshot, heavens, hud, format);
        }
        Ok(if self.is_over() { Flow::Close } else { Flow::Continue })
    }

    /// Draws the frame once more to where it can be read, and keeps it. That a disk is full ends no flight.
    fn take_picture(
        &mut self,
        view: &View,
        snapshot: &Snapshot,
        heavens: Heavens,
        hud: Vec<Stroke>,
        format: TextureFormat,
    ) {
        let Some((scenery, _)) = &mut self.stage else { return };
        let stamp: String = snapshot.date.to_string().chars().filter(|c| c.is_ascii_alphanumeric()).collect();
        let name = |number: usize| self.args.shots.join(format!("poligon-{stamp}-{number}.png"));
        let Some(path) = (1..10_000).map(name).find(|path| !path.exists()) else { return };
        let taken = Offscreen::with_format(&scenery.gpu, view.size_px, format)
            .and_then(|target| {
                scenery.draw(view, heavens, snapshot.time_s, hud, &target.view)?;
                target.read(&scenery.gpu)
            })
            .map_err(|error| error.to_string())
            .and_then(|picture| picture.write_png(&path).map_err(|error| error.to_string()));
        let told = match taken {
            Ok(()) => {
                output::tell(format_args!("poligon: picture {}", path.display()));
                self.pictures.push(path);
                "PICTURE SAVED"
            }
            Err(error) => {
                output::tell(format_args!("poligon: no picture: {error}"));
                "NO PICTURE"
            }
        };
        self.message = Some((told.to_owned(), Instant::now()));
    }

    fn is_over(&self) -> bool {
        match (self.length, self.flown.as_ref().and_then(|flown| flown.begun)) {
            (Length::Frames(frames), _) => self.record.frames() >= frames,
            (Length::Seconds(seconds_s), Some(begun)) => begun.elapsed().as_secs_f64() >= seconds_s,
            _ => false,
        }
    }

    fn report(self) -> Result<Fly, Failure> {
        let (Some((scenery, _)), Some(flown)) = (self.stage, self.flown) else {
            return Err(Failure::Failed("the window closed before there was a picture".to_owned()));
        };
        let flown_s = flown.begun.map_or(0.0, |begun| begun.elapsed().as_secs_f64());
        let scene = flown.sim.stop().map_err(|error| Failure::Failed(error.to_string()))?;
        inputs::keep(self.args, &scene)?;
        let last = scene.snapshot();
        let ending = Ending { mode: "window", flown_s, steps: last.step, sim_hash: report::hash(last.hash()) };
        let shots = self.pictures.iter().map(|path| path.display().to_string()).collect();
        Ok(Fly { shots, ..self.record.report(&scenery, &ending) })
    }
}

impl Flown {
    /// A stick that is moved takes over from the track.
    fn hear(&mut self, controls: Controls) {
        let on_track = self.sim.last_two().1.flags.mode == Mode::Track;
        let stick = controls.pitch.abs().max(controls.roll.abs()).max(controls.yaw.abs());
        if on_track && !self.taking_over && stick > TAKES_OVER {
            self.taking_over = true;
            self.taken_over = Some(Instant::now());
            self.sim.send(Message::Command(Command::Track));
        }
        if !on_track {
            self.taking_over = false;
        }
    }

    /// Whether wall time was dropped in the last second.
    fn is_slowed(&mut self, snapshot: &Snapshot) -> bool {
        if snapshot.slowed_s > self.slowed.0 + 1e-3 {
            self.slowed = (snapshot.slowed_s, Some(Instant::now()));
        }
        self.slowed.1.is_some_and(|since| since.elapsed() < Duration::from_secs(1))
    }

    /// The line of what is told that is on now: each for a while, from the start on.
    fn told<'s>(&self, say: &'s [String]) -> Option<&'s str> {
        let line = (self.begun?.elapsed().as_secs_f64() / TOLD.as_secs_f64()) as usize;
        say.get(line).map(String::as_str)
    }

    fn hint(&self, snapshot: &Snapshot) -> &'static str {
        match snapshot.flags.mode {
            _ if snapshot.flags.crashed => HINT_CRASHED,
            Mode::Track => HINT_TRACK,
            Mode::Slew => HINT_SLEW,
            Mode::Pilot if self.taken_over.is_some_and(|since| since.elapsed() < HELPED) => HINT_PILOT,
            Mode::Pilot => "",
        }
    }
}
