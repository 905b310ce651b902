//! `isosheet collect`.

use super::failure::{Code, Done, Failure};
use super::message::{counted, print_message, print_result};
use super::write::{bytes_to_stdout, is_same_file, refuse_file_of_run, refuse_other_kind};
use clap::Args;
use isosheet_runs::Collection;
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
    /// Refuses to replace what is read, a file of a run, or one that is no table.
    fn check_out(&self) -> Done {
        let Some(out) = &self.out else { return Ok(()) };
        let mut tables = self.folders.iter().map(|folder| folder.join("runs.csv"));
        if tables.any(|table| is_same_file(&table, out)) {
            let message = format!("{} belongs to the sweep", out.display());
            return Err(Failure::misuse(message).remedy("choose another name"));
        }
        refuse_file_of_run(out)?;
        refuse_other_kind(out, &["csv"], "table")
    }
}
