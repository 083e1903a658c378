//! From keys and sticks to what a pilot commands.
//!
//! Keyboard and joystick feed one [`Controls`]; nothing behind it knows which hand moved. Bad numbers stop here.

pub mod bindings;
mod controls;
mod hands;
mod head;
pub mod joystick;
pub mod keyboard;
mod levers;
pub mod mouse;
pub mod profile;
pub mod recording;

pub use controls::{Command, Controls, Curve, ViewLook};
pub use hands::Hands;
pub use head::Head;
pub use levers::Levers;

use bindings::LeverAxes;
use joystick::Joystick;
use keyboard::Keyboard;
use mouse::Mouse;
use std::time::Instant;

/// All of a pilot's devices as one.
pub struct Input {
    /// The keyboard.
    pub keyboard: Keyboard,
    /// The mouse.
    pub mouse: Mouse,
    /// The sticks; `None` where the system gives none.
    pub joystick: Option<Joystick>,
    throttle: f64,
    keyboard_throttle: f64,
    stick_throttle: Option<f64>,
    stick_levers: LeverAxes,
}

/// What the devices did since they were last asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Polled {
    /// What is commanded now.
    pub controls: Controls,
    /// Levers, if an axis of a stick moved one.
    pub levers: Option<Levers>,
    /// The sticks' commands.
    pub commands: Vec<Command>,
    /// When the first event of a stick was.
    pub stick_event: Option<Instant>,
}

impl Input {
    /// Keyboard, mouse and, if there is one, joystick; the throttle starts at `throttle`, 0..1.
    pub fn new(joystick: Option<Joystick>, throttle: f64) -> Self {
        let throttle = Controls { throttle, ..Controls::default() }.checked().throttle;
        Self {
            keyboard: Keyboard::new(throttle),
            mouse: Mouse::default(),
            joystick,
            throttle,
            keyboard_throttle: throttle,
            stick_throttle: None,
            stick_levers: LeverAxes::default(),
        }
    }

    /// What is commanded, as of the last poll's sticks.
    pub fn controls(&self) -> Controls {
        let (keys, [pitch, roll]) = (self.keyboard.controls(), self.mouse.stick());
        let stick = self.joystick.as_ref().map(|j| j.bindings().axes()).unwrap_or_default();
        let controls = Controls {
            pitch: keys.pitch + pitch + stick.pitch.unwrap_or(0.0),
            roll: keys.roll + roll + stick.roll.unwrap_or(0.0),
            yaw: keys.yaw + stick.yaw.unwrap_or(0.0),
            throttle: self.throttle,
        };
        controls.checked()
    }

    /// Takes in what the devices did since the last call, `wall_s` ago. `levers` are as they stand.
    ///
    /// Axes of all add up; of two throttles the one moved last counts.
    pub fn poll(&mut self, wall_s: f64, levers: &Levers) -> Polled {
        self.keyboard.update(wall_s);
        let commands = self.joystick.as_mut().map(Joystick::poll).unwrap_or_default();
        let stick_event = self.joystick.as_mut().and_then(Joystick::take_first_event);
        let stick = self.joystick.as_ref().map(|j| j.bindings().axes()).unwrap_or_default();
        let wheel = self.mouse.take_throttle();
        if wheel != 0.0 {
            self.keyboard.set_throttle(self.throttle + wheel);
        }
        let keys = self.keyboard.controls();
        if keys.throttle != self.keyboard_throttle {
            self.keyboard_throttle = keys.throttle;
            self.throttle = keys.throttle;
        }
        if stick.throttle.is_some() && stick.throttle != self.stick_throttle {
            self.throttle = stick.throttle.unwrap_or(self.throttle);
            self.keyboard.set_throttle(self.throttle);
            self.keyboard_throttle = self.keyboard.controls().throttle;
        }
        self.stick_throttle = stick.throttle;
        let moved = stick.levers.moved(&self.stick_levers, levers);
        self.stick_levers = stick.levers;
        Polled { controls: self.controls(), levers: moved, commands, stick_event }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keyboard_alone_gives_controls_and_the_throttle_last_set_counts() {
        let mut input = Input::new(None, f64::NAN);
        let levers = Levers::default();
        let nothing = Polled { controls: Controls::default(), levers: None, commands: Vec::new(), stick_event: None };
        assert_eq!(input.poll(0.1, &levers), nothing);
        input.keyboard.key("PageUp", true);
        input.keyboard.key("ArrowDown", true);
        let controls = input.poll(0.1, &levers).controls;
        assert!((controls.throttle - 0.54).abs() < 1e-12 && controls.pitch > 0.2);
        input.keyboard.set_throttle(0.9);
        input.keyboard.release_all();
        assert_eq!(input.poll(0.0, &levers).controls.throttle, 0.9);
        input.mouse.take_or_give_back();
        input.mouse.wheel(-2.0);
        input.mouse.moved(-1.0, 0.0);
        let controls = input.poll(0.0, &levers).controls;
        assert!((controls.throttle - 0.82).abs() < 1e-12 && controls.roll == -1.0);
    }
}
