//! `cost`: what error costs how much time, by method, by solver, by size, and what whole runs cost at the sizes
//! that people use.
//!
//! Every part, and every row of the parts over sizes, is kept in the output folder, so that an interrupted run
//! continues where it stopped.

mod accuracy;
mod methods;
mod solvers;
mod steps;
mod works;

use crate::interrupt;
use crate::report::{Effort, FullOptions, Page, Part as Excerpt, Requirement, Section, Table};
use crate::report::{demand, excerpt, list, machine, one_of, requirements};
use crate::store::{Kept, Store, Unit};
use accuracy::Problem;
use anyhow::Result;
use clap::Args;
use maud::{Markup, html};
use methods::Scene;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
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
    /// The linear solvers.
    Solvers,
    /// Single steps over the sizes of the mesh.
    Steps,
}

impl Part {
    /// All parts with their names, in the order of the page.
    fn named() -> Vec<(&'static str, Self)> {
        let problems = Problem::ALL.map(|(problem, name)| (name, Self::Problem(problem)));
        let others = [
            ("hanging", Self::Methods(Scene::Hanging)),
            ("tablecloth", Self::Methods(Scene::Tablecloth)),
            ("solvers", Self::Solvers),
            (steps::NAME, Self::Steps),
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

    /// Finest mesh of the single steps, M^LEVEL
    #[arg(long, value_name = "LEVEL", default_value_t = 7,
        value_parser = clap::value_parser!(u32).range(3..=i64::from(steps::FINEST)))]
    level: u32,

    /// Write the matrices of the linear solvers to this folder as Matrix Market files, and measure nothing
    #[arg(long, value_name = "DIR", conflicts_with_all = ["parts", "works"])]
    matrices: Option<PathBuf>,
}

/// What is kept of a part.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Record {
    name: String,
    section: Section,
    /// What it says among the conclusions of the whole report.
    conclusions: Vec<String>,
    /// Tables for the book.
    excerpt: Vec<Excerpt>,
    /// Of a problem: whether the default is on the fronts of position and energy error, of all methods and of
    /// those that take flat states.
    on_front: Option<[[bool; 2]; 2]>,
    requirements: Vec<Requirement>,
}

impl Record {
    /// A part with nothing but its section of the page.
    fn new(name: &str, inside: Markup) -> Self {
        Self {
            name: name.to_owned(),
            section: html! { section id=(name) { (inside) } }.into(),
            conclusions: Vec::new(),
            excerpt: Vec::new(),
            on_front: None,
            requirements: Vec::new(),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &CostArgs) -> Result<()> {
    let effort = args.options.effort();
    if let Some(folder) = &args.matrices {
        return solvers::write_matrices(folder, effort);
    }
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
        asked.try_for_each(|(name, part)| measure(&store, name, part, args.level))
    });
    interrupt::afterwards(made, || report(&store))
}

/// Makes a part and keeps it.
fn measure(store: &Store, name: &str, part: Part, finest: u32) -> Result<()> {
    let effort = store.effort;
    let unit = Part::unit(store, name);
    match part {
        Part::Steps => return steps::measure(store, finest),
        Part::Problem(problem) => store.keep(&unit, |files| accuracy::make(problem, effort, files)),
        Part::Methods(scene) => {
            store.keep(&unit, |files| methods::make(scene, name, effort, files))
        }
        Part::Solvers => store.keep(&unit, |files| solvers::make(name, effort, files)),
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
    records.extend(steps::record(store, &mut left_out)?);
    let mut parts = vec![Excerpt::list("fronts", &accuracy::fronts(&records))];
    parts.extend(records.iter().flat_map(|r| r.excerpt.clone()));
    excerpt::write(store, "cost", &parts)?;
    let required = required(&records);
    table(&required).write_to(&store.path("tables/targets.csv"))?;
    let page = page(&records, &required);
    Page { left_out, ..page }.write(store, "index.html")?;
    demand(&required)
}

/// The requirements of all parts.
fn required(records: &[Record]) -> Vec<(String, Requirement)> {
    let of = |r: &Record| {
        let named = r.requirements.iter().map(|q| (r.name.clone(), q.clone()));
        named.collect::<Vec<_>>()
    };
    records.iter().flat_map(of).collect()
}

fn table(all: &[(String, Requirement)]) -> Table {
    requirements(
        "Orders, lengths, gaps, growth and bits against what the documentation says",
        all,
    )
}

/// The page: conclusions first, then every part.
fn page(records: &[Record], required: &[(String, Requirement)]) -> Page {
    let mut conclusions = accuracy::fronts(records);
    conclusions.extend(records.iter().flat_map(|r| r.conclusions.clone()));
    let first = records.iter().position(|r| r.on_front.is_some());
    let body = html! {
        p { "Times are CPU seconds where nothing else is said. Machine: " (machine()) "." }
        section { h2 { "Conclusions" } (list(&conclusions)) (table(required)) }
        @for (k, record) in records.iter().enumerate() {
            @if first == Some(k) { section { h2 { "Error against time" } p { (accuracy::ABOUT) } } }
            (record.section)
        }
    };
    Page::new("Cost and error", body)
}
