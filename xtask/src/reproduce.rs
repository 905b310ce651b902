//! `reproduce-figures`: makes what is asked for and not up to date, then writes the report.

use crate::cli::ReproduceArgs;
use crate::figures::{self, Effort, Made, PictureRef, Record};
use crate::progress::{self, Progress};
use crate::store::{Extent, Store};
use crate::{Outcome, interrupt, report};
use anyhow::{Context, Result};
use serde_json::json;

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let effort = if args.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let mut outcome = Outcome::Complete;
    for figure in args.figures.iter() {
        if interrupt::requested() {
            outcome = Outcome::Interrupted;
            break;
        }
        let unit = unit(figure);
        let options = json!({ "figure": figure, "effort": effort });
        if !args.force && store.current(&unit, &options).is_some() {
            progress::note(&format!("figure {figure}"), "up to date");
            continue;
        }
        let bar = Progress::start(format!("figure {figure}"), 1);
        let made = figures::draw(figure).with_context(|| format!("figure {figure}"))?;
        keep(&store, figure, &options, made)?;
        bar.finish("made");
    }
    report::write(&store, effort)?;
    progress::note(
        "report",
        &store.root().join("index.html").display().to_string(),
    );
    Ok(outcome)
}

/// Name of the unit of a figure.
pub(crate) fn unit(figure: u8) -> String {
    format!("fig{figure:02}")
}

/// Moves a figure into place.
fn keep(store: &Store, figure: u8, options: &serde_json::Value, made: Made) -> Result<()> {
    let mut draft = store.draft()?;
    let mut pictures = Vec::new();
    for picture in &made.pictures {
        let path = format!("figures/{}", picture.file);
        draft.write(&path, &picture.bytes)?;
        pictures.push(PictureRef {
            path,
            alt: picture.alt.clone(),
        });
    }
    let record = Record {
        figure,
        title: made.title.to_owned(),
        paper: made.paper.to_owned(),
        measured: made.measured,
        pictures,
        tables: made.tables,
        facts: made.facts,
    };
    store.commit(
        draft,
        &unit(figure),
        options,
        Extent::Complete,
        serde_json::to_value(record)?,
    )?;
    Ok(())
}
