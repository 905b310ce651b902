//! `scale`: what a step costs as the mesh is refined.

mod measure;
mod report;

use crate::cli::ScaleArgs;
use crate::progress::Progress;
use crate::store::Store;
use crate::{Outcome, interrupt};
use anyhow::Result;
use measure::measure;

pub(crate) use measure::{Row, factorisation_time};
pub(crate) use report::section;

/// Levels of a run that only shows that everything works.
const QUICK: std::ops::RangeInclusive<u32> = 1..=3;

/// Coarsest level of a full run.
const COARSEST: u32 = 3;

/// Runs the command.
pub(crate) fn run(args: &ScaleArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let levels = if args.quick {
        QUICK
    } else {
        COARSEST..=args.level
    };
    let Some(rows) = rows(levels)? else {
        return Ok(Outcome::Interrupted);
    };
    for (path, bytes) in section(&rows)?.files {
        store.write(&path, &bytes)?;
    }
    store.write("scale.html", report::page(&rows)?.as_bytes())?;
    print!("{}", report::text(&rows));
    for name in ["scale.csv", "scale.svg", "scale.html"] {
        println!("{}", store.root().join(name).display());
    }
    Ok(Outcome::Complete)
}

/// One row for each level, coarse to fine, so that the peak of the memory is that of the level; `None` when stopped.
pub(crate) fn rows(levels: impl Iterator<Item = u32>) -> Result<Option<Vec<Row>>> {
    let mut rows = Vec::new();
    for level in levels {
        if interrupt::requested() {
            return Ok(None);
        }
        let bar = Progress::start(format!("hanging sheet M^{level}"), 1);
        rows.push(measure(level, STEPS)?);
        bar.finish("measured");
    }
    Ok(Some(rows))
}

/// Steps that are timed, see [`measure::STEP`].
const STEPS: usize = 3;
