//! `hard-cases`: the situations that break sheet solvers. Each case states what should happen and shows
//! measurements of what isosheet does; most show a naive method that fails.
//!
//! The cases of one kind are in one file. Cases run side by side on the threads that rayon has; none of
//! their numbers depends on the number of threads.

mod case;
mod charts;
mod clamps;
mod file;
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

pub(crate) use case::{Case, Code, Findings, Record, Work};

use crate::draw::{Chart, Charts, Series};
use crate::interrupt;
use crate::progress;
use crate::report::{Effort, FullOptions, demand, excerpt, one_of};
use crate::store::{Files, Kept, Store, Unit};
use anyhow::{Result, ensure};
use clap::Args;
use rayon::prelude::*;
use std::time::Instant;

/// The cases that are code, in the order of the report.
static CASES: [&Case; 16] = [
    &flat::BRANCH,
    &charts::CONDITION,
    &charts::LITERAL,
    &charts::COLLINEAR,
    &scales::SLIVERS,
    &scales::SIZES,
    &rigid::CLOSED,
    &plate::PLATE,
    &pins::TAUT,
    &steps::FREE_FALL,
    &long::MILLION,
    &invariance::REVERSAL,
    &invariance::SYMMETRY,
    &invariance::THREADS,
    &locking::DRAPE,
    &clamps::CLAMPS,
];

/// What code adds to the cases that are files, by their names.
static BESIDE: [(&str, Code); 6] = [
    ("fan-and-strip", meshes::long),
    ("flat-start", flat::start),
    ("irregular", meshes::irregular),
    ("mass-ratio", scales::masses),
    ("over-pinned", pins::over_pinned),
    ("step-sizes", steps::sizes),
];

/// All cases in the order of the report.
///
/// # Errors
/// What is wrong with a file.
fn cases() -> Result<Vec<&'static Case>> {
    Ok(CASES.into_iter().chain(file::all()?).collect())
}

/// The names of all cases: a file that is wrong has one, too, so that the other commands go on.
fn named() -> Vec<(&'static str, &'static str)> {
    let names = CASES.iter().map(|case| case.name).chain(file::names());
    names.map(|name| (name, name)).collect()
}

/// Arguments of `hard-cases`.
#[derive(Debug, Args)]
pub(crate) struct HardCasesArgs {
    /// Cases to run, such as flat-start,slivers; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(named))]
    cases: Vec<&'static str>,

    #[command(flatten)]
    options: FullOptions,
}

/// Runs the command.
pub(crate) fn run(args: &HardCasesArgs) -> Result<()> {
    let store = args.options.open("hard-cases")?;
    let cases = cases()?;
    let is_wanted = |case: &&&Case| args.cases.is_empty() || args.cases.contains(&case.name);
    let wanted: Vec<&Case> = cases.iter().filter(is_wanted).copied().collect();
    let results: Vec<Result<Record>> = wanted
        .into_par_iter()
        .with_max_len(1)
        .map(|case| store.keep(&unit(&store, case), |files| make(case, store.effort, files)))
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

/// Size of the area inside the axes of charts, points.
const SIZE: [f64; 2] = [230.0, 150.0];

/// A chart with logarithmic axes.
fn log_log(x: &str, y: &str, series: Vec<Series>) -> Charts {
    Chart::log_log(x, y, SIZE, series).into()
}

/// A chart whose vertical axis is logarithmic.
fn semi_log(x: &str, y: &str, series: Vec<Series>) -> Charts {
    Chart::semi_log(x, y, SIZE, series).into()
}

fn unit(store: &Store, case: &Case) -> Unit {
    let mut unit = store.unit(format!("case-{}", case.name), case.name);
    if let Work::File(file, _) = case.run {
        unit.options["file"] = file.options();
    }
    unit
}

/// Runs a case.
fn make(case: &Case, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let started = Instant::now();
    let mut found = Findings::default();
    case.find(&mut found, effort)?;
    ensure!(
        !found.here.is_empty(),
        "the case {} does not say what isosheet does",
        case.name
    );
    for picture in &found.pictures {
        picture.write(files)?;
    }
    let mut record = Record {
        name: case.name.to_owned(),
        title: case.title.to_owned(),
        section: Default::default(),
        naive: found.naive,
        checks: found.checks,
        wall: started.elapsed().as_secs_f64(),
    };
    let text = format!("{} ({:.1} s)", record.verdict().text(), record.wall);
    progress::note(case.name, &text);
    let shown = (found.pictures.as_slice(), found.tables.as_slice());
    record.section = page::section(case, &record, found.here, shown).into();
    Ok(record)
}
