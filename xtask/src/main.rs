//! Commands of the isosheet workspace: `cargo xtask --help` lists them.
//!
//! * `reproduce-figures`: the figures and the table of Liu, Tang and Joneja 2007, made with this workspace.
//! * `condition-table`: the condition numbers of the system coordinates.
//! * `cost`: time against errors of all methods and solvers, time and memory of steps against the size of the
//!   mesh, whole runs at the sizes that people use.
//! * `locking`: how much stiffer than a smooth sheet a triangulated one is.
//! * `validation`: published experiments and closed forms with the elastic sheet.
//! * `hard-cases`: what the solvers do where others break.
//! * `all`: the figures and all reports, one after another.
//! * `measured`: what the reports measured, as numbers of the book and the README, and what is out of date.
//! * `gallery`: pictures of sixteen scenes, and a film.
//! * `soak`: the random tests with new seeds.
//! * `reference`: the pages of the book that are made of the code.

mod cli;
mod condition;
mod cost;
mod draw;
mod failure;
mod figures;
mod gallery;
mod hard_cases;
mod interrupt;
mod locking;
mod measured;
mod progress;
mod reference;
mod report;
mod reproduce;
mod runs;
mod soak;
mod sources;
mod store;
mod validation;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    match interrupt::install().and_then(|()| cli.command.run()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failure::report(&error),
    }
}
