//! `hard-cases`: the situations that break sheet solvers. Each case states what should happen, shows a
//! naive method that fails, and shows measurements of what isosheet does.
//!
//! The cases of one kind are in one file. Cases run side by side on the threads that rayon has; none of
//! their numbers depends on the number of threads.

mod case;
mod charts;
mod flat;
mod invariance;
mod locking;
mod long;
mod meshes;
mod naive;
mod page;
mod pins;
mod plate;
mod rigid;
mod scales;
mod scenes;
mod steps;

pub(crate) use case::{Case, Findings, Record, Shortfall};

use crate::draw::{Chart, Drawing, Series};
use crate::interrupt::{self, Outcome};
use crate::progress;
use crate::report::Effort;
use crate::store::{Draft, Store, Unit};
use anyhow::{Result, bail};
use clap::Args;
use rayon::prelude::*;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// The cases in the order of the report.
pub(crate) static CASES: [&Case; 22] = [
    &flat::START,
    &flat::BRANCH,
    &charts::CONDITION,
    &charts::LITERAL,
    &charts::COLLINEAR,
    &scales::SLIVERS,
    &scales::MASSES,
    &scales::SIZES,
    &meshes::LONG,
    &meshes::IRREGULAR,
    &rigid::CLOSED,
    &plate::PLATE,
    &pins::OVER_PINNED,
    &pins::TAUT,
    &steps::SIZES,
    &steps::FREE_FALL,
    &long::REST,
    &long::MILLION,
    &invariance::REVERSAL,
    &invariance::SYMMETRY,
    &invariance::THREADS,
    &locking::DRAPE,
];

/// A case by its name on the command line.
pub(crate) fn parse(name: &str) -> Result<&'static Case, String> {
    CASES.into_iter().find(|c| c.name == name).ok_or_else(|| {
        let names: Vec<&str> = CASES.iter().map(|c| c.name).collect();
        format!("there is no such case; the cases are {}", names.join(", "))
    })
}

/// Arguments of `hard-cases`.
#[derive(Debug, Args)]
pub(crate) struct HardCasesArgs {
    /// Cases to run, such as flat-start,slivers; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse)]
    pub(crate) cases: Vec<&'static Case>,

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

/// Runs the command.
pub(crate) fn run(args: &HardCasesArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let effort = Effort::of_flags([args.quick, args.full]);
    let wanted =
        |case: &Case| args.cases.is_empty() || args.cases.iter().any(|c| c.name == case.name);
    let results: Vec<Result<()>> = CASES
        .par_iter()
        .with_max_len(1)
        .filter(|case| wanted(case))
        .map(|case| {
            let unit = unit(case, effort);
            if args.force {
                store.forget(&unit.name)?;
            }
            store.keep(&unit, |draft| make(case, effort, draft))?;
            Ok(())
        })
        .collect();
    let outcome = interrupt::each(results, |result| result)?;
    let kept = |case: &&Case| store.kept(&unit(case, effort));
    let records: Vec<Record> = CASES.iter().filter_map(kept).collect();
    page::write(&store, &records, effort)?;
    print!("{}", page::text(&records));
    println!("{}", store.root().join("index.html").display());
    let failed: Vec<&str> = records
        .iter()
        .filter(|r| r.verdict().is_failure())
        .map(|r| r.name.as_str())
        .collect();
    if !failed.is_empty() {
        bail!(
            "cases failed, or their open limitations are not as declared: {}",
            failed.join(", ")
        );
    }
    Ok(outcome)
}

/// Size of the area inside the axes of charts, points.
const SIZE: [f64; 2] = [230.0, 150.0];

/// A chart with logarithmic axes.
fn log_log(x: &str, y: &str, series: Vec<Series>) -> Drawing {
    Chart::log_log(x, y, SIZE, series).draw()
}

/// A chart whose vertical axis is logarithmic.
fn semi_log(x: &str, y: &str, series: Vec<Series>) -> Drawing {
    Chart::semi_log(x, y, SIZE, series).draw()
}

fn unit(case: &Case, effort: Effort) -> Unit {
    Unit {
        name: format!("case-{}", case.name),
        title: case.name.to_owned(),
        options: json!({ "effort": effort }),
    }
}

/// Runs a case.
fn make(case: &Case, effort: Effort, draft: &mut Draft) -> Result<Record> {
    let started = Instant::now();
    let found = (case.run)(effort)?;
    for picture in &found.pictures {
        draft.write(&picture.path, &picture.bytes)?;
    }
    let record = Record {
        name: case.name.to_owned(),
        title: case.title.to_owned(),
        expected: case.expected.to_owned(),
        found,
        wall: started.elapsed().as_secs_f64(),
    };
    progress::note(
        case.name,
        &format!("{} ({:.1} s)", record.verdict().text(), record.wall),
    );
    Ok(record)
}
