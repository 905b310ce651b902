//! `speed-vs-error`: time against errors of every method on problems with known motion, on two works that
//! other programs have been measured on, and of the linear solvers.
//!
//! Every part is kept in the output folder with its section of the page and what it says, so that an
//! interrupted run continues where it stopped.

mod analysis;
mod barrier;
mod hanging;
mod matrices;
mod measure;
mod problem;
mod reference;
mod scheme;
mod solvers;
mod study;
mod tablecloth;
mod verdict;

use crate::interrupt;
use crate::report::{Effort, FullOptions, Page, Part as Excerpt, Requirement, Section, Table};
use crate::report::{demand, excerpt, list, machine, one_of, plot, requirements};
use crate::store::{Files, Kept, Store, Unit};
use crate::timing::SHOWN;
use analysis::{ENERGY, POSITION};
use anyhow::Result;
use clap::Args;
use maud::{Markup, html};
use problem::Problem;
use scheme::DEFAULT;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// A part of the report that can be made alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// Time against errors on a problem.
    Problem(Problem),
    /// The hanging sheet of other programs.
    Hanging,
    /// The tablecloth of other programs.
    Tablecloth,
    /// The linear solvers.
    Solvers,
}

impl Part {
    /// All parts with their names, in the order of the page.
    fn named() -> Vec<(&'static str, Self)> {
        let problems = Problem::ALL.map(|(problem, name)| (name, Self::Problem(problem)));
        let others = [
            ("hanging", Self::Hanging),
            ("tablecloth", Self::Tablecloth),
            ("solvers", Self::Solvers),
        ];
        problems.into_iter().chain(others).collect()
    }

    /// Whether an effort has time for it.
    fn is_for(self, effort: Effort) -> bool {
        let costly = [Problem::Strip(64), Problem::Sheet(2), Problem::Sheet(3)];
        effort != Effort::Quick || !costly.map(Self::Problem).contains(&self)
    }

    fn name(self) -> &'static str {
        let named = Self::named().into_iter().find(|(_, part)| *part == self);
        named.map_or("", |(name, _)| name)
    }
}

/// Arguments of `speed-vs-error`.
#[derive(Debug, Args)]
pub(crate) struct SpeedArgs {
    #[command(flatten)]
    options: FullOptions,

    /// What to measure, separated by commas; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(Part::named))]
    problems: Vec<Part>,

    /// Write the matrices of the solver study to this folder as Matrix Market files, and measure nothing
    #[arg(long, value_name = "DIR", conflicts_with = "problems")]
    matrices: Option<PathBuf>,
}

/// What is kept of a part.
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    name: String,
    section: Section,
    /// What it says among the conclusions of the whole report.
    conclusions: Vec<String>,
    /// Tables for the book.
    excerpt: Vec<Excerpt>,
    /// Of a problem: whether the default is on the fronts of position and energy error, of all methods and of
    /// those that take flat states.
    on_front: Option<[[bool; 2]; 2]>,
    requirements: Vec<Requirement>,
}

/// Runs the command.
pub(crate) fn run(args: &SpeedArgs) -> Result<()> {
    if let Some(folder) = &args.matrices {
        return matrices::write(folder, args.options.effort());
    }
    let store = args.options.open("speed-vs-error")?;
    let all = || Part::named().into_iter().map(|(_, part)| part);
    let mut parts = args.problems.clone();
    if parts.is_empty() {
        parts.extend(all().filter(|part| part.is_for(store.effort)));
    }
    let made = parts.into_iter().try_for_each(|part| {
        store.keep(&unit(&store, part), |files| make(part, store.effort, files))?;
        Ok(())
    });
    interrupt::afterwards(made, || {
        let units = all().map(|part| unit(&store, part));
        let Kept { records, left_out } = store.all_kept(units.collect());
        let mut parts = vec![Excerpt::list("fronts", &fronts(&records))];
        parts.extend(records.iter().flat_map(|r| r.excerpt.clone()));
        excerpt::write(&store, "speed-vs-error", &parts)?;
        let requirements = required(&records);
        table(&requirements).write_to(&store.path("tables/targets.csv"))?;
        let page = page(&records);
        Page { left_out, ..page }.write(&store, "index.html")?;
        demand(&requirements)
    })
}

fn unit(store: &Store, part: Part) -> Unit {
    store.unit(format!("speed-{}", part.name()), part.name())
}

/// Makes a part and writes its files.
fn make(part: Part, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let name = part.name();
    let mut keep = |table: &Table| table.clone().named(name).write(files);
    let (mut conclusions, mut on_front) = (Vec::new(), None);
    let (mut excerpt, mut requirements) = (Vec::new(), Vec::new());
    let inside = match part {
        Part::Problem(problem) => {
            let study = study::make(problem, effort)?;
            keep(&study.data())?;
            let alt = format!("{}: errors against wall time, by method", problem.title());
            let figure = plot(files, name, &study.plot(), &alt)?;
            if verdict::concerns(problem) {
                conclusions.push(verdict::words(&study));
            }
            requirements = study.requirements();
            let fronts = [POSITION, ENERGY].map(|m| study.default_on_front(m));
            on_front = Some(fronts.map(|fronts| fronts.map(|front| front.is_some())));
            html! {
                h2 { (problem.title()) }
                p { (problem.about()) }
                p { (study.reference_words()) }
                (figure)
                (list(&study.conclusions()))
                details {
                    summary { "All methods" }
                    (study.table())
                    (study.solver_table())
                }
            }
        }
        Part::Hanging => {
            let rows = hanging::make(effort)?;
            let table = hanging::table(&rows);
            keep(&table)?;
            conclusions = hanging::comparisons(&rows);
            excerpt.push(Excerpt::table(
                name,
                &table.select(&table.caption, IN_THE_BOOK),
            ));
            excerpt.push(Excerpt::table("default", &hanging::default(&rows)));
            html! {
                h2 { "The hanging sheet" }
                p { (hanging::ABOUT) }
                (list(&hanging::conclusions(&rows)))
                (table.select(&table.caption, SHOWN))
                (elsewhere())
            }
        }
        Part::Tablecloth => {
            let rows = tablecloth::make(effort)?;
            let table = tablecloth::table(&rows);
            keep(&table)?;
            conclusions = tablecloth::conclusions(&rows);
            let names = format!("contact {IN_THE_BOOK} smallest_gap_m");
            excerpt.push(Excerpt::table(name, &table.select(&table.caption, &names)));
            html! {
                h2 { "The tablecloth" }
                p { (tablecloth::ABOUT) }
                (table.select(&table.caption, &format!("{SHOWN} depth_m crossings")))
                (elsewhere())
            }
        }
        Part::Solvers => {
            let rows = solvers::make(effort)?;
            let table = solvers::table(&rows);
            keep(&table)?;
            let alt = "Time and backward error of the linear solvers against the number of degrees of freedom";
            let figure = plot(files, name, &solvers::plot(&rows), alt)?;
            html! {
                h2 { "Linear solvers" }
                p { (solvers::ABOUT) }
                (figure)
                (list(&solvers::conclusions(&rows)))
                (table)
            }
        }
    };
    Ok(Record {
        name: name.to_owned(),
        section: html! { section id=(name) { (inside) } }.into(),
        conclusions,
        excerpt,
        on_front,
        requirements,
    })
}

/// The columns of runs that the book shows.
const IN_THE_BOOK: &str = "mesh vertices method step_s wall_s_per_simulated_s times_fastest_exact strain energy_balance \
    failure";
/// The requirements of all parts.
fn required(records: &[Record]) -> Vec<(String, Requirement)> {
    let of = |r: &Record| {
        let named = r.requirements.iter().map(|q| (r.name.clone(), q.clone()));
        named.collect::<Vec<_>>()
    };
    records.iter().flat_map(of).collect()
}

fn table(all: &[(String, Requirement)]) -> Table {
    requirements(
        "Orders and lengths against what the documentation says",
        all,
    )
}

/// Page of the repository on what other programs took for the same scenes.
const ELSEWHERE: &str = "docs/measured-elsewhere.md";

fn elsewhere() -> Markup {
    html! {
        p {
            "What other programs took for this scene was measured elsewhere, and not by this command: see "
            (ELSEWHERE) " in the repository."
        }
    }
}

const INTRODUCTION: &str = "Every method is run on every problem with ever finer steps. Times are wall seconds for a simulated second on one core, \
    set-up left out; short runs are repeated up to five times and the minimum is taken. Position errors are the largest distance of a vertex \
    from the reference at eight points of time, energy errors the largest change of T + V as part of the largest kinetic energy, strains \
    the largest relative edge length error. Differences in time below 10 % are noise. Whether a method is on the front is asked of position errors up to 0.05 m and energy errors up to \
    0.1: coarser runs are cheap, but no motion.";

/// The page: conclusions first, then every part.
fn page(records: &[Record]) -> Page {
    let mut conclusions = fronts(records);
    conclusions.extend(records.iter().flat_map(|r| r.conclusions.clone()));
    let body = html! {
        p { (INTRODUCTION) " Machine: " (machine()) "." }
        section { h2 { "Conclusions" } (list(&conclusions)) (table(&required(records))) }
        @for record in records { (record.section) }
    };
    Page::new("Speed against error", body)
}

/// On which problems the default is on which front.
fn fronts(records: &[Record]) -> Vec<String> {
    let whom = ["of all methods", "of the methods that take flat states"];
    let mut all = Vec::new();
    for (m, measure) in [POSITION, ENERGY].into_iter().enumerate() {
        for (k, whom) in whom.into_iter().enumerate() {
            let problems = records
                .iter()
                .filter_map(|r| Some((&*r.name, r.on_front?[m][k])));
            let (on, off): (Vec<_>, Vec<_>) = problems.partition(|(_, is_on)| *is_on);
            let names: Vec<&str> = off.iter().map(|(name, _)| *name).collect();
            let not = if off.is_empty() {
                String::new()
            } else {
                format!("; not on {}", names.join(", "))
            };
            let (n, name) = (on.len() + off.len(), measure.name);
            all.push(format!(
                "The default, {DEFAULT}, is on the front of {name} error {whom} on {} of {n} problems{not}.",
                on.len()
            ));
        }
    }
    all.retain(|_| records.iter().any(|r| r.on_front.is_some()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn conclusions_name_the_problems_off_the_front() {
        let record = |name: &str, on_front| Record {
            name: name.into(),
            section: Section::default(),
            conclusions: vec!["said".into()],
            excerpt: Vec::new(),
            on_front,
            requirements: Vec::new(),
        };
        let problems = ["a", "b"].map(|name| record(name, Some([[name == "a", true]; 2])));
        let all = fronts(&problems);
        assert_eq!(all.len(), 4);
        assert!(all[0].ends_with("of position error of all methods on 1 of 2 problems; not on b."));
        assert!(all[3].ends_with("that take flat states on 2 of 2 problems."));
        assert!(fronts(&[record("hanging", None)]).is_empty());
    }

    #[test]
    fn the_page_on_other_programs_exists() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let text = std::fs::read_to_string(root.join(ELSEWHERE)).expect("the page is there");
        assert!(text.contains("The hanging sheet") && text.contains("The tablecloth"));
    }
}
