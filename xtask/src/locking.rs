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
mod targets;

use crate::draw::Drawing;
use crate::interrupt::{self, Outcome};
use crate::report::Effort;
use crate::report::plot_files;
use crate::store::{Store, Unit};
use anyhow::Result;
use clap::Args;
use findings::Findings;
use page::Section;
use records::Records;
use serde_json::json;
use std::fmt;
use std::path::PathBuf;
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

impl Part {
    fn unit(self, effort: Effort) -> Unit {
        Unit {
            name: format!("locking-{self}"),
            title: self.to_string(),
            options: json!({ "effort": effort }),
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
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(crate) yardsticks: Vec<Part>,
}

/// Runs the command.
pub(crate) fn run(args: &LockingArgs) -> Result<Outcome> {
    let effort = Effort::of_flags([args.quick, true]);
    let store = Store::open(&args.out)?;
    let parts = if args.yardsticks.is_empty() {
        Part::ALL.to_vec()
    } else {
        args.yardsticks.clone()
    };
    let outcome = interrupt::each(parts, |part| {
        let found = store.keep(&part.unit(effort), |draft| {
            let (found, drawing) = part.make(&Records {
                store: &store,
                part: part.to_string(),
                effort,
            })?;
            for table in found.tables.iter().chain(&found.files) {
                draft.write(&format!("tables/{}", table.file()), &table.csv()?)?;
            }
            if let Some(drawing) = drawing {
                plot_files(draft, &part.to_string(), &drawing, part.title())?;
            }
            Ok(found)
        })?;
        for table in &found.tables {
            println!("{}", table.text());
        }
        found.remarks.iter().for_each(|remark| println!("{remark}"));
        Ok(())
    })?;
    let section = |part: Part| {
        Some(Section {
            name: part.to_string(),
            title: part.title(),
            about: part.about(),
            found: store.earlier(&part.unit(effort))?,
        })
    };
    let sections: Vec<Section> = Part::ALL.into_iter().filter_map(section).collect();
    page::write(&store, &sections, effort)?;
    println!("{}", store.root().join("index.html").display());
    Ok(outcome)
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
