//! `locking`: how much stiffer than a smooth inextensible sheet a triangulated one is, by yardsticks with
//! exact or published references.
//!
//! The runs of every model and the findings of every yardstick are kept in the output folder, so that an
//! interrupted report continues where it stopped, and the page is written from what is there.

mod bisection;
mod buckling;
mod cantilever;
pub(crate) mod clamped;
mod compliance;
mod cone;
mod cone_mesh;
mod cylinder;
mod declared;
mod disk;
mod dots;
mod drape;
mod everyday;
mod excess;
mod fear;
mod folded;
mod grids;
mod isometry;
mod iterations;
mod lasting;
mod limit;
pub(crate) mod meshes;
mod model;
mod nudge;
mod panels;
mod records;
mod rim;
mod sample;
mod scene;
mod sliding;
mod softening;
mod strips;
mod targets;
mod ways;

use crate::draw::Charts;
use crate::interrupt;
use crate::report::{Options, Page, Part, Section, Shortfall, Table, demand, excerpt};
use crate::report::{exponent, findings, list, machine, one_of, plot, write_findings};
use crate::store::{Files, Kept, Store, Unit};
use anyhow::Result;
use clap::Args;
use declared::declared;
use maud::html;
use records::Records;
use serde::{Deserialize, Serialize};
use targets::Target;

/// What a yardstick found.
#[derive(Clone, Debug, Default)]
struct Findings {
    /// Tables of the page, which are files as well.
    tables: Vec<Table>,
    /// Tables that are files alone: every single run.
    files: Vec<Table>,
    /// What the numbers say, one sentence or two each.
    remarks: Vec<String>,
    /// What the models are required to reach here.
    targets: Vec<Target>,
}

/// What is kept of a yardstick.
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    name: String,
    section: Section,
    /// Tables and remarks for a terminal.
    text: String,
    /// Its tables for the book.
    excerpt: Vec<Part>,
    targets: Vec<Target>,
}

/// Applies a yardstick: what it found, and its figure.
type Make = fn(&Records<'_>) -> Result<(Findings, Option<Charts>)>;

/// A yardstick.
#[derive(Debug)]
pub(crate) struct Yardstick {
    /// Its name on the command line and in file names.
    name: &'static str,
    title: &'static str,
    /// The set-up in words.
    about: &'static str,
    make: Make,
}

impl Yardstick {
    const fn new([name, title, about]: [&'static str; 3], make: Make) -> Self {
        Self {
            name,
            title,
            about,
            make,
        }
    }

    fn unit(&self, store: &Store) -> Unit {
        store.unit(format!("locking-{}", self.name), self.name)
    }

    /// Applies the yardstick and writes its tables and its figure.
    fn apply(&self, store: &Store, files: &mut Files<'_>) -> Result<Record> {
        let part = self.name;
        let (found, charts) = (self.make)(&Records { store, part })?;
        for table in found.tables.iter().chain(&found.files) {
            table.write(files)?;
        }
        let figure = charts.map(|charts| plot(files, self.name, &charts, self.title));
        let section = html! {
            section id=(self.name) {
                h2 { (self.title) }
                p { (self.about) }
                @if let Some(figure) = figure.transpose()? { (figure) }
                (list(&found.remarks))
                @for table in &found.tables { (table) }
            }
        };
        let excerpt = found
            .tables
            .iter()
            .map(|t| Part::table(&t.name, t))
            .collect();
        let tables = found.tables.iter().map(Table::text);
        let texts: Vec<String> = tables.chain(found.remarks).collect();
        Ok(Record {
            name: self.name.to_owned(),
            section: section.into(),
            text: texts.join("\n"),
            excerpt,
            targets: found.targets,
        })
    }
}

/// All of them, in the order of the page.
static YARDSTICKS: [Yardstick; 16] = [
    Yardstick::new(["clamped", "Clamped sheets", clamped::ABOUT], clamped::make),
    Yardstick::new(
        ["everyday", "Everyday scenes", everyday::ABOUT],
        everyday::make,
    ),
    Yardstick::new(
        ["cylinder", "Bent to a cylinder", cylinder::ABOUT],
        cylinder::make,
    ),
    Yardstick::new(
        ["cantilever", "The heavy elastica", cantilever::ABOUT],
        cantilever::make,
    ),
    Yardstick::new(
        ["strips", "Strips with known answers", strips::ABOUT],
        strips::make,
    ),
    Yardstick::new(
        ["d-cone", "A disk pushed into a ring", cone::ABOUT],
        cone::make,
    ),
    Yardstick::new(
        ["e-cone", "A disk with a wedge inserted", excess::ABOUT],
        excess::make,
    ),
    Yardstick::new(
        ["softening", "The bound of the stiffness", softening::ABOUT],
        softening::make,
    ),
    Yardstick::new(
        ["creases", "Creases with known answers", folded::ABOUT],
        folded::make,
    ),
    Yardstick::new(
        ["lasting", "Ten seconds after rest", lasting::ABOUT],
        lasting::make,
    ),
    Yardstick::new(["fear", "Falls and banners", fear::ABOUT], fear::make),
    Yardstick::new(
        ["compliance", "Error against compliance", compliance::ABOUT],
        compliance::make,
    ),
    Yardstick::new(
        [
            "iterations",
            "Iterations of the hanging sheet",
            iterations::ABOUT,
        ],
        iterations::make,
    ),
    Yardstick::new(
        ["drape", "A disk on a round table", drape::ABOUT],
        drape::make,
    ),
    Yardstick::new(
        ["buckling", "Lateral buckling", buckling::ABOUT],
        buckling::make,
    ),
    Yardstick::new(
        ["sliding", "Sliding down a plane", sliding::ABOUT],
        sliding::make,
    ),
];

fn named() -> Vec<(&'static str, &'static Yardstick)> {
    YARDSTICKS.iter().map(|y| (y.name, y)).collect()
}

/// The median; NaN of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    if n == 0 {
        return f64::NAN;
    }
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}

/// Fitted power of the errors above `floor`, the level of round-off and of the solver's tolerances, below
/// which an error says nothing; nothing from fewer than two.
fn order(points: &[[f64; 2]], floor: f64) -> Option<f64> {
    let is_positive = |point: &[f64; 2]| point.iter().all(|v| v.is_finite() && *v > 0.0);
    let all = points.iter().copied();
    let above: Vec<[f64; 2]> = all.filter(|p| is_positive(p) && p[1] > floor).collect();
    if above.len() < 2 {
        return None;
    }
    exponent(&above)
}

/// Arguments of `locking`.
#[derive(Debug, Args)]
pub(crate) struct LockingArgs {
    #[command(flatten)]
    options: Options,

    /// Yardsticks to apply, separated by commas, such as clamped; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = one_of(named))]
    yardsticks: Vec<&'static Yardstick>,
}

/// Runs the command.
pub(crate) fn run(args: &LockingArgs) -> Result<()> {
    let store = args.options.open("locking")?;
    let mut yardsticks = args.yardsticks.clone();
    if yardsticks.is_empty() {
        yardsticks.extend(&YARDSTICKS);
    }
    let made = yardsticks.into_iter().try_for_each(|yardstick| {
        let record = store.keep(&yardstick.unit(&store), |files| {
            yardstick.apply(&store, files)
        })?;
        println!("{}", record.text);
        Ok(())
    });
    interrupt::afterwards(made, || write(&store))
}

/// Writes the page, `findings.csv` and `findings.json` of all yardsticks applied so far.
fn write(store: &Store) -> Result<()> {
    let units = YARDSTICKS.iter().map(|yardstick| yardstick.unit(store));
    let Kept::<Record> { records, left_out } = store.all_kept(units.collect());
    let of = |r: &'_ Record| {
        r.targets
            .iter()
            .map(|t| {
                let mut target = t.clone();
                if let Some(why) = declared(&r.name, t, store.effort) {
                    target.limited(why, Shortfall::Varies);
                }
                (r.name.clone(), target)
            })
            .collect::<Vec<_>>()
    };
    let targets: Vec<(String, Target)> = records.iter().flat_map(of).collect();
    let named = targets.iter().map(|(name, t)| (name.as_str(), t));
    let summary = findings(CAPTION, named.clone());
    write_findings(store, named.clone())?;
    let mut parts = vec![Part::table("targets", &targets::by_model(&targets))];
    parts.extend(records.iter().flat_map(|r| r.excerpt.clone()));
    excerpt::write(store, "locking", &parts)?;
    let body = html! {
        p { (INTRODUCTION) }
        p {
            "SI units, z upwards. Times are wall times of runs on one core each, with other runs beside. Machine: "
            (machine()) "."
        }
        section #targets { h2 { "Measured against target" } (summary) }
        @for record in &records { (record.section) }
    };
    let page = Page {
        left_out,
        ..Page::new("Yardsticks of locking", body)
    };
    page.write(store, "index.html")?;
    demand(named)
}

const CAPTION: &str = "Measured against target. A number is the worst of all runs that the requirement names; where it is missing, one of these runs \
    did not end";

const INTRODUCTION: &str = "A triangle mesh whose edges are rigid rods has only B − 3 ways to deform (B: edges on the boundary) and folds only \
    along mesh lines. It is too stiff, or cannot move at all, where a smooth inextensible sheet bends in another direction: it locks. The \
    yardsticks measure by how much, and what two elastic sheets do: one with the membrane stiffness of office paper, 3e5 N/m, on every face (\"real stiffness\"), and the elastic sheet, office paper \
    that is softened as far as the mesh needs in order to bend (\"elastic\"), both with a limit of the strain of 1 %. Where a scene has no bending stiffness, the softening is that of D = 5e-4 N m.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_need_two_values_above_the_floor() {
        let points = [[0.1, 0.02], [0.2, 0.08], [0.4, 0.0], [0.8, f64::NAN]];
        assert!((order(&points, 0.0).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(order(&points, 0.05), None);
        assert_eq!(order(&points[1..], 0.0), None);
    }

    #[test]
    fn medians() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }
}
