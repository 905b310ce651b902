//! `scale`: what steps and whole runs cost as the mesh is refined.

mod charts;
mod drape;
mod findings;
mod page;
mod required;
mod steps;
mod tables;
mod timed;
mod whole;
mod whole_report;

use crate::draw::Vector;
use crate::progress::Progress;
use crate::report::{FullOptions, Part, demand, excerpt};
use crate::store::Store;
use crate::timing::{Measured, Work};
use anyhow::Result;
use clap::Args;
use serde::Serialize;
use serde::de::DeserializeOwned;
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
    let results = measured(&Extent::of(args), &store)?;
    let whole: Vec<&Measured> = results.whole.iter().collect();
    for (name, table) in [
        ("scale.csv", tables::hanging(&results.hanging)),
        ("draping.csv", tables::draping(&results.draping)),
        ("runs.csv", whole_report::table(&whole)),
    ] {
        table.write_to(&store.path(name))?;
    }
    let plot = charts::charts(&results);
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
    let required = required::required(&results);
    page::page(&results, &required).write(&store, "scale.html")?;
    demand(&required)
}

/// Single steps first, coarse to fine, so that the peak of the memory is that of the level; then whole runs.
/// Those of a mesh are kept as soon as they are measured.
fn measured(extent: &Extent, store: &Store) -> Result<Results> {
    let mut results = Results {
        hanging: Vec::new(),
        draping: Vec::new(),
        whole: Vec::new(),
        limit: extent.limit,
    };
    for level in extent.steps.clone() {
        let title = format!("hanging sheet M^{level}");
        let hanging = kept(store, title, || steps::measure(level, STEPS))?;
        results.hanging.push(hanging);
        let title = format!("draping sheet M^{level}");
        results.draping.push(kept(store, title, || draping(level))?);
    }
    for level in extent.runs.clone() {
        for scene in SCENES {
            let title = format!("whole runs of M^{level}, {}", whole::name(scene));
            let measure = || whole::measure(scene, level, extent.limit);
            results.whole.extend(kept(store, title, measure)?);
        }
    }
    Ok(results)
}

/// What was measured before under a title, or is now.
fn kept<T: Serialize + DeserializeOwned>(
    store: &Store,
    title: String,
    measure: impl FnOnce() -> Result<T>,
) -> Result<T> {
    let name = title.replace(|c: char| !c.is_alphanumeric(), "-");
    let unit = store.unit(name, title);
    store.keep(&unit, |_| {
        let bar = Progress::start(&unit.title, 1);
        let found = measure()?;
        bar.finish("measured");
        Ok(found)
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Effort;
    use crate::store::Remake;
    use std::cell::Cell;

    #[test]
    fn what_was_measured_is_kept_unless_the_user_insists() {
        let folder = tempfile::tempdir().unwrap();
        let count = Cell::new(0);
        for (remake, measurements) in [(Remake::Never, 1), (Remake::Never, 1), (Remake::Once, 2)] {
            let store = Store::open(folder.path(), "scale", Effort::Quick, remake).unwrap();
            let measure = || {
                count.set(count.get() + 1);
                steps::measure(0, 1)
            };
            let row = kept(&store, "hanging sheet M^0".into(), measure).unwrap();
            assert_eq!((row.vertices, count.get()), (9, measurements));
        }
    }
}
