//! A pilot's inputs as a file, `I.csv`: what the axes were and which commands were given, by time.
//!
//! `t_s,<axis>..,command`: a row where an axis changed or a command was given; an empty cell holds. Times are those of
//! the scene's steps and are rounded to them; rows stand in the order in which things happened. Lines with `#` are
//! comments. Axes are those of [`AXES`], commands have the names of [`Command::names`]. Where axes of a stick moved levers,
//! there are columns for [`LEVERS`], and a row that sets one sets them all: those left empty are as by default.
//!
//! Invariant others rely on: what is written of a scene's record and read back with the same rate of steps is the same,
//! so a flight that is played again is the same flight.

use super::{Command, Controls, Levers};
use crate::scene::{self, Stamped};
use std::fmt::{self, Write};

/// Most rows read.
const MOST_ROWS: usize = 10_000_000;
/// Longest flight, seconds.
const LONGEST_S: f64 = 1e6;

/// An axis by name.
pub type Axis = (&'static str, fn(&Controls) -> f64, fn(&mut Controls, f64));

/// Every axis that a pilot has.
pub const AXES: [Axis; 4] = [
    ("pitch", |c| c.pitch, |c, v| c.pitch = v),
    ("roll", |c| c.roll, |c, v| c.roll = v),
    ("yaw", |c| c.yaw, |c, v| c.yaw = v),
    ("throttle", |c| c.throttle, |c, v| c.throttle = v),
];

/// A lever by name.
pub type Lever = (&'static str, fn(&Levers) -> f64, fn(&mut Levers, f64));

/// Every lever.
pub const LEVERS: [Lever; 9] = [
    ("mixture", |l| l.mixture, |l, v| l.mixture = v),
    ("flaps", |l| l.flaps, |l, v| l.flaps = v),
    ("gear", |l| l.gear, |l, v| l.gear = v),
    ("brake_left", |l| l.brakes[0], |l, v| l.brakes[0] = v),
    ("brake_right", |l| l.brakes[1], |l, v| l.brakes[1] = v),
    ("parking_brake", |l| l.parking_brake, |l, v| l.parking_brake = v),
    ("trim", |l| l.trim, |l, v| l.trim = v),
    ("starter", |l| l.starter, |l, v| l.starter = v),
    ("altimeter_pa", |l| l.altimeter_pa, |l, v| l.altimeter_pa = v),
];

/// Why a file is no recording: the line, what was expected and what was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingError {
    line: usize,
    why: String,
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.why)
    }
}

impl std::error::Error for RecordingError {}

/// The pilot's part of a scene's record as text; orders that no pilot gives are left out.
pub fn written(record: &[Stamped], step_hz: u32) -> String {
    let mut text = String::from("t_s");
    for (name, ..) in AXES {
        let _ = write!(text, ",{name}");
    }
    let with_levers = record.iter().any(|stamped| matches!(stamped.command, scene::Command::Levers(_)));
    let levers = if with_levers { &LEVERS[..] } else { &[] };
    for (name, ..) in levers {
        let _ = write!(text, ",{name}");
    }
    text.push_str(",command\n");
    let (no_axes, no_levers) = (",".repeat(AXES.len()), ",".repeat(levers.len()));
    let mut before: Option<Controls> = None;
    for Stamped { step, command } in record {
        let t_s = *step as f64 / f64::from(step_hz);
        match command {
            scene::Command::Controls(controls) => {
                if before == Some(*controls) {
                    continue;
                }
                let _ = write!(text, "{t_s}");
                for (_, get, _) in AXES {
                    let now = get(controls);
                    if before.is_some_and(|before| get(&before).to_bits() == now.to_bits()) {
                        text.push(',');
                    } else {
                        let _ = write!(text, ",{now}");
                    }
                }
                let _ = writeln!(text, "{no_levers},");
                before = Some(*controls);
            }
            scene::Command::Levers(now) => {
                let _ = write!(text, "{t_s}{no_axes}");
                for (_, get, _) in levers {
                    let _ = write!(text, ",{}", get(now));
                }
                text.push_str(",\n");
            }
            // In a scene that stands still no step comes that could end a pause: played, it would stand for ever.
            scene::Command::Pilot(Command::Pause) => {}
            scene::Command::Pilot(command) => {
                let _ = writeln!(text, "{t_s}{no_axes}{no_levers},{}", command.name());
            }
            _ => {}
        }
    }
    text
}

/// The commands of a recording, to be scheduled in their order in a scene of this rate.
///
/// # Errors
/// [`RecordingError`] names the line.
pub fn parse(text: &str, step_hz: u32) -> Result<Vec<Stamped>, RecordingError> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let refuse = |line: usize, why: String| RecordingError { line: line + 1, why };
    let (at, header) = lines.next().ok_or_else(|| refuse(0, "expected a header, found nothing".to_owned()))?;
    let columns = header.split(',').map(|name| column(name.trim()).ok_or(name));
    let columns: Vec<Column> = columns.collect::<Result<_, _>>().map_err(|found| {
        let axes = AXES.iter().map(|(name, ..)| *name);
        let known: Vec<&str> = axes.chain(LEVERS.iter().map(|(name, ..)| *name)).collect();
        refuse(at, format!("expected columns t_s, {}, command, found {}", known.join(", "), found.trim()))
    })?;
    if columns.first() != Some(&Column::Time) || columns.iter().filter(|column| **column == Column::Time).count() > 1 {
        return Err(refuse(at, "expected t_s as the first column and once".to_owned()));
    }
    let mut stamped = Vec::new();
    let (mut controls, mut last_s) = (Controls::default(), 0.0);
    for (at, line) in lines.take(MOST_ROWS) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != columns.len() {
            return Err(refuse(at, format!("expected {} cells, found {}", columns.len(), cells.len())));
        }
        let number = |cell: &str| cell.parse::<f64>().ok().filter(|value| value.is_finite());
        let t_s = number(cells[0]).filter(|t_s| (last_s..=LONGEST_S).contains(t_s));
        let t_s =
            t_s.ok_or_else(|| refuse(at, format!("t_s: expected a time of {last_s} or later, found {}", cells[0])))?;
        last_s = t_s;
        let step = (t_s * f64::from(step_hz)).round() as u64;
        let (mut moved, mut levers, mut given) = (false, None, None);
        for (column, cell) in columns.iter().zip(&cells).skip(1).filter(|(_, cell)| !cell.is_empty()) {
            match *column {
                Column::Time => {}
                Column::Axis(axis) => {
                    let (name, _, set) = AXES[axis];
                    let value =
                        number(cell).ok_or_else(|| refuse(at, format!("{name}: expected a number, found {cell}")))?;
                    set(&mut controls, value);
                    moved = true;
                }
                Column::Lever(lever) => {
                    let (name, _, set) = LEVERS[lever];
                    let value =
                        number(cell).ok_or_else(|| refuse(at, format!("{name}: expected a number, found {cell}")))?;
                    set(levers.get_or_insert_with(Levers::default), value);
                }
                Column::Command => {
                    given = Some(Command::named(cell).ok_or_else(|| {
                        let known: Vec<&str> = Command::names().collect();
                        refuse(at, format!("command: expected one of {}, found {cell}", known.join(" ")))
                    })?);
                }
            }
        }
        if moved {
            controls = controls.checked();
            stamped.push(Stamped { step, command: scene::Command::Controls(controls) });
        }
        stamped.extend(levers.map(|l: Levers| Stamped { step, command: scene::Command::Levers(l.checked()) }));
        stamped.extend(given.map(|command| Stamped { step, command: scene::Command::Pilot(command) }));
    }
    Ok(stamped)
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Column {
    Time,
    Axis(usize),
    Lever(usize),
    Command,
}

fn column(name: &str) -> Option<Column> {
    match name {
        "t_s" => Some(Column::Time),
        "command" => Some(Column::Command),
        name => {
            let axis = AXES.iter().position(|(axis, ..)| *axis == name).map(Column::Axis);
            axis.or_else(|| LEVERS.iter().position(|(lever, ..)| *lever == name).map(Column::Lever))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aircraft::AircraftState;
    use crate::{Scene, SceneGround, UtcTime};
    use glam::DVec3;

    fn scene() -> Scene {
        let mut scene =
            Scene::new(AircraftState::level(DVec3::new(0.0, 3_000.0, 0.0), 0.4, 90.0), UtcTime { unix_ns: 0 });
        scene.start_record();
        scene
    }

    #[test]
    fn a_flight_played_again_is_the_same_flight() {
        let ground = SceneGround::void();
        let mut first = scene();
        for step in 0..600_u32 {
            let wave = f64::from(step) * 0.013;
            if step % 7 == 0 {
                let (pitch, roll) = (0.3 * wave.sin(), 0.6 * (1.7 * wave).cos());
                first.set_controls(Controls { pitch, roll, throttle: 0.7, ..Controls::default() });
            }
            if step == 300 {
                first.command(Command::TimeForward);
            }
            first.step(&ground);
        }
        let text = written(first.record(), 120);
        let mut again = scene();
        for stamped in parse(&text, 120).unwrap() {
            again.schedule(stamped).unwrap();
        }
        for _ in 0..600 {
            again.step(&ground);
        }
        assert_eq!(again.snapshot().hash(), first.snapshot().hash());
        assert_eq!(written(again.record(), 120), text);
    }

    #[test]
    fn levers_on_axes_are_written_and_read_back() {
        let mut first = scene();
        let levers = Levers { brakes: [0.25, 1.0 / 3.0], trim: -0.125, mixture: 0.7, ..Levers::default() };
        first.step(&SceneGround::void());
        first.set_levers(levers);
        first.command(Command::FlapsDown);
        first.step(&SceneGround::void());
        let text = written(first.record(), 120);
        assert!(text.starts_with("t_s,pitch,roll,yaw,throttle,mixture,flaps,gear,brake_left,"), "{text}");
        let stamped = parse(&text, 120).unwrap();
        let found: Vec<_> = stamped.into_iter().map(|stamped| stamped.command).collect();
        let given = [scene::Command::Levers(levers), scene::Command::Pilot(Command::FlapsDown)];
        assert_eq!(found, given);
        let refused = parse("t_s,brake_left\n0,inf\n", 120).unwrap_err().to_string();
        assert!(refused.contains("brake_left: expected a number"), "{refused}");
    }

    #[test]
    fn a_hand_written_file_holds_and_comments() {
        let text = "# a turn\nt_s,roll,command\n0,0.5,\n\n1.5,,trigger\n1.5,-2,\n";
        let stamped = parse(text, 120).unwrap();
        let steps: Vec<u64> = stamped.iter().map(|stamped| stamped.step).collect();
        assert_eq!(steps, [0, 180, 180]);
        assert_eq!(stamped[1].command, scene::Command::Pilot(Command::Trigger));
        let held = Controls { roll: -1.0, ..Controls::default() };
        assert_eq!(stamped[2].command, scene::Command::Controls(held), "held within its range");
    }

    #[test]
    fn hostile_files_are_refused_with_their_line() {
        let refused = |text: &str| parse(text, 120).unwrap_err().to_string();
        assert!(refused("").contains("expected a header"));
        assert!(refused("t_s,warp\n").contains("found warp"));
        assert!(refused("roll,t_s\n").contains("first column"));
        assert!(refused("t_s,t_s\n").contains("once"));
        assert!(refused("t_s,roll\n0\n").starts_with("line 2: expected 2 cells, found 1"));
        assert!(refused("t_s,roll\nNaN,0\n").contains("t_s"));
        assert!(refused("t_s,roll\n2,0\n1,0\n").starts_with("line 3"));
        assert!(refused("t_s,roll\n0,inf\n").contains("expected a number"));
        assert!(refused("t_s,command\n0,eject\n").contains("expected one of pause"));
        assert!(refused("t_s\n1e300\n").contains("expected a time"));
    }
}
