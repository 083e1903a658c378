//! How far a long job is: one line on stderr, where stderr is a terminal.
//!
//! Redrawn at most ten times a second and never on stdout; off a terminal nothing is written at all.

use std::io::{self, IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

const REDRAW: Duration = Duration::from_millis(100);
const WIDTH: usize = 30;

/// A bar. May be told from several threads; it goes when dropped.
#[derive(Debug)]
pub struct Progress {
    label: String,
    drawn: Option<Mutex<Option<Instant>>>,
}

impl Progress {
    /// A bar at nothing; `label` says what is being done.
    pub fn new(label: &str) -> Self {
        Self { label: label.to_owned(), drawn: io::stderr().is_terminal().then(|| Mutex::new(None)) }
    }

    /// Shows the share done, 0..=1. Cheap enough to call for every row.
    pub fn show(&self, share: f64) {
        self.show_stage("", share);
    }

    /// Shows which stage the job is in and the share done of that, 0..=1.
    pub fn show_stage(&self, stage: &str, share: f64) {
        let Some(drawn) = &self.drawn else { return };
        // A bar that another thread is drawing need not be drawn again.
        let Ok(mut last) = drawn.try_lock() else { return };
        if last.is_some_and(|last| last.elapsed() < REDRAW) {
            return;
        }
        *last = Some(Instant::now());
        let label = if stage.is_empty() { self.label.clone() } else { format!("{}: {stage}", self.label) };
        // A shorter line than the last leaves nothing of it behind.
        let _ = write!(io::stderr(), "\r{}\x1b[K", line(&label, share));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.drawn.is_some() {
            let _ = write!(io::stderr(), "\r\x1b[K");
        }
    }
}

fn line(label: &str, share: f64) -> String {
    // NaN clamps to NaN and casts to 0.
    let share = share.clamp(0.0, 1.0);
    let full = (share * WIDTH as f64) as usize;
    format!("{label} [{}{}] {:3.0} %", "#".repeat(full), ".".repeat(WIDTH - full), share.max(0.0) * 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_share_makes_a_line_of_one_width() {
        for share in [0.0, 0.5, 1.0, -1.0, 7.0, f64::NAN, f64::INFINITY] {
            assert_eq!(line("bake", share).len(), line("bake", 0.0).len(), "{share}");
        }
        assert!(line("bake", 1.0).ends_with("] 100 %") && line("bake", f64::NAN).ends_with("]   0 %"));
    }
}
