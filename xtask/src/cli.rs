//! The command line.

use crate::selection::Selection;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Commands of the isosheet workspace.
#[derive(Debug, Parser)]
#[command(name = "xtask", bin_name = "cargo xtask", version, about)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Make the figures and the table of Liu, Tang and Joneja 2007 with this workspace
    ///
    /// Writes DIR/index.html (self-contained), DIR/figures, DIR/runs and DIR/summary.json. What is already there and was made
    /// by the same program with the same options is kept; Ctrl-C stops at the next frame, and the same command continues.
    ReproduceFigures(ReproduceArgs),
}

/// Arguments of `reproduce-figures`.
#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// Figures to make, such as 3 or 1-9,11; all when left out
    #[arg(long, value_name = "LIST", default_value_t = Selection::all())]
    pub(crate) figures: Selection,

    /// Folder to write to; it is created when missing
    #[arg(long, value_name = "DIR", default_value = "out/reproduce-figures")]
    pub(crate) out: PathBuf,

    /// Short runs and small pictures: checks that everything works in seconds, and shows no result
    #[arg(long)]
    pub(crate) quick: bool,

    /// Make everything that is asked for again, also what is up to date
    #[arg(long)]
    pub(crate) force: bool,
}
