//! `scale`: what a step costs as the mesh is refined.

mod drape;
mod measure;
mod plot;
mod report;
mod timed;

use crate::cli::ScaleArgs;
use crate::progress::Progress;
use crate::store::Store;
use crate::{Outcome, interrupt};
use anyhow::Result;
use measure::measure;

pub(crate) use drape::DrapeRow;
pub(crate) use measure::{Row, exponent, factorisation_time};

/// Levels of a run that only shows that everything works.
const QUICK: std::ops::RangeInclusive<u32> = 1..=3;

/// Coarsest level of a full run.
const COARSEST: u32 = 2;

/// Runs the command.
pub(crate) fn run(args: &ScaleArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let levels = if args.quick {
        QUICK
    } else {
        COARSEST..=args.level
    };
    let Some(results) = measured(levels)? else {
        return Ok(Outcome::Interrupted);
    };
    for (path, bytes) in report::files(&results)? {
        store.write(&path, &bytes)?;
    }
    store.write("scale.html", report::page(&results)?.as_bytes())?;
    print!("{}", report::text(&results));
    for name in [
        "scale.csv",
        "draping.csv",
        "scale.svg",
        "scale.png",
        "scale.html",
    ] {
        println!("{}", store.root().join(name).display());
    }
    Ok(Outcome::Complete)
}

/// Everything measured.
pub(crate) struct Results {
    pub(crate) hanging: Vec<Row>,
    pub(crate) draping: Vec<DrapeRow>,
}

/// One row of each kind for each level, coarse to fine, so that the peak of the memory is that of the level;
/// `None` when stopped.
fn measured(levels: impl Iterator<Item = u32>) -> Result<Option<Results>> {
    let mut results = Results {
        hanging: Vec::new(),
        draping: Vec::new(),
    };
    for level in levels {
        if interrupt::requested() {
            return Ok(None);
        }
        let bar = Progress::start(format!("M^{level}"), 2);
        results.hanging.push(measure(level, STEPS)?);
        bar.step();
        results.draping.push(draping(level)?);
        bar.finish("hanging and draping measured");
    }
    Ok(Some(results))
}

/// The fastest of some runs, or of one where that takes long.
fn draping(level: u32) -> Result<DrapeRow> {
    let mut best = drape::measure(level, STEPS, PATIENCE)?;
    for _ in 1..REPETITIONS {
        if best.per_step * best.steps as f64 > LONG {
            break;
        }
        let row = drape::measure(level, STEPS, PATIENCE)?;
        if row.per_step < best.per_step {
            best = row;
        }
    }
    Ok(best)
}

/// Runs of a draping sheet, and the time of one from which it is not repeated, seconds.
const REPETITIONS: usize = 5;
const LONG: f64 = 1.0;

/// Steps that are timed, see [`measure::STEP`].
const STEPS: usize = 3;

/// Longest time for the steps of a draping sheet, seconds.
const PATIENCE: f64 = 120.0;
