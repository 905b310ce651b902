//! Whole runs, from the scene to its end: scenes at the sizes that people use, and two scenes on which other
//! programs have been measured as well, by several methods.

mod kinds;
mod penetration;
mod report;
mod run;

pub(super) use kinds::Work;

use super::Record;
use crate::progress;
use crate::report::{Part as Excerpt, Table, plot};
use crate::store::{Store, Unit};
use anyhow::Result;
use kinds::{Stepped, WORKS};
use maud::{Markup, html};
use run::Row;

const ABOUT: &str = "\
    Scenes are files of xtask/scenes (or of isosheet new), with the edits of the last column: isosheet \
    simulate runs each of them. Every run starts with other small random displacements; times and \
    factorisations are medians over the starts, strains and gaps the worst. The strain is the error of \
    rods; of the faces of an elastic sheet it is no error but part of the motion. Times are CPU seconds \
    of all threads of a run, set-up left out; wall seconds stand beside them. A run that does not end in \
    its time is marked with the simulated time that it reached, and no power is fitted to it. The motion \
    of rods without bending stiffness on fine meshes is chaotic down to single edges: neighbouring \
    starts differ in cost by a third and more.";

const HANGING: &str = "\
    Square sheet, side 1 m, union-jack mesh M^k, mass 0.1 kg lumped by thirds of the incident areas, \
    horizontal with z = 1e-3 sin(πx) sin(πy), rest lengths those of the start, corner (0, 1) pinned, \
    gravity 9.8 m/s², no bending stiffness, no contact, no damping, 1.0 s.";

const TABLECLOTH: &str = "\
    The sheet of the hanging work, all vertices free, 1 mm above a square table of half its side (a \
    box), 1.5 s, without friction, by the methods that take contact with steps of 1/60 s; once without \
    and once with contact of the sheet with itself. That nothing penetrates is checked after every step \
    apart from the contact code: depth of every vertex in the box, and every edge against every face of \
    the box and, with self-contact, of the sheet. The energy of the barriers counts: where the sheet \
    starts within their reach they push it up at first.";

/// Page of the repository on what other programs took for the same scenes.
const ELSEWHERE: &str = "\
    What other programs took for this scene was measured elsewhere, and not by this command: see \
    docs/measured-elsewhere.md in the repository.";

/// A table of some works, with its text on the page.
struct Part {
    /// What the names of its works begin with; nothing for those that no other part has.
    name: &'static str,
    title: &'static str,
    about: &'static str,
    caption: &'static str,
    /// The columns that the page and the book show.
    shown: [&'static str; 2],
}

const CAPTION: &str = "CPU seconds for a simulated second, medians over the starts, and as multiples of those of the fastest run of the \
    scene and mesh that keeps lengths to 1e-9; largest relative edge length error, energy balance at the end as part of the \
    potential energy released (negative: lost), its largest change on the way";

const PARTS: [Part; 3] = [
    Part {
        name: "works",
        title: "Whole runs",
        about: ABOUT,
        caption: "Whole runs: medians over the starts of CPU and wall seconds and of factorisations a step; the most factorisations of a \
            start over the fewest; largest strain of an edge of rods or of a face of an elastic sheet, smallest gap",
        shown: [
            "work what_happens size vertices model threads starts simulated_s cpu_s wall_s factorisations_per_step \
             largest_over_smallest strain smallest_gap_m peak_bytes ended failure scene",
            "work what_happens vertices model threads starts simulated_s cpu_s factorisations_per_step strain smallest_gap_m \
             failure",
        ],
    },
    Part {
        name: "hanging",
        title: "The hanging sheet",
        about: HANGING,
        caption: CAPTION,
        shown: [
            "size method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance largest_energy_change \
             iterations_per_step factorisations_per_step steps rejected failure",
            "size vertices method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance failure",
        ],
    },
    Part {
        name: "tablecloth",
        title: "The tablecloth",
        about: TABLECLOTH,
        caption: CAPTION,
        shown: [
            "what_happens size method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance \
             largest_energy_change smallest_gap_m depth_m crossings iterations_per_step factorisations_per_step steps rejected \
             failure",
            "what_happens size vertices method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance \
             smallest_gap_m failure",
        ],
    },
];

/// All works with their names.
pub(super) fn named() -> Vec<(&'static str, &'static Work)> {
    WORKS.iter().map(|work| (work.name, work)).collect()
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
            for &threads in work.threads {
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
                work.name,
                "skipped: ISOSHEET_DATA names no folder with its mesh",
            );
        }
        for task in tasks {
            store.keep(&task.unit, |_| run::measure(&task, store.effort))?;
        }
    }
    Ok(())
}

impl Part {
    fn of(work: &Work) -> &'static Self {
        let mut others = PARTS[1..].iter();
        let found = others.find(|part| work.name.starts_with(part.name));
        found.unwrap_or(&PARTS[0])
    }

    /// What the rows of the part make, with its files; `None` without a row.
    fn record(&self, store: &Store, rows: &[Row]) -> Result<Option<Record>> {
        if rows.is_empty() {
            return Ok(None);
        }
        let table = report::table(self.caption, rows.to_vec())?.named(self.name);
        let mut files = store.files();
        table.write(&mut files)?;
        let [page, book] = self
            .shown
            .map(|columns| table.select(self.caption, columns));
        let mut excerpt = vec![Excerpt::table(self.name, &book)];
        let mut add = |name: &str, table: Table| {
            excerpt.push(Excerpt::table(name, &table));
            table
        };
        let more: Markup = match self.name {
            "works" => {
                let alt = "CPU seconds for a simulated second against the number of vertices, by kind of run";
                let figure = plot(&mut files, self.name, &report::chart(rows)?, alt)?;
                let powers = add("works-powers", report::powers(rows));
                let threads = add("works-threads", report::threads(rows));
                html! { (figure) (powers) (threads) }
            }
            "hanging" => {
                add("default", report::default(rows));
                html! { p { (ELSEWHERE) } }
            }
            _ => html! { p { (ELSEWHERE) } },
        };
        let inside = html! { h2 { (self.title) } p { (self.about) } (more) (page) };
        Ok(Some(Record {
            excerpt,
            findings: report::required(rows),
            ..Record::new(self.name, inside)
        }))
    }
}

/// The parts of the works that have been run, with their files. The titles of those that another build ran are
/// added to `left_out`.
pub(super) fn records(store: &Store, left_out: &mut Vec<String>) -> Result<Vec<Record>> {
    let mut records = Vec::new();
    for part in &PARTS {
        let mut rows = Vec::new();
        for work in WORKS.iter().filter(|work| Part::of(work).name == part.name) {
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
        assert_eq!(all.map(Vec::len).collect::<Vec<_>>(), [2, 3]);
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
