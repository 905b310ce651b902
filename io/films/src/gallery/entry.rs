//! One run of a gallery.

use isosheet_runs::Summary;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The folder of the pages and pictures of the runs, in that of the gallery.
pub(super) const RUNS: &str = "runs";

/// A run in a gallery.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GalleryEntry {
    /// The name of its files, made of ASCII letters, digits, `-`, `_` and `.`.
    pub name: String,
    /// The folder of the run, as it was found.
    pub folder: PathBuf,
    /// The name of the run: that of its folder without `-run` at its end.
    pub title: String,
    /// The comment at the top of the scene, up to the first line that ends with a full stop; empty without
    /// one.
    pub caption: String,
    /// Of a run of a sweep, the keys that the runs differ by, with their values in this one.
    #[serde(default)]
    pub values: Vec<(String, String)>,
    /// The time that was reached, seconds.
    pub t: f64,
    /// Number of vertices.
    pub vertices: usize,
    /// What came of the run, if it is complete.
    pub summary: Option<Summary>,
}
