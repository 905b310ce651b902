//! `cost`: what error costs how much time, by method, and what whole runs cost at the sizes that people use.
//!
//! Every problem and every row of the whole runs is kept in the output folder, so that an interrupted run
//! continues where it stopped.

mod accuracy;
mod works;

use crate::interrupt;
use crate::report::{Finding, FullOptions, Page, Part as Excerpt, Section};
use crate::report::{demand, excerpt, findings, machine, one_of, write_findings};
use crate::store::{Kept, Store, Unit};
use accuracy::Problem;
use anyhow::Result;
use clap::Args;
use maud::{Markup, html};
use serde::{Deserialize, Serialize};
use works::Work;

/// Name of the method that isosheet uses when none is asked for.
const DEFAULT: &str = "BDF2 (default)";

/// Arguments of `cost`.
#[derive(Debug, Args)]
pub(crate) struct CostArgs {
    #[command(flatten)]
    options: FullOptions,

    /// Problems to measure, separated by commas; all, and all works, when neither is given
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(Problem::named))]
    parts: Vec<Problem>,

    /// Whole runs to measure, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(works::named))]
    works: Vec<&'static Work>,
}

/// What is kept of a part.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Record {
    name: String,
    section: Section,
    /// Tables for the book.
    excerpt: Vec<Excerpt>,
    findings: Vec<Finding>,
}

impl Record {
    /// A part with nothing but its section of the page.
    fn new(name: &str, inside: Markup) -> Self {
        Self {
            name: name.to_owned(),
            section: html! { section id=(name) { (inside) } }.into(),
            excerpt: Vec::new(),
            findings: Vec::new(),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &CostArgs) -> Result<()> {
    let store = args.options.open("cost")?;
    let (mut problems, mut works) = (args.parts.clone(), args.works.clone());
    if problems.is_empty() && works.is_empty() {
        problems.extend(Problem::named().into_iter().map(|(_, problem)| problem));
        works.extend(works::named().into_iter().map(|(_, work)| work));
    }
    let made = works::measure(&store, &works).and_then(|()| {
        problems.iter().try_for_each(|&problem| {
            let unit = unit(&store, problem);
            store.keep(&unit, |files| accuracy::make(problem, store.effort, files))?;
            Ok(())
        })
    });
    interrupt::afterwards(made, || report(&store))
}

fn unit(store: &Store, problem: Problem) -> Unit {
    let name = problem.name();
    store.unit(format!("cost-{name}"), name)
}

/// Writes the page and the other files of all that is kept.
fn report(store: &Store) -> Result<()> {
    let all = Problem::named().into_iter();
    let units = all.map(|(_, problem)| unit(store, problem)).collect();
    let Kept {
        records: problems,
        mut left_out,
    } = store.all_kept::<Record>(units);
    let works = works::records(store, &mut left_out)?;
    let records = || works.iter().chain(&problems);
    let parts = records().flat_map(|r| r.excerpt.clone()).collect();
    excerpt::write(store, "cost", parts)?;
    let found = || records().flat_map(|r| r.findings.iter().map(|f| (r.name.as_str(), f)));
    write_findings(store, found().collect::<Vec<_>>())?;
    let caption = "Orders, lengths and gaps against what the documentation says";
    let body = html! {
        p { "Times are CPU seconds where nothing else is said. Machine: " (machine()) "." }
        section { h2 { "Findings" } (findings(caption, found())) }
        @for record in &works { (record.section) }
        @if !problems.is_empty() {
            section { h2 { "Error against time" } p { (accuracy::ABOUT) } }
        }
        @for record in &problems { (record.section) }
    };
    let page = Page::new("Cost and error", body);
    Page { left_out, ..page }.write(store, "index.html")?;
    demand(found())
}
