//! The layers of a sheet that is folded flat, as a drawing.

use super::failure::{Code, Done, Failure};
use super::message::counted;
use super::pictures::input;
use super::write::to_stdout;
use isosheet_files::write_atomically;
use isosheet_runs::{Layers, Recording};
use std::io::Write;
use std::path::Path;

/// Draws the layers of a run, and says how many there are.
pub(super) fn write(recording: &Recording, path: &Path) -> Done {
    let layers = Layers::of(recording).map_err(|e| input(&e))?;
    let drawing = layers.drawing(recording);
    let written = write_atomically(path, |w| w.write_all(drawing.as_bytes()));
    written.map_err(|e| Failure::of(Code::Output, &e))?;
    to_stdout(&format!(
        "{}: {} in {}, the lowest one below\n",
        path.display(),
        counted(layers.levels.len(), "panel", "panels"),
        counted(layers.count(), "layer", "layers")
    ))
}
