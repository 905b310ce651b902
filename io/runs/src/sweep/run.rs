//! One run of a sweep, and how many there can be.

/// [`Sweep::MOST_RUNS`](super::Sweep::MOST_RUNS), which says why it is this number.
pub(super) const MOST_RUNS: usize = 100_000;

/// One run of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SweepRun {
    /// Its number, from 0.
    pub number: usize,
    /// The name of its folder in that of the sweep: the number with at least three digits.
    pub folder: String,
    /// The value of each key of the sweep, as TOML.
    pub values: Vec<String>,
    /// What the sweep changes in the scene, as `key=value`: the edits that all runs have, and its own.
    pub edits: Vec<String>,
}
