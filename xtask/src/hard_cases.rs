//! `hard-cases`: the situations that break sheet solvers. A case is a file of `xtask/cases`: a scene,
//! variations of it, and bounds for what its runs say of themselves. `xtask/cases/README.md` describes them.
//!
//! Cases run side by side on the threads that rayon has; none of their numbers depends on the number of
//! threads.

mod case;
mod check;
mod variants;

use crate::interrupt;
use crate::progress;
use crate::report::{Finding, FullOptions, Part, Record, Report, Table, Verdict};
use crate::report::{all_findings, columns, findings};
use crate::store::{Kept, Store, Unit};
use anyhow::Result;
use case::Case;
use clap::Args;
use maud::html;
use rayon::prelude::*;
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
        let summary = summary(&cases, &kept.records);
        let counts = counts(&kept.records);
        println!("{}{counts}", summary.text());
        let report = Report {
            name: "hard-cases",
            title: "Hard cases",
            introduction: html! { p { (ABOUT) } p { (counts) } (summary) },
            caption: "Every check of every case",
            excerpt: vec![
                Part::text("counts", counts),
                Part::table("cases", &summary),
                Part::table("limitations", &limitations(&kept.records)),
            ],
        };
        report.write(&store, kept)
    })
}

const ABOUT: &str = "\
    Situations that break solvers for thin sheets. Each says what should happen and measures isosheet against bounds. Every number is \
    computed by the run that made this page: the summaries of all runs of a scene are judged. Largest strains and smallest gaps are of \
    all accepted steps, those of runs that stop early included.";

/// How many checks of some cases passed, are open limitations and failed.
fn counts(records: &[Record]) -> String {
    let verdicts = || all_findings(records).map(|(_, f)| f.verdict());
    let count = |v: Verdict| verdicts().filter(|other| *other == v).count();
    let failed = verdicts().filter(|v| v.is_failure()).count();
    let (cases, all) = (records.len(), verdicts().count());
    let [passed, open] = [Verdict::Passed, Verdict::Limitation].map(count);
    format!(
        "{cases} cases, {all} checks: {passed} passed, {open} open limitations, {failed} failed."
    )
}

/// The cases that have been run.
fn summary(cases: &[Case], records: &[Record]) -> Table {
    let title = |r: &Record| cases.iter().find(|case| case.name == r.name);
    let passed = |r: &Record| {
        let verdicts = r.findings.iter().map(Finding::verdict);
        verdicts.filter(|v| *v == Verdict::Passed).count()
    };
    Table::of(
        "The cases.",
        records,
        columns! { r;
            "case" => r.name.as_str(),
            "situation" => title(r).map(|case| case.contents.title.as_str()),
            "checks" => r.findings.len(),
            "passed" => passed(r),
            "verdict" => verdict(&r.findings).text(),
        },
    )
}

/// The checks that did not pass.
fn limitations(records: &[Record]) -> Table {
    let open = all_findings(records).filter(|(_, f)| f.verdict() != Verdict::Passed);
    let why = |f: &Finding| {
        f.limitation
            .as_ref()
            .map_or("not declared", |l| &l.why)
            .to_owned()
    };
    Table::of(
        "The checks that did not pass.",
        open,
        columns! { row;
            "case" => row.0,
            "check" => row.1.quantity.as_str(),
            "measured" => row.1.measured(),
            "bound" => row.1.bound.text(),
            "why" => why(row.1),
        },
    )
}

/// The worst verdict of some checks.
fn verdict(checks: &[Finding]) -> Verdict {
    let verdicts = checks.iter().map(Finding::verdict);
    verdicts.max().unwrap_or(Verdict::Passed)
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
    let wall = started.elapsed().as_secs_f64();
    let text = format!("{} ({wall:.1} s)", verdict(&checks).text());
    progress::note(&case.name, &text);
    let contents = &case.contents;
    let named = checks.iter().map(|check| (case.name.as_str(), check));
    let section = html! {
        h2 { (contents.title) }
        p { (contents.expected) }
        (findings("What isosheet does", named))
        (runs)
    };
    Ok(Record {
        findings: checks,
        ..Record::new(&case.name, section)
    })
}
