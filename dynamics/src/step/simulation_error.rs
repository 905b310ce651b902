//! Why a simulation cannot start.

use crate::chart::ChartDynamicsError;
use crate::contact::ContactError;
use crate::options::OptionsError;
use crate::step::checkpoint_error::CheckpointError;
use crate::step::report::StepError;
use isosheet_coords::linalg::LinalgError;
use isosheet_mesh::Advice;

/// Why a simulation cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// An option makes no sense.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The state does not fit the model.
    #[error(
        "the state has {positions} position and {velocities} velocity values, the sheet needs \
         {expected} of each"
    )]
    StateLength {
        /// Number of position values.
        positions: usize,
        /// Number of velocity values.
        velocities: usize,
        /// Three for each vertex.
        expected: usize,
    },
    /// The start state is not one that a step could start from.
    #[error(transparent)]
    Start(#[from] StepError),
    /// The linear algebra could not be set up.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The chart cannot be used.
    #[error(transparent)]
    Chart(#[from] ChartDynamicsError),
    /// Contact cannot start here.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A one-sided constraint is in a scene of a conservative method.
    #[error(
        "vertex constraint {index} is one-sided, which the conservative methods have no place for \
         (an impact loses energy)"
    )]
    OneSided {
        /// Place in the order in which the constraints were added.
        index: usize,
    },
    /// An elastic sheet is in a scene of a method that needs rods.
    #[error("the sheet has no rigid rods (it is elastic), and the method needs them")]
    Elastic,
    /// The checkpoint does not belong to the model or cannot be resumed this way.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Step control by subdivision was asked for a chart, which has its own.
    #[error("a simulation in a chart controls its steps by `ChartOptions::control`")]
    ChartControl,
}

impl Advice for SimulationError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Options(error) => error.advice(),
            Self::Start(error) => error.advice(),
            Self::Linalg(error) => error.advice(),
            Self::Chart(error) => error.advice(),
            Self::Contact(error) => error.advice(),
            Self::OneSided { .. } => Some("use BDF2, implicit Euler or projection"),
            Self::Elastic => Some("use BDF2 or implicit Euler"),
            Self::Checkpoint(error) => error.advice(),
            Self::ChartControl => Some("leave `StepControl` out"),
            Self::StateLength { .. } => None,
        }
    }
}
