//! What a pilot sets and leaves: mixture, flaps, gear, brakes, trim, the altimeter.
//!
//! Parts of a lever's way, and a pressure. A model takes those that it has a control for, by name ([`crate::scene`], `flown.rs`).

use crate::air_data::{SETTINGS_PA, STANDARD_PA};

/// Levers. Invariant: after [`Levers::checked`] every one is finite and within its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levers {
    /// 0 is cut off, 1 full rich.
    pub mixture: f64,
    /// 0 is up, 1 full out.
    pub flaps: f64,
    /// 0 is up, 1 down.
    pub gear: f64,
    /// Left and right wheel brake, 0..1.
    pub brakes: [f64; 2],
    /// Parking brake, 0..1.
    pub parking_brake: f64,
    /// Elevator trim, -1..1, nose up positive.
    pub trim: f64,
    /// Starter, 0..1.
    pub starter: f64,
    /// What the altimeter is set to, Pa.
    pub altimeter_pa: f64,
}

impl Default for Levers {
    fn default() -> Self {
        Self {
            mixture: 1.0,
            flaps: 0.0,
            gear: 1.0,
            brakes: [0.0; 2],
            parking_brake: 0.0,
            trim: 0.0,
            starter: 0.0,
            altimeter_pa: STANDARD_PA,
        }
    }
}

impl Levers {
    /// The same within range; what is not finite is as by default.
    #[must_use]
    pub fn checked(self) -> Self {
        let safe = Self::default();
        let held = |value: f64, low: f64, safe: f64| if value.is_finite() { value.clamp(low, 1.0) } else { safe };
        Self {
            mixture: held(self.mixture, 0.0, safe.mixture),
            flaps: held(self.flaps, 0.0, safe.flaps),
            gear: held(self.gear, 0.0, safe.gear),
            brakes: self.brakes.map(|brake| held(brake, 0.0, 0.0)),
            parking_brake: held(self.parking_brake, 0.0, safe.parking_brake),
            trim: held(self.trim, -1.0, safe.trim),
            starter: held(self.starter, 0.0, safe.starter),
            altimeter_pa: if self.altimeter_pa.is_finite() {
                self.altimeter_pa.clamp(SETTINGS_PA.0, SETTINGS_PA.1)
            } else {
                safe.altimeter_pa
            },
        }
    }
}
