//! Why a run cannot go on beyond its end.

use super::summary::EndReason;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::given;
use thiserror::Error;

/// Why a run does not go on until a later time.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ExtensionError {
    /// The time is not finite.
    #[error("that is no time")]
    NotFinite,
    /// It goes as far already.
    #[error("it goes until {time} s already", time = given(*time))]
    Earlier {
        /// The time in its scene, seconds.
        time: f64,
    },
    /// It did not end because its time had passed.
    #[error("it ended because {}", in_words(*reason))]
    Ended {
        /// Why it ended.
        reason: EndReason,
    },
    /// Its last step was shorter than the others, so that a run of the longer time has other steps.
    #[error("its last step was shorter than `method.step`, to end at {time} s", time = given(*time))]
    ShortStep {
        /// The time in its scene, seconds.
        time: f64,
    },
    /// A file that it needs to go on is not there any more.
    #[error("its {file} was deleted")]
    Deleted {
        /// The name of the file.
        file: &'static str,
    },
}

fn in_words(reason: EndReason) -> &'static str {
    match reason {
        EndReason::Time => "its time had passed",
        EndReason::Rest => "the sheet was at rest (`stop.rest`)",
        EndReason::SupportForce => "the force at a support was reached (`stop.support_force`)",
        EndReason::Program | EndReason::Error => "a program took its steps and ended it",
        EndReason::Taut => "the lengths did not allow more (`method.taut`)",
    }
}

impl Advice for ExtensionError {
    fn advice(&self) -> Option<&'static str> {
        Some(match self {
            Self::NotFinite => "give a finite time in seconds",
            Self::Earlier { .. } => "give a later time",
            Self::Ended { .. } => {
                "run the scene without that condition, in a folder of its own: `isosheet simulate SCENE --out DIR`"
            }
            Self::ShortStep { .. } | Self::Deleted { .. } => {
                "run the scene with the later `stop.time`, in a folder of its own: `isosheet simulate SCENE --out DIR`"
            }
        })
    }
}
