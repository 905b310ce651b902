//! Commands of the isosheet workspace: `cargo xtask --help` lists them.
//!
//! * `reproduce-figures`: the figures and the table of Liu, Tang and Joneja 2007, made with this workspace.
//! * `condition-table`: the condition numbers of the system coordinates.
//! * `speed-vs-error`: time against errors of all methods and solvers.
//! * `scale`: time, memory and fill of a step, and the cost of whole runs, against the size of the mesh.
//! * `locking`: how much stiffer than a smooth sheet a triangulated one is.
//! * `hard-cases`: what the solvers do where others break.
//! * `bundle-view`: the program of the 3D page of a run.
//!
//! The exit code is 0 when everything was made, 1 on failure, 2 for a command line that makes no sense and
//! 130 when stopped with Ctrl-C.

mod bundle_view;
mod cli;
mod condition;
mod draw;
mod figures;
mod hard_cases;
mod interrupt;
mod locking;
mod methods;
mod progress;
mod report;
mod reproduce;
mod runs;
mod scale;
mod selection;
mod speed_vs_error;
mod store;
mod timing;

use clap::Parser;
use interrupt::Outcome;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    let result = interrupt::install().and_then(|()| cli.command.run());
    match result {
        Ok(Outcome::Complete) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted) => {
            eprintln!("stopped; what is finished is kept, the same command continues");
            ExitCode::from(130)
        }
        Err(error) => {
            eprintln!("error: {}", explain(&error));
            ExitCode::FAILURE
        }
    }
}

/// An error with its causes, each unless the text before holds it already: many of our messages name their
/// cause.
fn explain(error: &anyhow::Error) -> String {
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.contains(&cause) {
            text.push_str(": ");
            text.push_str(&cause);
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_told_once() {
        let full = || std::io::Error::other("disk full");
        let error = store::StoreError::Read {
            path: "a".into(),
            source: full(),
        };
        let error = anyhow::Error::from(error).context("figure 3");
        assert_eq!(explain(&error), "figure 3: cannot read a: disk full");
        let error = anyhow::Error::from(full()).context("figure 3");
        assert_eq!(explain(&error), "figure 3: disk full");
    }
}
