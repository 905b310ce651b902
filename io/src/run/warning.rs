//! What to know of a run before its results are used.

use super::Summary;
use isosheet_mesh::Advice;
use isosheet_mesh::wording::{brief, counted};
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
    /// The sheet stretched by more than [`Summary::MODELLED_STRAIN`].
    #[error(
        "the sheet stretched by {}: `sheet.isometry` weak and membrane are meant for sheets that stretch by at most {}, \
         and beyond that the result is not that of paper, metal, film or cloth",
        percent(*.strain), percent(Summary::MODELLED_STRAIN)
    )]
    Stretched {
        /// Largest strain of an edge.
        strain: f64,
    },
}

impl Advice for RunWarning {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Held { .. } => Some(
                "choose `sheet.isometry` weak or membrane, or a larger `method.hold_after`; `method.fallback` refuse \
                 divides such steps, and may end with an error",
            ),
            Self::Stretched { .. } => Some(
                "give the sheet the stiffness of its material, `sheet.isometry = { membrane = { stiffness = 3e5 } }` \
                 for office paper, refine the mesh, or take a load away; `history.csv` says at which time the strain \
                 grows",
            ),
        }
    }
}

impl Summary {
    /// The largest strain of an edge that weak isometry and membranes are meant for: a larger one says that
    /// the mesh is too coarse for the bends of the scene, or that a load is carried that stretches the sheet
    /// as no paper, metal or film stretches before it tears or yields.
    pub const MODELLED_STRAIN: f64 = 0.01;

    /// What to know before the results are used.
    pub fn warnings(&self) -> Vec<RunWarning> {
        let held = (self.held > 0).then_some(RunWarning::Held {
            held: self.held,
            steps: self.steps,
        });
        let strain = self.largest_strain;
        let stretched =
            (strain > Self::MODELLED_STRAIN).then_some(RunWarning::Stretched { strain });
        held.into_iter().chain(stretched).collect()
    }
}

fn percent(strain: f64) -> String {
    format!("{} %", brief(100.0 * strain))
}
