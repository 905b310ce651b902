//! `isosheet collect`.

use super::failure::{Code, Done, Failure};
use super::message::{counted, print_message, print_result};
use super::write::{bytes_to_stdout, is_same_file};
use crate::run::{Collection, run_of_file};
use clap::Args;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet collect cloth-sweep -o cloth.csv              one table of a sweep
  isosheet collect runs/a runs/b --allow-incomplete      a table of two folders, on standard output";

/// Make one table (CSV) of the summaries of runs and sweeps
///
/// The table has a row for each run: its folder, the keys of its sweep, and all of its `summary.json`.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct Collect {
    /// Folders of sweeps and of runs
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Make the table without the runs that are not complete
    #[arg(long)]
    allow_incomplete: bool,
}

impl Collect {
    pub(crate) fn run(&self) -> Done {
        self.check_out()?;
        let collection = Collection::of(&self.folders)?;
        for folder in collection.incomplete() {
            print_message(format_args!("not complete: {}", folder.display()));
        }
        let missing = collection.incomplete().len();
        if missing > 0 && !self.allow_incomplete {
            let count = missing + collection.row_count();
            let message = format!("{missing} of {count} runs are not complete");
            return Err(Failure::new(Code::Input, message)
                .remedy("run them, or leave them out with --allow-incomplete"));
        }
        match &self.out {
            Some(path) => {
                collection.write(path)?;
                print_result(format_args!(
                    "{}: {}",
                    path.display(),
                    counted(collection.row_count(), "run", "runs")
                ))
            }
            None => bytes_to_stdout(&collection.to_csv()),
        }
    }
    /// Refuses to replace what is read, or the history of a run. Other files are replaced.
    fn check_out(&self) -> Result<(), Failure> {
        let Some(out) = &self.out else { return Ok(()) };
        let mut tables = self.folders.iter().map(|folder| folder.join("runs.csv"));
        let is_read = tables.any(|table| is_same_file(&table, out));
        if is_read || run_of_file(out).is_some() {
            let message = format!("{} belongs to the sweep or the run", out.display());
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        let is_table = out
            .extension()
            .is_some_and(|e| e.eq_ignore_ascii_case("csv"));
        if out.is_file() && !is_table {
            let message = format!("{} is a file that is no table", out.display());
            return Err(Failure::misuse(message).remedy("choose another name, such as results.csv"));
        }
        Ok(())
    }
}
