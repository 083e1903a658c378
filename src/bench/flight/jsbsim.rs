//! JSBSim as a process of its own: a Python that times its own loop over many steps and answers in nanoseconds a step.
//!
//! The Python is the one that `POLIGON_PYTHON` names (a program, or the folder of a virtual environment), else `python3`.
//! Invariant others rely on: the process waits for a line between its rounds and ends with this value.

use crate::failure::Failure;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

const SCRIPT: &str = include_str!("yardstick.py");
/// Names the Python to use.
const VARIABLE: &str = "POLIGON_PYTHON";

/// A JSBSim that waits to be asked.
pub struct Jsbsim {
    child: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// Its version.
    pub version: String,
    /// Nanoseconds of a call from Python that does nothing, each time it was asked.
    pub nothing_ns: Vec<f64>,
}

impl Jsbsim {
    /// Starts it.
    ///
    /// # Errors
    /// Why there is none.
    pub fn start() -> Result<Self, String> {
        let python = python();
        let shown = python.display().to_string();
        let mut child = Command::new(&python)
            .args(["-c", SCRIPT])
            // What its models write is no one's business here.
            .current_dir(std::env::temp_dir())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("expected a Python with the package jsbsim, found none at {shown}: {error}"))?;
        let (Some(questions), Some(answers)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("expected pipes to {shown}, found none"));
        };
        let mut answers = BufReader::new(answers);
        let mut version = String::new();
        // Nothing but an end of the file comes from a Python without the package.
        let read = answers.read_line(&mut version);
        let version = version.trim().to_owned();
        let mut this = Self { child, questions, answers, version, nothing_ns: Vec::new() };
        match read {
            Ok(_) if this.version.starts_with(|c: char| c.is_ascii_digit()) => Ok(this),
            _ => {
                let _ = this.child.kill();
                Err(format!("expected the package jsbsim in {shown} (or in the one {VARIABLE} names), found none"))
            }
        }
    }

    /// Nanoseconds a step of a model, over so many.
    ///
    /// # Errors
    /// [`Failure::Failed`] if it does not answer.
    pub fn step_ns(&mut self, model: &str, steps: u32) -> Result<f64, Failure> {
        let failed = |error: std::io::Error| Failure::while_doing("asking JSBSim", error);
        writeln!(self.questions, "{model} {steps}").map_err(failed)?;
        let mut line = String::new();
        loop {
            line.clear();
            if self.answers.read_line(&mut line).map_err(failed)? == 0 {
                return Err(Failure::Failed(format!("JSBSim ended while it flew {model}")));
            }
            // It greets and warns on the same stream.
            let Some(numbers) = line.strip_prefix("answer ") else { continue };
            let mut numbers = numbers.split_whitespace().map(str::parse::<f64>);
            return match (numbers.next(), numbers.next()) {
                (Some(Ok(step_ns)), Some(Ok(nothing_ns))) => {
                    self.nothing_ns.push(nothing_ns);
                    Ok(step_ns)
                }
                _ => Err(Failure::Failed(format!("JSBSim: expected two numbers, found `{}`", line.trim()))),
            };
        }
    }
}

impl Drop for Jsbsim {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn python() -> PathBuf {
    match std::env::var_os(VARIABLE).map(PathBuf::from) {
        Some(folder) if folder.is_dir() => folder.join("bin/python"),
        Some(program) => program,
        None => PathBuf::from("python3"),
    }
}
