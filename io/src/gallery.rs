//! `isosheet gallery`.

use super::failure::{Code, Done, Failure};
use super::message::{counted, print_message, print_result};
use super::open::open_page;
use clap::Args;
use isosheet_files::FileError;
use isosheet_films::{Gallery, GalleryError};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isosheet gallery cloth-sweep --open          the runs of a sweep on one page, in a browser
  isosheet gallery . -o cloths                 all runs beneath the current folder, in the folder cloths";

/// Make one page of many runs: pictures, key numbers and links to the pages that play them
///
/// The folder that is written refers to nothing outside of it, so that it can be moved or sent.
#[derive(Debug, Args)]
#[command(before_help = EXAMPLES)]
pub(crate) struct GalleryArgs {
    /// Folders of runs, or folders with runs anywhere beneath them
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The folder to write
    #[arg(short, long, value_name = "DIR", default_value = "gallery")]
    out: PathBuf,
    /// Open the page in a browser
    #[arg(long)]
    open: bool,
}

impl GalleryArgs {
    pub(crate) fn run(&self) -> Done {
        let gallery = Gallery::make(&self.folders, &self.out).map_err(|error| {
            let code = match error {
                GalleryError::Foreign { .. } => Code::OtherScene,
                GalleryError::File(FileError::Write(_)) => Code::Output,
                _ => Code::Input,
            };
            Failure::of(code, &error)
        })?;
        for (folder, reason) in &gallery.left_out {
            print_message(format_args!("left out: {}: {reason}", folder.display()));
        }
        let page = self.out.join("index.html");
        print_result(format_args!(
            "{}: {}",
            page.display(),
            counted(gallery.entries.len(), "run", "runs")
        ))?;
        if self.open {
            open_page(&page);
        }
        Ok(())
    }
}
