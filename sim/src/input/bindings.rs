//! What bound sticks say: from axes and buttons of devices to what they move and command.
//!
//! Knows no library, so tests can feed it what no device would send. A device is known by vendor and product and bound
//! by the first of the [`Profile`]s that is for it, else by the first that is for any.
//!
//! Invariant: a device that goes leaves its axes neutral, its brakes let go and its throttle and levers where they were; a bad
//! value changes nothing.

use super::profile::{self, Profile, Target};
use super::{Command, Curve, Levers, ViewLook};
use std::collections::HashMap;
use std::sync::Arc;

/// Axes as the devices give them; `None` where none was moved yet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StickAxes {
    /// Stick back positive, -1..1.
    pub pitch: Option<f64>,
    /// Right positive, -1..1.
    pub roll: Option<f64>,
    /// Right pedal positive, -1..1.
    pub yaw: Option<f64>,
    /// 0..1.
    pub throttle: Option<f64>,
    /// Levers.
    pub levers: LeverAxes,
}

/// Levers that stand on axes, parts of their way as [`Levers`] has them; `None` where none was moved yet.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeverAxes {
    /// 0..1.
    pub mixture: Option<f64>,
    /// 0..1.
    pub flaps: Option<f64>,
    /// -1..1.
    pub trim: Option<f64>,
    /// Left and right, 0..1.
    pub brakes: [Option<f64>; 2],
}

impl LeverAxes {
    /// Levers after what moved since `before`; `None` if nothing did. Brakes of a device that went are let go.
    pub fn moved(&self, before: &Self, levers: &Levers) -> Option<Levers> {
        if self == before {
            return None;
        }
        let after = |now: Option<f64>, then: Option<f64>, lever: f64| now.filter(|_| now != then).unwrap_or(lever);
        let brake = |side: usize| match (self.brakes[side], before.brakes[side]) {
            (None, Some(_)) => 0.0,
            (now, then) => after(now, then, levers.brakes[side]),
        };
        let moved = Levers {
            mixture: after(self.mixture, before.mixture, levers.mixture),
            flaps: after(self.flaps, before.flaps, levers.flaps),
            trim: after(self.trim, before.trim, levers.trim),
            brakes: [brake(0), brake(1)],
            ..*levers
        };
        Some(moved.checked())
    }
}

/// State of all devices.
#[derive(Debug, Clone)]
pub struct Bindings {
    profiles: Arc<[Profile]>,
    /// Vendor and product by the number a device has while it is connected.
    devices: HashMap<usize, Option<(u16, u16)>>,
    /// Value of a target by device.
    values: HashMap<(usize, Target), f64>,
    looking: Option<ViewLook>,
}

impl Default for Bindings {
    fn default() -> Self {
        Self::new(profile::embedded())
    }
}

impl Bindings {
    /// No devices yet; those that come are bound by these.
    pub fn new(profiles: Arc<[Profile]>) -> Self {
        Self { profiles, devices: HashMap::new(), values: HashMap::new(), looking: None }
    }

    /// Whether a kind of device has a profile of its own.
    pub fn knows(&self, vendor_product: Option<(u16, u16)>) -> bool {
        vendor_product.is_some() && self.profiles.iter().any(|profile| profile.device == vendor_product)
    }

    /// A device came.
    pub fn connected(&mut self, device: usize, vendor_product: Option<(u16, u16)>) {
        self.devices.insert(device, vendor_product);
    }

    /// A device went: its axes are neutral again, its levers stay where they were. Gives `LookEnd` if its hat was held.
    pub fn disconnected(&mut self, device: usize) -> Option<Command> {
        self.devices.remove(&device);
        self.values.retain(|(of, target), _| *of != device || target.stays());
        self.looking.take().map(|_| Command::LookEnd)
    }

    /// Every device went.
    pub fn disconnect_all(&mut self) {
        self.devices.clear();
        self.values.retain(|(_, target), _| target.stays());
        self.looking = None;
    }

    /// Devices now connected.
    pub fn device_count(&self) -> usize {
        self.devices.len()
    }

    /// An axis moved to `raw`, -1..1. Gives a command where a hat was pushed or let go.
    pub fn axis(&mut self, device: usize, code: u32, raw: f64) -> Option<Command> {
        let binding = *self.profile(device)?.axes.iter().find(|binding| binding.code == code)?;
        self.move_target(device, binding.target, binding.curve, raw)
    }

    /// A target moved, whatever axis it is on.
    pub fn move_target(&mut self, device: usize, target: Target, curve: Curve, raw: f64) -> Option<Command> {
        let value = curve.apply(raw)?;
        self.values.insert((device, target), value);
        let (negative, positive) = match target {
            Target::LookSide => (ViewLook::Left, ViewLook::Right),
            Target::LookUp => (ViewLook::Down, ViewLook::Up),
            _ => return None,
        };
        let looks = (value.abs() > 0.5).then_some(if value > 0.0 { positive } else { negative });
        // The hat's other axis stays as it is: only a change of this one counts.
        if looks.is_none() && !self.looking.is_some_and(|l| l == negative || l == positive) {
            return None;
        }
        if looks == self.looking {
            return None;
        }
        self.looking = looks;
        Some(looks.map_or(Command::LookEnd, Command::Look))
    }

    /// A button went down or up; gives its command.
    pub fn button(&mut self, device: usize, code: u32, pressed: bool) -> Option<Command> {
        let &(_, command) = self.profile(device)?.buttons.iter().find(|(of, _)| *of == code)?;
        match (command, pressed) {
            (command, true) => Some(command),
            (command, false) => command.ending(),
        }
    }

    /// Axes of all devices together: sums, and of throttles the most open.
    pub fn axes(&self) -> StickAxes {
        let sum = |target: Target| -> Option<f64> {
            let mut values: Vec<f64> =
                self.values.iter().filter(|((_, of), _)| *of == target).map(|(_, v)| *v).collect();
            // A sum of floats depends on its order, and a hash map has none.
            values.sort_by(f64::total_cmp);
            (!values.is_empty()).then(|| values.iter().sum::<f64>().clamp(-1.0, 1.0))
        };
        // Of several levers the one farthest on.
        let lever = |target: Target| {
            let values = self.values.iter().filter(|((_, of), _)| *of == target);
            values.map(|(_, value)| 0.5 + 0.5 * value).reduce(f64::max)
        };
        StickAxes {
            pitch: sum(Target::Pitch),
            roll: sum(Target::Roll),
            yaw: sum(Target::Yaw),
            throttle: lever(Target::Throttle),
            levers: LeverAxes {
                mixture: lever(Target::Mixture),
                flaps: lever(Target::Flaps),
                trim: sum(Target::Trim),
                brakes: [lever(Target::BrakeLeft), lever(Target::BrakeRight)],
            },
        }
    }

    fn profile(&self, device: usize) -> Option<&Profile> {
        profile::of_device(&self.profiles, self.devices.get(&device).copied().flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STICK: Option<(u16, u16)> = Some((0x044f, 0xb10a));

    fn with_stick() -> Bindings {
        let mut bindings = Bindings::default();
        bindings.connected(0, STICK);
        bindings
    }

    #[test]
    fn the_throttle_is_bound_by_raw_code_and_open_at_its_far_end() {
        let mut bindings = with_stick();
        assert_eq!(bindings.axes().throttle, None, "not moved yet");
        bindings.axis(0, 0x30006, -1.0);
        assert_eq!(bindings.axes().throttle, Some(1.0));
        bindings.axis(0, 0x30006, 1.0);
        assert_eq!(bindings.axes().throttle, Some(0.0));
        bindings.axis(0, 0x30000, 1.0);
        assert_eq!(bindings.axes().roll, Some(1.0));
    }

    #[test]
    fn unplugging_in_flight_neutralises_the_stick_and_keeps_the_throttle() {
        let mut bindings = with_stick();
        bindings.axis(0, 0x30001, 0.9);
        bindings.axis(0, 0x30006, -0.5);
        assert_eq!(bindings.axis(0, 0x30010, -1.0), Some(Command::Look(ViewLook::Left)));
        assert_eq!(bindings.disconnected(0), Some(Command::LookEnd));
        let axes = bindings.axes();
        assert_eq!((axes.pitch, axes.throttle), (None, Some(0.75)));
        assert_eq!(bindings.device_count(), 0);
    }

    #[test]
    fn levers_on_axes_move_only_what_moved_and_brakes_are_let_go_with_their_device() {
        let pedals = "[[stick]]\ndevice = \"06a3:0763\"\naxes = [{ code = 1, moves = \"brake_left\" }, \
                      { code = 2, moves = \"brake_right\" }, { code = 3, moves = \"mixture\" }, \
                      { code = 4, moves = \"trim\" }, { code = 5, moves = \"flaps\" }]";
        let mut bindings = Bindings::new(profile::with_embedded(pedals).unwrap());
        bindings.connected(3, Some((0x06a3, 0x0763)));
        let levers = Levers { gear: 0.0, trim: 0.3, ..Levers::default() };
        let before = bindings.axes().levers;
        assert_eq!(before.moved(&before, &levers), None);
        bindings.axis(3, 1, 1.0);
        bindings.axis(3, 3, 0.0);
        bindings.axis(3, 5, f64::NAN);
        let now = bindings.axes().levers;
        let moved = now.moved(&before, &levers).unwrap();
        assert_eq!(moved, Levers { brakes: [1.0, 0.0], mixture: 0.5, ..levers });
        // A key leaned since: the axis that rests does not take it back.
        bindings.axis(3, 4, -1.0);
        let leaned = Levers { mixture: 0.7, ..moved };
        let moved = bindings.axes().levers.moved(&now, &leaned).unwrap();
        assert_eq!(moved, Levers { trim: -1.0, ..leaned });
        let now = bindings.axes().levers;
        bindings.disconnected(3);
        let moved = bindings.axes().levers.moved(&now, &moved).unwrap();
        assert_eq!((moved.brakes, moved.mixture), ([0.0; 2], 0.7));
    }

    #[test]
    fn hostile_values_and_codes_change_nothing() {
        let mut bindings = with_stick();
        bindings.axis(0, 0x30000, 0.5);
        let before = bindings.axes();
        for raw in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            bindings.axis(0, 0x30000, raw);
        }
        for code in [0, u32::MAX, 0x3ffff] {
            bindings.axis(0, code, 0.3);
            assert_eq!(bindings.button(0, code, true), None);
        }
        bindings.axis(0, 0x30000, 0.5);
        assert_eq!(bindings.axes(), before);
        bindings.axis(0, 0x30000, 1e30);
        assert_eq!(bindings.axes().roll, Some(1.0));
    }

    #[test]
    fn an_unknown_stick_gets_the_general_profile_and_two_sticks_add_up() {
        let mut bindings = with_stick();
        bindings.connected(1, Some((0x1234, 0x5678)));
        bindings.axis(0, 0x30000, -1.0);
        bindings.axis(1, 0x30000, 1.0);
        assert_eq!(bindings.axes().roll, Some(0.0));
        assert_eq!(bindings.button(1, 0x10120, true), Some(Command::Trigger));
        assert_eq!(bindings.button(1, 0x10120, false), Some(Command::TriggerEnd));
        assert_eq!(bindings.button(1, 0x10122, false), None);
    }
}
