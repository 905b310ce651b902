//! The report: DIR/index.html and DIR/summary.json, from the stamps of all figures made so far.

pub(crate) mod html;

use crate::figures::{Record, RenderEffort};
use crate::reproduce::unit;
use crate::selection::Selection;
use crate::store::{Extent, Store};
use anyhow::Result;
use serde_json::json;

/// Writes the report anew.
pub(crate) fn write(store: &Store, effort: RenderEffort) -> Result<()> {
    let mut records = Vec::new();
    for figure in Selection::all().iter() {
        let Some(stamp) = store
            .stamp(&unit(figure))
            .filter(|s| s.extent == Extent::Complete)
        else {
            continue;
        };
        let record: Record = serde_json::from_value(stamp.facts)?;
        let quick = stamp.options["effort"] == serde_json::to_value(RenderEffort::Quick)?;
        records.push((
            record,
            if quick {
                RenderEffort::Quick
            } else {
                RenderEffort::Full
            },
        ));
    }
    let page = html::page(&records, &mut |path| store.read(path))?;
    store.write("index.html", page.as_bytes())?;
    let figures: Vec<_> = records
        .iter()
        .map(|(r, effort)| {
            json!({
                "figure": r.figure, "title": r.title, "effort": effort, "paper": r.paper, "measured": r.measured,
                "pictures": r.pictures.iter().map(|p| &p.path).collect::<Vec<_>>(),
                "pages": r.pages.iter().map(|p| &p.path).collect::<Vec<_>>(), "facts": r.facts,
            })
        })
        .collect();
    store.write_json(
        "summary.json",
        &json!({ "version": env!("CARGO_PKG_VERSION"), "effort": effort, "figures": figures }),
    )?;
    Ok(())
}
