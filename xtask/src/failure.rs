//! How the program fails: what is said, what to do about it, and the exit code.

use crate::interrupt::Interrupted;
use crate::threads::ThreadsError;
use anyhow::Error;
use isosheet_coords::ChartError;
use isosheet_dynamics::{ModelError, SimulationError, StepError};
use isosheet_files::{DataError, FileError};
use isosheet_formats::ExportError;
use isosheet_mesh::Advice;
use isosheet_pictures::PictureError;
use isosheet_runs::RunError;
use isosheet_scenes::{SceneError, SceneFileError};
use std::path::PathBuf;
use std::process::ExitCode;

/// The exit codes, as `--help` shows them: those of `isosheet` where they say the same.
pub(crate) const EXIT_CODES: &str = "\
Exit codes:
  0    everything that was asked for is there
  1    a run failed, or a finding is out of bounds and not declared an open limitation
  2    the command line is wrong
  4    the folder holds other files, another report, or full results that quick ones would replace
  5    another process is writing to the folder
  6    a file or a folder cannot be written
  130  stopped by Ctrl-C; the same command continues";

/// Why a report ends without success although no run failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ReportError {
    #[error("{} is for results without --quick, which are not mixed with quick ones", folder.display())]
    NotQuick { folder: PathBuf },
    #[error("{} has results of {of}", folder.display())]
    OtherReport { folder: PathBuf, of: String },
    #[error("{} has no part called {part}", file.display())]
    Part { file: PathBuf, part: String },
    #[error("the sources of these reports have changed since they were measured: {names}")]
    OutOfDate { names: String },
    #[error("findings are out of bounds, or not out of them as declared: {names}")]
    Findings { names: String },
    #[error("random tests fail with these seeds: {seeds}")]
    Seeds { seeds: String },
    #[error("these reports failed: {names}")]
    Reports { names: String },
}

impl Advice for ReportError {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::NotQuick { .. } | Self::OtherReport { .. } => "choose another folder with --out",
            Self::Part { .. } => {
                "run the whole report, without --quick, and `cargo xtask measured` again"
            }
            Self::OutOfDate { .. } => {
                "run these reports, without --quick, and `cargo xtask measured`"
            }
            Self::Findings { .. } => "see the page, or findings.csv",
            Self::Seeds { .. } => {
                "repeat a test with `PROPTEST_RNG_SEED=SEED ISOSHEET_TIMES=N cargo test NAME`"
            }
            Self::Reports { .. } => "see what each of them said above",
        })
    }
}

type Cause = dyn std::error::Error + 'static;

/// The advice of an error that is an `E`.
fn advice_of<E: Advice + 'static>(cause: &Cause) -> Option<&'static str> {
    cause.downcast_ref::<E>()?.advice()
}

/// What to do: the advice of the first error of the chain that has some.
fn advice(error: &Error) -> Option<&'static str> {
    let known = [
        advice_of::<ReportError>,
        advice_of::<Interrupted>,
        advice_of::<ThreadsError>,
        advice_of::<RunError>,
        advice_of::<FileError>,
        advice_of::<ExportError>,
        advice_of::<PictureError>,
        advice_of::<DataError>,
        advice_of::<SceneError>,
        advice_of::<SceneFileError>,
        advice_of::<StepError>,
        advice_of::<SimulationError>,
        advice_of::<ModelError>,
        advice_of::<ChartError>,
    ];
    let of = |cause: &Cause| known.iter().find_map(|advice| advice(cause));
    error.chain().find_map(of)
}

/// The exit code, see [`EXIT_CODES`].
fn code(error: &Error) -> u8 {
    let of = |cause: &Cause| {
        if cause.is::<Interrupted>() {
            return Some(130);
        }
        if let Some(report) = cause.downcast_ref() {
            return Some(match report {
                ReportError::NotQuick { .. } | ReportError::OtherReport { .. } => 4,
                ReportError::Part { .. }
                | ReportError::OutOfDate { .. }
                | ReportError::Findings { .. }
                | ReportError::Seeds { .. }
                | ReportError::Reports { .. } => 1,
            });
        }
        if cause.is::<FileError>() || cause.is::<std::io::Error>() {
            return Some(6);
        }
        Some(match cause.downcast_ref()? {
            RunError::Foreign { .. } => 4,
            RunError::Busy { .. } => 5,
            RunError::Step(_) | RunError::Scene(_) => 1,
            _ => 6,
        })
    };
    error.chain().find_map(of).unwrap_or(1)
}

/// An error with its causes, each unless the text before holds it already: many messages name their cause.
fn explain(error: &Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

/// Says what went wrong and what to do, and returns the exit code.
pub(crate) fn report(error: &Error) -> ExitCode {
    eprintln!("error: {}", explain(error));
    if let Some(advice) = advice(error) {
        eprintln!("  = help: {advice}");
    }
    ExitCode::from(code(error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_told_once_with_advice_and_code() {
        let full = || std::io::Error::other("disk full");
        let error = Error::from(FileError::from(isosheet_files::WriteError::Write {
            path: "a".into(),
            source: full(),
        }));
        let error = error.context("figure 3");
        assert_eq!(explain(&error), "figure 3: cannot write a: disk full");
        assert_eq!(advice(&error), Some("check the free space"));
        assert_eq!(code(&error), 6);
        let error = Error::from(RunError::Busy { folder: "a".into() });
        assert_eq!(code(&error), 5);
        assert!(advice(&error).is_some_and(|advice| advice.contains("another folder")));
        let error = Error::from(StepError::StepSize { h: 0.0, t: 1.0 }).context("run");
        assert_eq!(code(&error), 1);
        assert_eq!(code(&Error::from(Interrupted)), 130);
        let names = "sliding: smallest gap".to_owned();
        assert_eq!(code(&Error::from(ReportError::Findings { names })), 1);
    }
}
