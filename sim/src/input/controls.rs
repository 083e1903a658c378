//! What a pilot commands: four axes and a list of commands.

use std::fmt;

/// Axes. Invariant: after [`Controls::checked`] every one is finite and within its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controls {
    /// Stick back (nose up) positive, -1..1.
    pub pitch: f64,
    /// Stick right positive, -1..1.
    pub roll: f64,
    /// Right pedal positive, -1..1.
    pub yaw: f64,
    /// 0..1.
    pub throttle: f64,
}

impl Default for Controls {
    fn default() -> Self {
        Self { pitch: 0.0, roll: 0.0, yaw: 0.0, throttle: 0.5 }
    }
}

impl Controls {
    /// The same within range; what is not finite becomes neutral, a throttle half.
    #[must_use]
    pub fn checked(self) -> Self {
        let axis = |v: f64| if v.is_finite() { v.clamp(-1.0, 1.0) } else { 0.0 };
        let throttle = if self.throttle.is_finite() { self.throttle.clamp(0.0, 1.0) } else { 0.5 };
        Self { pitch: axis(self.pitch), roll: axis(self.roll), yaw: axis(self.yaw), throttle }
    }
}

/// Where the pilot's head looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ViewLook {
    /// Ahead again.
    Ahead,
    /// Turned left while held.
    Left,
    /// Turned right while held.
    Right,
    /// Up while held.
    Up,
    /// Down while held.
    Down,
    /// Behind.
    Back,
}

/// A discrete command, given once when its key or button goes down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Command {
    /// Stops or continues time.
    Pause,
    /// Holds the aircraft in place while time goes on.
    Freeze,
    /// Back to the start.
    Reset,
    /// Into or out of free movement.
    Slew,
    /// Lets the built-in track fly, or takes over from it.
    Track,
    /// Saves a picture.
    Screenshot,
    /// Wireframe on or off.
    Wireframe,
    /// Next overlay of block levels.
    BlockOverlay,
    /// Head-up display on or off.
    Hud,
    /// The mouse becomes the stick, or no longer.
    MouseStick,
    /// The next place to see from.
    NextCamera,
    /// Back to the pilot's eye.
    CockpitCamera,
    /// Flaps out by a notch.
    FlapsDown,
    /// Flaps in by a notch.
    FlapsUp,
    /// Gear up or down.
    Gear,
    /// Both wheel brakes, while held.
    Brake,
    /// Wheel brakes let go.
    BrakeEnd,
    /// Parking brake on or off.
    ParkingBrake,
    /// Trim nose up by a notch.
    TrimUp,
    /// Trim nose down by a notch.
    TrimDown,
    /// Mixture richer by a notch.
    MixtureRich,
    /// Mixture leaner by a notch.
    MixtureLean,
    /// Altimeter set to a hectopascal more.
    AltimeterUp,
    /// Altimeter set to a hectopascal less.
    AltimeterDown,
    /// Lets the trigger do something, or no longer.
    MasterArm,
    /// The next weapon.
    NextWeapon,
    /// How many bombs or rockets leave at a press of the trigger.
    NextRipple,
    /// Drops all bombs and pods unarmed.
    Jettison,
    /// The trigger is pressed.
    Trigger,
    /// The trigger is let go.
    TriggerEnd,
    /// An hour later.
    TimeForward,
    /// An hour earlier.
    TimeBack,
    /// A month later.
    DateForward,
    /// A month earlier.
    DateBack,
    /// Simulation twice as fast, at most 8 times.
    RateUp,
    /// Simulation at half its rate.
    RateDown,
    /// The head turns.
    Look(ViewLook),
    /// The head's turn ends.
    LookEnd,
    /// Leaves the program.
    Quit,
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Pause => "pause",
            Self::Freeze => "freeze the aircraft",
            Self::Reset => "reset",
            Self::Slew => "slew",
            Self::Track => "built-in track on/off",
            Self::Screenshot => "screenshot",
            Self::Wireframe => "wireframe",
            Self::BlockOverlay => "block overlay",
            Self::Hud => "head-up display",
            Self::MouseStick => "mouse as a stick",
            Self::NextCamera => "next camera",
            Self::CockpitCamera => "cockpit",
            Self::FlapsDown => "flaps down",
            Self::FlapsUp => "flaps up",
            Self::Gear => "gear",
            Self::Brake => "brakes",
            Self::BrakeEnd => "brakes let go",
            Self::ParkingBrake => "parking brake",
            Self::TrimUp => "trim nose up",
            Self::TrimDown => "trim nose down",
            Self::MixtureRich => "mixture richer",
            Self::MixtureLean => "mixture leaner",
            Self::AltimeterUp => "altimeter 1 hPa more",
            Self::AltimeterDown => "altimeter 1 hPa less",
            Self::MasterArm => "master arm",
            Self::NextWeapon => "next weapon",
            Self::NextRipple => "more or fewer in a row",
            Self::Jettison => "jettison",
            Self::Trigger => "trigger",
            Self::TriggerEnd => "trigger let go",
            Self::TimeForward => "an hour later",
            Self::TimeBack => "an hour earlier",
            Self::DateForward => "a month later",
            Self::DateBack => "a month earlier",
            Self::RateUp => "simulate faster",
            Self::RateDown => "simulate slower",
            Self::Look(ViewLook::Ahead) => "look ahead",
            Self::Look(ViewLook::Left) => "look left",
            Self::Look(ViewLook::Right) => "look right",
            Self::Look(ViewLook::Up) => "look up",
            Self::Look(ViewLook::Down) => "look down",
            Self::Look(ViewLook::Back) => "look back",
            Self::LookEnd => "look where the nose points",
            Self::Quit => "quit",
        })
    }
}

/// Every command by the name that a file calls it.
const NAMES: &[(&str, Command)] = &[
    ("pause", Command::Pause),
    ("freeze", Command::Freeze),
    ("reset", Command::Reset),
    ("slew", Command::Slew),
    ("track", Command::Track),
    ("screenshot", Command::Screenshot),
    ("wireframe", Command::Wireframe),
    ("block_overlay", Command::BlockOverlay),
    ("hud", Command::Hud),
    ("mouse_stick", Command::MouseStick),
    ("next_camera", Command::NextCamera),
    ("cockpit_camera", Command::CockpitCamera),
    ("flaps_down", Command::FlapsDown),
    ("flaps_up", Command::FlapsUp),
    ("gear", Command::Gear),
    ("brake", Command::Brake),
    ("brake_end", Command::BrakeEnd),
    ("parking_brake", Command::ParkingBrake),
    ("trim_up", Command::TrimUp),
    ("trim_down", Command::TrimDown),
    ("mixture_rich", Command::MixtureRich),
    ("mixture_lean", Command::MixtureLean),
    ("altimeter_up", Command::AltimeterUp),
    ("altimeter_down", Command::AltimeterDown),
    ("master_arm", Command::MasterArm),
    ("next_weapon", Command::NextWeapon),
    ("next_ripple", Command::NextRipple),
    ("jettison", Command::Jettison),
    ("trigger", Command::Trigger),
    ("trigger_end", Command::TriggerEnd),
    ("time_forward", Command::TimeForward),
    ("time_back", Command::TimeBack),
    ("date_forward", Command::DateForward),
    ("date_back", Command::DateBack),
    ("rate_up", Command::RateUp),
    ("rate_down", Command::RateDown),
    ("look_ahead", Command::Look(ViewLook::Ahead)),
    ("look_left", Command::Look(ViewLook::Left)),
    ("look_right", Command::Look(ViewLook::Right)),
    ("look_up", Command::Look(ViewLook::Up)),
    ("look_down", Command::Look(ViewLook::Down)),
    ("look_back", Command::Look(ViewLook::Back)),
    ("look_end", Command::LookEnd),
    ("quit", Command::Quit),
];

impl Command {
    /// What letting go of its key or button does.
    pub fn ending(self) -> Option<Self> {
        match self {
            Self::Look(_) => Some(Self::LookEnd),
            Self::Trigger => Some(Self::TriggerEnd),
            Self::Brake => Some(Self::BrakeEnd),
            _ => None,
        }
    }

    /// Names that a file may use.
    pub fn names() -> impl Iterator<Item = &'static str> {
        NAMES.iter().map(|(name, _)| *name)
    }

    /// The command of a name.
    pub fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(of, _)| *of == name).map(|(_, command)| *command)
    }

    /// Its name in a file; a test finds every command there.
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(_, of)| *of == self).map_or("", |(name, _)| name)
    }
}

/// How a device's axis becomes a command: dead zone, softness about the middle, direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// Half width of the middle that counts as neutral, 0..1.
    pub dead_zone: f64,
    /// 0 is straight, 1 is the cube: how much softer the middle is.
    pub softness: f64,
    /// Turns the axis round.
    pub inverted: bool,
}

impl Curve {
    /// Straight, without a dead zone.
    pub const STRAIGHT: Self = Self { dead_zone: 0.0, softness: 0.0, inverted: false };

    /// The command of a raw value, -1..1 and continuous; `None` if the value is not finite.
    pub fn apply(&self, raw: f64) -> Option<f64> {
        if !raw.is_finite() {
            return None;
        }
        let raw = raw.clamp(-1.0, 1.0);
        let dead = self.dead_zone.clamp(0.0, 0.9);
        let past = ((raw.abs() - dead) / (1.0 - dead)).max(0.0).copysign(raw);
        let softness = self.softness.clamp(0.0, 1.0);
        let bent = (1.0 - softness) * past + softness * past.powi(3);
        Some(if self.inverted { -bent } else { bent })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn controls_are_in_range_whatever_comes(pitch: f64, roll: f64, yaw: f64, throttle: f64) {
            let c = Controls { pitch, roll, yaw, throttle }.checked();
            prop_assert!([c.pitch, c.roll, c.yaw].iter().all(|v| (-1.0..=1.0).contains(v)));
            prop_assert!((0.0..=1.0).contains(&c.throttle));
        }

        #[test]
        fn a_curve_is_odd_rising_and_reaches_its_ends(dead_zone in 0.0..0.5, softness in 0.0..1.0, a in -1.0..1.0, b in -1.0..1.0) {
            let curve = Curve { dead_zone, softness, inverted: false };
            let at = |v: f64| curve.apply(v).unwrap();
            prop_assert!((at(1.0) - 1.0).abs() < 1e-15 && (at(-1.0) + 1.0).abs() < 1e-15);
            prop_assert_eq!(at(a), -at(-a));
            prop_assert!(a > b || at(a) <= at(b));
            prop_assert!(a.abs() > dead_zone || at(a) == 0.0);
        }
    }

    #[test]
    fn names_and_commands_belong_together() {
        for (name, command) in NAMES {
            assert_eq!((Command::named(name), command.name()), (Some(*command), *name));
        }
        for (_, action) in crate::input::keyboard::DEFAULT_KEYS {
            if let crate::input::keyboard::KeyAction::Command(command) = action {
                assert!(!command.name().is_empty(), "{command}");
            }
        }
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        for raw in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(Curve::STRAIGHT.apply(raw), None);
        }
        assert_eq!(
            Controls { pitch: f64::NAN, roll: 9.0, yaw: 0.0, throttle: f64::NAN }.checked(),
            Controls { roll: 1.0, ..Controls::default() }
        );
    }
}
