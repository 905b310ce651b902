//! What to know of a run before its results are used.

use super::Summary;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::counted;
use thiserror::Error;

/// A reason why the results of a complete run may not be those of a real sheet.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RunWarning {
    /// The sheet was held where it was, or stopped short.
    #[error(
        "{held} of {} ended without a balance of forces: the rods lock, or no motion was found, and the sheet was held \
         where it was or stopped short", counted(*.steps as usize, "step", "steps")
    )]
    Held {
        /// Steps that ended so.
        held: u64,
        /// All steps.
        steps: u64,
    },
}

impl Advice for RunWarning {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Held { .. } => Some(
                "name what the sheet is made of, `sheet.material`, which makes it elastic; or choose a larger \
                 `method.hold_after`; `method.fallback` refuse divides such steps, and may end with an error",
            ),
        }
    }
}

impl Summary {
    /// What to know before the results are used.
    pub fn warnings(&self) -> Vec<RunWarning> {
        let held = (self.held > 0).then_some(RunWarning::Held {
            held: self.held,
            steps: self.steps,
        });
        held.into_iter().collect()
    }
}
