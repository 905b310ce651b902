//! `locking`: how much stiffer than a smooth inextensible sheet a triangulated one is, by yardsticks with
//! exact or published references.
//!
//! The runs of every model and the findings of every yardstick are kept in the output folder, so that an
//! interrupted report continues where it stopped, and the page is written from what is there.

mod analysis;
mod buckling;
mod clamped;
mod cone;
mod curved;
mod disks;
mod excess;
mod model;
mod nudge;
mod runs;
mod scene;
mod slack;
mod strips;
mod tension;

use crate::interrupt;
use crate::report::{Options, Part, Record, Report, Table, all_findings, findings};
use crate::report::{machine, one_of};
use crate::store::{Files, Kept, Store, Unit};
use analysis::{Required, SummaryTable};
use anyhow::Result;
use clap::Args;
use maud::html;
use runs::Records;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The file of the yardsticks.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct YardsticksFile {
    /// Why requirements may be missed, by a word.
    reasons: BTreeMap<String, String>,
    yardstick: Vec<Yardstick>,
}

/// A yardstick: runs of the same scenes with all models, and what is read off the table of all runs.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Yardstick {
    /// Its name on the command line and in file names.
    name: String,
    title: String,
    /// The set-up in words.
    about: String,
    /// The column with the size of the mesh; empty without powers.
    #[serde(default)]
    size: String,
    /// Tables of the page and of the book.
    table: Vec<SummaryTable>,
    #[serde(default)]
    required: Vec<Required>,
}

static CONTENTS: LazyLock<YardsticksFile> = LazyLock::new(|| {
    let contents = toml::from_str(include_str!("locking/yardsticks.toml"));
    contents.unwrap_or_else(|error| panic!("yardsticks.toml: {error}"))
});

impl Yardstick {
    fn unit(&self, store: &Store) -> Unit {
        store.unit(format!("locking-{}", self.name), &self.name)
    }

    /// The table of all runs.
    fn runs(&self, records: &Records<'_>) -> Result<Table> {
        let runs = match self.name.as_str() {
            "clamped" => clamped::runs,
            "strips" => strips::runs,
            "d-cone" => cone::runs,
            "e-cone" => excess::runs,
            "slack" => slack::runs,
            "curved-creases" => curved::runs,
            "buckling" => buckling::runs,
            "tension" => tension::runs,
            name => panic!("no runs of the yardstick {name}"),
        };
        runs(records)
    }

    /// Applies the yardstick and writes its tables and its figure.
    fn apply(&self, store: &Store, files: &mut Files<'_>) -> Result<Record> {
        let part = self.name.as_str();
        let runs = self.runs(&Records { store, part })?;
        runs.clone().named(&format!("{part}-all")).write(files)?;
        let tables: Vec<Table> = self.table.iter().map(|t| t.of(&runs, &self.size)).collect();
        for table in &tables {
            table.write(files)?;
        }
        let section = html! {
            h2 { (self.title) }
            p { (self.about) }
            @for table in &tables { (table) }
            p { "Every run: tables/" (part) "-all.csv." }
        };
        Ok(Record {
            excerpt: tables.iter().map(|t| Part::table(&t.name, t)).collect(),
            findings: analysis::findings(&self.required, &runs, store.effort, &CONTENTS.reasons),
            ..Record::new(part, section)
        })
    }
}

fn named() -> Vec<(&'static str, &'static Yardstick)> {
    let all = CONTENTS.yardstick.iter();
    all.map(|y| (y.name.as_str(), y)).collect()
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
        yardsticks.extend(&CONTENTS.yardstick);
    }
    let made = yardsticks.into_iter().try_for_each(|yardstick| {
        let record = store.keep(&yardstick.unit(&store), |files| {
            yardstick.apply(&store, files)
        })?;
        let named = record.findings.iter().map(|f| (yardstick.name.as_str(), f));
        println!("{}", findings(&yardstick.title, named).text());
        Ok(())
    });
    interrupt::afterwards(made, || write(&store))
}

/// Writes the page and the other files of all yardsticks applied so far.
fn write(store: &Store) -> Result<()> {
    let units = CONTENTS.yardstick.iter().map(|y| y.unit(store));
    let kept: Kept<Record> = store.all_kept(units.collect());
    let targets = analysis::by_model(all_findings(&kept.records));
    let report = Report {
        name: "locking",
        title: "Yardsticks of locking",
        introduction: html! {
            p { (INTRODUCTION) }
            p {
                "SI units, z upwards. Times are seconds of the processor, of runs on one core each. Machine: "
                (machine()) "."
            }
        },
        caption: CAPTION,
        excerpt: vec![Part::table("targets", &targets)],
    };
    report.write(store, kept)
}

const CAPTION: &str = "Measured against target. A number is the worst of all runs that the requirement names; where it is missing, one of these runs \
    did not end";

const INTRODUCTION: &str = "A triangle mesh whose edges are rigid rods has only B − 3 ways to deform (B: edges on the boundary) and folds only \
    along mesh lines. It is too stiff, or cannot move at all, where a smooth inextensible sheet bends in another direction: it locks. The \
    yardsticks measure by how much, and what two elastic sheets do: one with the membrane stiffness of office paper, 3e5 N/m, on every face (\"real stiffness\"), and the elastic sheet, office paper \
    with slack where faces bend (\"elastic\"), both with a limit of the strain of 1 %.";
