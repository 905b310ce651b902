//! `scale`: what steps and whole runs cost as the mesh is refined.

mod drape;
mod findings;
mod page;
mod plot;
mod steps;
mod tables;
mod timed;
mod whole;
mod whole_report;

use crate::interrupt;
use crate::progress::Progress;
use crate::report::{FullOptions, Part, excerpt};
use crate::timing::{Measured, Work};
use anyhow::Result;
use clap::Args;
use std::ops::RangeInclusive;
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
        let effort = args.options.effort();
        let (finest, limit) = effort.pick((2, 5.0), (3, 60.0), (5, 600.0));
        Self {
            steps: effort.quick_or(1..=3, 2..=args.level),
            runs: 1..=finest,
            limit,
        }
    }
}

/// Everything measured.
#[derive(Clone, Debug)]
struct Results {
    hanging: Vec<steps::Row>,
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
    level: u32,

    #[command(flatten)]
    options: FullOptions,
}

/// What the picture shows, for those who do not see it.
const PICTURE: &str = "Time, memory and fill of a step against the number of vertices";

/// Runs the command.
pub(crate) fn run(args: &ScaleArgs) -> Result<()> {
    let store = args.options.open("scale")?;
    let results = measured(&Extent::of(args))?;
    let whole: Vec<&Measured> = results.whole.iter().collect();
    for (name, table) in [
        ("scale.csv", tables::hanging(&results.hanging)),
        ("draping.csv", tables::draping(&results.draping)),
        ("runs.csv", whole_report::table(&whole)),
    ] {
        table.write_to(&store.path(name))?;
    }
    let plot = plot::plot(&results);
    store.write("scale.svg", plot.to_svg(PICTURE).as_bytes())?;
    store.write("scale.png", &plot.to_png(PICTURE)?)?;
    let parts = [
        Part::table("steps", &tables::steps(&results.hanging)),
        Part::table("draping", &tables::draping(&results.draping)),
        Part::list(
            "runs",
            &SCENES
                .map(|s| whole_report::findings(&results.whole_of(s)))
                .concat(),
        ),
    ];
    excerpt::write(&store, "scale", &parts)?;
    print!("{}", page::text(&results));
    page::page(&results).write(&store, "scale.html")
}

/// Single steps first, coarse to fine, so that the peak of the memory is that of the level; then whole runs.
fn measured(extent: &Extent) -> Result<Results> {
    let mut results = Results {
        hanging: Vec::new(),
        draping: Vec::new(),
        whole: Vec::new(),
        limit: extent.limit,
    };
    for level in extent.steps.clone() {
        interrupt::check()?;
        let bar = Progress::start(format!("M^{level}"), 2);
        results.hanging.push(steps::measure(level, STEPS)?);
        bar.step();
        results.draping.push(draping(level)?);
        bar.finish("hanging and draping measured");
    }
    for level in extent.runs.clone() {
        let bar = Progress::start(format!("whole runs of M^{level}"), SCENES.len());
        for scene in SCENES {
            interrupt::check()?;
            results
                .whole
                .extend(whole::measure(scene, level, extent.limit)?);
            bar.step();
        }
        bar.finish("measured");
    }
    Ok(results)
}

/// The fastest of some runs, or of one where that takes long.
fn draping(level: u32) -> Result<drape::DrapeRow> {
    let mut best = drape::measure(level, STEPS, PATIENCE)?;
    for _ in 1..REPETITIONS {
        if best.course.cost.wall > LONG {
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

/// Steps that are timed, see [`steps::STEP`].
const STEPS: usize = 3;

/// Longest time for the steps of a draping sheet, seconds.
const PATIENCE: f64 = 120.0;
