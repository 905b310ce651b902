//! Error against time: every method on problems with known motions, with ever finer steps.

mod analysis;
mod barrier;
mod measure;
mod problem;
mod reference;
mod scheme;
mod study;

pub(super) use problem::Problem;

use super::{DEFAULT, Record};
use crate::report::{Effort, list, plot};
use crate::store::Files;
use analysis::{ENERGY, POSITION};
use anyhow::Result;
use maud::html;

/// What is measured, in words.
pub(super) const ABOUT: &str = "\
    Every method is run on every problem with ever finer steps. Times are CPU seconds for a simulated \
    second on one core, set-up left out; short runs are repeated up to five times and the minimum is \
    taken. Position errors are the largest distance of a vertex from the reference at eight points of \
    time, energy errors the largest change of T + V as part of the largest kinetic energy, strains the \
    largest relative edge length error. Differences in time below 10 % are noise. Whether a method is on \
    the front is asked of position errors up to 0.05 m and energy errors up to 0.1: coarser runs are \
    cheap, but no motion.";

/// Makes the part of a problem.
pub(super) fn make(problem: Problem, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let name = problem.to_string();
    let study = study::make(problem, effort)?;
    study.data().named(&name).write(files)?;
    let alt = format!("{}: errors against CPU time, by method", problem.title());
    let figure = plot(files, &name, &study.plot(), &alt)?;
    let fronts = [POSITION, ENERGY].map(|m| study.default_on_front(m));
    let inside = html! {
        h2 { (problem.title()) }
        p { (problem.about()) }
        p { (study.reference_words()) }
        (figure)
        (list(&study.conclusions()))
        details {
            summary { "All methods" }
            (study.table())
        }
    };
    Ok(Record {
        conclusions: study.published().into_iter().collect(),
        requirements: study.requirements(),
        on_front: Some(fronts.map(|fronts| fronts.map(|front| front.is_some()))),
        ..Record::new(&name, inside)
    })
}

/// On which problems the default is on which front.
pub(super) fn fronts(records: &[Record]) -> Vec<String> {
    let whom = ["of all methods", "of the methods that take flat states"];
    let mut all = Vec::new();
    for (m, measure) in [POSITION, ENERGY].into_iter().enumerate() {
        for (k, whom) in whom.into_iter().enumerate() {
            let problems = records
                .iter()
                .filter_map(|r| Some((&*r.name, r.on_front?[m][k])));
            let (on, off): (Vec<_>, Vec<_>) = problems.partition(|(_, is_on)| *is_on);
            let names: Vec<&str> = off.iter().map(|(name, _)| *name).collect();
            let not = if off.is_empty() {
                String::new()
            } else {
                format!("; not on {}", names.join(", "))
            };
            let (n, name) = (on.len() + off.len(), measure.name);
            all.push(format!(
                "The default, {DEFAULT}, is on the front of {name} error {whom} on {} of {n} problems{not}.",
                on.len()
            ));
        }
    }
    all.retain(|_| records.iter().any(|r| r.on_front.is_some()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conclusions_name_the_problems_off_the_front() {
        let record = |name: &str, on_front| Record {
            on_front,
            ..Record::new(name, html! {})
        };
        let problems = ["a", "b"].map(|name| record(name, Some([[name == "a", true]; 2])));
        let all = fronts(&problems);
        assert_eq!(all.len(), 4);
        assert!(all[0].ends_with("of position error of all methods on 1 of 2 problems; not on b."));
        assert!(all[3].ends_with("that take flat states on 2 of 2 problems."));
        assert!(fronts(&[record("hanging", None)]).is_empty());
    }
}
