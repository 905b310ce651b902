//! What was taken up and released in a run.

use super::history::{Row, RowWriter, read_rows};
use isosheet_files::FileError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// What an event is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// A support.
    Support,
    /// A seam.
    Glue,
    /// Contact of a pair.
    Contact,
}

/// What happened to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventChange {
    /// It holds from now on.
    TakenUp,
    /// It holds no more.
    Released,
    /// Some pairs of a seam have torn, and others hold.
    Torn,
}

/// Something that was taken up or released at the end of a step. The field order is the column order of the
/// file.
///
/// ```
/// use isosheet_formats::{EventChange, EventKind, EventRow, EventWriter, read_events};
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("events.csv");
/// let mut events = EventWriter::create(&path)?;
/// let (on, change) = (EventKind::Support, EventChange::Released);
/// let row = EventRow { t: 0.5, on, number: 0, change, pairs: None, force: Some(0.98) };
/// events.append(&row)?;
/// assert_eq!(read_events(&path)?, [row]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventRow {
    /// Time, seconds.
    pub t: f64,
    /// What it is of.
    pub on: EventKind,
    /// Its number in the scene, from 0.
    pub number: usize,
    /// What happened.
    pub change: EventChange,
    /// Of a seam how many pairs are concerned.
    pub pairs: Option<usize>,
    /// The force that a support carried in the step before it was released, or the largest one of a pair of a
    /// seam, newtons.
    pub force: Option<f64>,
}

impl Row for EventRow {
    const COLUMNS: &'static [&'static str] = &["t", "on", "number", "change", "pairs", "force"];

    fn time(&self) -> f64 {
        self.t
    }

    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let force = self.force.map(|force| ("force", force));
        [("t", self.t)].into_iter().chain(force)
    }
}

/// Writes events row by row.
pub type EventWriter = RowWriter<EventRow>;

/// Reads events. A last row that is cut short, as an interrupted run may leave it, is ignored.
///
/// # Errors
/// As [`read_history`](super::read_history).
pub fn read_events(path: &Path) -> Result<Vec<EventRow>, FileError> {
    read_rows(path)
}
