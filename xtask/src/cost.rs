//! `cost`: what error costs how much time, by method, and what whole runs cost at the sizes that people use.
//!
//! Every problem and every row of the whole runs is kept in the output folder, so that an interrupted run
//! continues where it stopped.

mod accuracy;
mod baselines;
mod solvers;
mod works;

use crate::interrupt;
use crate::report::{Effort, FullOptions, Record, Report, machine, one_of};
use crate::store::{Files, Kept, Store, Unit};
use accuracy::ExactProblem;
use anyhow::Result;
use clap::Args;
use maud::html;
use works::Work;

/// Name of the method that isosheet uses when none is asked for.
const DEFAULT: &str = "BDF2 (default)";

/// Arguments of `cost`.
#[derive(Debug, Args)]
pub(crate) struct CostArgs {
    #[command(flatten)]
    options: FullOptions,

    /// Problems to measure, separated by commas; all, and all works, when neither is given
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(CostPart::named))]
    parts: Vec<CostPart>,

    /// Whole runs to measure, separated by commas
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(works::named))]
    works: Vec<&'static Work>,
}

/// What is measured besides whole runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CostPart {
    /// Error against time on a problem with an exact solution.
    Accuracy(ExactProblem),
    /// The solvers of the paper's linear system.
    Solvers,
}

impl CostPart {
    /// All of them with their names.
    fn named() -> Vec<(&'static str, Self)> {
        let problems = ExactProblem::named().into_iter();
        let problems = problems.map(|(name, problem)| (name, Self::Accuracy(problem)));
        problems.chain([(solvers::NAME, Self::Solvers)]).collect()
    }

    fn name(self) -> &'static str {
        match self {
            Self::Accuracy(problem) => problem.name(),
            Self::Solvers => solvers::NAME,
        }
    }

    fn make(self, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
        match self {
            Self::Accuracy(problem) => accuracy::make(problem, effort, files),
            Self::Solvers => solvers::make(effort, files),
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &CostArgs) -> Result<()> {
    let store = args.options.open("cost")?;
    let (mut problems, mut works) = (args.parts.clone(), args.works.clone());
    if problems.is_empty() && works.is_empty() {
        problems.extend(CostPart::named().into_iter().map(|(_, part)| part));
        works.extend(works::named().into_iter().map(|(_, work)| work));
    }
    let made = works::measure(&store, &works).and_then(|()| {
        problems.iter().try_for_each(|&problem| {
            let unit = unit(&store, problem);
            store.keep(&unit, |files| problem.make(store.effort, files))?;
            Ok(())
        })
    });
    interrupt::afterwards(made, || report(&store))
}

fn unit(store: &Store, problem: CostPart) -> Unit {
    let name = problem.name();
    store.unit(format!("cost-{name}"), name)
}

/// Writes the page and the other files of all that is kept.
fn report(store: &Store) -> Result<()> {
    let all = CostPart::named().into_iter();
    let units = all.map(|(_, problem)| unit(store, problem)).collect();
    let mut kept: Kept<Record> = store.all_kept(units);
    let mut works = works::records(store, &mut kept.left_out)?;
    works.append(&mut kept.records);
    kept.records = works;
    let report = Report {
        name: "cost",
        title: "Cost and error",
        introduction: html! {
            p { "Times are CPU seconds where nothing else is said. Machine: " (machine()) "." }
            p { (accuracy::ABOUT) }
        },
        caption: "Orders, lengths and gaps against what the documentation says",
        excerpt: Vec::new(),
    };
    report.write(store, kept)
}
