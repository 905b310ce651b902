//! Commands of the isosheet workspace: `cargo xtask --help` lists them.
//!
//! * `reproduce-figures`: the figures and the table of Liu, Tang and Joneja 2007, made with this workspace.
//! * `condition-table`: the condition numbers of the system coordinates.
//!
//! The exit code is 0 when everything was made, 1 on failure, 2 for a command line that makes no sense and 130 when
//! stopped with Ctrl-C.

mod cli;
mod condition;
mod draw;
mod figures;
mod interrupt;
mod progress;
mod render;
mod report;
mod reproduce;
mod runs;
mod selection;
mod store;

use clap::Parser;
use std::process::ExitCode;

/// How a command ended when it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Everything asked for is there.
    Complete,
    /// Stopped with Ctrl-C; what was finished has been kept.
    Interrupted,
}

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    let result = interrupt::install().and_then(|()| match cli.command {
        cli::Command::ReproduceFigures(args) => reproduce::run(&args),
        cli::Command::ConditionTable(args) => condition::run(&args),
    });
    match result {
        Ok(Outcome::Complete) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted) => {
            eprintln!("stopped; what is finished is kept, the same command continues");
            ExitCode::from(130)
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
