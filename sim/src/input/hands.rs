//! A pilot's hands: the devices, shared by the thread that hears of keys and the mouse and the one that flies.
//!
//! Whoever flies asks each time it steps ([`Hands::poll`]), so a stick's event waits for the next step and not for the next
//! picture. The window's thread tells keys, takes commands, and asks when the input was that a picture is the first to show.
//!
//! Invariant others rely on: nobody holds the devices longer than a poll takes.

use super::{Command, Controls, Input, Levers, Polled};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Controls that did not move for so long are at rest: what moves them next is told from what they did before.
const AT_REST: Duration = Duration::from_millis(250);
/// Most commands that wait for someone to take them.
const MOST_COMMANDS: usize = 1_000;

/// See the module.
#[derive(Clone)]
pub struct Hands(Arc<Mutex<State>>);

struct State {
    input: Input,
    controls: Controls,
    commands: Vec<Command>,
    polled: Option<Instant>,
    changed: Instant,
    /// The earliest event since the last poll.
    touched: Option<Instant>,
    /// The event that moved controls that were at rest; until it is taken.
    moved: Option<Instant>,
}

impl Hands {
    /// On these devices.
    pub fn new(input: Input) -> Self {
        Self(Arc::new(Mutex::new(State {
            controls: input.controls(),
            input,
            commands: Vec::new(),
            polled: None,
            changed: Instant::now(),
            touched: None,
            moved: None,
        })))
    }

    /// Does something to the devices, such as pressing a key.
    pub fn with<T>(&self, act: impl FnOnce(&mut Input) -> T) -> T {
        let mut state = self.locked();
        state.touched.get_or_insert_with(Instant::now);
        act(&mut state.input)
    }

    /// Looks at the devices.
    pub fn look<T>(&self, at: impl FnOnce(&Input) -> T) -> T {
        at(&self.locked().input)
    }

    /// Takes in what the devices did since the last call: what is commanded now, and levers that were moved away from
    /// `levers`.
    pub fn poll(&self, levers: &Levers) -> (Controls, Option<Levers>) {
        let mut state = self.locked();
        let now = Instant::now();
        let wall_s = state.polled.replace(now).map_or(0.0, |then| (now - then).as_secs_f64());
        let Polled { controls, levers, commands, stick_event } = state.input.poll(wall_s, levers);
        let room = MOST_COMMANDS.saturating_sub(state.commands.len());
        state.commands.extend(commands.into_iter().take(room));
        let touched = [state.touched.take(), stick_event].into_iter().flatten().min();
        if controls != state.controls {
            if now - state.changed > AT_REST {
                state.moved = touched;
            }
            (state.controls, state.changed) = (controls, now);
        }
        (controls, levers)
    }

    /// Controls as they were last polled.
    pub fn controls(&self) -> Controls {
        self.locked().controls
    }

    /// The commands of sticks since the last call.
    pub fn take_commands(&self) -> Vec<Command> {
        std::mem::take(&mut self.locked().commands)
    }

    /// When the input was that moved controls which were at rest, once: asked where a picture shows other controls than the
    /// one before.
    pub fn take_moved_if(&self, shows: bool) -> Option<Instant> {
        if shows { self.locked().moved.take() } else { None }
    }

    /// A poll that failed cannot have left the devices in a state that they are not in by themselves.
    fn locked(&self) -> std::sync::MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_heard_by_whoever_flies_and_its_time_is_told_once() {
        let hands = Hands::new(Input::new(None, 0.5));
        let levers = Levers::default();
        assert_eq!(hands.poll(&levers), (Controls { throttle: 0.5, ..Controls::default() }, None));
        std::thread::sleep(AT_REST + Duration::from_millis(10));
        let before = Instant::now();
        hands.with(|input| input.keyboard.key("ArrowDown", true));
        std::thread::sleep(Duration::from_millis(5));
        let (controls, _) = hands.poll(&levers);
        assert!(controls.pitch > 0.0 && hands.controls() == controls);
        let moved = hands.take_moved_if(true).expect("the key's time");
        assert!(moved >= before && moved.elapsed() >= Duration::from_millis(5));
        assert_eq!(hands.take_moved_if(true), None);
        std::thread::sleep(Duration::from_millis(5));
        assert!(hands.poll(&levers).0.pitch > controls.pitch, "the key is held");
        assert_eq!(hands.take_moved_if(true), None, "the axis was under way");
    }
}
