//! `speed-vs-error`: time against errors of every method on problems with known motion, on two works that
//! other programs have been measured on, and of the linear solvers.
//!
//! Every part is kept in the output folder with what it found, so that an interrupted run continues where it
//! stopped, and the page is written from what is there.

mod analysis;
mod barrier;
pub(crate) mod comparison;
mod effort;
pub(crate) mod hanging;
mod matrices;
mod measure;
mod page;
mod problem;
mod reference;
mod scheme;
mod solvers;
mod study;
pub(crate) mod tablecloth;
mod verdict;

use crate::cli::SpeedArgs;
use crate::draw::Drawing;
use crate::interrupt::Interrupted;
use crate::store::{Extent, Stamp, Store};
use crate::{Outcome, interrupt, progress};
use anyhow::Result;
use effort::StudyEffort;
use problem::Problem;
use serde::Serialize;
use serde_json::json;
use std::fmt;
use std::str::FromStr;

pub(crate) use analysis::short;
pub(crate) use problem::{bumped, corner};

/// A part of the report that can be made alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Time against errors on a problem.
    Problem(Problem),
    /// The hanging sheet of other programs.
    Hanging,
    /// The tablecloth of other programs.
    Tablecloth,
    /// The linear solvers.
    Solvers,
}

impl Part {
    /// All parts that an effort has time for.
    fn all(effort: StudyEffort) -> Vec<Self> {
        let costly = [Problem::Strip(64), Problem::Sheet(2), Problem::Sheet(3)];
        let mut all: Vec<Self> = Problem::ALL
            .into_iter()
            .filter(|p| effort != StudyEffort::Quick || !costly.contains(p))
            .map(Self::Problem)
            .collect();
        all.extend([Self::Hanging, Self::Tablecloth, Self::Solvers]);
        all
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Problem(p) => p.fmt(f),
            Self::Hanging => f.write_str("hanging"),
            Self::Tablecloth => f.write_str("tablecloth"),
            Self::Solvers => f.write_str("solvers"),
        }
    }
}

impl FromStr for Part {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "hanging" => Ok(Self::Hanging),
            "tablecloth" => Ok(Self::Tablecloth),
            "solvers" => Ok(Self::Solvers),
            _ => match text.parse() {
                Ok(problem) => Ok(Self::Problem(problem)),
                Err(error) => anyhow::bail!("{error}, hanging, tablecloth, solvers"),
            },
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &SpeedArgs) -> Result<Outcome> {
    let effort = if args.quick {
        StudyEffort::Quick
    } else if args.full {
        StudyEffort::Full
    } else {
        StudyEffort::Usual
    };
    if let Some(folder) = &args.matrices {
        return matrices::write(folder, effort);
    }
    let store = Store::open(&args.out)?;
    let parts = if args.problems.is_empty() {
        Part::all(effort)
    } else {
        args.problems.clone()
    };
    let mut outcome = Outcome::Complete;
    for part in parts {
        if interrupt::requested() {
            outcome = Outcome::Interrupted;
            break;
        }
        if store.current(&unit(part), &options(effort)).is_some() {
            progress::note(&part.to_string(), "up to date");
            continue;
        }
        match make(&store, part, effort) {
            Ok(()) => {}
            Err(error) if error.is::<Interrupted>() => {
                outcome = Outcome::Interrupted;
                break;
            }
            Err(error) => return Err(error.context(part.to_string())),
        }
    }
    page::write(&store, effort)?;
    println!("{}", store.root().join("index.html").display());
    Ok(outcome)
}

fn unit(part: Part) -> String {
    format!("speed-{part}")
}

/// Layout of what is kept of a part; raised with each change of it, so that results in an older layout are
/// made again and not read.
const LAYOUT: u32 = 2;

fn options(effort: StudyEffort) -> serde_json::Value {
    json!({ "effort": effort, "layout": LAYOUT })
}

/// What is known about a part, whatever its effort.
fn stamp(store: &Store, part: Part) -> Option<Stamp> {
    store
        .stamp(&unit(part))
        .filter(|s| s.extent == Extent::Complete)
}

fn make(store: &Store, part: Part, effort: StudyEffort) -> Result<()> {
    match part {
        Part::Problem(problem) => {
            let study = study::make(problem, effort)?;
            let plots = vec![(problem.to_string(), study.plot(), plot_title(problem))];
            keep(store, part, effort, &study.csv(), &plots, &study)
        }
        Part::Hanging => {
            let rows = hanging::make(effort)?;
            keep(store, part, effort, &hanging::csv(&rows), &[], &rows)
        }
        Part::Tablecloth => {
            let rows = tablecloth::make(effort)?;
            keep(store, part, effort, &tablecloth::csv(&rows), &[], &rows)
        }
        Part::Solvers => {
            let rows = solvers::make(effort)?;
            let plots = vec![(
                "solvers".to_owned(),
                solvers::plot(&rows),
                SOLVERS.to_owned(),
            )];
            keep(store, part, effort, &solvers::csv(&rows), &plots, &rows)
        }
    }
}

/// What the plot of the solvers shows, for those who do not see it.
const SOLVERS: &str =
    "Time and backward error of the linear solvers against the number of degrees of freedom";

/// What the plot of a problem shows, for those who do not see it.
fn plot_title(problem: Problem) -> String {
    format!("{}: errors against wall time, by method", problem.title())
}

fn keep(
    store: &Store,
    part: Part,
    effort: StudyEffort,
    csv: &str,
    plots: &[(String, Drawing, String)],
    facts: &impl Serialize,
) -> Result<()> {
    let mut draft = store.draft()?;
    draft.write(&format!("tables/{part}.csv"), csv.as_bytes())?;
    for (name, drawing, title) in plots {
        draft.write(
            &format!("plots/{name}.svg"),
            drawing.to_svg(title)?.as_bytes(),
        )?;
        draft.write(&format!("plots/{name}.png"), &drawing.to_png(title)?)?;
    }
    store.commit(
        draft,
        &unit(part),
        &options(effort),
        Extent::Complete,
        serde_json::to_value(facts)?,
    )?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_read_back() {
        for part in Part::all(StudyEffort::Full) {
            assert_eq!(part.to_string().parse::<Part>().unwrap(), part);
        }
        let error = "sun".parse::<Part>().unwrap_err().to_string();
        assert!(
            error.contains("sheet-3, cloth-2, hanging, tablecloth, solvers"),
            "{error}"
        );
    }
}
