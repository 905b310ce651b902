//! `reproduce-figures`: makes what is asked for and not up to date, then writes the report.

use crate::cli::ReproduceArgs;
use crate::figures::{self, Context, Made, PageRef, PictureRef, Record, RenderEffort};
use crate::interrupt::Interrupted;
use crate::progress;
use crate::store::{Extent, Store};
use crate::{Outcome, interrupt, report};
use anyhow::{Result, bail};
use serde_json::json;
use std::time::Instant;

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let effort = if args.quick {
        RenderEffort::Quick
    } else {
        RenderEffort::Full
    };
    claim(&store, effort)?;
    let context = Context {
        store: &store,
        effort,
    };
    if args.force && args.figures.iter().any(|f| f >= 10) {
        store.forget("run-")?;
    }
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
        let started = Instant::now();
        match figures::make(figure, &context) {
            Ok(made) => keep(&store, figure, &options, made)?,
            Err(error) if error.is::<Interrupted>() => {
                outcome = Outcome::Interrupted;
                break;
            }
            Err(error) => return Err(error.context(format!("figure {figure}"))),
        }
        progress::note(
            &format!("figure {figure}"),
            &format!("made ({:.1} s)", started.elapsed().as_secs_f64()),
        );
    }
    report::write(&store, effort)?;
    progress::note(
        "report",
        &store.root().join("index.html").display().to_string(),
    );
    Ok(outcome)
}

/// Where the folder keeps the effort that its results were made with.
const EFFORT: &str = ".stamps/effort.json";

/// Keeps quick and full results apart, which share the names of figures and runs: full results are not
/// replaced by quick ones, and quick ones are removed before the first full one is made.
fn claim(store: &Store, effort: RenderEffort) -> Result<()> {
    let recorded = store.read(EFFORT).ok();
    let recorded = recorded.and_then(|text| serde_json::from_slice::<RenderEffort>(&text).ok());
    match (recorded, effort) {
        (Some(RenderEffort::Full), RenderEffort::Quick) => bail!(
            "{} is for results without --quick, which are not mixed with quick ones; choose another folder with --out",
            store.root().display()
        ),
        (Some(RenderEffort::Quick), RenderEffort::Full) => {
            progress::note("quick results", "removed");
            store.clear()?;
        }
        _ => {}
    }
    if recorded != Some(effort) {
        store.write_json(EFFORT, &effort)?;
    }
    Ok(())
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
    let mut pages = Vec::new();
    for play in &made.pages {
        let thumbnail = format!("figures/{}", play.thumbnail_file);
        draft.write(&play.file, play.page.as_bytes())?;
        draft.write(&thumbnail, &play.thumbnail)?;
        pages.push(PageRef {
            path: play.file.clone(),
            thumbnail,
            choices: play.choices.to_owned(),
            label: play.label.clone(),
        });
    }
    let record = Record {
        figure,
        title: made.title.to_owned(),
        paper: made.paper.to_owned(),
        measured: made.measured,
        pictures,
        pages,
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
