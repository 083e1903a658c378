//! The pilot's levers by key and button: each press moves one by a notch, as a switch would.

use super::Scene;
use crate::input::{self, Levers};

/// Notches of the flaps' way, and of a press of trim and mixture.
const FLAPS_NOTCH: f64 = 0.25;
const TRIM_NOTCH: f64 = 0.02;
const MIXTURE_NOTCH: f64 = 0.05;
/// A press of the altimeter's knob.
const ALTIMETER_NOTCH_PA: f64 = 100.0;

impl Scene {
    pub(super) fn lever(&mut self, command: input::Command) {
        let toggled = |lever: f64| if lever > 0.5 { 0.0 } else { 1.0 };
        let now = self.levers;
        let levers = match command {
            input::Command::FlapsDown => Levers { flaps: now.flaps + FLAPS_NOTCH, ..now },
            input::Command::FlapsUp => Levers { flaps: (now.flaps - FLAPS_NOTCH).max(0.0), ..now },
            input::Command::Gear => Levers { gear: toggled(now.gear), ..now },
            input::Command::Brake => Levers { brakes: [1.0; 2], ..now },
            input::Command::BrakeEnd => Levers { brakes: [0.0; 2], ..now },
            input::Command::ParkingBrake => Levers { parking_brake: toggled(now.parking_brake), ..now },
            input::Command::TrimUp => Levers { trim: now.trim + TRIM_NOTCH, ..now },
            input::Command::TrimDown => Levers { trim: now.trim - TRIM_NOTCH, ..now },
            input::Command::MixtureRich => Levers { mixture: now.mixture + MIXTURE_NOTCH, ..now },
            input::Command::MixtureLean => Levers { mixture: (now.mixture - MIXTURE_NOTCH).max(0.0), ..now },
            input::Command::AltimeterUp => Levers { altimeter_pa: now.altimeter_pa + ALTIMETER_NOTCH_PA, ..now },
            input::Command::AltimeterDown => Levers { altimeter_pa: now.altimeter_pa - ALTIMETER_NOTCH_PA, ..now },
            _ => now,
        };
        self.levers = levers.checked();
    }
}
