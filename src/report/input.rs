//! What `input` reports of the sticks: which there are, how far each axis went, which buttons went down.

use serde::Serialize;

/// `input`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Input {
    /// The devices that were there.
    pub devices: Vec<Device>,
    /// Events taken in.
    pub events: u64,
    /// The file that was written.
    pub written: Option<String>,
}

/// A device.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Device {
    /// As the system calls it.
    pub name: String,
    /// `vendor:product`, hexadecimal; null where the system does not say.
    pub device: Option<String>,
    /// Name of the profile that binds it.
    pub bound_by: Option<String>,
    /// Axes that moved.
    pub axes: Vec<AxisSeen>,
    /// Buttons that went down.
    pub buttons: Vec<ButtonSeen>,
}

/// An axis that moved.
#[derive(Debug, Clone, Default, Serialize)]
pub struct AxisSeen {
    /// Raw code, hexadecimal.
    pub code: String,
    /// What it moves, if it is bound.
    pub moves: Option<String>,
    /// Least value, -1..=1.
    pub least: f64,
    /// Greatest value.
    pub greatest: f64,
    /// Last value.
    pub last: f64,
}

/// A button that went down.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ButtonSeen {
    /// Raw code, hexadecimal.
    pub code: String,
    /// What it does, if it is bound.
    pub does: Option<String>,
    /// How often.
    pub times: u64,
}
