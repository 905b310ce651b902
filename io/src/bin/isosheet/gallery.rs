//! `isosheet gallery`.

use crate::Done;
use crate::exit::{Code, Failure};
use crate::message::{counted, print_message};
use clap::Args;
use isosheet_io::run::{Gallery, GalleryError};
use std::path::PathBuf;

/// Make one page of many runs: pictures, key numbers and links to the pages that play them
///
/// The folder that is written refers to nothing outside of it, so that it can be moved or sent.
#[derive(Debug, Args)]
pub(crate) struct GalleryArgs {
    /// Folders of runs, or folders with runs anywhere beneath them
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The folder to write
    #[arg(long, value_name = "DIR", default_value = "gallery")]
    out: PathBuf,
}

impl GalleryArgs {
    pub(crate) fn run(&self) -> Done {
        let gallery = Gallery::make(&self.folders, &self.out).map_err(|error| {
            let code = match error {
                GalleryError::Foreign { .. } => Code::OtherScene,
                GalleryError::Write(_) => Code::Output,
                _ => Code::Input,
            };
            Failure::of(code, &error)
        })?;
        for (folder, reason) in &gallery.left_out {
            print_message(format_args!("left out: {}: {reason}", folder.display()));
        }
        print_message(format_args!(
            "{}: {}",
            self.out.join("index.html").display(),
            counted(gallery.entries.len(), "run", "runs")
        ));
        Ok(())
    }
}
