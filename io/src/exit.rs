//! How the command ends.

use super::failure::{Failure, Format, Message};
use super::message::{print_coloured, print_message};
use super::progress::event;
use isosheet_scenes::MessageStyle;
use serde_json::json;
use std::io::IsTerminal;

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
  130  stopped by Ctrl-C, or a run of a sweep was killed; the same command without `--force` continues";

/// Writes the message of a failure to stderr, or as JSON to stdout, and returns the exit code.
pub(crate) fn report(failure: &Failure) -> u8 {
    let code = failure.code as u8;
    match failure.format {
        Format::Text => {
            match &failure.message {
                Message::Text(text) => print_message(format_args!("error: {text}")),
                Message::Scene(error) if std::io::stderr().is_terminal() => {
                    print_coloured(&error.render(MessageStyle::Terminal));
                }
                Message::Scene(error) => {
                    print_message(format_args!("{}", error.render(MessageStyle::Plain)));
                }
            }
            if let Some(remedy) = &failure.remedy {
                print_message(format_args!("  = help: {remedy}"));
            }
        }
        Format::Json => {
            let problems = match &failure.message {
                Message::Text(text) => json!([{ "message": text, "remedy": failure.remedy }]),
                Message::Scene(error) => json!(error.placed()),
            };
            event(&json!({ "event": "error", "code": code, "problems": problems }));
        }
    }
    code
}
