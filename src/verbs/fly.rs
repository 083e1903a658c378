//! `poligon fly`: the main job. A window where there is a display, else headless with pictures.

use crate::ahead;
use crate::args::FlyArgs;
use crate::failure::Failure;
use crate::flight;
use crate::open_world;
use crate::output::{self, Output};
use std::ffi::OsStr;
use std::sync::Arc;
use std::time::Instant;

/// How the flight is shown and timed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mode {
    /// In a window, at the display's pace.
    Window,
    /// Headless; waits for every block.
    Lockstep,
    /// Headless; holds this many frames a second and waits for nothing.
    Paced {
        /// Frames a second.
        hz: f64,
    },
}

impl Mode {
    /// The mode asked for; `display` says whether a window can be opened.
    ///
    /// Headless alone is lockstep: its pictures have no missing block on however slow a machine.
    fn of(args: &FlyArgs, display: bool) -> Self {
        match args.paced_hz {
            Some(hz) => Self::Paced { hz },
            None if args.lockstep || args.headless || !display => Self::Lockstep,
            None => Self::Window,
        }
    }
}

/// Whether the environment names an X display; that one can be opened is seen when it is.
fn has_display() -> bool {
    let named = |value: Option<&OsStr>| value.is_some_and(|value| !value.is_empty());
    !cfg!(target_os = "linux") || named(std::env::var_os("DISPLAY").as_deref())
}

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &FlyArgs, to: Output, started: Instant) -> Result<(), Failure> {
    let mode = Mode::of(args, has_display());
    if mode != Mode::Window {
        output::tell(format_args!("no window: pictures go to {}", args.shots.display()));
    }
    ahead::begin_ground();
    let world = Arc::new(open_world::open(args.world.as_deref())?);
    ahead::begin_plants(&world, &args.view);
    let report = match mode {
        Mode::Window => flight::window::fly(args, world, started)?,
        Mode::Lockstep => flight::headless::fly(args, world, started)?,
        Mode::Paced { hz } => flight::paced::fly(args, hz, world, started)?,
    };
    if let Some(path) = &args.report {
        flight::write_report(path, &report)?;
    }
    to.print(&report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::{CommandLine, Verb};
    use clap::Parser;

    #[test]
    fn a_window_only_where_there_is_a_display_and_nothing_else_was_asked() {
        let mode = |line: &str, display| {
            let line = CommandLine::try_parse_from(line.split(' ')).unwrap();
            let Verb::Fly(args) = line.verb else { panic!("not fly") };
            Mode::of(&args, display)
        };
        assert_eq!(mode("poligon fly", true), Mode::Window);
        assert_eq!(mode("poligon fly", false), Mode::Lockstep);
        assert_eq!(mode("poligon fly --headless", true), Mode::Lockstep);
        assert_eq!(mode("poligon fly --lockstep", true), Mode::Lockstep);
        assert_eq!(mode("poligon fly --headless --paced 60", true), Mode::Paced { hz: 60.0 });
    }
}
