//! Why a subcommand fails, and the code that the command ends with.

use isosheet_files::FileError;
use isosheet_mesh::Advice;
use isosheet_runs::{FitError, RunError, SweepError};
use isosheet_scenes::{SceneError, SceneFileError};

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

/// A failure of a subcommand, or nothing to say.
pub(crate) type Done = Result<(), Failure>;

/// A failure with its message.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) code: Code,
    pub(super) message: Message,
    /// What to do, where the message does not say it.
    pub(super) remedy: Option<String>,
    pub(super) format: Format,
}

/// What a failure says.
#[derive(Debug)]
pub(super) enum Message {
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

    /// This failure with what to do about it.
    pub(crate) fn remedy(self, remedy: impl Into<String>) -> Self {
        Self {
            remedy: Some(remedy.into()),
            ..self
        }
    }

    pub(crate) fn in_format(self, format: Format) -> Self {
        Self { format, ..self }
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let code = match &error {
            RunError::Step(_) => Code::Step,
            RunError::OtherScene { .. }
            | RunError::OtherVersion { .. }
            | RunError::Foreign { .. }
            | RunError::NotOwn { .. }
            | RunError::Taken { .. }
            | RunError::ReadByScene { .. }
            | RunError::Recorded { .. } => Code::OtherScene,
            RunError::Busy { .. } => Code::Busy,
            RunError::NoFolder | RunError::Extension { .. } => Code::CommandLine,
            RunError::SceneFile(SceneFileError::Edit(_)) => Code::CommandLine,
            RunError::Scene(_)
            | RunError::SceneFile(_)
            | RunError::NoRun { .. }
            | RunError::Page(_)
            | RunError::File(FileError::Read(_)) => Code::Input,
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
            SweepError::Keys(_) => Code::CommandLine,
            SweepError::OtherSweep { .. } | SweepError::Foreign { .. } => Code::OtherScene,
            SweepError::File(FileError::Write(_)) => Code::Output,
            _ => Code::Input,
        };
        Self::of(code, &error)
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        let code = match error {
            FitError::Scene(error) => return error.into(),
            FitError::Keys(_) | FitError::Units { .. } => Code::CommandLine,
            FitError::Run { .. } | FitError::NoEffect { .. } => Code::Step,
            FitError::Interrupted => Code::Interrupted,
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
