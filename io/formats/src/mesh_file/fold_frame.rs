//! Which frame of a FOLD file is read.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A frame of a FOLD file: its number, from 0, or its title in quotes. Frame 0 is the key frame, which has
/// the keys of the file itself; frame 1 is the first entry of `file_frames`. A title is the `frame_title` of
/// one frame.
///
/// ```toml
/// [sheet.mesh]
/// file = { path = "crane.fold", frame = "flat pattern" }
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "expected the number of a frame of a FOLD file, from 0, or its title in quotes"
)]
pub enum FoldFrame {
    /// The number, from 0.
    Number(usize),
    /// The title.
    Title(String),
}

impl fmt::Display for FoldFrame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Title(title) => write!(f, "{title:?}"),
        }
    }
}
