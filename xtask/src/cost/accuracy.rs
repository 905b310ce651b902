//! Error against time: every method on problems with known motions, with ever finer steps.

mod analysis;
mod barrier;
mod measure;
mod problem;
mod reference;
mod scheme;
mod study;

pub(super) use problem::Problem;
pub(super) use study::Front;

use super::Record;
use crate::report::{Effort, plot};
use crate::store::Files;
use anyhow::Result;
use maud::html;

/// What is measured, in words.
pub(super) const ABOUT: &str = "\
    Every method is run on every problem with ever finer steps. Times are CPU seconds for a simulated \
    second on one core, set-up left out; short runs are repeated up to five times and the minimum is \
    taken. Position errors are the largest distance of a vertex from the reference at eight points of \
    time, energy errors the largest change of T + V as part of the largest kinetic energy, strains the \
    largest relative edge length error. Differences in time below 10 % are noise.";

/// Makes the part of a problem.
pub(super) fn make(problem: Problem, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let name = problem.to_string();
    let study = study::make(problem, effort)?;
    study.data().named(&name).write(files)?;
    let alt = format!("{}: errors against CPU time, by method", problem.title());
    let figure = plot(files, &name, &study.plot(), &alt)?;
    let fronts = study.fronts();
    let inside = html! {
        h2 { (problem.title()) }
        p { (problem.about()) }
        (figure)
        (study.reference_table())
        details {
            summary { "All methods" }
            (study.table())
        }
    };
    Ok(Record {
        findings: study.findings(),
        fronts,
        ..Record::new(&name, inside)
    })
}
