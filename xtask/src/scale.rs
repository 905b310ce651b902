//! `scale`: what steps and whole runs cost as the mesh is refined.

mod drape;
mod findings;
mod measure;
mod plot;
mod report;
mod tables;
mod timed;
mod whole;
mod whole_report;

use crate::interrupt::{self, Outcome};
use crate::progress::Progress;
use crate::store::Store;
use crate::timing::{Measured, Work};
use anyhow::Result;
use clap::Args;
use measure::measure;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use whole::SCENES;

/// What is measured.
struct Extent {
    /// Meshes of the single steps.
    steps: RangeInclusive<u32>,
    /// Meshes of the whole runs.
    runs: RangeInclusive<u32>,
    /// Longest whole run, seconds of wall time.
    limit: f64,
}

impl Extent {
    fn of(args: &ScaleArgs) -> Self {
        if args.quick {
            // Shows that everything works.
            return Self {
                steps: 1..=3,
                runs: 1..=2,
                limit: 5.0,
            };
        }
        let (finest, limit) = if args.full { (5, 600.0) } else { (3, 60.0) };
        Self {
            steps: 2..=args.level,
            runs: 1..=finest,
            limit,
        }
    }
}

/// Everything measured.
#[derive(Clone, Debug)]
struct Results {
    hanging: Vec<measure::Row>,
    draping: Vec<drape::DrapeRow>,
    /// Whole runs, and the limit of wall time of each, seconds.
    whole: Vec<Measured>,
    limit: f64,
}

impl Results {
    /// The whole runs of a scene.
    fn whole_of(&self, scene: Work) -> Vec<&Measured> {
        self.whole.iter().filter(|r| r.work == scene).collect()
    }
}

/// Arguments of `scale`.
#[derive(Debug, Args)]
pub(crate) struct ScaleArgs {
    /// Finest mesh, M^LEVEL
    #[arg(long, value_name = "LEVEL", default_value_t = 7, value_parser = clap::value_parser!(u32).range(3..=8))]
    pub(crate) level: u32,

    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/scale")]
    pub(crate) out: PathBuf,

    /// Small meshes only: checks that everything works in seconds, and shows no result
    #[arg(long, conflicts_with = "full")]
    pub(crate) quick: bool,

    /// Whole runs up to M^5 instead of M^3, with ten minutes of wall time for each: about an hour
    #[arg(long)]
    pub(crate) full: bool,
}

/// Runs the command.
pub(crate) fn run(args: &ScaleArgs) -> Result<Outcome> {
    let store = Store::open(&args.out)?;
    let Some(results) = measured(&Extent::of(args))? else {
        return Ok(Outcome::Interrupted);
    };
    let mut names = Vec::new();
    for (name, bytes) in report::files(&results)? {
        store.write(name, &bytes)?;
        names.push(name);
    }
    store.write("scale.html", report::page(&results)?.to_html().as_bytes())?;
    print!("{}", report::text(&results));
    for name in names.into_iter().chain(["scale.html"]) {
        println!("{}", store.root().join(name).display());
    }
    Ok(Outcome::Complete)
}

/// Single steps first, coarse to fine, so that the peak of the memory is that of the level; then whole runs.
/// `None` when stopped.
fn measured(extent: &Extent) -> Result<Option<Results>> {
    let mut results = Results {
        hanging: Vec::new(),
        draping: Vec::new(),
        whole: Vec::new(),
        limit: extent.limit,
    };
    for level in extent.steps.clone() {
        if interrupt::requested() {
            return Ok(None);
        }
        let bar = Progress::start(format!("M^{level}"), 2);
        results.hanging.push(measure(level, STEPS)?);
        bar.step();
        results.draping.push(draping(level)?);
        bar.finish("hanging and draping measured");
    }
    for level in extent.runs.clone() {
        let bar = Progress::start(format!("whole runs of M^{level}"), SCENES.len());
        for scene in SCENES {
            if interrupt::requested() {
                return Ok(None);
            }
            results
                .whole
                .extend(whole::measure(scene, level, extent.limit)?);
            bar.step();
        }
        bar.finish("measured");
    }
    Ok(Some(results))
}

/// The fastest of some runs, or of one where that takes long.
fn draping(level: u32) -> Result<drape::DrapeRow> {
    let mut best = drape::measure(level, STEPS, PATIENCE)?;
    for _ in 1..REPETITIONS {
        if best.cost.wall > LONG {
            break;
        }
        let row = drape::measure(level, STEPS, PATIENCE)?;
        if row.step() < best.step() {
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
