//! From keys and sticks to what a pilot commands.
//!
//! Keyboard and joystick feed one [`Controls`]; nothing behind it knows which hand moved. Bad numbers stop here.

pub mod bindings;
mod controls;
mod head;
pub mod joystick;
pub mod keyboard;
mod levers;
pub mod profile;
pub mod recording;

pub use controls::{Command, Controls, Curve, ViewLook};
pub use head::Head;
pub use levers::Levers;

use joystick::Joystick;
use keyboard::Keyboard;

/// All of a pilot's devices as one.
pub struct Input {
    /// The keyboard.
    pub keyboard: Keyboard,
    /// The sticks; `None` where the system gives none.
    pub joystick: Option<Joystick>,
    throttle: f64,
    keyboard_throttle: f64,
    stick_throttle: Option<f64>,
}

impl Input {
    /// Keyboard and, if there is one, joystick; the throttle starts at `throttle`, 0..1.
    pub fn new(joystick: Option<Joystick>, throttle: f64) -> Self {
        let throttle = Controls { throttle, ..Controls::default() }.checked().throttle;
        let keyboard = Keyboard::new(throttle);
        Self { keyboard, joystick, throttle, keyboard_throttle: throttle, stick_throttle: None }
    }

    /// Takes in what the devices did since the last call, `wall_s` ago; gives controls and the stick's commands.
    ///
    /// Axes of both add up; of two throttles the one moved last counts.
    pub fn poll(&mut self, wall_s: f64) -> (Controls, Vec<Command>) {
        self.keyboard.update(wall_s);
        let keys = self.keyboard.controls();
        let commands = self.joystick.as_mut().map(Joystick::poll).unwrap_or_default();
        let stick = self.joystick.as_ref().map(|j| j.bindings().axes()).unwrap_or_default();
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
        let controls = Controls {
            pitch: keys.pitch + stick.pitch.unwrap_or(0.0),
            roll: keys.roll + stick.roll.unwrap_or(0.0),
            yaw: keys.yaw + stick.yaw.unwrap_or(0.0),
            throttle: self.throttle,
        };
        (controls.checked(), commands)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_keyboard_alone_gives_controls_and_the_throttle_last_set_counts() {
        let mut input = Input::new(None, f64::NAN);
        assert_eq!(input.poll(0.1), (Controls::default(), Vec::new()));
        input.keyboard.key("PageUp", true);
        input.keyboard.key("ArrowDown", true);
        let (controls, _) = input.poll(0.1);
        assert!((controls.throttle - 0.54).abs() < 1e-12 && controls.pitch > 0.2);
        input.keyboard.set_throttle(0.9);
        input.keyboard.release_all();
        assert_eq!(input.poll(0.0).0.throttle, 0.9);
    }
}
