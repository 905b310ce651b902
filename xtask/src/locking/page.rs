//! The page: every yardstick with its figure and tables.

use super::targets::{self, Target};
use super::{Findings, Yardstick};
use crate::report::{Effort, Page, drawing, list, machine};
use crate::store::Store;
use anyhow::Result;
use maud::{Markup, html};

/// A yardstick that was applied.
pub(super) struct Section {
    pub(super) yardstick: &'static Yardstick,
    pub(super) found: Findings,
}

/// Writes the page, `tables/targets.csv` and `targets.json`.
pub(super) fn write(store: &Store, sections: &[Section], effort: Effort) -> Result<()> {
    let named = |s: &'_ Section| {
        let of = s
            .found
            .targets
            .iter()
            .map(|t| (s.yardstick.name, t.clone()));
        of.collect::<Vec<_>>()
    };
    let targets: Vec<(&str, Target)> = sections.iter().flat_map(named).collect();
    let summary = targets::table(targets.iter().map(|(name, t)| (*name, t)));
    store.write("tables/targets.csv", &summary.csv()?)?;
    store.write_json("targets.json", &targets)?;
    let body = html! {
        p { (INTRODUCTION) }
        p {
            "SI units, z upwards. Times are wall times of runs on one core each, with other runs beside. Machine: "
            (machine()) "."
        }
        @if effort == Effort::Quick {
            p.note {
                "Made with " code { "--quick" } ": few sheets on coarse meshes. They show that the command works, and no "
                "result."
            }
        }
        section #targets { h2 { "Measured against target" } (summary) }
        @for s in sections { (section(store, s)) }
    };
    let page = Page::new("Yardsticks of locking", body);
    store.write("index.html", page.to_html().as_bytes())?;
    Ok(())
}

const INTRODUCTION: &str = "A triangle mesh whose edges are rigid rods has only B − 3 ways to deform (B: edges on the boundary) and folds only \
    along mesh lines. It is too stiff, or cannot move at all, where a smooth inextensible sheet bends in another direction: it locks. The \
    yardsticks measure by how much, and what other models of isometry do: an elastic sheet with the membrane stiffness of office paper, 3e5 N/m; one with the \
    stiffness 100 D / h² that leaves bends free (D: flexural rigidity; h²: twice the mean area of a triangle); and isometry in weak form, two equations for each vertex that \
    keep lengths in the mean over the triangles around it, with a membrane of the stiffness 100 D / h² for what the equations leave free. Where a scene has no bending stiffness, the last two have the membrane \
    of D = 5e-4 N m.";

fn section(store: &Store, s: &Section) -> Markup {
    let Yardstick {
        name, title, about, ..
    } = s.yardstick;
    html! {
        section id=(name) {
            h2 { (title) }
            p { (about) }
            @if let Ok(svg) = store.read(&format!("plots/{name}.svg")) { figure { (drawing(&svg)) } }
            (list(&s.found.remarks))
            @for table in &s.found.tables { (table) }
        }
    }
}
