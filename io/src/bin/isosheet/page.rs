//! `isosheet page`.

use crate::Done;
use crate::exit::Failure;
use crate::message::print_message;
use clap::Args;
use isosheet_io::run::write_page;
use isosheet_io::view::PageOptions;
use std::path::PathBuf;

/// Make the 3D page of a run, complete or not
///
/// `isosheet simulate` ends with this page, unless the scene has `output.page = false`.
#[derive(Debug, Args)]
pub(crate) struct Page {
    /// The folder of the run
    dir: PathBuf,
    /// The file to write [default: index.html in the folder of the run]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Largest size of the page: of a run that needs more, fewer frames are kept
    #[arg(long, value_name = "BYTES", default_value_t = PageOptions::default().budget)]
    budget: usize,
}

impl Page {
    pub(crate) fn run(&self) -> Done {
        let file = self
            .out
            .clone()
            .unwrap_or_else(|| self.dir.join("index.html"));
        let options = PageOptions {
            budget: self.budget,
        };
        let size = write_page(&self.dir, &file, &options).map_err(Failure::from)?;
        print_message(format_args!(
            "page: {} ({} kB)",
            file.display(),
            size.div_ceil(1000)
        ));
        Ok(())
    }
}
