//! The page: conclusions first, then every part with its plot and tables.

use super::analysis::Measure;
use super::effort::StudyEffort;
use super::hanging::{self, Hanging};
use super::problem::Problem;
use super::scheme::DEFAULT;
use super::solvers::{self, SolverRow};
use super::study::Study;
use super::tablecloth::{self, Tablecloth};
use super::{Part, options, stamp, verdict};
use crate::figures::machine;
use crate::report::html::{STYLE, escape, inline_svg, table};
use crate::store::Store;
use anyhow::Result;
use std::fmt::Write;

/// Page of the repository on what other programs took for the same scenes.
const ELSEWHERE: &str = "docs/measured-elsewhere.md";

fn elsewhere() -> String {
    format!(
        "What other programs took for this scene was measured elsewhere, and not by this command: see {ELSEWHERE} in the repository."
    )
}

/// What has been made so far with one effort.
struct Results {
    studies: Vec<Study>,
    hanging: Option<Vec<Hanging>>,
    tablecloth: Option<Vec<Tablecloth>>,
    solvers: Option<Vec<SolverRow>>,
}

/// Writes the page from all parts that were made with this effort.
pub(crate) fn write(store: &Store, effort: StudyEffort) -> Result<()> {
    let results = read(store, effort)?;
    let mut pictures = |name: &str| -> Result<String> {
        let bytes = store.read(&format!("plots/{name}.svg"))?;
        Ok(inline_svg(&String::from_utf8_lossy(&bytes)))
    };
    let page = page(&results, effort, &mut pictures)?;
    store.write("index.html", page.as_bytes())?;
    Ok(())
}

fn read(store: &Store, effort: StudyEffort) -> Result<Results> {
    let facts = |part| {
        stamp(store, part)
            .filter(|s| s.options == options(effort))
            .map(|s| s.facts)
    };
    let mut studies = Vec::new();
    for problem in Problem::ALL {
        if let Some(facts) = facts(Part::Problem(problem)) {
            studies.push(serde_json::from_value(facts)?);
        }
    }
    Ok(Results {
        studies,
        hanging: facts(Part::Hanging)
            .map(serde_json::from_value)
            .transpose()?,
        tablecloth: facts(Part::Tablecloth)
            .map(serde_json::from_value)
            .transpose()?,
        solvers: facts(Part::Solvers)
            .map(serde_json::from_value)
            .transpose()?,
    })
}

fn page(
    results: &Results,
    effort: StudyEffort,
    picture: &mut dyn FnMut(&str) -> Result<String>,
) -> Result<String> {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Speed against error</title>\
         <style>{STYLE}</style></head><body><h1>Speed against error</h1>"
    );
    paragraph(&mut out, &intro());
    if effort == StudyEffort::Quick {
        out.push_str(
            "<p class=\"note\">Made with <code>--quick</code>: the runs are far too short to conclude anything from them. They show \
             that the command works.</p>",
        );
    }
    out.push_str("<section><h2>Conclusions</h2>");
    list(&mut out, &conclusions(results));
    out.push_str("</section>");
    for study in &results.studies {
        problem(&mut out, study, picture)?;
    }
    if let Some(rows) = &results.hanging {
        out.push_str("<section id=\"hanging\"><h2>The hanging sheet</h2>");
        paragraph(&mut out, hanging::ABOUT);
        list(&mut out, &hanging::conclusions(rows));
        table(&mut out, &hanging::table(rows));
        paragraph(&mut out, &elsewhere());
        out.push_str("</section>");
    }
    if let Some(rows) = &results.tablecloth {
        out.push_str("<section id=\"tablecloth\"><h2>The tablecloth</h2>");
        paragraph(&mut out, tablecloth::ABOUT);
        table(&mut out, &tablecloth::table(rows));
        paragraph(&mut out, &elsewhere());
        out.push_str("</section>");
    }
    if let Some(rows) = &results.solvers {
        out.push_str("<section id=\"solvers\"><h2>Linear solvers</h2>");
        paragraph(&mut out, solvers::ABOUT);
        let _ = write!(out, "<figure>{}</figure>", picture("solvers")?);
        list(&mut out, &solvers::conclusions(rows));
        table(&mut out, &solvers::table(rows));
        out.push_str("</section>");
    }
    out.push_str("</body></html>\n");
    Ok(out)
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

fn problem(
    out: &mut String,
    study: &Study,
    picture: &mut dyn FnMut(&str) -> Result<String>,
) -> Result<()> {
    let _ = write!(
        out,
        "<section id=\"{0}\"><h2>{1}</h2>",
        study.problem,
        escape(&study.problem.title())
    );
    paragraph(out, &study.problem.about());
    paragraph(out, &study.reference_words());
    let _ = write!(
        out,
        "<figure>{}</figure>",
        picture(&study.problem.to_string())?
    );
    list(out, &study.conclusions());
    out.push_str("<details><summary>All methods</summary>");
    table(out, &study.table());
    table(out, &study.solver_table());
    out.push_str("</details></section>\n");
    Ok(())
}

fn paragraph(out: &mut String, text: &str) {
    let _ = write!(out, "<p>{}</p>", escape(text));
}

fn list(out: &mut String, items: &[String]) {
    out.push_str("<ul>");
    for item in items {
        let _ = write!(out, "<li>{}</li>", escape(item));
    }
    out.push_str("</ul>");
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
