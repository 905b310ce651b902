//! The command line.

use crate::condition::{self, ConditionArgs};
use crate::cost::{self, CostArgs};
use crate::failure;
use crate::gallery::{self, GalleryArgs};
use crate::hard_cases::{self, HardCasesArgs};
use crate::interrupt;
use crate::locking::{self, LockingArgs};
use crate::measured::{self, MeasuredArgs};
use crate::reference::{self, ReferenceArgs};
use crate::reproduce::{self, ReproduceArgs};
use crate::soak::{self, SoakArgs};
use crate::validation::{self, ValidationArgs};
use anyhow::{Result, ensure};
use clap::{Args, Parser, Subcommand};
use std::ffi::OsStr;
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
    /// Writes DIR/index.html (small pictures are inside and open the files beside it), DIR/figures,
    /// DIR/scenes, DIR/runs and DIR/tables (CSV). What is already there and was made by the same program with
    /// the same options is kept; Ctrl-C stops at the next frame, and the same command continues.
    ReproduceFigures(ReproduceArgs),
    /// Tabulate and plot the condition numbers of three systems of coordinates, by mesh level
    ///
    /// Writes DIR/condition.csv and DIR/condition.svg and prints the table.
    ConditionTable(ConditionArgs),
    /// Measure time against errors: every method on every problem, the scenes of other programs, and whole
    /// runs at the sizes that people use
    ///
    /// Writes DIR/index.html (self-contained), DIR/tables (CSV) and DIR/plots (SVG and PNG). What is already
    /// there and was made by the same program with the same effort is kept, row by row; `--works w1,w2e
    /// --force` runs some rows anew. Times are CPU seconds: leave the machine alone meanwhile. The exit code
    /// is 0 unless an order, a length or a gap is not as the documentation says.
    Cost(CostArgs),
    /// Measure how much a triangulated sheet locks: how much stiffer it is than a smooth one, by yardsticks
    /// with references
    ///
    /// Writes DIR/index.html (self-contained), DIR/findings.csv and DIR/tables (CSV) and prints the
    /// findings. Finished yardsticks are kept, as in `reproduce-figures`. A run that does not
    /// end is an entry of a table. The exit code is 0 unless a finding is out of bounds that is not declared
    /// to be.
    Locking(LockingArgs),
    /// Run published experiments and closed forms with the elastic sheet, and tell how far each number is off
    ///
    /// Writes DIR/index.html (self-contained), DIR/findings.csv, DIR/tables (CSV) and DIR/plots, and prints
    /// the findings. Finished experiments are kept, as in `reproduce-figures`. The exit code is 0 unless an
    /// error is larger than the documentation says and not declared an open limitation.
    Validation(ValidationArgs),
    /// Put the solvers through the cases that break others, and report what they do
    ///
    /// Writes DIR/index.html (self-contained) and DIR/findings.csv, and prints a table. The exit code is 0
    /// unless a case fails that is not declared an open limitation. Finished cases are kept, as in
    /// `reproduce-figures`.
    HardCases(HardCasesArgs),
    /// Make the figures, the table of condition numbers and all reports, one after another
    ///
    /// Each is written to its own folder, DIR/REPORT. One that fails is reported, and the next one begins;
    /// the exit code is 0 if none fails. What is finished is kept, as in `reproduce-figures`.
    All(AllArgs),
    /// Copy what the reports have measured into the book and the README, or list what is out of date
    ///
    /// Each report writes DIR/measured.md, unless it is quick. This command puts the parts of these files
    /// into the parts of docs/measured and fills the marked blocks of README.md and of the pages of the book.
    Measured(MeasuredArgs),
    /// Make the pictures of the README: eighteen scenes that anybody can run, and a film of one of them
    ///
    /// Writes DIR/gallery.png and DIR/film.png (an animated PNG) and keeps the runs in DIR/runs. The scenes
    /// come from `isosheet new` and `xtask/scenes`.
    Gallery(GalleryArgs),
    /// Search with new seeds for cases in which a random test fails
    ///
    /// `cargo test` draws the same cases in every run. This command runs its random tests alone, with seeds
    /// that it prints and more cases for each: `PROPTEST_RNG_SEED=SEED ISOSHEET_TIMES=N cargo test NAME`
    /// repeats what failed.
    Soak(SoakArgs),
    /// Write the pages that are made of the code: scene.md, scene/*.md, materials.md and scene.schema.json
    Reference(ReferenceArgs),
}

impl Command {
    /// Runs the command.
    pub(crate) fn run(&self) -> Result<()> {
        match self {
            Self::ReproduceFigures(args) => reproduce::run(args),
            Self::ConditionTable(args) => condition::run(args),
            Self::Cost(args) => cost::run(args),
            Self::Locking(args) => locking::run(args),
            Self::Validation(args) => validation::run(args),
            Self::HardCases(args) => hard_cases::run(args),
            Self::All(args) => args.run(),
            Self::Measured(args) => measured::run(args),
            Self::Gallery(args) => gallery::run(args),
            Self::Soak(args) => soak::run(args),
            Self::Reference(args) => reference::run(args),
        }
    }
}

/// Arguments of `all`.
#[derive(Debug, Args)]
pub(crate) struct AllArgs {
    /// Folder with a folder for each report
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,

    /// Short runs on small meshes, as with each of the reports
    #[arg(long)]
    quick: bool,
}

/// The reports, with their options for short runs.
const REPORTS: [(&str, &[&str]); 6] = [
    ("reproduce-figures", &["--quick"]),
    ("condition-table", &["--level", "2"]),
    ("hard-cases", &["--quick"]),
    ("locking", &["--quick"]),
    ("validation", &["--quick"]),
    ("cost", &["--quick"]),
];

impl AllArgs {
    fn run(&self) -> Result<()> {
        let mut failed = Vec::new();
        for (report, quick) in REPORTS {
            let folder = self.out.join(report);
            let words = ["xtask", report, "--out"].map(OsStr::new);
            let mut words = [&words[..], &[folder.as_os_str()]].concat();
            words.extend(quick.iter().filter(|_| self.quick).map(OsStr::new));
            if let Err(error) = Cli::try_parse_from(words)?.command.run() {
                interrupt::check()?;
                failure::report(&error);
                failed.push(report);
            }
        }
        let names = failed.join(", ");
        ensure!(failed.is_empty(), "these reports failed: {names}");
        Ok(())
    }
}
