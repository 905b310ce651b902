//! `isosheet collect`.

use crate::Done;
use crate::exit::{Code, Failure};
use crate::message::{counted, print_message};
use crate::write::bytes_to_stdout;
use clap::Args;
use isosheet_io::run::Collection;
use std::path::PathBuf;

/// Make one table (CSV) of the summaries of runs and sweeps
///
/// The table has a row for each run: its folder, the keys of its sweep, and all of its `summary.json`.
#[derive(Debug, Args)]
pub(crate) struct Collect {
    /// Folders of sweeps and of runs
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The file to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Make the table without the runs that are not complete
    #[arg(long)]
    allow_incomplete: bool,
}

impl Collect {
    pub(crate) fn run(&self) -> Done {
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
                print_message(format_args!(
                    "{}: {}",
                    path.display(),
                    counted(collection.row_count(), "run", "runs")
                ));
                Ok(())
            }
            None => bytes_to_stdout(&collection.to_csv()),
        }
    }
}
