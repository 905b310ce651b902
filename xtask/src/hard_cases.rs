//! `hard-cases`: the situations that break sheet solvers. A case is a file of `xtask/cases`: a scene,
//! variations of it, and bounds for what its runs say of themselves. `xtask/cases/README.md` describes them.
//!
//! Cases run side by side on the threads that rayon has; none of their numbers depends on the number of
//! threads.

mod case;
mod check;
mod page;
mod variants;

use crate::interrupt;
use crate::progress;
use crate::report::{Finding, FullOptions, Section, Verdict, demand, excerpt};
use crate::store::{Kept, Store, Unit};
use anyhow::Result;
use case::Case;
use clap::Args;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::time::Instant;

/// Arguments of `hard-cases`.
#[derive(Debug, Args)]
pub(crate) struct HardCasesArgs {
    /// Cases to run, such as flat-start,rest; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = case::named)]
    cases: Vec<String>,

    #[command(flatten)]
    options: FullOptions,
}

/// What is kept about a case.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Record {
    name: String,
    title: String,
    section: Section,
    checks: Vec<Finding>,
    /// Wall time, seconds.
    wall: f64,
}

impl Record {
    /// The worst verdict of the checks.
    fn verdict(&self) -> Verdict {
        let verdicts = self.checks.iter().map(Finding::verdict);
        verdicts.max().unwrap_or(Verdict::Passed)
    }
}

/// Runs the command.
pub(crate) fn run(args: &HardCasesArgs) -> Result<()> {
    let store = args.options.open("hard-cases")?;
    let cases = case::all()?;
    let is_wanted = |case: &&Case| args.cases.is_empty() || args.cases.contains(&case.name);
    let wanted: Vec<&Case> = cases.iter().filter(is_wanted).collect();
    let results: Vec<Result<Record>> = wanted
        .into_par_iter()
        .with_max_len(1)
        .map(|case| store.keep(&unit(&store, case), |_| make(case, &store)))
        .collect();
    let made = results.into_iter().try_for_each(|made| made.map(drop));
    interrupt::afterwards(made, || {
        let units = cases.iter().map(|case| unit(&store, case));
        let kept: Kept<Record> = store.all_kept(units.collect());
        let records = &kept.records;
        print!("{}", page::text(records));
        page::write(&store, &kept)?;
        excerpt::write(&store, "hard-cases", page::excerpt(records))?;
        demand(page::findings(records))
    })
}

fn unit(store: &Store, case: &Case) -> Unit {
    let mut unit = store.unit(format!("case-{}", case.name), &case.name);
    unit.options["file"] = json!(case.texts);
    unit
}

/// Runs a case.
fn make(case: &Case, store: &Store) -> Result<Record> {
    let started = Instant::now();
    let (checks, runs) = case.run(store.effort)?;
    let mut record = Record {
        name: case.name.clone(),
        title: case.contents.title.clone(),
        section: Section::default(),
        checks,
        wall: started.elapsed().as_secs_f64(),
    };
    let text = format!("{} ({:.1} s)", record.verdict().text(), record.wall);
    progress::note(&case.name, &text);
    record.section = page::section(&case.contents.expected, &record, &runs).into();
    Ok(record)
}
