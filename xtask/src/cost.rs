//! `cost`: what error costs how much time, by method, and what whole runs cost at the sizes that people use.
//!
//! Every part, and every row of the parts over sizes, is kept in the output folder, so that an interrupted
//! run continues where it stopped.

mod accuracy;
mod methods;
mod ran;
mod works;

use crate::interrupt;
use crate::report::{Effort, Finding, FullOptions, Page, Part as Excerpt, Section, Table};
use crate::report::{demand, excerpt, findings, machine, one_of, write_findings};
use crate::store::{Kept, Store, Unit};
use accuracy::{Front, Problem};
use anyhow::Result;
use clap::Args;
use maud::{Markup, html};
use methods::Scene;
use serde::{Deserialize, Serialize};
use works::Work;

/// Name of the method that isosheet uses when none is asked for.
const DEFAULT: &str = "BDF2 (default)";

/// A part of the report that can be made alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// Time against errors on a problem.
    Problem(Problem),
    /// The methods on a scene of other programs.
    Methods(Scene),
}

impl Part {
    /// All parts with their names, in the order of the page.
    fn named() -> Vec<(&'static str, Self)> {
        let problems = Problem::ALL.map(|(problem, name, _)| (name, Self::Problem(problem)));
        let others = [
            ("hanging", Self::Methods(Scene::Hanging)),
            ("tablecloth", Self::Methods(Scene::Tablecloth)),
        ];
        problems.into_iter().chain(others).collect()
    }

    /// Whether an effort has time for it.
    fn is_for(self, effort: Effort) -> bool {
        let costly = [Problem::Strip(64), Problem::Sheet(2), Problem::Sheet(3)];
        effort != Effort::Quick || !costly.map(Self::Problem).contains(&self)
    }

    fn unit(store: &Store, name: &str) -> Unit {
        store.unit(format!("cost-{name}"), name)
    }
}

/// Arguments of `cost`.
#[derive(Debug, Args)]
pub(crate) struct CostArgs {
    #[command(flatten)]
    options: FullOptions,

    /// Parts to measure, separated by commas; all, and all works, when neither is given
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(Part::named))]
    parts: Vec<Part>,

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
    /// Of a problem: the cheapest methods by error.
    fronts: Vec<Front>,
    findings: Vec<Finding>,
}

impl Record {
    /// A part with nothing but its section of the page.
    fn new(name: &str, inside: Markup) -> Self {
        Self {
            name: name.to_owned(),
            section: html! { section id=(name) { (inside) } }.into(),
            excerpt: Vec::new(),
            fronts: Vec::new(),
            findings: Vec::new(),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &CostArgs) -> Result<()> {
    let effort = args.options.effort();
    let store = args.options.open("cost")?;
    let (mut parts, mut works) = (args.parts.clone(), args.works.clone());
    if parts.is_empty() && works.is_empty() {
        let all = Part::named().into_iter().map(|(_, part)| part);
        parts.extend(all.filter(|part| part.is_for(effort)));
        works.extend(works::named().into_iter().map(|(_, work)| work));
    }
    let made = works::measure(&store, &works).and_then(|()| {
        let named = Part::named().into_iter();
        let mut asked = named.filter(|(_, part)| parts.contains(part));
        asked.try_for_each(|(name, part)| measure(&store, name, part))
    });
    interrupt::afterwards(made, || report(&store))
}

/// Makes a part and keeps it.
fn measure(store: &Store, name: &str, part: Part) -> Result<()> {
    let effort = store.effort;
    let unit = Part::unit(store, name);
    match part {
        Part::Problem(problem) => {
            store.keep(&unit, |files| accuracy::make(problem, name, effort, files))
        }
        Part::Methods(scene) => {
            store.keep(&unit, |files| methods::make(scene, name, effort, files))
        }
    }?;
    Ok(())
}

/// Writes the page and the other files of all that is kept.
fn report(store: &Store) -> Result<()> {
    let names = Part::named().into_iter().map(|(name, _)| name);
    let units = names.map(|name| Part::unit(store, name)).collect();
    let Kept {
        mut records,
        mut left_out,
    } = store.all_kept::<Record>(units);
    let works = works::record(store, &mut left_out)?;
    records.splice(0..0, works);
    let fronts: Vec<Front> = records.iter().flat_map(|r| r.fronts.clone()).collect();
    let fronts = accuracy::fronts(&fronts)?;
    let mut parts = vec![Excerpt::table(&*fronts.name, &fronts)];
    parts.extend(records.iter().flat_map(|r| r.excerpt.clone()));
    excerpt::write(store, "cost", &parts)?;
    fronts.write_to(&store.path("tables/fronts.csv"))?;
    write_findings(store, found(&records))?;
    let page = page(&records, &fronts);
    Page { left_out, ..page }.write(store, "index.html")?;
    demand(found(&records))
}

/// The findings of all parts, with the names of the parts.
fn found(records: &[Record]) -> impl Iterator<Item = (&str, &Finding)> + Clone {
    let parts = records.iter();
    parts.flat_map(|r| r.findings.iter().map(move |f| (r.name.as_str(), f)))
}

/// The page: findings first, then every part.
fn page(records: &[Record], fronts: &Table) -> Page {
    let caption = "Orders, lengths and gaps against what the documentation says";
    let first = records.iter().position(|r| !r.fronts.is_empty());
    let body = html! {
        p { "Times are CPU seconds where nothing else is said. Machine: " (machine()) "." }
        section { h2 { "Findings" } (findings(caption, found(records))) }
        @for (k, record) in records.iter().enumerate() {
            @if first == Some(k) {
                section { h2 { "Error against time" } p { (accuracy::ABOUT) } (fronts) }
            }
            (record.section)
        }
    };
    Page::new("Cost and error", body)
}
