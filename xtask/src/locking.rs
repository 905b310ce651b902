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
mod effort;
mod elastica;
mod everyday;
mod findings;
mod isometry;
mod iterations;
mod limit;
pub(crate) mod meshes;
mod page;
mod plot;
mod records;
mod rim;
mod sliding;
mod table;
mod targets;

use crate::cli::LockingArgs;
use crate::draw::Drawing;
use crate::interrupt::Interrupted;
use crate::store::{Extent, Store};
use crate::{Outcome, interrupt, progress};
use anyhow::Result;
use effort::LockingEffort;
use findings::Findings;
use records::Records;
use serde_json::json;
use std::fmt;
use std::str::FromStr;

/// A yardstick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// Flat sheets that are clamped along lines of any direction.
    Clamped,
    /// Single everyday scenes with paper.
    Everyday,
    /// A square that clamps bend to a cylinder.
    Cylinder,
    /// The drop of a heavy strip.
    Cantilever,
    /// Elastic sheets against rods and against an inextensible strip.
    Compliance,
    /// Iterations of the hanging sheet.
    Iterations,
    /// A disk on a round table.
    Drape,
    /// Lateral buckling of a strip on edge.
    Buckling,
    /// The angle at which a sheet slides.
    Sliding,
}

impl Part {
    /// All of them, in the order of the page.
    const ALL: [Self; 9] = [
        Self::Clamped,
        Self::Everyday,
        Self::Cylinder,
        Self::Cantilever,
        Self::Compliance,
        Self::Iterations,
        Self::Drape,
        Self::Buckling,
        Self::Sliding,
    ];

    fn title(self) -> &'static str {
        match self {
            Self::Clamped => "Clamped sheets",
            Self::Everyday => "Everyday scenes",
            Self::Cylinder => "Bent to a cylinder",
            Self::Cantilever => "The heavy elastica",
            Self::Compliance => "Error against compliance",
            Self::Iterations => "Iterations of the hanging sheet",
            Self::Drape => "A disk on a round table",
            Self::Buckling => "Lateral buckling",
            Self::Sliding => "Sliding down a plane",
        }
    }

    /// The set-up in words.
    fn about(self) -> &'static str {
        match self {
            Self::Clamped => clamped::ABOUT,
            Self::Everyday => everyday::ABOUT,
            Self::Cylinder => cylinder::ABOUT,
            Self::Cantilever => cantilever::ABOUT,
            Self::Compliance => compliance::ABOUT,
            Self::Iterations => iterations::ABOUT,
            Self::Drape => drape::ABOUT,
            Self::Buckling => buckling::ABOUT,
            Self::Sliding => sliding::ABOUT,
        }
    }

    fn make(self, records: &Records<'_>) -> Result<(Findings, Option<Drawing>)> {
        match self {
            Self::Clamped => clamped::make(records),
            Self::Everyday => everyday::make(records),
            Self::Cylinder => cylinder::make(records),
            Self::Cantilever => cantilever::make(records),
            Self::Compliance => compliance::make(records),
            Self::Iterations => iterations::make(records),
            Self::Drape => drape::make(records),
            Self::Buckling => buckling::make(records),
            Self::Sliding => sliding::make(records),
        }
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Clamped => "clamped",
            Self::Everyday => "everyday",
            Self::Cylinder => "cylinder",
            Self::Cantilever => "cantilever",
            Self::Compliance => "compliance",
            Self::Iterations => "iterations",
            Self::Drape => "drape",
            Self::Buckling => "buckling",
            Self::Sliding => "sliding",
        })
    }
}

impl FromStr for Part {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        match Self::ALL.iter().find(|p| p.to_string() == text) {
            Some(part) => Ok(*part),
            None => {
                let names = Self::ALL.map(|p| p.to_string()).join(", ");
                anyhow::bail!("there is no yardstick {text:?}; choose from {names}")
            }
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &LockingArgs) -> Result<Outcome> {
    let effort = if args.quick {
        LockingEffort::Quick
    } else {
        LockingEffort::Full
    };
    let store = Store::open(&args.out)?;
    let parts = if args.yardsticks.is_empty() {
        Part::ALL.to_vec()
    } else {
        args.yardsticks.clone()
    };
    let mut outcome = Outcome::Complete;
    for part in parts {
        if interrupt::requested() {
            outcome = Outcome::Interrupted;
            break;
        }
        if let Some(stamp) = store.current(&unit(part), &options(effort)) {
            progress::note(&part.to_string(), "up to date");
            print(&serde_json::from_value(stamp.facts)?);
            continue;
        }
        let records = Records {
            store: &store,
            part,
            effort,
        };
        match part.make(&records) {
            Ok((found, drawing)) => {
                keep(&store, part, effort, &found, drawing)?;
                print(&found);
            }
            Err(error) if error.is::<Interrupted>() => {
                outcome = Outcome::Interrupted;
                break;
            }
            Err(error) => return Err(error.context(part.to_string())),
        }
    }
    page::write(&store, effort)?;
    println!("{}", store.root().join("index.html").display());
    Ok(outcome)
}

fn unit(part: Part) -> String {
    format!("locking-{part}")
}

fn options(effort: LockingEffort) -> serde_json::Value {
    json!({ "effort": effort })
}

/// What a part found with this effort; `None` if it was not made yet.
fn findings(store: &Store, part: Part, effort: LockingEffort) -> Option<Findings> {
    let stamp = store.stamp(&unit(part))?;
    if stamp.extent != Extent::Complete || stamp.options != options(effort) {
        return None;
    }
    serde_json::from_value(stamp.facts).ok()
}

fn print(found: &Findings) {
    for table in &found.tables {
        println!("{}", table.text());
    }
    for remark in &found.remarks {
        println!("{remark}");
    }
}

fn keep(
    store: &Store,
    part: Part,
    effort: LockingEffort,
    found: &Findings,
    drawing: Option<Drawing>,
) -> Result<()> {
    let mut draft = store.draft()?;
    for table in found.tables.iter().chain(&found.files) {
        draft.write(
            &format!("tables/{}.csv", table.name),
            table.csv().as_bytes(),
        )?;
    }
    if let Some(drawing) = drawing {
        let title = part.title();
        let svg = drawing.to_svg(title)?;
        draft.write(&format!("plots/{part}.svg"), svg.as_bytes())?;
        draft.write(&format!("plots/{part}.png"), &drawing.to_png(title)?)?;
    }
    store.commit(
        draft,
        &unit(part),
        &options(effort),
        Extent::Complete,
        serde_json::to_value(found)?,
    )?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_read_back() {
        for part in Part::ALL {
            assert_eq!(part.to_string().parse::<Part>().unwrap(), part);
        }
        let error = "moon".parse::<Part>().unwrap_err().to_string();
        assert!(error.contains("choose from clamped, everyday"), "{error}");
    }
}
