//! `speed-vs-error`: time against errors of every method on problems with known motion, on two works that
//! other programs have been measured on, and of the linear solvers.
//!
//! Every part is kept in the output folder with what it found, so that an interrupted run continues where it
//! stopped, and the page is written from what is there.

mod analysis;
mod barrier;
mod effort;
mod hanging;
mod matrices;
mod measure;
mod page;
mod problem;
mod reference;
mod scheme;
mod solvers;
mod study;
mod tablecloth;
mod verdict;

use crate::interrupt::{self, Outcome};
use crate::report::Effort;
use crate::report::plot_files;
use crate::store::{Store, Unit};
use anyhow::Result;
use clap::Args;
use page::Results;
use problem::Problem;
use serde_json::json;
use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

/// A part of the report that can be made alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
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
    /// All parts that an effort has time for.
    fn all(effort: Effort) -> Vec<Self> {
        let costly = [Problem::Strip(64), Problem::Sheet(2), Problem::Sheet(3)];
        let mut all: Vec<Self> = Problem::ALL
            .into_iter()
            .filter(|p| effort != Effort::Quick || !costly.contains(p))
            .map(Self::Problem)
            .collect();
        all.extend([Self::Hanging, Self::Tablecloth, Self::Solvers]);
        all
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Problem(p) => p.fmt(f),
            Self::Hanging => f.write_str("hanging"),
            Self::Tablecloth => f.write_str("tablecloth"),
            Self::Solvers => f.write_str("solvers"),
        }
    }
}

impl FromStr for Part {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "hanging" => Ok(Self::Hanging),
            "tablecloth" => Ok(Self::Tablecloth),
            "solvers" => Ok(Self::Solvers),
            _ => match text.parse() {
                Ok(problem) => Ok(Self::Problem(problem)),
                Err(error) => anyhow::bail!("{error}, hanging, tablecloth, solvers"),
            },
        }
    }
}

/// Arguments of `speed-vs-error`.
#[derive(Debug, Args)]
pub(crate) struct SpeedArgs {
    /// Folder to write to: a new or empty one, or one of an earlier run of this program
    #[arg(long, value_name = "DIR", default_value = "out/speed-vs-error")]
    pub(crate) out: PathBuf,

    /// Seconds instead of ten minutes: checks that everything works, and shows no result
    #[arg(long, conflicts_with = "full")]
    pub(crate) quick: bool,

    /// Longer runs, smaller steps, larger matrices: about an hour
    #[arg(long)]
    pub(crate) full: bool,

    /// What to measure, separated by commas: problems (pendulum, triangle, strip-2, ..., sheet-3, cloth-2),
    /// hanging, tablecloth, solvers; all when left out
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub(crate) problems: Vec<Part>,

    /// Write the matrices of the solver study to this folder as Matrix Market files, and measure nothing
    #[arg(long, value_name = "DIR", conflicts_with = "problems")]
    pub(crate) matrices: Option<PathBuf>,
}

/// Runs the command.
pub(crate) fn run(args: &SpeedArgs) -> Result<Outcome> {
    let effort = Effort::of_flags([args.quick, args.full]);
    if let Some(folder) = &args.matrices {
        return matrices::write(folder, effort);
    }
    let store = Store::open(&args.out)?;
    let parts = if args.problems.is_empty() {
        Part::all(effort)
    } else {
        args.problems.clone()
    };
    let outcome = interrupt::each(parts, |part| make(&store, part, effort))?;
    let problems = Problem::ALL.into_iter().map(Part::Problem);
    let results = Results {
        studies: problems
            .filter_map(|part| store.earlier(&part.unit(effort)))
            .collect(),
        hanging: store.earlier(&Part::Hanging.unit(effort)),
        tablecloth: store.earlier(&Part::Tablecloth.unit(effort)),
        solvers: store.earlier(&Part::Solvers.unit(effort)),
    };
    page::write(&store, &results, effort)?;
    println!("{}", store.root().join("index.html").display());
    Ok(outcome)
}

impl Part {
    fn unit(self, effort: Effort) -> Unit {
        Unit {
            name: format!("speed-{self}"),
            title: self.to_string(),
            options: json!({ "effort": effort }),
        }
    }
}

/// Makes a part with its files, unless it is up to date.
fn make(store: &Store, part: Part, effort: Effort) -> Result<()> {
    let unit = part.unit(effort);
    let csv = format!("tables/{part}.csv");
    match part {
        Part::Problem(problem) => {
            store.keep(&unit, |draft| {
                let study = study::make(problem, effort)?;
                draft.write(&csv, &study.data().csv()?)?;
                let alt = format!("{}: errors against wall time, by method", problem.title());
                plot_files(draft, &problem.to_string(), &study.plot(), &alt)?;
                Ok(study)
            })?;
        }
        Part::Hanging => {
            store.keep(&unit, |draft| {
                let rows = hanging::make(effort)?;
                draft.write(&csv, &hanging::data(&rows).csv()?)?;
                Ok(rows)
            })?;
        }
        Part::Tablecloth => {
            store.keep(&unit, |draft| {
                let rows = tablecloth::make(effort)?;
                draft.write(&csv, &tablecloth::data(&rows).csv()?)?;
                Ok(rows)
            })?;
        }
        Part::Solvers => {
            store.keep(&unit, |draft| {
                let rows = solvers::make(effort)?;
                draft.write(&csv, &solvers::data(&rows).csv()?)?;
                plot_files(draft, "solvers", &solvers::plot(&rows), SOLVERS)?;
                Ok(rows)
            })?;
        }
    }
    Ok(())
}

/// What the plot of the solvers shows, for those who do not see it.
const SOLVERS: &str =
    "Time and backward error of the linear solvers against the number of degrees of freedom";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_read_back() {
        for part in Part::all(Effort::Full) {
            assert_eq!(part.to_string().parse::<Part>().unwrap(), part);
        }
        let error = "sun".parse::<Part>().unwrap_err().to_string();
        assert!(
            error.contains("sheet-3, cloth-2, hanging, tablecloth, solvers"),
            "{error}"
        );
    }
}
