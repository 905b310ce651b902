//! The page: every yardstick with its figure and tables.

use super::effort::LockingEffort;
use super::findings::Findings;
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
            "SI units, z upwards. Times are wall times on one core. Machine: {}.",
            machine()
        ),
    );
    if effort == LockingEffort::Quick {
        out.push_str(
            "<p class=\"note\">Made with <code>--quick</code>: few sheets on coarse meshes. They show that the command works, and no \
             result.</p>",
        );
    }
    for part in Part::ALL {
        if let Some(found) = findings(store, part, effort) {
            section(&mut out, store, part, &found)?;
        }
    }
    out.push_str("</body></html>\n");
    store.write("index.html", out.as_bytes())?;
    Ok(())
}

const INTRODUCTION: &str = "A triangle mesh whose edges are rigid rods has only B − 3 ways to deform (B: edges on the boundary) and folds only \
    along mesh lines. It is too stiff, or cannot move at all, where a smooth inextensible sheet bends in another direction: it locks. The \
    yardsticks measure by how much. The column “model” names the model of isometry.";

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
