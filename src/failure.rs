//! How a verb ends that did not do its work: one sentence for a person, one number for a script.

use std::fmt;
use std::process::ExitCode;

/// Why a verb did not do its work. The text is one sentence without a full stop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// What was asked makes no sense; exit status 2.
    Misuse(String),
    /// What was asked could not be done, or the proof failed; exit status 1.
    Failed(String),
}

impl Failure {
    /// The program's exit status.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Misuse(_) => ExitCode::from(2),
            Self::Failed(_) => ExitCode::from(1),
        }
    }

    /// A failure out of another area's error: `doing` says what was being done, the error what went wrong.
    ///
    /// To be used with `map_err`, as in `read(path).map_err(|e| Failure::while_doing("reading the points", e))`.
    pub fn while_doing(doing: impl fmt::Display, error: impl fmt::Display) -> Self {
        Self::Failed(format!("{doing}: {error}"))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Misuse(sentence) | Self::Failed(sentence)) = self;
        f.write_str(sentence)
    }
}

impl std::error::Error for Failure {}
