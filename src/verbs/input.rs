//! `poligon input`: what the sticks of this machine say, live, and a file that binds them.
//!
//! Without `--write` it shows for a while which axis moves and which button goes down, by raw code, and what each is
//! bound to. With it the pilot is asked to move one control after the other; the axis that goes farthest and stays there
//! is that control's, and the way it went its direction. An axis that has its control is not looked at again: it is let
//! go while the next is moved.

use crate::args::InputArgs;
use crate::failure::Failure;
use crate::output::{self, Output};
use crate::report::{AxisSeen, ButtonSeen, Device, Input};
use crate::sticks;
use sim::input::Curve;
use sim::input::joystick::{Change, Connected, Joystick};
use sim::input::profile::{self, AxisBinding, Profile, Target};
use std::collections::BTreeMap;
use std::io::{self, IsTerminal, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long is listened unless asked for; with `--write`, at most for each control. Seconds.
const LISTEN_S: f64 = 15.0;
const CONTROL_S: f64 = 10.0;
/// A control that is held this long was meant.
const HELD: Duration = Duration::from_millis(700);
/// An axis counts as moved on purpose from here on, of its -1..1.
const MOVED: f64 = 0.4;
/// Devices are looked at this often.
const LOOK: Duration = Duration::from_millis(8);

/// What the pilot is asked for: the control, where to move it, and the sign that this has for us.
const ASKED: [(Target, &str); 7] = [
    (Target::Roll, "the stick fully to the right"),
    (Target::Pitch, "the stick fully back"),
    (Target::Yaw, "the right pedal (or twist the stick right) fully"),
    (Target::Throttle, "the throttle fully open"),
    (Target::BrakeLeft, "the left toe brake fully down, if there is one"),
    (Target::BrakeRight, "the right toe brake fully down, if there is one"),
    (Target::Mixture, "the mixture lever fully rich, if there is one"),
];

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &InputArgs, output: Output) -> Result<(), Failure> {
    // A file that is to be written need not be there yet.
    let named = args.sticks.as_deref().filter(|file| !args.write || file.exists());
    let profiles = sticks::bindings(named)?;
    let mut sticks = Joystick::bound(profiles.clone()).map_err(|error| Failure::Failed(error.to_string()))?;
    let mut heard = Heard::default();
    if sticks.connected().is_empty() {
        output::tell(format_args!("poligon: no stick is plugged in; one that comes now is seen"));
    }
    for device in sticks.devices() {
        output::tell(format_args!("poligon: {device}"));
    }
    let mut found = Vec::new();
    if args.write {
        for (target, what) in ASKED {
            output::tell(format_args!("poligon: move {what} and hold it there"));
            let taken: Vec<(usize, u32)> = found.iter().map(|(device, _, code, _)| (*device, *code)).collect();
            heard.listen(&mut sticks, args.seconds_s.unwrap_or(CONTROL_S), Some(&taken));
            match heard.moved(&taken) {
                Some((device, code, way)) => {
                    output::tell(format_args!("poligon: {code:#x} {}", if way > 0.0 { "" } else { "inverted" }));
                    found.push((device, target, code, way));
                }
                None => output::tell(format_args!("poligon: nothing moved; it stays as it is")),
            }
        }
    } else {
        heard.listen(&mut sticks, args.seconds_s.unwrap_or(LISTEN_S), None);
    }
    let mut report = heard.report(&sticks, &profiles);
    if args.write {
        report.written = written(args, &sticks, &profiles, &found)?;
    }
    output.print(&report)
}

/// What an axis did.
#[derive(Debug, Clone, Copy)]
struct Moves {
    least: f64,
    greatest: f64,
    last: f64,
    /// Where it stood when the listening began.
    began: f64,
}

#[derive(Debug, Default)]
struct Heard {
    axes: BTreeMap<(usize, u32), Moves>,
    buttons: BTreeMap<(usize, u32), u64>,
    events: u64,
}

impl Heard {
    /// Listens for a time; with axes that are taken, until another is moved and held.
    fn listen(&mut self, sticks: &mut Joystick, seconds_s: f64, taken: Option<&[(usize, u32)]>) {
        let mut held: Option<((usize, u32), Instant)> = None;
        self.axes.values_mut().for_each(|axis| axis.began = axis.last);
        let live = io::stderr().is_terminal();
        let began = Instant::now();
        while began.elapsed().as_secs_f64() < seconds_s {
            sticks.poll_and_tell(|change| self.take(change));
            if live {
                self.show();
            }
            if let Some(taken) = taken {
                let now = self.moved(taken).map(|(device, code, _)| (device, code));
                held = now.map(|axis| match held {
                    Some((before, since)) if before == axis => (axis, since),
                    _ => (axis, Instant::now()),
                });
                if held.is_some_and(|(_, since)| since.elapsed() > HELD) {
                    break;
                }
            }
            std::thread::sleep(LOOK);
        }
        if live {
            // A line that cannot be written is one that nobody sees.
            let _ = writeln!(io::stderr());
        }
    }

    fn take(&mut self, change: Change) {
        self.events += 1;
        match change {
            Change::Axis { device, code, raw } if raw.is_finite() => {
                let new = Moves { least: raw, greatest: raw, last: raw, began: 0.0 };
                let axis = self.axes.entry((device, code)).or_insert(new);
                *axis = Moves { least: axis.least.min(raw), greatest: axis.greatest.max(raw), last: raw, ..*axis };
            }
            Change::Button { device, code } => *self.buttons.entry((device, code)).or_default() += 1,
            _ => {}
        }
    }

    /// The axis that is farthest from where it was, and which way; not one that is taken.
    fn moved(&self, taken: &[(usize, u32)]) -> Option<(usize, u32, f64)> {
        let off = |axis: &Moves| axis.last - axis.began;
        let free = self.axes.iter().filter(|(axis, _)| !taken.contains(axis));
        let (&(device, code), axis) = free.max_by(|(_, a), (_, b)| off(a).abs().total_cmp(&off(b).abs()))?;
        (off(axis).abs() > MOVED).then_some((device, code, off(axis).signum()))
    }

    /// All axes on one line of the terminal.
    fn show(&self) {
        let bar = |value: f64| {
            let at = ((value * 0.5 + 0.5) * 8.0).round().clamp(0.0, 8.0) as usize;
            (0..9).map(|place| if place == at { '|' } else { '.' }).collect::<String>()
        };
        let axes = self.axes.iter().map(|((_, code), axis)| format!("{code:05x} {} {:+.2}", bar(axis.last), axis.last));
        let line: String = axes.collect::<Vec<_>>().join("  ").chars().take(150).collect();
        // A line that cannot be written is one that nobody sees.
        let _ = write!(io::stderr(), "\r\x1b[K{line}");
        let _ = io::stderr().flush();
    }

    fn report(&self, sticks: &Joystick, profiles: &Arc<[Profile]>) -> Input {
        let device = |Connected { number, name, vendor_product: id }: Connected| {
            let by = profile::of_device(profiles, id);
            let of = |(key, _): &(&(usize, u32), &Moves)| key.0 == number;
            let axes = self.axes.iter().filter(of).map(|((_, code), axis)| AxisSeen {
                code: format!("{code:#x}"),
                moves: by
                    .and_then(|by| by.axes.iter().find(|bound| bound.code == *code))
                    .map(|bound| format!("{:?}", bound.target).to_lowercase()),
                least: axis.least,
                greatest: axis.greatest,
                last: axis.last,
            });
            let pressed = self.buttons.iter().filter(|((of, _), _)| *of == number);
            let buttons = pressed.map(|((_, code), times)| ButtonSeen {
                code: format!("{code:#x}"),
                does: by
                    .and_then(|by| by.buttons.iter().find(|(bound, _)| bound == code))
                    .map(|(_, does)| does.name().to_owned()),
                times: *times,
            });
            Device {
                name,
                device: id.map(|(vendor, product)| format!("{vendor:04x}:{product:04x}")),
                bound_by: by.map(|by| by.name.clone()),
                axes: axes.collect(),
                buttons: buttons.collect(),
            }
        };
        let devices = sticks.connected().into_iter().map(device).collect();
        Input { devices, events: self.events, written: None }
    }
}

/// Writes what was found for each device; gives the file.
fn written(
    args: &InputArgs,
    sticks: &Joystick,
    profiles: &Arc<[Profile]>,
    found: &[(usize, Target, u32, f64)],
) -> Result<Option<String>, Failure> {
    if found.is_empty() {
        output::tell(format_args!("poligon: no axis was moved: nothing is written"));
        return Ok(None);
    }
    let file = args.sticks.clone().or_else(sticks::own_file).ok_or_else(|| {
        Failure::Misuse("expected --sticks FILE to write to, found neither it nor XDG_CONFIG_HOME nor HOME".to_owned())
    })?;
    for Connected { number, name, vendor_product: id } in sticks.connected() {
        let axes: Vec<_> = found.iter().filter(|(device, ..)| *device == number).collect();
        let Some(id) = id.filter(|_| !axes.is_empty()) else { continue };
        let before = profile::of_device(profiles, Some(id)).cloned().unwrap_or_default();
        let mut profile = Profile { name, device: Some(id), ..before };
        for (_, target, code, way) in axes {
            profile.axes.retain(|bound| bound.target != *target && bound.code != *code);
            let curve = Curve { dead_zone: 0.03, softness: 0.3, inverted: *way < 0.0 };
            let curve = if target.is_lever() { Curve { dead_zone: 0.0, softness: 0.0, ..curve } } else { curve };
            profile.axes.push(AxisBinding { code: *code, target: *target, curve });
        }
        sticks::keep(&file, profile)?;
    }
    Ok(Some(file.display().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_that_went_farthest_is_the_one_meant() {
        let mut heard = Heard::default();
        assert_eq!(heard.moved(&[]), None);
        let axis = |code, raw| Change::Axis { device: 2, code, raw };
        for change in [axis(1, 0.2), axis(5, -0.9), axis(1, f64::NAN), axis(6, 0.5)] {
            heard.take(change);
        }
        assert_eq!(heard.moved(&[]), Some((2, 5, -1.0)));
        assert_eq!(heard.moved(&[(2, 5)]), Some((2, 6, 1.0)), "one that has its control is let go");
        // What stands at its end since the last control is not moved by this one.
        heard.axes.values_mut().for_each(|axis| axis.began = axis.last);
        assert_eq!(heard.moved(&[]), None);
        heard.take(axis(1, 1.0));
        assert_eq!(heard.moved(&[]), Some((2, 1, 1.0)));
        assert_eq!(heard.axes[&(2, 1)].least, 0.2);
    }
}
