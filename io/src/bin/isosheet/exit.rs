//! How the command ends.

use crate::message::print_message;
use isosheet_io::Advice;
use isosheet_io::run::{RunError, SweepError};
use isosheet_io::scene::{Colours, SceneError, SceneFileError};
use serde_json::json;
use std::io::{IsTerminal, Write};
use std::process::ExitCode;

/// The exit codes, as `--help` shows them.
pub(crate) const EXIT_CODES: &str = "\
Exit codes:
  0    done; of `simulate`, the run is complete; of `sweep`, all runs are
  1    a step of the simulation failed
  2    the command line is wrong, or does not fit to the files that it names
  3    the scene or the mesh is wrong, or a file cannot be read
  4    the folder holds the run of another scene or version, another sweep, or other files
  5    another process is writing to the folder
  6    a file or a folder cannot be written
  130  stopped by Ctrl-C, or a run of a sweep was killed; the same command continues";

/// A class of failures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    /// A step failed.
    Step = 1,
    /// Arguments that do not fit together.
    CommandLine = 2,
    /// Scene, mesh or a file that is read.
    Input = 3,
    /// Another scene in the folder.
    OtherScene = 4,
    /// The folder is in use.
    Busy = 5,
    /// A file cannot be written.
    Output = 6,
    /// Ctrl-C.
    Interrupted = 130,
}

impl Code {
    /// The code that a run of a sweep ended with; a code that no run ends with by itself counts as that of a
    /// failed step.
    pub(crate) fn of(code: i32) -> Self {
        let codes = [
            Self::Input,
            Self::OtherScene,
            Self::Busy,
            Self::Output,
            Self::Interrupted,
        ];
        let found = codes.into_iter().find(|c| *c as i32 == code);
        found.unwrap_or(Self::Step)
    }
}

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// One JSON object a line, for programs.
    Json,
}

/// A failure with its message.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) code: Code,
    message: Message,
    /// What to do, where the message does not say it.
    remedy: Option<String>,
    format: Format,
}

#[derive(Debug)]
enum Message {
    Text(String),
    Scene(SceneError),
}

impl Failure {
    pub(crate) fn new(code: Code, message: impl ToString) -> Self {
        Self {
            code,
            message: Message::Text(message.to_string()),
            remedy: None,
            format: Format::Text,
        }
    }

    /// A command line that makes no sense.
    pub(crate) fn misuse(message: impl ToString) -> Self {
        Self::new(Code::CommandLine, message)
    }

    /// The failure that an error describes, with its advice.
    pub(crate) fn of(code: Code, error: &impl Advice) -> Self {
        Self {
            remedy: error.advice().map(str::to_owned),
            ..Self::new(code, error)
        }
    }

    /// The same failure with what to do about it.
    pub(crate) fn remedy(self, remedy: impl Into<String>) -> Self {
        Self {
            remedy: Some(remedy.into()),
            ..self
        }
    }

    pub(crate) fn in_format(self, format: Format) -> Self {
        Self { format, ..self }
    }

    /// Writes the message to stderr, or as JSON to stdout, and returns the exit code.
    pub(crate) fn report(self) -> ExitCode {
        let code = self.code as u8;
        match self.format {
            Format::Text => {
                let text = match &self.message {
                    Message::Text(text) => format!("error: {text}"),
                    Message::Scene(error) if std::io::stderr().is_terminal() => {
                        error.render(Colours::Terminal)
                    }
                    Message::Scene(error) => error.render(Colours::Plain),
                };
                print_message(format_args!("{text}"));
                if let Some(remedy) = &self.remedy {
                    print_message(format_args!("  = help: {remedy}"));
                }
            }
            Format::Json => {
                let problems = match &self.message {
                    Message::Text(text) => json!([{ "message": text, "remedy": self.remedy }]),
                    Message::Scene(error) => json!(error.placed()),
                };
                let line = json!({ "event": "error", "code": code, "problems": problems });
                // Nobody is left to be told that stdout is closed.
                let _ = writeln!(std::io::stdout(), "{line}");
            }
        }
        ExitCode::from(code)
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let code = match &error {
            RunError::Step(_) => Code::Step,
            RunError::OtherScene { .. }
            | RunError::OtherVersion { .. }
            | RunError::Foreign { .. } => Code::OtherScene,
            RunError::Busy { .. } => Code::Busy,
            RunError::SceneFile(SceneFileError::Edit(_)) => Code::CommandLine,
            RunError::Scene(_)
            | RunError::SceneFile(_)
            | RunError::NoRun { .. }
            | RunError::Damaged { .. }
            | RunError::DamagedFrame { .. }
            | RunError::NoFrames { .. }
            | RunError::Page(_)
            | RunError::Read { .. } => Code::Input,
            _ => Code::Output,
        };
        match error {
            RunError::Scene(error)
            | RunError::Step(error)
            | RunError::SceneFile(SceneFileError::Scene(error)) => Self {
                code,
                message: Message::Scene(error),
                remedy: None,
                format: Format::Text,
            },
            error => Self::of(code, &error),
        }
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        let code = match error {
            SweepError::Scene(error) => return error.into(),
            SweepError::NoKeys | SweepError::SameKey { .. } | SweepError::TooMany { .. } => {
                Code::CommandLine
            }
            SweepError::OtherSweep { .. } | SweepError::Foreign { .. } => Code::OtherScene,
            SweepError::Write(_) => Code::Output,
            _ => Code::Input,
        };
        Self::of(code, &error)
    }
}

impl From<SceneFileError> for Failure {
    fn from(error: SceneFileError) -> Self {
        RunError::from(error).into()
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        RunError::from(error).into()
    }
}
