//! Sticks, throttles and gamepads of the system, read by gilrs and bound by [`super::bindings`].
//!
//! A HOTAS throttle lies outside gilrs' gamepad set and arrives as an unknown axis, so a stick is bound by raw code and
//! by vendor and product. What gilrs knows as a gamepad is bound by gilrs' own axes.

use super::bindings::Bindings;
use super::profile::{self, Profile, Target};
use super::{Command, Curve, ViewLook};
use gilrs::{Axis, Button, Event, EventType, GamepadId, Gilrs, GilrsBuilder};
use std::collections::HashMap;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

/// Faulty events after which sticks are no longer read.
const MOST_FAULTS: u32 = 8;

/// Why there is no joystick input at all. One stick less is no error.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JoystickError(String);

impl fmt::Display for JoystickError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "expected an input system that lists joysticks, found none: {}", self.0)
    }
}

impl std::error::Error for JoystickError {}

/// A device that is there.
#[derive(Debug, Clone, PartialEq)]
pub struct Connected {
    /// Its number while it is there.
    pub number: usize,
    /// As the system calls it.
    pub name: String,
    /// USB vendor and product.
    pub vendor_product: Option<(u16, u16)>,
}

/// What a device did, before anything is bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// It was plugged in.
    Came {
        /// Its number while it is there.
        device: usize,
    },
    /// It was unplugged.
    Went {
        /// Its number.
        device: usize,
    },
    /// An axis moved.
    Axis {
        /// Its number.
        device: usize,
        /// Raw code.
        code: u32,
        /// -1..1.
        raw: f64,
    },
    /// A button went down.
    Button {
        /// Its number.
        device: usize,
        /// Raw code.
        code: u32,
    },
}

/// The system's sticks.
pub struct Joystick {
    gilrs: Gilrs,
    bindings: Bindings,
    is_gamepad: HashMap<usize, bool>,
    faults: u32,
    first_event: Option<Instant>,
}

impl Joystick {
    /// Opens the system's input devices; more may come and go later.
    ///
    /// # Errors
    /// [`JoystickError`] if the system has no such input at all.
    pub fn open() -> Result<Self, JoystickError> {
        Self::bound(profile::embedded())
    }

    /// The same, bound by these profiles.
    ///
    /// # Errors
    /// [`JoystickError`] if the system has no such input at all.
    pub fn bound(profiles: Arc<[Profile]>) -> Result<Self, JoystickError> {
        // Dead zones are ours, by axis: gilrs' own would be applied on top.
        let gilrs = GilrsBuilder::new().with_default_filters(false).build();
        let gilrs = gilrs.map_err(|error| JoystickError(error.to_string()))?;
        let mut joystick =
            Self { gilrs, bindings: Bindings::new(profiles), is_gamepad: HashMap::new(), faults: 0, first_event: None };
        let present: Vec<GamepadId> = joystick.gilrs.gamepads().map(|(id, _)| id).collect();
        for id in present {
            joystick.connect(id);
        }
        Ok(joystick)
    }

    /// Axes and devices.
    pub fn bindings(&self) -> &Bindings {
        &self.bindings
    }

    /// The connected devices.
    pub fn connected(&self) -> Vec<Connected> {
        let one = |(id, pad): (GamepadId, gilrs::Gamepad<'_>)| Connected {
            number: usize::from(id),
            name: pad.os_name().to_owned(),
            vendor_product: pad.vendor_id().zip(pad.product_id()),
        };
        self.gilrs.gamepads().map(one).collect()
    }

    /// Names of the connected devices with vendor and product.
    pub fn devices(&self) -> Vec<String> {
        let id = |v: Option<u16>| v.map_or("????".to_owned(), |v| format!("{v:04x}"));
        let pads = self.gilrs.gamepads();
        pads.map(|(_, pad)| format!("{} ({}:{})", pad.os_name(), id(pad.vendor_id()), id(pad.product_id()))).collect()
    }

    /// Takes in what happened since the last call and gives its commands. At most 1,000 events a call: a device that
    /// floods must not hold the caller.
    pub fn poll(&mut self) -> Vec<Command> {
        self.poll_and_tell(|_| {})
    }

    /// The same, and tells each change as the device sent it.
    pub fn poll_and_tell(&mut self, mut tell: impl FnMut(Change)) -> Vec<Command> {
        let mut commands = Vec::new();
        for _ in 0..1_000 {
            let Some(event) = self.next_event() else { break };
            let device = usize::from(event.id);
            if matches!(event.event, EventType::AxisChanged(..)) {
                self.first_event.get_or_insert_with(|| told_at(event.time));
            }
            let gamepad = self.is_gamepad.get(&device).copied().unwrap_or(false);
            let command = match event.event {
                EventType::Connected => {
                    self.connect(event.id);
                    tell(Change::Came { device });
                    None
                }
                EventType::Disconnected => {
                    tell(Change::Went { device });
                    self.bindings.disconnected(device)
                }
                EventType::AxisChanged(axis, value, code) => match gamepad_axis(axis).filter(|_| gamepad) {
                    Some((target, curve)) => self.bindings.move_target(device, target, curve, f64::from(value)),
                    None => {
                        let raw = raw_axis(axis, f64::from(value));
                        tell(Change::Axis { device, code: code.into_u32(), raw });
                        self.bindings.axis(device, code.into_u32(), raw)
                    }
                },
                EventType::ButtonPressed(button, _) if gamepad => gamepad_button(button),
                EventType::ButtonPressed(_, code) => {
                    tell(Change::Button { device, code: code.into_u32() });
                    self.bindings.button(device, code.into_u32(), true)
                }
                EventType::ButtonReleased(_, code) if !gamepad => self.bindings.button(device, code.into_u32(), false),
                // A gamepad's triggers are buttons with a value: right opens the throttle, left closes it.
                EventType::ButtonChanged(Button::RightTrigger2, value, _) if gamepad => {
                    self.bindings.move_target(device, Target::Throttle, Curve::STRAIGHT, f64::from(value))
                }
                EventType::ButtonChanged(Button::LeftTrigger2, value, _) if gamepad => {
                    self.bindings.move_target(device, Target::Throttle, Curve::STRAIGHT, -f64::from(value))
                }
                _ => None,
            };
            commands.extend(command);
        }
        commands
    }

    /// When the first axis moved since the last call, by the system's own time of it.
    pub fn take_first_event(&mut self) -> Option<Instant> {
        self.first_event.take()
    }

    /// The next event. gilrs 0.11 panics where a device sends an axis that it had not announced; the event is lost and
    /// the rest goes on, until a device does it too often.
    fn next_event(&mut self) -> Option<Event> {
        while self.faults < MOST_FAULTS {
            let gilrs = &mut self.gilrs;
            match catch_unwind(AssertUnwindSafe(|| gilrs.next_event())) {
                Ok(event) => return event,
                Err(_) => self.faults += 1,
            }
        }
        self.bindings.disconnect_all();
        None
    }

    fn connect(&mut self, id: GamepadId) {
        let Some(pad) = self.gilrs.connected_gamepad(id) else { return };
        let vendor_product = pad.vendor_id().zip(pad.product_id());
        let bound = self.bindings.knows(vendor_product);
        let thumb_sticks = pad.axis_code(Axis::RightStickX).is_some() && pad.button_code(Button::South).is_some();
        self.is_gamepad.insert(usize::from(id), thumb_sticks && !bound);
        self.bindings.connected(usize::from(id), vendor_product);
    }
}

/// A time of the wall clock as one of the clock that never jumps; one of another age is now.
fn told_at(time: SystemTime) -> Instant {
    let now = Instant::now();
    let ago = time.elapsed().ok().filter(|ago| *ago < Duration::from_secs(10)).unwrap_or_default();
    now.checked_sub(ago).unwrap_or(now)
}

/// gilrs turns Y axes round so that up is positive; undone, so that a raw code has its raw direction.
fn raw_axis(axis: Axis, value: f64) -> f64 {
    if cfg!(target_os = "linux") && matches!(axis, Axis::LeftStickY | Axis::RightStickY | Axis::DPadY) {
        -value
    } else {
        value
    }
}

/// A gamepad's axes: left stick flies, right stick is the pedals. gilrs gives up as positive.
fn gamepad_axis(axis: Axis) -> Option<(Target, Curve)> {
    let curve = |inverted| Curve { dead_zone: 0.12, softness: 0.5, inverted };
    match axis {
        Axis::LeftStickX => Some((Target::Roll, curve(false))),
        Axis::LeftStickY => Some((Target::Pitch, curve(true))),
        Axis::RightStickX => Some((Target::Yaw, curve(false))),
        Axis::DPadX => Some((Target::LookSide, curve(false))),
        Axis::DPadY => Some((Target::LookUp, curve(false))),
        _ => None,
    }
}

fn gamepad_button(button: Button) -> Option<Command> {
    match button {
        Button::Start => Some(Command::Pause),
        Button::Select => Some(Command::Reset),
        Button::North => Some(Command::Slew),
        Button::West => Some(Command::Hud),
        Button::East => Some(Command::Track),
        Button::South => Some(Command::Screenshot),
        Button::LeftTrigger => Some(Command::TimeBack),
        Button::RightTrigger => Some(Command::TimeForward),
        Button::DPadLeft => Some(Command::Look(ViewLook::Left)),
        Button::DPadRight => Some(Command::Look(ViewLook::Right)),
        Button::DPadUp => Some(Command::Look(ViewLook::Up)),
        Button::DPadDown => Some(Command::Look(ViewLook::Down)),
        _ => None,
    }
}
