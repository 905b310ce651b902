//! Whole runs at the sizes that people use, from the scene to its end.

mod kinds;
mod report;
mod run;

pub(super) use kinds::Work;

use super::Record;
use crate::progress;
use crate::report::{Part as Excerpt, plot};
use crate::store::{Store, Unit};
use anyhow::Result;
use kinds::WORKS;
use maud::html;
use run::{Extent, Row};

/// The name of the part.
const NAME: &str = "works";

const ABOUT: &str = "\
    Scenes are files of xtask/scenes (or of isosheet new), with the edits of the last column: isosheet \
    simulate runs each of them. Every run starts with other small random displacements; times and \
    factorisations are medians over the starts, strains and gaps the worst. The strain is the error of \
    rods; of the faces of an elastic sheet it is no error but part of the motion. Times are CPU seconds \
    of all threads of a run, set-up left out; wall seconds stand beside them. A run that does not end in \
    its time is marked with the simulated time that it reached, and no power is fitted to it. The motion \
    of rods without bending stiffness on fine meshes is chaotic down to single edges: neighbouring \
    starts differ in cost by a third and more.";

/// All works with their names.
pub(super) fn named() -> Vec<(&'static str, &'static Work)> {
    WORKS.iter().map(|work| (work.name, work)).collect()
}

/// A row of the table: a work at a size on some threads.
struct Task {
    work: &'static Work,
    size: u32,
    threads: usize,
    unit: Unit,
}

/// The rows of a work. Its scene is part of the options, so that an edited scene runs anew.
fn tasks(store: &Store, work: &'static Work) -> Result<Vec<Task>> {
    let mut tasks = Vec::new();
    for &size in work.sizes(store.effort) {
        let Some(scene) = work.scene(size, 1)? else {
            continue;
        };
        for &threads in work.threads {
            let title = work.row_name(size, threads);
            let name = title.replace(|c: char| !c.is_alphanumeric(), "-");
            let mut unit = store.unit(format!("work-{name}"), title);
            unit.options["scene"] = scene.options();
            tasks.push(Task {
                work,
                size,
                threads,
                unit,
            });
        }
    }
    Ok(tasks)
}

/// Runs some works and keeps their rows.
pub(super) fn measure(store: &Store, works: &[&'static Work]) -> Result<()> {
    let extent = Extent::of(store.effort);
    for &work in works {
        let tasks = tasks(store, work)?;
        if tasks.is_empty() {
            progress::note(
                work.name,
                "skipped: ISOSHEET_DATA names no folder with its mesh",
            );
        }
        for task in tasks {
            store.keep(&task.unit, |_| {
                run::measure(task.work, task.size, task.threads, extent)
            })?;
        }
    }
    Ok(())
}

/// The part of the works that have been run, with its files; `None` if there is none. The titles of those
/// that another build ran are added to `left_out`.
pub(super) fn record(store: &Store, left_out: &mut Vec<String>) -> Result<Option<Record>> {
    let mut rows: Vec<Row> = Vec::new();
    for work in WORKS {
        let units = tasks(store, work)?.into_iter().map(|task| task.unit);
        let kept = store.all_kept(units.collect());
        left_out.extend(kept.left_out);
        rows.extend(kept.records);
    }
    if rows.is_empty() {
        return Ok(None);
    }
    let table = report::table(&rows).named(NAME);
    table.write_to(&store.path("tables/works.csv"))?;
    let [powers, threads] = [report::powers(&rows), report::threads(&rows)];
    let alt = "CPU seconds for a simulated second against the number of vertices, by kind of run";
    let figure = plot(&mut store.files(), NAME, &report::chart(&rows)?, alt)?;
    let inside = html! {
        h2 { "Whole runs" }
        p { (ABOUT) }
        (figure)
        (powers)
        (threads)
        (table.select(&table.caption, report::SHOWN))
    };
    Ok(Some(Record {
        excerpt: vec![
            Excerpt::table(NAME, &table.select(&table.caption, report::IN_THE_BOOK)),
            Excerpt::table("works-powers", &powers),
            Excerpt::table("works-threads", &threads),
        ],
        findings: report::required(&rows),
        ..Record::new(NAME, inside)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Effort, Finding, Verdict};
    use crate::store::Remake;

    #[test]
    fn rows_are_kept_and_make_a_part() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), "cost", Effort::Quick, Remake::Never).unwrap();
        assert!(record(&store, &mut Vec::new()).unwrap().is_none());
        let works = named();
        let chosen = works
            .iter()
            .filter(|(name, _)| ["w1", "w2e"].contains(name));
        let chosen: Vec<&'static Work> = chosen.map(|(_, work)| *work).collect();
        assert_eq!(chosen.len(), 2);
        measure(&store, &chosen).unwrap();
        let made = record(&store, &mut Vec::new()).unwrap().expect("rows");
        let passed = |f: &Finding| f.verdict() == Verdict::Passed;
        assert!(made.findings.iter().all(passed), "{made:?}");
        let csv = std::fs::read_to_string(store.path("tables/works.csv")).unwrap();
        assert!(
            csv.contains("w1,") && csv.contains("w2e,") && !csv.contains("NaN"),
            "{csv}"
        );
        assert!(store.path("plots/works.svg").is_file());
    }

    #[test]
    fn every_work_makes_a_simulation_at_its_smallest_size() {
        for (name, work) in named() {
            for effort in [Effort::Quick, Effort::Standard, Effort::Full] {
                assert!(!work.sizes(effort).is_empty(), "{name}");
            }
            let size = work.sizes(Effort::Quick)[0];
            let Some(scene) = work.scene(size, 2).unwrap() else {
                continue;
            };
            let setup = scene.setup().unwrap();
            assert!(setup.start().is_ok(), "{name}");
            let other = work.scene(size, 3).unwrap().unwrap().setup().unwrap();
            let scene = work.scene(size, 2).unwrap().unwrap().setup().unwrap();
            assert_ne!(other.start.x, scene.start.x, "{name}: another start");
        }
    }
}
