//! Keys to axes and commands. Keys are named by place, not by letter, as winit names them (`KeyW`, `ArrowUp`).
//!
//! A held axis key moves its axis out at [`OUT_PER_S`] and the axis comes back at [`BACK_PER_S`]: small corrections are
//! taps. Throttle keys move the throttle while held and leave it there.

use super::{Command, Controls, ViewLook};

/// How fast a held key moves an axis, full deflections a second.
pub const OUT_PER_S: f64 = 2.2;
/// How fast it comes back when let go.
pub const BACK_PER_S: f64 = 4.0;
/// How fast a held key moves the throttle, a second.
pub const THROTTLE_PER_S: f64 = 0.4;

/// What a key does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KeyAction {
    /// Moves the pitch axis towards this while held.
    Pitch(f64),
    /// Moves the roll axis.
    Roll(f64),
    /// Moves the yaw axis.
    Yaw(f64),
    /// Moves the throttle up (1) or down (-1).
    Throttle(f64),
    /// Gives a command when pressed.
    Command(Command),
}

use KeyAction::{Command as Do, Pitch, Roll, Throttle, Yaw};

/// The default keys, the one table: name, action.
pub const DEFAULT_KEYS: &[(&str, KeyAction)] = &[
    ("ArrowDown", Pitch(1.0)),
    ("ArrowUp", Pitch(-1.0)),
    ("ArrowRight", Roll(1.0)),
    ("ArrowLeft", Roll(-1.0)),
    ("KeyS", Pitch(1.0)),
    ("KeyW", Pitch(-1.0)),
    ("KeyD", Roll(1.0)),
    ("KeyA", Roll(-1.0)),
    ("KeyE", Yaw(1.0)),
    ("KeyQ", Yaw(-1.0)),
    ("PageUp", Throttle(1.0)),
    ("PageDown", Throttle(-1.0)),
    ("Equal", Throttle(1.0)),
    ("Minus", Throttle(-1.0)),
    ("Space", Do(Command::Trigger)),
    ("KeyV", Do(Command::FlapsDown)),
    ("KeyX", Do(Command::FlapsUp)),
    ("KeyG", Do(Command::Gear)),
    ("KeyZ", Do(Command::Brake)),
    ("KeyU", Do(Command::ParkingBrake)),
    ("End", Do(Command::TrimUp)),
    ("Home", Do(Command::TrimDown)),
    ("Insert", Do(Command::MixtureRich)),
    ("Delete", Do(Command::MixtureLean)),
    ("Quote", Do(Command::AltimeterUp)),
    ("Semicolon", Do(Command::AltimeterDown)),
    ("KeyM", Do(Command::MasterArm)),
    ("KeyN", Do(Command::NextWeapon)),
    ("KeyB", Do(Command::NextRipple)),
    ("KeyO", Do(Command::Jettison)),
    ("KeyP", Do(Command::Pause)),
    ("KeyF", Do(Command::Freeze)),
    ("KeyR", Do(Command::Reset)),
    ("KeyY", Do(Command::Slew)),
    ("KeyT", Do(Command::Track)),
    ("F12", Do(Command::Screenshot)),
    ("F2", Do(Command::Wireframe)),
    ("F3", Do(Command::BlockOverlay)),
    ("KeyH", Do(Command::Hud)),
    ("F4", Do(Command::MouseStick)),
    ("KeyC", Do(Command::NextCamera)),
    ("F1", Do(Command::CockpitCamera)),
    ("BracketRight", Do(Command::TimeForward)),
    ("BracketLeft", Do(Command::TimeBack)),
    ("Period", Do(Command::DateForward)),
    ("Comma", Do(Command::DateBack)),
    ("F6", Do(Command::RateUp)),
    ("F5", Do(Command::RateDown)),
    ("Numpad8", Do(Command::Look(ViewLook::Up))),
    ("Numpad2", Do(Command::Look(ViewLook::Down))),
    ("Numpad4", Do(Command::Look(ViewLook::Left))),
    ("Numpad6", Do(Command::Look(ViewLook::Right))),
    ("Numpad0", Do(Command::Look(ViewLook::Back))),
    ("Numpad5", Do(Command::Look(ViewLook::Ahead))),
    ("KeyJ", Do(Command::Look(ViewLook::Left))),
    ("KeyL", Do(Command::Look(ViewLook::Right))),
    ("KeyI", Do(Command::Look(ViewLook::Up))),
    ("KeyK", Do(Command::Look(ViewLook::Down))),
    ("Escape", Do(Command::Quit)),
];

/// The keyboard's state.
#[derive(Debug, Clone, PartialEq)]
pub struct Keyboard {
    held: Vec<&'static str>,
    controls: Controls,
}

impl Keyboard {
    /// Nothing held, axes neutral.
    pub fn new(throttle: f64) -> Self {
        Self { held: Vec::new(), controls: Controls { throttle, ..Controls::default() }.checked() }
    }

    /// A key went down or up; gives the command, if it is one. Repeats of a held key and unknown keys give none.
    pub fn key(&mut self, name: &str, pressed: bool) -> Option<Command> {
        let &(name, action) = DEFAULT_KEYS.iter().find(|(key, _)| *key == name)?;
        let was_held = self.held.contains(&name);
        if !pressed {
            self.held.retain(|held| *held != name);
            return match action {
                Do(command) if was_held => command.ending(),
                _ => None,
            };
        }
        if was_held {
            return None;
        }
        self.held.push(name);
        match action {
            Do(command) => Some(command),
            _ => None,
        }
    }

    /// Lets go of every key, as when the window loses the focus; gives what that ends.
    pub fn release_all(&mut self) -> Vec<Command> {
        let held = std::mem::take(&mut self.held);
        let action = |name: &&str| DEFAULT_KEYS.iter().find(|(key, _)| key == name).map(|(_, action)| *action);
        let ending = |action| if let Do(command) = action { command.ending() } else { None };
        held.iter().filter_map(action).filter_map(ending).collect()
    }

    /// Moves the axes by `wall_s` of held keys; a stall counts as a tenth of a second.
    pub fn update(&mut self, wall_s: f64) {
        let dt_s = if wall_s.is_finite() { wall_s.clamp(0.0, 0.1) } else { 0.0 };
        let sum = |pick: fn(KeyAction) -> Option<f64>| -> f64 {
            let actions = DEFAULT_KEYS.iter().filter(|(key, _)| self.held.contains(key));
            actions.filter_map(|&(_, action)| pick(action)).sum::<f64>().clamp(-1.0, 1.0)
        };
        let pitch = sum(|a| if let Pitch(v) = a { Some(v) } else { None });
        let roll = sum(|a| if let Roll(v) = a { Some(v) } else { None });
        let yaw = sum(|a| if let Yaw(v) = a { Some(v) } else { None });
        let throttle = sum(|a| if let Throttle(v) = a { Some(v) } else { None });
        let now = self.controls;
        self.controls = Controls {
            pitch: ramped(now.pitch, pitch, dt_s),
            roll: ramped(now.roll, roll, dt_s),
            yaw: ramped(now.yaw, yaw, dt_s),
            throttle: now.throttle + throttle * THROTTLE_PER_S * dt_s,
        }
        .checked();
    }

    /// Axes as they stand.
    pub fn controls(&self) -> Controls {
        self.controls
    }

    /// Puts the throttle where another device left it.
    pub fn set_throttle(&mut self, throttle: f64) {
        self.controls = Controls { throttle, ..self.controls }.checked();
    }
}

/// An axis on its way to where its keys want it.
fn ramped(now: f64, wanted: f64, dt_s: f64) -> f64 {
    let returning = wanted == 0.0 || wanted * now < 0.0;
    let most = if returning { BACK_PER_S } else { OUT_PER_S } * dt_s;
    now + (wanted - now).clamp(-most, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_in_the_table_once() {
        for (place, (name, _)) in DEFAULT_KEYS.iter().enumerate() {
            assert!(DEFAULT_KEYS[..place].iter().all(|(other, _)| other != name), "{name} twice");
        }
    }

    #[test]
    fn a_tap_is_small_a_hold_is_full_and_letting_go_returns() {
        let mut keyboard = Keyboard::new(0.5);
        assert_eq!(keyboard.key("ArrowRight", true), None);
        keyboard.update(0.05);
        assert!((keyboard.controls().roll - 0.05 * OUT_PER_S).abs() < 1e-12);
        for _ in 0..20 {
            keyboard.update(0.05);
        }
        assert_eq!(keyboard.controls().roll, 1.0);
        keyboard.key("ArrowLeft", true); // both held: neutral
        for _ in 0..20 {
            keyboard.update(0.05);
        }
        assert_eq!(keyboard.controls().roll, 0.0);
        keyboard.key("Space", true);
        assert_eq!(keyboard.release_all(), [Command::TriggerEnd], "a trigger does not stick");
        keyboard.update(f64::NAN);
        assert_eq!(keyboard.controls().roll, 0.0);
    }

    #[test]
    fn a_command_comes_once_a_press_and_the_throttle_stays() {
        let mut keyboard = Keyboard::new(0.5);
        assert_eq!(keyboard.key("KeyP", true), Some(Command::Pause));
        assert_eq!(keyboard.key("KeyP", true), None, "repeat");
        assert_eq!(keyboard.key("KeyP", false), None);
        assert_eq!(keyboard.key("Space", true), Some(Command::Trigger));
        assert_eq!(keyboard.key("Space", false), Some(Command::TriggerEnd));
        assert_eq!(keyboard.key("Space", false), None, "not held");
        assert_eq!(keyboard.key("Numpad4", true), Some(Command::Look(ViewLook::Left)));
        assert_eq!(keyboard.key("Numpad4", false), Some(Command::LookEnd));
        assert_eq!(keyboard.key("NoSuchKey", true), None);
        keyboard.key("PageUp", true);
        keyboard.update(10.0);
        keyboard.key("PageUp", false);
        keyboard.update(1.0);
        assert!((keyboard.controls().throttle - 0.54).abs() < 1e-12, "a stall of 10 s moves it by a tenth of a second");
    }
}
