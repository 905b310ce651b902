//! `reproduce-figures`: makes what is asked for and not up to date, then writes the report.

mod page;

use crate::figures::{self, Context, Made};
use crate::interrupt::{self, Outcome};
use crate::progress;
use crate::report::Effort;
use crate::selection;
use crate::store::{Store, Unit};
use anyhow::{Result, bail};
use clap::Args;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `reproduce-figures`.
#[derive(Debug, Args)]
pub(crate) struct ReproduceArgs {
    /// Figures to make, such as 3 or 1-9,11; all when left out
    #[arg(long, value_name = "LIST", default_value = "1-17", value_parser = selection::parse)]
    pub(crate) figures: BTreeSet<u8>,

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

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let effort = Effort::of_flags([args.quick, true]);
    claim(&store, effort)?;
    let context = Context {
        store: &store,
        effort,
    };
    if args.force && args.figures.iter().any(|f| *f >= 10) {
        store.forget("run-")?;
    }
    let outcome = interrupt::each(&args.figures, |&figure| {
        let unit = unit(figure, effort);
        if args.force {
            store.forget(&unit.name)?;
        }
        let title = unit.title.clone();
        store.keep(&unit, |draft| {
            let started = Instant::now();
            let made = figures::make(figure, &context)?;
            made.keep(draft)?;
            let wall = started.elapsed().as_secs_f64();
            progress::note(&title, &format!("made ({wall:.1} s)"));
            Ok(made)
        })?;
        Ok(())
    })?;
    page::write(&store, effort, &records(&store))?;
    progress::note(
        "report",
        &store.root().join("index.html").display().to_string(),
    );
    Ok(outcome)
}

/// Where the folder keeps the effort that its results were made with.
const EFFORT: &str = ".stamps/effort.json";

/// Keeps quick and full results apart, which share the names of figures and runs: full results are not
/// replaced by quick ones, and quick ones are removed before the first full one is made.
fn claim(store: &Store, effort: Effort) -> Result<()> {
    let recorded = store.read(EFFORT).ok();
    let recorded = recorded.and_then(|text| serde_json::from_slice::<Effort>(&text).ok());
    match (recorded, effort) {
        (Some(Effort::Full), Effort::Quick) => bail!(
            "{} is for results without --quick, which are not mixed with quick ones; choose another folder with --out",
            store.root().display()
        ),
        (Some(Effort::Quick), Effort::Full) => {
            progress::note("quick results", "removed");
            store.clear()?;
        }
        _ => {}
    }
    if recorded != Some(effort) {
        store.write_json(EFFORT, &effort)?;
    }
    Ok(())
}

/// What is kept of a figure.
fn unit(figure: u8, effort: Effort) -> Unit {
    Unit {
        name: format!("fig{figure:02}"),
        title: format!("figure {figure}"),
        options: json!({ "figure": figure, "effort": effort }),
    }
}

/// All figures made so far, with the effort of each.
fn records(store: &Store) -> Vec<(u8, Made, Effort)> {
    let of = |figure| {
        let made = |effort| Some((figure, store.earlier(&unit(figure, effort))?, effort));
        [Effort::Quick, Effort::Full].into_iter().find_map(made)
    };
    selection::all().filter_map(of).collect()
}
