//! The command line.

use crate::locking;
use crate::selection::Selection;
use crate::speed_vs_error::Part;
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
    /// Figures 1-15 are those of the paper; 16, a paper jam, and 17, origami, are applications that it only
    /// names. Writes DIR/index.html (self-contained), DIR/figures, DIR/runs and DIR/summary.json. What is
    /// already there and was made by the same program with the same options is kept; Ctrl-C stops at the next
    /// frame, and the same command continues.
    ReproduceFigures(ReproduceArgs),
    /// Tabulate and plot the condition numbers of three systems of coordinates, by mesh level
    ///
    /// Writes DIR/condition.csv and DIR/condition.svg and prints the table.
    ConditionTable(ConditionArgs),
    /// Measure time against errors: every method on every problem, the hanging sheet and the tablecloth of
    /// other programs, the linear solvers
    ///
    /// Writes DIR/index.html (self-contained), DIR/tables (CSV) and DIR/plots (SVG and PNG). What is already
    /// there and was made by the same program with the same effort is kept. Times are wall times on one core:
    /// leave the machine alone meanwhile.
    SpeedVsError(SpeedArgs),
    /// Measure what steps and whole runs cost as the mesh is refined, without and with contact: time, memory,
    /// fill, fitted powers
    ///
    /// Writes DIR/scale.html (self-contained), DIR/scale.csv, DIR/draping.csv, DIR/runs.csv, DIR/scale.svg
    /// and DIR/scale.png and prints the tables.
    Scale(ScaleArgs),
    /// Measure how much a triangulated sheet locks: how much stiffer it is than a smooth one, by yardsticks
    /// with references
    ///
    /// Writes DIR/index.html (self-contained), DIR/tables (CSV) and DIR/plots (SVG and PNG) and prints the
    /// tables. Finished yardsticks are kept, as in `reproduce-figures`. A run that does not end is an entry
    /// of a table: the exit code says whether the report was made.
    Locking(LockingArgs),
    /// Put the solvers through the cases that break others, and report what they do
    ///
    /// Writes DIR/index.html (self-contained), DIR/verdicts.csv, DIR/verdicts.json and DIR/figures, and
    /// prints a table. The exit code is 0 unless a case fails that is not declared an open limitation.
    /// Finished cases are kept, as in `reproduce-figures`.
    HardCases(HardCasesArgs),
    /// Build the program of the 3D page of a run, io/view/dist, from io/view/src with npm and esbuild
    ///
    /// Only needed after a change of io/view; needs Node.js 20 or newer and the npm registry.
    BundleView(BundleViewArgs),
}

/// Arguments of `bundle-view`.
#[derive(Debug, Args)]
pub(crate) struct BundleViewArgs {
    /// Change nothing; fail if io/view/dist is not what the sources and the lock file make
    ///
    /// Says so and succeeds where npm is missing or the registry does not answer.
    #[arg(long)]
    pub(crate) check: bool,
}

/// Arguments of `speed-vs-error`.
#[derive(Debug, Args)]
pub(crate) struct SpeedArgs {
    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/speed-vs-error")]
    pub(crate) out: PathBuf,

    /// Seconds instead of ten minutes: checks that everything works, and shows no result
    #[arg(long, conflicts_with = "full")]
    pub(crate) quick: bool,

    /// Longer runs, smaller steps, larger matrices: about an hour
    #[arg(long)]
    pub(crate) full: bool,

    /// What to measure, separated by commas: problems (pendulum, triangle, strip-2, ..., sheet-3, cloth-2),
    /// hanging, tablecloth, solvers; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(crate) problems: Vec<Part>,

    /// Write the matrices of the solver study to this folder as Matrix Market files, and measure nothing
    #[arg(long, value_name = "DIR", conflicts_with = "problems")]
    pub(crate) matrices: Option<PathBuf>,
}

/// Arguments of `hard-cases`.
#[derive(Debug, Args)]
pub(crate) struct HardCasesArgs {
    /// Cases to run, such as flat-start,slivers; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = crate::hard_cases::parse)]
    pub(crate) cases: Vec<&'static crate::hard_cases::Case>,

    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/hard-cases")]
    pub(crate) out: PathBuf,

    /// Short runs on small meshes: checks in seconds that everything works
    #[arg(long, conflicts_with = "full")]
    pub(crate) quick: bool,

    /// Longer runs and finer meshes than fit into a few minutes
    #[arg(long)]
    pub(crate) full: bool,

    /// Run everything that is asked for again, also what is up to date
    #[arg(long)]
    pub(crate) force: bool,
}

/// Arguments of `condition-table`.
#[derive(Debug, Args)]
pub(crate) struct ConditionArgs {
    /// Finest mesh, M^LEVEL
    #[arg(long, value_name = "LEVEL", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=5))]
    pub(crate) level: u32,

    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/condition-table")]
    pub(crate) out: PathBuf,
}

/// Arguments of `scale`.
#[derive(Debug, Args)]
pub(crate) struct ScaleArgs {
    /// Finest mesh, M^LEVEL
    #[arg(long, value_name = "LEVEL", default_value_t = 7, value_parser = clap::value_parser!(u32).range(3..=8))]
    pub(crate) level: u32,

    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/scale")]
    pub(crate) out: PathBuf,

    /// Small meshes only: checks that everything works in seconds, and shows no result
    #[arg(long, conflicts_with = "full")]
    pub(crate) quick: bool,

    /// Whole runs up to M^5 instead of M^3, with ten minutes of wall time for each: about an hour
    #[arg(long)]
    pub(crate) full: bool,
}

/// Arguments of `locking`.
#[derive(Debug, Args)]
pub(crate) struct LockingArgs {
    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/locking")]
    pub(crate) out: PathBuf,

    /// Seconds instead of a quarter of an hour: checks that everything works, and shows no result
    #[arg(long)]
    pub(crate) quick: bool,

    /// Yardsticks to apply, separated by commas, such as clamped; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(crate) yardsticks: Vec<locking::Part>,
}

/// Arguments of `reproduce-figures`.
#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// Figures to make, such as 3 or 1-9,11; all when left out
    #[arg(long, value_name = "LIST", default_value_t = Selection::all())]
    pub(crate) figures: Selection,

    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/reproduce-figures")]
    pub(crate) out: PathBuf,

    /// Short runs and small pictures: checks that everything works in seconds, and shows no result
    ///
    /// Not for a folder that has full results. A full run removes quick results.
    #[arg(long)]
    pub(crate) quick: bool,

    /// Make everything that is asked for again, also what is up to date
    #[arg(long)]
    pub(crate) force: bool,
}
