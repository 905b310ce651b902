//! The page: conclusions first, then every part with its plot and tables.

use super::analysis::Measure;
use super::scheme::DEFAULT;
use super::solvers::{self, SolverRow};
use super::study::Study;
use super::tablecloth::{self, Tablecloth};
use super::{hanging, verdict};
use crate::report::Effort;
use crate::report::{Page, drawing, list, machine};
use crate::store::{Store, StoreError};
use crate::timing::Measured;
use anyhow::Result;
use maud::{Markup, html};
use std::fmt::Write;

/// Page of the repository on what other programs took for the same scenes.
const ELSEWHERE: &str = "docs/measured-elsewhere.md";

fn elsewhere() -> Markup {
    html! {
        p {
            "What other programs took for this scene was measured elsewhere, and not by this command: see "
            (ELSEWHERE) " in the repository."
        }
    }
}

/// What has been made so far with one effort.
#[derive(Debug, Default)]
pub(super) struct Results {
    pub(super) studies: Vec<Study>,
    pub(super) hanging: Option<Vec<Measured>>,
    pub(super) tablecloth: Option<Vec<Tablecloth>>,
    pub(super) solvers: Option<Vec<SolverRow>>,
}

/// Writes the page.
pub(super) fn write(store: &Store, results: &Results, effort: Effort) -> Result<()> {
    let studies = results.studies.iter().map(|s| problem(store, s));
    let studies = studies.collect::<Result<Vec<Markup>, _>>()?;
    let solvers = match &results.solvers {
        Some(rows) => solver_study(store, rows)?,
        None => html! {},
    };
    let body = html! {
        p { (intro()) }
        @if effort == Effort::Quick {
            p.note {
                "Made with " code { "--quick" } ": the runs are far too short to conclude anything from them. They show "
                "that the command works."
            }
        }
        section { h2 { "Conclusions" } (list(&conclusions(results))) }
        @for study in &studies { (study) }
        @if let Some(rows) = &results.hanging {
            section #hanging {
                h2 { "The hanging sheet" }
                p { (hanging::ABOUT) }
                (list(&hanging::conclusions(rows)))
                (hanging::table(rows))
                (elsewhere())
            }
        }
        @if let Some(rows) = &results.tablecloth {
            section #tablecloth {
                h2 { "The tablecloth" }
                p { (tablecloth::ABOUT) }
                (tablecloth::table(rows))
                (elsewhere())
            }
        }
        (solvers)
    };
    let page = Page::new("Speed against error", body);
    store.write("index.html", page.to_html().as_bytes())?;
    Ok(())
}

fn solver_study(store: &Store, rows: &[SolverRow]) -> Result<Markup, StoreError> {
    let plot = store.read("plots/solvers.svg")?;
    Ok(html! {
        section #solvers {
            h2 { "Linear solvers" }
            p { (solvers::ABOUT) }
            figure { (drawing(&plot)) }
            (list(&solvers::conclusions(rows)))
            (solvers::table(rows))
        }
    })
}

fn intro() -> String {
    format!(
        "Every method is run on every problem with ever finer steps. Times are wall seconds for a simulated second on one core, \
         set-up left out; short runs are repeated up to five times and the minimum is taken. Position errors are the largest distance of a vertex \
         from the reference at eight points of time, energy errors the largest change of T + V as part of the largest kinetic energy, strains \
         the largest relative edge length error. Differences in time below 10 % are noise. Whether a method is on the front is asked of position errors up to 0.05 m and energy errors up to \
         0.1: coarser runs are cheap, but no motion. Machine: {}.",
        machine()
    )
}

/// What the whole report says.
fn conclusions(results: &Results) -> Vec<String> {
    let mut all = Vec::new();
    for (measure, k, whom) in [
        (Measure::Position, 0, "of all methods"),
        (Measure::Position, 1, "of the methods that take flat states"),
        (Measure::Energy, 0, "of all methods"),
        (Measure::Energy, 1, "of the methods that take flat states"),
    ] {
        let (on, off): (Vec<&Study>, Vec<&Study>) = results
            .studies
            .iter()
            .partition(|s| s.default_on_front(measure)[k].is_some());
        if on.is_empty() && off.is_empty() {
            continue;
        }
        let names = |studies: &[&Study]| {
            let names: Vec<String> = studies.iter().map(|s| s.problem.to_string()).collect();
            names.join(", ")
        };
        let mut text = format!(
            "The default, {DEFAULT}, is on the front of {} error {whom} on {} of {} problems",
            measure.name(),
            on.len(),
            on.len() + off.len()
        );
        if !off.is_empty() {
            let _ = write!(text, "; not on {}", names(&off));
        }
        text.push('.');
        all.push(text);
    }
    all.extend(
        results
            .studies
            .iter()
            .filter(|s| verdict::concerns(s.problem))
            .map(verdict::words),
    );
    if let Some(rows) = &results.hanging {
        all.extend(hanging::comparisons(rows));
    }
    if let Some(rows) = &results.tablecloth {
        all.extend(tablecloth::conclusions(rows));
    }
    all
}

fn problem(store: &Store, study: &Study) -> Result<Markup, StoreError> {
    let plot = store.read(&format!("plots/{}.svg", study.problem))?;
    Ok(html! {
        section id=(study.problem) {
            h2 { (study.problem.title()) }
            p { (study.problem.about()) }
            p { (study.reference_words()) }
            figure { (drawing(&plot)) }
            (list(&study.conclusions()))
            details {
                summary { "All methods" }
                (study.table())
                (study.solver_table())
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_page_on_other_programs_exists() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let text = std::fs::read_to_string(root.join(ELSEWHERE)).expect("the page is there");
        assert!(text.contains("The hanging sheet") && text.contains("The tablecloth"));
    }
}
