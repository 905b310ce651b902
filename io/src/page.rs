//! `isosheet page`.

use super::failure::{Done, Failure};
use super::message::print_result;
use super::open::open_page;
use super::write::refuse_other_kind;
use clap::Args;
use isosheet_page::PageOptions;
use isosheet_runs::write_page;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet page cloth-run --open              make the page of a run anew, and open it in a browser
  isosheet page cloth-run -o cloth.html       write it to another file, which can be sent to somebody";

/// Make the 3D page of a run, complete or not
///
/// `isosheet simulate` ends with this page, unless the scene has `output.page = false`.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct Page {
    /// The folder of the run
    dir: PathBuf,
    /// The file to write [default: index.html in the folder of the run]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Largest size of the page: of a run that needs more, fewer frames are kept
    #[arg(long, value_name = "BYTES", default_value_t = PageOptions::default().budget)]
    budget: usize,
    /// Open the page in a browser
    #[arg(long)]
    open: bool,
}

impl Page {
    pub(crate) fn run(&self) -> Done {
        let file = self
            .out
            .clone()
            .unwrap_or_else(|| self.dir.join("index.html"));
        if let Some(out) = &self.out {
            refuse_other_kind(out, &["html", "htm"], "page")?;
        }
        let options = PageOptions {
            budget: self.budget,
        };
        let size = write_page(&self.dir, &file, &options).map_err(Failure::from)?;
        print_result(format_args!(
            "page: {} ({} kB)",
            file.display(),
            size.div_ceil(1000)
        ))?;
        if self.open {
            open_page(&file);
        }
        Ok(())
    }
}
