//! Options that reports share.

use super::Effort;
use crate::store::{Remake, Store};
use anyhow::Result;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::{Path, PathBuf};

/// Options of all reports.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Folder to write to, out/REPORT when left out: a new or empty one, or one of an earlier run
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Short runs on small meshes and small pictures: checks in seconds that everything works, and shows no
    /// result
    ///
    /// Not for a folder that has other results. A run without --quick removes quick results.
    #[arg(long)]
    pub(crate) quick: bool,

    /// Make everything that is asked for again, also what is up to date
    #[arg(long)]
    pub(crate) force: bool,
}

/// Options of reports that can be asked for more than fits into minutes.
#[derive(Debug, Args)]
pub(crate) struct FullOptions {
    #[command(flatten)]
    pub(crate) options: Options,

    /// Longer runs, finer meshes and ensembles, for as long as it takes
    #[arg(long, conflicts_with = "quick")]
    pub(crate) full: bool,
}

impl Options {
    /// The output folder of a report.
    ///
    /// # Errors
    /// Errors of [`Store::open`].
    pub(crate) fn open(&self, report: &str) -> Result<Store> {
        let standard = Effort::Standard;
        self.open_with(report, if self.quick { Effort::Quick } else { standard })
    }

    fn open_with(&self, report: &str, effort: Effort) -> Result<Store> {
        let remake = if self.force {
            Remake::Once
        } else {
            Remake::Never
        };
        let default = || Path::new("out").join(report);
        let out = self.out.clone().unwrap_or_else(default);
        Store::of_report(&out, report, effort, remake)
    }
}

impl FullOptions {
    /// The effort asked for.
    pub(crate) fn effort(&self) -> Effort {
        match (self.options.quick, self.full) {
            (true, _) => Effort::Quick,
            (_, true) => Effort::Full,
            _ => Effort::Standard,
        }
    }

    /// As [`Options::open`].
    pub(crate) fn open(&self, report: &str) -> Result<Store> {
        self.options.open_with(report, self.effort())
    }
}

/// Reads one of some things by its name on the command line; an unknown name is answered with the nearest
/// one.
pub(crate) fn one_of<T: Copy + Send + Sync + 'static>(
    all: impl Fn() -> Vec<(&'static str, T)> + Clone + Send + Sync + 'static,
) -> impl TypedValueParser<Value = T> {
    let names: Vec<&str> = all().into_iter().map(|(name, _)| name).collect();
    PossibleValuesParser::new(names).map(move |name| {
        let named = all().into_iter().find(|(known, _)| *known == name);
        named.expect("the parser knows these names alone").1
    })
}
