//! Files that bind sticks: raw codes of a kind of device to what they move and command, as TOML.
//!
//! The embedded file is `assets/input/sticks.toml`, which says what the keys mean; a pilot's own file comes before it.
//! Raw codes are those of the system, on Linux `type << 16 | code` of linux/input-event-codes.h.
//!
//! Invariant others rely on: what was read binds each code of a device once, and every number of it is within its range.

use super::{Command, Curve};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::fmt;
use std::sync::{Arc, LazyLock};

/// The embedded file.
const EMBEDDED: &str = include_str!("../../../assets/input/sticks.toml");
/// Largest file read, bytes, and most axes or buttons of a stick.
pub const MOST_BYTES: usize = 1 << 20;
const MOST_CODES: usize = 512;

/// What an axis moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// Stick forward and back.
    Pitch,
    /// Stick left and right.
    Roll,
    /// Pedals or the stick's twist.
    Yaw,
    /// Throttle lever: -1 closed, 1 open.
    Throttle,
    /// Mixture lever: -1 cut off, 1 full rich.
    Mixture,
    /// Flaps lever: -1 up, 1 full out.
    Flaps,
    /// Trim wheel: 1 nose up.
    Trim,
    /// Left toe brake: -1 let go, 1 pressed.
    BrakeLeft,
    /// Right toe brake.
    BrakeRight,
    /// The hat left and right.
    LookSide,
    /// The hat forward and back.
    LookUp,
}

impl Target {
    /// Whether its whole way is of use: it has no middle that is neutral.
    pub fn is_lever(self) -> bool {
        matches!(self, Self::Throttle | Self::Mixture | Self::Flaps | Self::BrakeLeft | Self::BrakeRight)
    }

    /// Whether it stays where it was when its device goes.
    pub fn stays(self) -> bool {
        matches!(self, Self::Throttle | Self::Mixture | Self::Flaps | Self::Trim)
    }
}

/// One axis of a device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisBinding {
    /// Raw code.
    pub code: u32,
    /// What it moves.
    pub target: Target,
    /// How.
    pub curve: Curve,
}

/// How the axes and buttons of a kind of device are bound.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    /// For people.
    pub name: String,
    /// USB vendor and product, or `None` for any stick.
    pub device: Option<(u16, u16)>,
    /// Axes.
    pub axes: Vec<AxisBinding>,
    /// Buttons by raw code.
    pub buttons: Vec<(u32, Command)>,
}

/// Why a file binds nothing: what was expected and what was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProfileError(String);

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for ProfileError {}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    stick: Vec<Stick>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stick {
    #[serde(default)]
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    device: Option<String>,
    #[serde(default)]
    axes: Vec<Axis>,
    #[serde(default)]
    buttons: Vec<Button>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Axis {
    code: u32,
    moves: Target,
    #[serde(default)]
    dead_zone: f64,
    #[serde(default)]
    softness: f64,
    #[serde(default)]
    inverted: bool,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Button {
    code: u32,
    does: String,
}

/// The embedded profiles, the particular before the general.
pub fn embedded() -> Arc<[Profile]> {
    // A test reads it, so it never falls to the empty list.
    static READ: LazyLock<Arc<[Profile]>> = LazyLock::new(|| parse(EMBEDDED).unwrap_or_default().into());
    READ.clone()
}

/// Profiles of a file, and after them the embedded ones.
///
/// # Errors
/// [`ProfileError`] names the stick and the key.
pub fn with_embedded(text: &str) -> Result<Arc<[Profile]>, ProfileError> {
    let mut own = parse(text)?;
    own.extend(embedded().iter().cloned());
    Ok(own.into())
}

/// Profiles of a file.
///
/// # Errors
/// [`ProfileError`] names the stick and the key.
pub fn parse(text: &str) -> Result<Vec<Profile>, ProfileError> {
    if text.len() > MOST_BYTES {
        return Err(ProfileError(format!("expected at most {MOST_BYTES} bytes, found {}", text.len())));
    }
    let file: File = toml::from_str(text).map_err(|error| ProfileError(error.to_string()))?;
    file.stick.into_iter().enumerate().map(|(number, stick)| profile(number + 1, stick)).collect()
}

/// The profile of a kind of device: the first of its own, else the first for any.
pub fn of_device(profiles: &[Profile], vendor_product: Option<(u16, u16)>) -> Option<&Profile> {
    let own = profiles.iter().find(|profile| profile.device.is_some() && profile.device == vendor_product);
    own.or_else(|| profiles.iter().find(|profile| profile.device.is_none()))
}

/// A file that reads back to the same profiles.
pub fn written(profiles: &[Profile]) -> String {
    let stick = |profile: &Profile| Stick {
        name: profile.name.clone(),
        device: profile.device.map(|(vendor, product)| format!("{vendor:04x}:{product:04x}")),
        axes: profile.axes.iter().map(written_axis).collect(),
        buttons: profile
            .buttons
            .iter()
            .map(|(code, does)| Button { code: *code, does: does.name().to_owned() })
            .collect(),
    };
    // Plain numbers and texts always are TOML.
    toml::to_string(&File { stick: profiles.iter().map(stick).collect() }).unwrap_or_default()
}

fn written_axis(axis: &AxisBinding) -> Axis {
    let Curve { dead_zone, softness, inverted } = axis.curve;
    Axis { code: axis.code, moves: axis.target, dead_zone, softness, inverted }
}

fn profile(number: usize, stick: Stick) -> Result<Profile, ProfileError> {
    let refuse = |what: String| ProfileError(format!("stick {number} ({}): {what}", stick.name));
    let device = stick.device.as_deref().map(|text| device(text).map_err(&refuse)).transpose()?;
    if stick.axes.len() > MOST_CODES || stick.buttons.len() > MOST_CODES {
        return Err(refuse(format!("expected at most {MOST_CODES} axes and buttons each")));
    }
    let mut seen = HashSet::new();
    let mut axes = Vec::with_capacity(stick.axes.len());
    for axis in &stick.axes {
        let code = axis.code;
        if !seen.insert(code) {
            return Err(refuse(format!("axes: expected each code once, found {code:#x} twice")));
        }
        for (key, value, most) in [("dead_zone", axis.dead_zone, 0.9), ("softness", axis.softness, 1.0)] {
            if !(0.0..=most).contains(&value) {
                return Err(refuse(format!("axis {code:#x}: {key}: expected 0..={most}, found {value}")));
            }
        }
        let curve = Curve { dead_zone: axis.dead_zone, softness: axis.softness, inverted: axis.inverted };
        axes.push(AxisBinding { code, target: axis.moves, curve });
    }
    seen.clear();
    let mut buttons = Vec::with_capacity(stick.buttons.len());
    for button in &stick.buttons {
        let code = button.code;
        if !seen.insert(code) {
            return Err(refuse(format!("buttons: expected each code once, found {code:#x} twice")));
        }
        let does = Command::named(&button.does).ok_or_else(|| {
            let known: Vec<&str> = Command::names().collect();
            refuse(format!("button {code:#x}: does: expected one of {}, found {}", known.join(" "), button.does))
        })?;
        buttons.push((code, does));
    }
    Ok(Profile { name: stick.name, device, axes, buttons })
}

fn device(text: &str) -> Result<(u16, u16), String> {
    let is_hex = |part: &str| part.len() == 4 && part.bytes().all(|digit| digit.is_ascii_hexdigit());
    let number = |part: &str| u16::from_str_radix(part, 16).ok().filter(|_| is_hex(part));
    text.split_once(':')
        .and_then(|(vendor, product)| number(vendor).zip(number(product)))
        .ok_or_else(|| format!("device: expected vendor:product such as 044f:b10a, found {text}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_file_reads_and_ends_with_a_profile_for_any_stick() {
        let profiles = parse(EMBEDDED).unwrap();
        assert_eq!(profiles.len(), embedded().len());
        assert_eq!(profiles[0].device, Some((0x044f, 0xb10a)));
        assert_eq!(profiles.last().map(|profile| profile.device), Some(None));
        for profile in &profiles {
            for target in [Target::Pitch, Target::Roll, Target::Yaw, Target::Throttle] {
                assert!(profile.axes.iter().any(|axis| axis.target == target), "{} {target:?}", profile.name);
            }
        }
    }

    #[test]
    fn what_is_written_reads_back() {
        let profiles = parse(EMBEDDED).unwrap();
        assert_eq!(parse(&written(&profiles)).unwrap(), profiles);
        let own = with_embedded("[[stick]]\ndevice = '1234:abcd'\naxes = [{ code = 3, moves = 'yaw' }]\n").unwrap();
        assert_eq!((own[0].device, own.len()), (Some((0x1234, 0xabcd)), profiles.len() + 1));
    }

    #[test]
    fn hostile_files_are_refused_with_what_was_expected() {
        let refused = |text: &str| parse(text).unwrap_err().to_string();
        assert!(refused("[[stick]]\ndevice = '44f:b10a'").contains("expected vendor:product"));
        assert!(refused("[[stick]]\ndevice = '+44f:b10a'").contains("expected vendor:product"));
        assert!(refused("[[stick]]\naxes = [{ code = 1, moves = 'up' }]").contains("look_up"));
        assert!(refused("[[stick]]\naxes = [{ code = -1, moves = 'yaw' }]").contains("u32"));
        assert!(refused("[[stick]]\naxes = [{ code = 1, moves = 'yaw', dead_zone = nan }]").contains("0..=0.9"));
        let twice = "[[stick]]\naxes = [{ code = 1, moves = 'yaw' }, { code = 1, moves = 'roll' }]";
        assert!(refused(twice).contains("0x1 twice"));
        assert!(refused("[[stick]]\nbuttons = [{ code = 1, does = 'eject' }]").contains("expected one of pause"));
        assert!(refused("[[stick]]\nwheels = 3").contains("wheels"));
        assert!(refused(&"#".repeat(MOST_BYTES + 1)).contains("bytes"));
        assert!(!refused("\u{0}").is_empty());
    }
}
