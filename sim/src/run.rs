//! Who drives the scene: a thread against the wall clock, or the caller step by step.
//!
//! [`lockstep`] takes steps as fast as they come and is deterministic. [`SimThread`] follows the wall clock on a thread
//! of its own and publishes the last two snapshots; the caller interpolates between them and is never waited for, so a
//! renderer that stalls costs the simulation nothing. A simulation that stalls is slowed ([`crate::clock`]).

use crate::aircraft::AircraftState;
use crate::clock::MAX_FRAME_S;
use crate::input::{Command, Hands};
use crate::scene::{self, Event, Happening, Scene, SceneGround};
use crate::snapshot::Snapshot;
use crate::track::Track;
use crate::utc::UtcTime;
use glam::DVec2;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use terrain::edit::{Crater, Edit};

/// Takes `steps` steps and gives the scene as it stands then. A paused scene takes none.
pub fn lockstep(scene: &mut Scene, ground: &SceneGround, steps: u32) -> Arc<Snapshot> {
    if scene.clock.paused() {
        scene.look_down(ground);
    } else {
        for _ in 0..steps {
            scene.step(ground);
        }
    }
    Arc::new(scene.snapshot())
}

/// The crater of an event that the posts can show.
pub fn crater(event: &Event) -> Option<Crater> {
    match event.what {
        Happening::Crater { centre_m, radius_m, depth_m, changes_posts: true } => {
            Some(Crater { centre_m: DVec2::new(centre_m.x, centre_m.z), radius_m, depth_m })
        }
        _ => None,
    }
}

/// The ground after the craters of some events, an edit each, in their order; one that cannot be made changes nothing.
pub fn edited<'a>(ground: &SceneGround, events: impl Iterator<Item = &'a Event>) -> Option<SceneGround> {
    let mut other: Option<SceneGround> = None;
    for crater in events.filter_map(crater) {
        let now = other.as_ref().unwrap_or(ground);
        other = now.edited(&[Edit::Crater(crater)]).ok().or(other);
    }
    other
}

/// Takes a step, and makes the craters of it in the ground of the next; gives the scene as it stands then. A paused scene takes
/// none.
pub fn advance(scene: &mut Scene, ground: &mut SceneGround) -> Arc<Snapshot> {
    let from = scene.events_counted();
    let snapshot = lockstep(scene, ground, 1);
    if let Some(other) = edited(ground, snapshot.events.iter().filter(|event| event.number >= from)) {
        *ground = other;
    }
    snapshot
}

/// What can be told to a running simulation.
pub enum Message {
    /// A discrete command.
    Command(Command),
    /// Stops time or lets it run, whichever it was.
    Paused(bool),
    /// Date and time of day.
    Date(UtcTime),
    /// How fast the date runs against the simulation.
    DayRate(f64),
    /// Puts the aircraft into a state.
    Place(Box<AircraftState>),
    /// Gives it a track to fly.
    Track(Box<Track>),
    /// Moves along the track to a distance, metres.
    SeekTrack(f64),
    /// Another ground.
    Ground(SceneGround),
    /// An order to the scene; one that is refused changes nothing.
    Order(Box<scene::Command>),
    /// Ends the thread.
    Stop,
}

/// The last two snapshots and when the later one was due.
struct Published {
    before: Arc<Snapshot>,
    last: Arc<Snapshot>,
    /// Part of a step that wall time was ahead of `last` at `at`.
    fraction: f64,
    at: Instant,
    /// What happened since it was last asked.
    events: Vec<Event>,
}

/// Most events that wait to be taken: of more only those stay that change the ground.
const MOST_EVENTS: usize = 100_000;

/// The simulation on a thread of its own.
pub struct SimThread {
    messages: Sender<Message>,
    published: Arc<Mutex<Published>>,
    thread: Option<JoinHandle<Scene>>,
    step_s: f64,
}

/// The thread is gone because it failed; what it said.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SimStopped(pub String);

impl std::fmt::Display for SimStopped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "the simulation stopped: {}", self.0)
    }
}

impl std::error::Error for SimStopped {}

impl SimThread {
    /// Starts a scene on the wall clock.
    ///
    /// # Errors
    /// The system's, if it gives no thread.
    pub fn start(scene: Scene, ground: SceneGround) -> std::io::Result<Self> {
        Self::start_with(scene, ground, None)
    }

    /// The same in a pilot's hands: they are asked each time the thread wakes to step, so that none waits for a picture. What
    /// they command beside axes and levers waits for who takes it ([`Hands::take_commands`]).
    ///
    /// # Errors
    /// The system's, if it gives no thread.
    pub fn start_with(mut scene: Scene, ground: SceneGround, hands: Option<Hands>) -> std::io::Result<Self> {
        scene.look_down(&ground);
        let first = Arc::new(scene.snapshot());
        let published =
            Published { before: first.clone(), last: first, fraction: 0.0, at: Instant::now(), events: Vec::new() };
        let published = Arc::new(Mutex::new(published));
        let (messages, inbox) = channel();
        let step_s = scene.clock.step_s();
        let shared = published.clone();
        let builder = std::thread::Builder::new().name("simulation".to_owned());
        let thread = builder.spawn(move || drive(scene, ground, hands, &inbox, &shared))?;
        Ok(Self { messages, published, thread: Some(thread), step_s })
    }

    /// Tells the simulation something; false if it no longer runs.
    pub fn send(&self, message: Message) -> bool {
        self.messages.send(message).is_ok()
    }

    /// Whether it still runs.
    pub fn is_running(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// What happened since this was last asked, in order, however long that was; of very much only what changes the ground.
    pub fn take_events(&self) -> Vec<Event> {
        std::mem::take(&mut locked(&self.published).events)
    }

    /// The last two snapshots.
    pub fn last_two(&self) -> (Arc<Snapshot>, Arc<Snapshot>) {
        let published = locked(&self.published);
        (published.before.clone(), published.last.clone())
    }

    /// The scene now: between the last two snapshots, one step behind the wall clock, so that it never guesses ahead.
    pub fn now(&self) -> Snapshot {
        let (before, last, part) = {
            let published = locked(&self.published);
            let since_s = published.at.elapsed().as_secs_f64() * published.last.rate;
            (published.before.clone(), published.last.clone(), published.fraction + since_s / self.step_s)
        };
        Snapshot::interpolate(&before, &last, part)
    }

    /// Ends the simulation and gives its scene back.
    ///
    /// # Errors
    /// [`SimStopped`] if it had failed.
    pub fn stop(mut self) -> Result<Scene, SimStopped> {
        self.send(Message::Stop);
        let thread = self.thread.take().ok_or_else(|| SimStopped("it was stopped before".to_owned()))?;
        thread.join().map_err(|panic| {
            let said = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
            let said = said.or_else(|| panic.downcast_ref::<String>().cloned());
            SimStopped(said.unwrap_or_else(|| "no reason given".to_owned()))
        })
    }
}

impl Drop for SimThread {
    fn drop(&mut self) {
        self.send(Message::Stop);
        if let Some(thread) = self.thread.take() {
            // Nobody is left to be told of a failure.
            let _ = thread.join();
        }
    }
}

/// The published pair; a panic while it was held cannot have left it half written.
fn locked(published: &Mutex<Published>) -> MutexGuard<'_, Published> {
    published.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Does a command; one that is refused leaves the scene as it was and nobody waits for an answer.
fn order(scene: &mut Scene, command: scene::Command) {
    let _ = scene.order(command);
}

fn drive(
    mut scene: Scene,
    mut ground: SceneGround,
    hands: Option<Hands>,
    inbox: &Receiver<Message>,
    shared: &Mutex<Published>,
) -> Scene {
    let mut then = Instant::now();
    loop {
        let step_s = scene.clock.step_s() / scene.clock.rate();
        let wait_s = if scene.clock.paused() { 0.02 } else { (1.0 - scene.clock.fraction()) * step_s };
        let mut changed = false;
        // Sleep until a step is due; a message ends the sleep.
        let mut next = match inbox.recv_timeout(Duration::from_secs_f64(wait_s.clamp(0.0, MAX_FRAME_S))) {
            Ok(message) => Some(message),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return scene,
        };
        while let Some(message) = next {
            match message {
                Message::Command(command) => scene.command(command),
                Message::Paused(paused) => scene.clock.set_paused(paused),
                Message::Date(date) => order(&mut scene, scene::Command::Date(date)),
                Message::DayRate(rate) => order(&mut scene, scene::Command::DayRate(rate)),
                Message::Place(state) => scene.place(*state),
                Message::Track(track) => scene.fly_track(*track),
                Message::SeekTrack(distance_m) => scene.seek_track(distance_m),
                Message::Ground(other) => {
                    ground = other;
                    scene.ground_changed();
                }
                Message::Order(command) => order(&mut scene, *command),
                Message::Stop => return scene,
            }
            changed = true;
            next = inbox.try_recv().ok();
        }
        if let Some(hands) = &hands {
            let (controls, levers) = hands.poll(&scene.levers());
            if controls != scene.controls() {
                scene.set_controls(controls);
            }
            if let Some(levers) = levers {
                scene.set_levers(levers);
            }
        }
        let now = Instant::now();
        let due = scene.clock.advance(now.duration_since(then).as_secs_f64());
        then = now;
        if due == 0 {
            if changed && scene.clock.paused() {
                scene.look_down(&ground);
                let snapshot = Arc::new(scene.snapshot());
                let mut published = locked(shared);
                (published.before, published.last) = (snapshot.clone(), snapshot);
            }
            continue;
        }
        let mut events = Vec::new();
        let mut step = |scene: &mut Scene| {
            let from = scene.events_counted();
            scene.step(&ground);
            let new = events.len();
            events.extend(scene.events_from(from).cloned());
            if let Some(other) = edited(&ground, events[new..].iter()) {
                ground = other;
            }
        };
        for _ in 1..due {
            step(&mut scene);
        }
        let before = scene.snapshot();
        step(&mut scene);
        let last = Arc::new(scene.snapshot());
        let mut published = locked(shared);
        published.events.append(&mut events);
        if published.events.len() > MOST_EVENTS {
            published.events.retain(|event| crater(event).is_some());
        }
        published.before = Arc::new(before);
        published.last = last;
        published.fraction = scene.clock.fraction();
        published.at = now;
    }
}
