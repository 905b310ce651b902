//! Error against time: every method on problems with known motions, with ever finer steps.

mod barrier;
mod motion;
mod point;
mod problem;
mod reference;
mod scheme;
mod study;

pub(super) use problem::Problem;
pub(super) use study::Front;

use super::Record;
use crate::report::{Effort, Table, plot};
use crate::store::Files;
use anyhow::Result;
use maud::html;
use study::Study;

/// What is measured, in words.
pub(super) const ABOUT: &str = "\
    Every method is run on every problem with ever finer steps. Times are CPU seconds for a simulated \
    second on one core, set-up left out; short runs are repeated up to five times and the minimum is \
    taken. Position errors are the largest distance of a vertex from the reference at eight points of \
    time, energy errors the largest change of T + V as part of the largest kinetic energy, strains the \
    largest relative edge length error. Differences in time below 10 % are noise.";

/// What the table of the fronts shows.
const FRONTS: &str = "The cheapest method for an error of positions or of energy: of all, and of those that take flat states, beside \
    the default; CPU seconds for a simulated second (s/s)";

/// The table of the fronts of all problems.
pub(super) fn fronts<'a>(rows: impl Iterator<Item = &'a Front>) -> Result<Table> {
    Ok(Table::of_fields(FRONTS, rows)?.named("fronts"))
}

/// Makes the part of a problem.
pub(super) fn make(problem: Problem, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let (name, title) = (problem.name(), problem.title());
    let study = Study::of(problem, effort)?;
    study.data()?.named(name).write(files)?;
    let alt = format!("{title}: errors against CPU time, by method");
    let figure = plot(files, name, &study.plot(), &alt)?;
    let inside = html! {
        h2 { (title) }
        p { (problem.about()) }
        (figure)
        (study.reference.table())
        details {
            summary { "All methods" }
            (study.table())
        }
    };
    Ok(Record {
        findings: study.findings(),
        fronts: study.fronts(),
        ..Record::new(name, inside)
    })
}
