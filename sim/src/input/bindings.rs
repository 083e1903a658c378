//! What bound sticks say: from axes and buttons of devices to what they move and command.
//!
//! Knows no library, so tests can feed it what no device would send. A device is known by vendor and product and bound
//! by the first of the [`Profile`]s that is for it, else by the first that is for any.
//!
//! Invariant: a device that goes leaves its axes neutral and its throttle where it was; a bad value changes nothing.

use super::profile::{self, Profile, Target};
use super::{Command, Curve, ViewLook};
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

    /// A device went: its axes are neutral again, its throttle stays where it was. Gives `LookEnd` if its hat was held.
    pub fn disconnected(&mut self, device: usize) -> Option<Command> {
        self.devices.remove(&device);
        self.values.retain(|(of, target), _| *of != device || *target == Target::Throttle);
        self.looking.take().map(|_| Command::LookEnd)
    }

    /// Every device went.
    pub fn disconnect_all(&mut self) {
        self.devices.clear();
        self.values.retain(|(_, target), _| *target == Target::Throttle);
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
        let throttles = self.values.iter().filter(|((_, of), _)| *of == Target::Throttle).map(|(_, v)| 0.5 + 0.5 * v);
        StickAxes {
            pitch: sum(Target::Pitch),
            roll: sum(Target::Roll),
            yaw: sum(Target::Yaw),
            throttle: throttles.reduce(f64::max),
        }
    }

    fn profile(&self, device: usize) -> Option<&Profile> {
        let known = self.devices.get(&device).copied().flatten();
        let own = self.profiles.iter().find(|profile| profile.device.is_some() && profile.device == known);
        own.or_else(|| self.profiles.iter().find(|profile| profile.device.is_none()))
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
