//! How a command fails: one clear sentence on stderr, exit code 1 for a failure, 2 for wrong usage.

use std::fmt::Display;
use std::io::{self, Write};
use std::process::ExitCode;

/// Why a command did not do what was asked.
#[derive(Debug)]
pub enum Failure {
    /// The words of the command are wrong: exit code 2.
    Usage(anyhow::Error),
    /// The command was right and could not be carried out: exit code 1.
    Run(anyhow::Error),
}

/// Result of a command.
pub type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// Wrong usage, in one sentence.
    pub fn usage(sentence: impl Display) -> Self {
        Self::Usage(anyhow::anyhow!("{sentence}"))
    }

    /// A failure, in one sentence.
    pub fn run(sentence: impl Display) -> Self {
        Self::Run(anyhow::anyhow!("{sentence}"))
    }

    /// Prints the sentence and what caused it, and gives the exit code.
    pub fn report(&self) -> ExitCode {
        let (error, code) = match self {
            Self::Usage(error) => (error, 2),
            Self::Run(error) => (error, 1),
        };
        let mut stderr = io::stderr().lock();
        let mut said = error.to_string();
        let _ = writeln!(stderr, "error: {said}");
        for cause in error.chain().skip(1) {
            let cause = cause.to_string();
            if !said.contains(&cause) {
                let _ = writeln!(stderr, "  because: {cause}");
            }
            said = cause;
        }
        ExitCode::from(code)
    }
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Run(error.into())
    }
}
