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
mod plot;
mod rigid;
mod scales;
mod scenes;
mod spin;
mod steps;

pub(crate) use case::{Bound, Case, Check, Effort, Findings, Record, Shortfall, Verdict};

use crate::cli::HardCasesArgs;
use crate::figures::PictureRef;
use crate::interrupt::Interrupted;
use crate::progress;
use crate::store::{Extent, Store};
use crate::{Outcome, interrupt};
use anyhow::{Context, Result, bail};
use rayon::prelude::*;
use serde_json::json;
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

/// Runs the command.
pub(crate) fn run(args: &HardCasesArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let effort = match (args.quick, args.full) {
        (true, _) => Effort::Quick,
        (_, true) => Effort::Full,
        _ => Effort::Standard,
    };
    let wanted =
        |case: &Case| args.cases.is_empty() || args.cases.iter().any(|c| c.name == case.name);
    let results: Vec<Result<()>> = CASES
        .par_iter()
        .with_max_len(1)
        .filter(|case| wanted(case))
        .map(|case| make(&store, case, effort, args.force))
        .collect();
    let mut outcome = Outcome::Complete;
    for result in results {
        match result {
            Err(error) if error.is::<Interrupted>() => outcome = Outcome::Interrupted,
            other => other?,
        }
    }
    let records: Vec<Record> = CASES
        .iter()
        .filter_map(|case| stored(&store, case, effort))
        .collect();
    page::write(&store, &records, effort)?;
    print!("{}", page::table(&records));
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

fn unit(case: &Case) -> String {
    format!("case-{}", case.name)
}

/// The record of a case that is up to date.
fn stored(store: &Store, case: &Case, effort: Effort) -> Option<Record> {
    let stamp = store.current(&unit(case), &json!({ "effort": effort }))?;
    serde_json::from_value(stamp.facts).ok()
}

/// Runs a case unless it is up to date, and keeps what it found.
fn make(store: &Store, case: &Case, effort: Effort, force: bool) -> Result<()> {
    interrupt::check()?;
    if !force && stored(store, case, effort).is_some() {
        progress::note(case.name, "up to date");
        return Ok(());
    }
    let started = Instant::now();
    let findings = (case.run)(effort).with_context(|| format!("case {}", case.name))?;
    let mut draft = store.draft()?;
    let mut pictures = Vec::new();
    for picture in &findings.pictures {
        let path = format!("figures/{}", picture.file);
        draft.write(&path, &picture.bytes)?;
        pictures.push(PictureRef {
            path,
            alt: picture.alt.clone(),
        });
    }
    let record = Record {
        name: case.name.to_owned(),
        title: case.title.to_owned(),
        expected: case.expected.to_owned(),
        naive: findings.naive,
        here: findings.here,
        checks: findings.checks,
        pictures,
        tables: findings.tables,
        wall: started.elapsed().as_secs_f64(),
    };
    progress::note(
        case.name,
        &format!("{} ({:.1} s)", record.verdict().text(), record.wall),
    );
    let facts = serde_json::to_value(&record)?;
    let options = json!({ "effort": effort });
    store.commit(draft, &unit(case), &options, Extent::Complete, facts)?;
    Ok(())
}
