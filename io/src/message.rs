//! Text for people: results on standard output, everything else on standard error.

use super::failure::Done;
use super::printable::{printable, shortened};
use super::write::to_stdout;
use clap::Args;
use isosheet_mesh::Advice;
pub(crate) use isosheet_mesh::wording::counted;
use std::fmt::Arguments;
use std::io::Write;
use std::sync::OnceLock;

/// How much a command says, as options that every subcommand has.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Verbosity {
    /// Say no more than results, warnings and errors: no progress
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Say more: of a run a line for each step
    #[arg(short, long, global = true)]
    verbose: bool,
}

static VERBOSITY: OnceLock<Verbosity> = OnceLock::new();

impl Verbosity {
    /// Makes this the choice of the process, for good.
    pub(crate) fn choose(self) {
        let _ = VERBOSITY.set(self);
    }
}

/// Whether nothing is said besides results, warnings and errors.
pub(crate) fn is_quiet() -> bool {
    VERBOSITY.get().is_some_and(|v| v.quiet)
}

/// Whether every step is told.
pub(crate) fn is_verbose() -> bool {
    VERBOSITY.get().is_some_and(|v| v.verbose)
}

/// What colours begin with.
const ESCAPE: char = '\u{1b}';

/// Writes a warning or an error as a line to standard error. Nothing happens where nobody reads it any more,
/// as behind `2>&1 | head`: the work goes on.
pub(crate) fn print_message(text: Arguments<'_>) {
    let text = text.to_string();
    let text = shortened(&text);
    let _ = writeln!(std::io::stderr(), "{}", printable(&text, &[]));
}

/// Writes a warning or an error with colours as a line to standard error. Nothing happens where nobody reads
/// it any more, as behind `2>&1 | head`: the work goes on.
pub(crate) fn print_coloured(text: &str) {
    let text = shortened(text);
    let _ = writeln!(std::io::stderr(), "{}", printable(&text, &[ESCAPE]));
}

/// Writes warnings with what to do about them.
pub(crate) fn print_warnings(warnings: &[impl Advice]) {
    for warning in warnings {
        print_message(format_args!("warning: {warning}"));
        if let Some(advice) = warning.advice() {
            print_message(format_args!("  = help: {advice}"));
        }
    }
}

/// Warnings as texts, with what to do about them.
pub(crate) fn with_advice(warnings: &[impl Advice]) -> Vec<String> {
    warnings.iter().map(Advice::with_advice).collect()
}

/// Writes a line of progress to standard error, unless the command is to be quiet.
pub(crate) fn print_progress(text: Arguments<'_>) {
    if !is_quiet() {
        print_message(text);
    }
}

/// Writes a line of the result to standard output.
pub(crate) fn print_result(text: Arguments<'_>) -> Done {
    to_stdout(&format!("{text}\n"))
}
