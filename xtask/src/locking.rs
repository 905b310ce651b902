//! `locking`: how much stiffer than a smooth inextensible sheet a triangulated one is, by yardsticks with
//! exact or published references.
//!
//! The runs of every model and the findings of every yardstick are kept in the output folder, so that an
//! interrupted report continues where it stopped, and the page is written from what is there.

mod bisection;
mod buckling;
mod cantilever;
mod clamped;
mod compliance;
mod course;
mod cylinder;
mod disk;
mod drape;
mod everyday;
mod isometry;
mod iterations;
mod limit;
pub(crate) mod meshes;
mod page;
mod plot;
mod records;
mod rim;
mod sample;
mod sliding;
mod targets;

use crate::draw::Drawing;
use crate::interrupt::{self, Outcome};
use crate::report::{Effort, Table, plot_files};
use crate::store::{Draft, Store, Unit};
use anyhow::Result;
use clap::Args;
use page::Section;
use records::Records;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::path::PathBuf;
use targets::Target;

/// What a yardstick found.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
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

/// Applies a yardstick: what it found, and its figure.
type Make = fn(&Records<'_>) -> Result<(Findings, Option<Drawing>)>;

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

    fn unit(&self, effort: Effort) -> Unit {
        Unit {
            name: format!("locking-{}", self.name),
            title: self.name.to_owned(),
            options: json!({ "effort": effort }),
        }
    }

    /// Applies the yardstick; its tables and its figure go into the draft.
    fn apply(&self, store: &Store, effort: Effort, draft: &mut Draft) -> Result<Findings> {
        let part = self.name.to_owned();
        let (found, drawing) = (self.make)(&Records {
            store,
            part,
            effort,
        })?;
        for table in found.tables.iter().chain(&found.files) {
            draft.write(&format!("tables/{}", table.file()), &table.csv()?)?;
        }
        if let Some(drawing) = drawing {
            plot_files(draft, self.name, &drawing, self.title)?;
        }
        Ok(found)
    }
}

/// All of them, in the order of the page.
static YARDSTICKS: [Yardstick; 9] = [
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

/// A yardstick by its name on the command line.
fn parse(name: &str) -> Result<&'static Yardstick, String> {
    let found = YARDSTICKS.iter().find(|y| y.name == name);
    found.ok_or_else(|| {
        let names = YARDSTICKS.each_ref().map(|y| y.name).join(", ");
        format!("there is no yardstick {name:?}; choose from {names}")
    })
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

/// Arguments of `locking`.
#[derive(Debug, Args)]
pub(crate) struct LockingArgs {
    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/locking")]
    pub(crate) out: PathBuf,

    /// Seconds instead of a quarter of an hour: checks that everything works, and shows no result
    #[arg(long)]
    pub(crate) quick: bool,

    /// Yardsticks to apply, separated by commas, such as clamped; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse)]
    pub(crate) yardsticks: Vec<&'static Yardstick>,
}

/// Runs the command.
pub(crate) fn run(args: &LockingArgs) -> Result<Outcome> {
    let effort = Effort::of_flags([args.quick, true]);
    let store = Store::open(&args.out)?;
    let mut yardsticks = args.yardsticks.clone();
    if yardsticks.is_empty() {
        yardsticks.extend(&YARDSTICKS);
    }
    let outcome = interrupt::each(yardsticks, |yardstick| {
        let unit = yardstick.unit(effort);
        let found = store.keep(&unit, |draft| yardstick.apply(&store, effort, draft))?;
        for table in &found.tables {
            println!("{}", table.text());
        }
        found.remarks.iter().for_each(|remark| println!("{remark}"));
        Ok(())
    })?;
    let section = |yardstick: &'static Yardstick| {
        let found = store.earlier(&yardstick.unit(effort))?;
        Some(Section { yardstick, found })
    };
    let sections: Vec<Section> = YARDSTICKS.iter().filter_map(section).collect();
    page::write(&store, &sections, effort)?;
    println!("{}", store.root().join("index.html").display());
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yardsticks_are_found_by_their_names() {
        for yardstick in &YARDSTICKS {
            assert_eq!(parse(yardstick.name).unwrap().name, yardstick.name);
        }
        let error = parse("moon").unwrap_err();
        assert!(error.contains("choose from clamped, everyday"), "{error}");
    }

    #[test]
    fn medians() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0]), 2.5);
        assert!(median(Vec::new()).is_nan());
    }
}
