//! Whole runs, from the scene to its end: scenes at the sizes that people use, and two scenes on which other
//! programs have been measured as well, by several methods.

mod kinds;
mod report;
mod run;

pub(super) use kinds::Work;

use crate::progress;
use crate::report::{Part, Record, Table, plot};
use crate::store::{Store, Unit};
use anyhow::Result;
use kinds::Stepped;
use maud::{Markup, html};
use run::WorkRow;
use serde::Deserialize;
use std::sync::LazyLock;

/// A table of some works, with its text on the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WorkPart {
    name: String,
    title: String,
    about: String,
    caption: String,
    /// The columns that the page and the book show.
    page: String,
    book: String,
    work: Vec<Work>,
}

/// The file of the works.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WorksFile {
    part: Vec<WorkPart>,
}

static CONTENTS: LazyLock<WorksFile> = LazyLock::new(|| {
    let contents = toml::from_str(include_str!("works/works.toml"));
    contents.unwrap_or_else(|error| panic!("works.toml: {error}"))
});

/// All works with their names.
pub(super) fn named() -> Vec<(&'static str, &'static Work)> {
    let works = CONTENTS.part.iter().flat_map(|part| &part.work);
    works.map(|work| (work.name.as_str(), work)).collect()
}

/// A row of the table: a work at a size on some threads, by a method where it has several.
struct Task {
    work: &'static Work,
    size: u32,
    threads: usize,
    method: Option<Stepped>,
    unit: Unit,
}

/// The rows of a work. A scene file is part of the options, so that an edited scene runs anew.
fn tasks(store: &Store, work: &'static Work) -> Result<Vec<Task>> {
    let mut tasks = Vec::new();
    for &size in work.sizes(store.effort) {
        let file = work.file(size, 1)?;
        for method in work.methods() {
            if file.is_none() && method.is_none() {
                continue;
            }
            for &threads in &work.threads {
                let size_name = work.size_name(size);
                let mut title = format!("{} {size_name}", work.name).trim_end().to_owned();
                if threads > 1 {
                    title += &format!(", {threads} threads");
                }
                if let Some(((name, _), step)) = &method {
                    title += &format!(", {name}, {:.1} ms", 1e3 * step);
                }
                let name = title.replace(|c: char| !c.is_alphanumeric(), "-");
                let mut unit = store.unit(format!("work-{name}"), title);
                unit.options["scene"] = file.as_ref().map(|scene| scene.options()).into();
                tasks.push(Task {
                    work,
                    size,
                    threads,
                    method: method.clone(),
                    unit,
                });
            }
        }
    }
    Ok(tasks)
}

/// Runs some works and keeps their rows.
pub(super) fn measure(store: &Store, works: &[&'static Work]) -> Result<()> {
    for &work in works {
        let tasks = tasks(store, work)?;
        if tasks.is_empty() {
            progress::note(
                &work.name,
                "skipped: ISOSHEET_DATA names no folder with its mesh",
            );
        }
        for task in tasks {
            store.keep(&task.unit, |_| run::measure(&task, store.effort))?;
        }
    }
    Ok(())
}

impl WorkPart {
    /// What the rows of the part make, with its files; `None` without a row.
    fn record(&self, store: &Store, rows: &[WorkRow]) -> Result<Option<Record>> {
        if rows.is_empty() {
            return Ok(None);
        }
        let table = report::table(&self.caption, rows.to_vec())?.named(&self.name);
        let mut files = store.files();
        table.write(&mut files)?;
        let shown = |columns: &str| table.select(&table.caption, columns);
        let mut excerpt = vec![Part::table(&self.name, &shown(&self.book))];
        let mut add = |name: &str, table: Table| {
            excerpt.push(Part::table(name, &table));
            table
        };
        let more: Markup = match self.name.as_str() {
            "works" => {
                let alt = "CPU seconds for a simulated second against the number of vertices, by kind of run";
                let figure = plot(&mut files, &self.name, &report::chart(rows), alt)?;
                let powers = add("works-powers", report::powers(rows));
                html! { (figure) (powers) }
            }
            "hanging" => {
                add("default", report::default(rows));
                html! {}
            }
            _ => html! {},
        };
        let inside = html! { h2 { (self.title) } p { (self.about) } (more) (shown(&self.page)) };
        Ok(Some(Record {
            excerpt,
            findings: report::required(rows),
            ..Record::new(&self.name, inside)
        }))
    }
}

/// The parts of the works that have been run, with their files. The titles of parts that another build ran
/// are added to `left_out`.
pub(super) fn records(store: &Store, left_out: &mut Vec<String>) -> Result<Vec<Record>> {
    let mut records = Vec::new();
    for part in &CONTENTS.part {
        let mut rows = Vec::new();
        for work in &part.work {
            let units = tasks(store, work)?.into_iter().map(|task| task.unit);
            let kept = store.all_kept(units.collect());
            left_out.extend(kept.left_out);
            rows.extend(kept.records);
        }
        records.extend(part.record(store, &rows)?);
    }
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Effort, Finding, Verdict};
    use crate::store::Remake;

    #[test]
    fn rows_are_kept_and_make_parts() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(folder.path(), "cost", Effort::Quick, Remake::Never).unwrap();
        assert!(records(&store, &mut Vec::new()).unwrap().is_empty());
        let chosen = named().into_iter().filter_map(|(name, work)| {
            let chosen = ["w1", "w2e", "tablecloth-itself"].contains(&name);
            chosen.then_some(work)
        });
        let chosen: Vec<&'static Work> = chosen.collect();
        assert_eq!(chosen.len(), 3);
        measure(&store, &chosen).unwrap();
        let made = records(&store, &mut Vec::new()).unwrap();
        assert_eq!(made.len(), 2, "works and the tablecloth");
        let passed = |f: &Finding| f.verdict() == Verdict::Passed;
        let all = made.iter().map(|record| &record.findings);
        assert!(all.clone().all(|all| all.iter().all(passed)), "{made:?}");
        assert_eq!(all.map(Vec::len).collect::<Vec<_>>(), [2, 1]);
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
            let method = work.methods().swap_remove(0);
            let [first, other] = [2, 3].map(|k| work.start(size, method.as_ref(), k).unwrap());
            if let (Some(first), Some(other)) = (first, other) {
                let [first, other] = [first, other].map(|s| s.simulation.state().x.clone());
                assert_eq!(first != other, method.is_none(), "{name}: another start");
            }
        }
    }
}
