//! The page: every yardstick with its figure and tables.

use super::effort::LockingEffort;
use super::findings::Findings;
use super::targets::{self, Target};
use super::{Part, findings};
use crate::figures::machine;
use crate::report::html::{STYLE, escape, inline_svg, table};
use crate::store::Store;
use anyhow::Result;
use std::fmt::Write;

/// Writes the page from all parts that were made with this effort.
pub(super) fn write(store: &Store, effort: LockingEffort) -> Result<()> {
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Yardsticks of locking</title>\
         <style>{STYLE}</style></head><body><h1>Yardsticks of locking</h1>"
    );
    paragraph(&mut out, INTRODUCTION);
    paragraph(
        &mut out,
        &format!(
            "SI units, z upwards. Times are wall times of runs on one core each, with other runs beside. Machine: {}.",
            machine()
        ),
    );
    if effort == LockingEffort::Quick {
        out.push_str(
            "<p class=\"note\">Made with <code>--quick</code>: few sheets on coarse meshes. They show that the command works, and no \
             result.</p>",
        );
    }
    let made = |part: Part| Some((part.to_string(), part, findings(store, part, effort)?));
    let made: Vec<(String, Part, Findings)> = Part::ALL.into_iter().filter_map(made).collect();
    let named = |(name, _, found): &'_ (String, Part, Findings)| {
        found
            .targets
            .iter()
            .map(|t| (name.clone(), t.clone()))
            .collect::<Vec<_>>()
    };
    let targets: Vec<(String, Target)> = made.iter().flat_map(named).collect();
    summary(&mut out, store, &targets)?;
    for (_, part, found) in &made {
        section(&mut out, store, *part, found)?;
    }
    out.push_str("</body></html>\n");
    store.write("index.html", out.as_bytes())?;
    Ok(())
}

const INTRODUCTION: &str = "A triangle mesh whose edges are rigid rods has only B − 3 ways to deform (B: edges on the boundary) and folds only \
    along mesh lines. It is too stiff, or cannot move at all, where a smooth inextensible sheet bends in another direction: it locks. The \
    yardsticks measure by how much, and what other models of isometry do: an elastic sheet with the membrane stiffness of office paper, 3e5 N/m; one with the \
    stiffness 100 D / h² that leaves bends free (D: flexural rigidity; h²: twice the mean area of a triangle); and isometry in weak form, two equations for each vertex that \
    keep lengths in the mean over the triangles around it, with a membrane of the stiffness 100 D / h² for what the equations leave free. Where a scene has no bending stiffness, the last two have the membrane \
    of D = 5e-4 N m.";

/// What was measured against what is required: the first table of the page, `tables/targets.csv` and
/// `targets.json`.
fn summary(out: &mut String, store: &Store, targets: &[(String, Target)]) -> Result<()> {
    let named = targets.iter().map(|(name, t)| (name.as_str(), t));
    let results = targets::table(named);
    out.push_str("<section id=\"targets\"><h2>Measured against target</h2>");
    table(out, &results.table());
    out.push_str("</section>\n");
    store.write("tables/targets.csv", results.csv().as_bytes())?;
    store.write_json("targets.json", &targets)?;
    Ok(())
}

fn section(out: &mut String, store: &Store, part: Part, found: &Findings) -> Result<()> {
    let _ = write!(
        out,
        "<section id=\"{part}\"><h2>{}</h2>",
        escape(part.title())
    );
    paragraph(out, part.about());
    if let Ok(svg) = store.read(&format!("plots/{part}.svg")) {
        let svg = String::from_utf8_lossy(&svg);
        let _ = write!(out, "<figure>{}</figure>", inline_svg(&svg));
    }
    if !found.remarks.is_empty() {
        out.push_str("<ul>");
        for remark in &found.remarks {
            let _ = write!(out, "<li>{}</li>", escape(remark));
        }
        out.push_str("</ul>");
    }
    for results in &found.tables {
        table(out, &results.table());
    }
    out.push_str("</section>\n");
    Ok(())
}

fn paragraph(out: &mut String, text: &str) {
    // Writing to a string cannot fail.
    let _ = write!(out, "<p>{}</p>", escape(text));
}
