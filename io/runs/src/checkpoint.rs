//! The checkpoint of a run: how far it has come, with the checkpoint of its simulation.

use super::RunError;
use super::balance::ForceBalance;
use super::elastic::ElasticSummary;
use super::energy::EnergySummary;
use super::error::BEGIN_ANEW;
use super::incidence::Incidence;
use super::intervention::Intervention;
use super::kept::KeptAngles;
use super::summary::{Ending, Measured};
use super::time_error::TimeError;
use super::vibration::Vibrations;
use crc::{CRC_64_XZ, Crc};
use isosheet_dynamics::Checkpoint;
use isosheet_files::{FileError, input, write_atomically};
use isosheet_formats::Written;
use isosheet_scenes::FollowedFolds;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::io::Write;
use std::path::Path;

/// How far a run has come.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct RunProgress {
    /// Hash of the scene.
    pub(crate) scene: String,
    /// Version of the program that began the run.
    pub(crate) version: String,
    /// The commit that this program was built from, if it said so.
    #[serde(default)]
    pub(crate) commit: Option<String>,
    /// Who takes the steps.
    #[serde(default)]
    pub(crate) steps_by: StepsBy,
    /// Steps taken.
    pub(crate) steps: u64,
    /// What is written of the history.
    pub(crate) history: Written,
    /// What is written of the table of loads; none if nothing can bear a load.
    #[serde(default)]
    pub(crate) loads: Option<Written>,
    /// What is written of the table of measures; none if the scene names none.
    #[serde(default)]
    pub(crate) measures: Option<Written>,
    /// What is written of the table of events; none if all holds at all times.
    #[serde(default)]
    pub(crate) events: Option<Written>,
    /// What a program did between the steps so far that the scene at the beginning did not say.
    #[serde(default)]
    pub(crate) control: Vec<Intervention>,
    /// What the measures showed so far.
    #[serde(default)]
    pub(crate) measured: BTreeMap<String, Measured>,
    /// Number of frames.
    pub(crate) frames: u64,
    /// Wall time of all processes up to here, seconds.
    pub(crate) wall: f64,
    /// Total energy at the start, joules.
    pub(crate) start_energy: f64,
    /// Since when the sheet is at rest, seconds of simulated time.
    pub(crate) slow_since: Option<f64>,
    /// Largest edge strain so far.
    pub(crate) strain: f64,
    /// Largest edge strain so far of each sheet, where there are several.
    #[serde(default)]
    pub(crate) sheet_strains: Vec<f64>,
    /// Largest displacement of a vertex so far, metres.
    pub(crate) displacement: f64,
    /// The angles of creases that are folded to targets, as they were followed so far.
    #[serde(default)]
    pub(crate) folds: Option<FollowedFolds>,
    /// Extremes of the energies so far.
    pub(crate) energy: EnergySummary,
    /// Vibrations so far.
    #[serde(default)]
    pub(crate) vibrations: Vibrations,
    /// The largest estimated error of a step so far.
    #[serde(default)]
    pub(crate) time_error: Option<TimeError>,
    /// What supports left of the balance of forces so far.
    #[serde(default)]
    pub(crate) balance: Option<ForceBalance>,
    /// What they left at the end, if the run has come to one.
    #[serde(default)]
    pub(crate) end_balance: Option<ForceBalance>,
    /// The largest angle of attached flow so far.
    #[serde(default)]
    pub(crate) incidence: Option<Incidence>,
    /// Smallest gap so far, metres.
    pub(crate) gap: Option<f64>,
    /// Newton iterations so far.
    pub(crate) iterations: u64,
    /// Factorisations so far.
    pub(crate) factorisations: u64,
    /// Rejected sub-steps so far.
    pub(crate) rejected: u64,
    /// What an elastic sheet did so far.
    #[serde(default)]
    pub(crate) elastic: Option<ElasticSummary>,
    /// What stays of the angles that have yielded so far.
    #[serde(default)]
    pub(crate) kept: KeptAngles,
    /// How it ended, if it did.
    pub(crate) ending: Option<Ending>,
}

/// Who takes the steps of a run, and so who can continue it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum StepsBy {
    /// The scene says all of it. A recording that has ended, and during which nothing was changed, is such a
    /// run.
    #[default]
    Scene,
    /// A program, which may have been about to change something.
    Program,
}

/// First bytes of the file; the last two are the version of the format.
const MAGIC: &[u8; 8] = b"isorun01";

/// Sum over the file.
const SUM: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// Writes a checkpoint: the eight bytes `isorun01`, the length of the progress (little-endian `u64`), the
/// progress as JSON, the simulation as [`Checkpoint::to_bytes`] has it, and the CRC-64 of all that.
pub(crate) fn write(
    path: &Path,
    progress: &RunProgress,
    simulation: &Checkpoint,
) -> Result<(), RunError> {
    let head = serde_json::to_vec(progress).map_err(|e| damaged(path, e))?;
    let body = simulation.to_bytes().map_err(|e| damaged(path, e))?;
    let mut bytes = Vec::with_capacity(head.len() + body.len() + 24);
    bytes.extend_from_slice(MAGIC);
    bytes.extend((head.len() as u64).to_le_bytes());
    bytes.extend(head);
    bytes.extend(body);
    bytes.extend(SUM.checksum(&bytes).to_le_bytes());
    write_atomically(path, |w| w.write_all(&bytes))?;
    Ok(())
}

/// A checkpoint that cannot be used.
fn damaged(path: &Path, problem: impl Display) -> FileError {
    FileError::content(path, problem, BEGIN_ANEW)
}

/// Reads a checkpoint.
pub(crate) fn read(path: &Path) -> Result<(RunProgress, Checkpoint), RunError> {
    let bytes = input::read(path).map_err(|e| damaged(path, e))?;
    let whole = || -> Option<(&[u8], &[u8])> {
        let (content, sum) = bytes.split_last_chunk::<8>()?;
        if SUM.checksum(content).to_le_bytes() != *sum {
            return None;
        }
        let (length, rest) = content.strip_prefix(MAGIC)?.split_first_chunk::<8>()?;
        rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)
    };
    let (head, body) =
        whole().ok_or_else(|| damaged(path, "it is not a whole checkpoint of this version"))?;
    let progress = serde_json::from_slice(head).map_err(|e| damaged(path, e))?;
    let simulation = Checkpoint::from_bytes(body).map_err(|e| damaged(path, e))?;
    Ok((progress, simulation))
}
