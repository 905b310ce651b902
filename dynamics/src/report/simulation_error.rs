//! Errors of the start of a simulation.

use crate::report::checkpoint_error::CheckpointError;
use isosheet_linalg::LinalgError;
use isosheet_materials::OptionsError;
use isosheet_mesh::Advice;
use isosheet_model::ContactError;
use isosheet_model::EngineError;
use isosheet_model::StepError;

/// Errors of the start of a simulation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] OptionsError),
    /// The state does not have three values per vertex of the model.
    #[error(
        "the state has {positions} position and {velocities} velocity values, the sheet needs \
         {expected} of each"
    )]
    StateLength {
        /// Number of position values.
        positions: usize,
        /// Number of velocity values.
        velocities: usize,
        /// Three per vertex.
        expected: usize,
    },
    /// The start state is invalid.
    #[error(transparent)]
    Start(#[from] StepError),
    /// Linear algebra failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// An [engine](crate::engine::Engine) from outside cannot start.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The start state is in contact, or the method does not support contact.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Conservative methods do not support one-sided constraints.
    #[error(
        "vertex constraint {index} is one-sided, which the conservative methods have no place for \
         (an impact loses energy)"
    )]
    OneSided {
        /// Index in the order of addition.
        index: usize,
    },
    /// The method does not support elastic sheets.
    #[error("the sheet has no rigid rods (it is elastic), and the method needs them")]
    Elastic,
    /// The method does not support plastic deformations.
    #[error(
        "the sheet yields (its bends or creases stay), and the method has no place for what yielding loses"
    )]
    Plastic,
    /// A force of the sheet acts in steps that minimise alone, such as that of attached flow.
    #[error("a force of the sheet, such as attached flow, acts in steps that minimise alone")]
    NeedsMinimising,
    /// The method has no estimate of its error, and an accuracy was asked for.
    #[error("an accuracy is asked for, and the method does not estimate the errors of its steps")]
    Accuracy,
    /// The checkpoint is invalid or of another model.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The method has no place for supports that come and go.
    #[error(
        "supports, glue and contacts change during the simulation, and the method has no place for what that \
         loses"
    )]
    Held,
    /// Charts do not use [`StepControl`](crate::StepControl).
    #[error("a simulation in a chart controls its steps by `ChartOptions::control`")]
    ChartControl,
}

impl Advice for SimulationError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Options(error) => error.advice(),
            Self::Start(error) => error.advice(),
            Self::Engine(error) => error.advice(),
            Self::Contact(error) => error.advice(),
            Self::OneSided { .. } => Some("use BDF2, implicit Euler or projection"),
            Self::Elastic | Self::Plastic | Self::NeedsMinimising | Self::Held | Self::Accuracy => {
                Some("use BDF2 or implicit Euler")
            }
            Self::Checkpoint(error) => error.advice(),
            Self::ChartControl => Some("leave `StepControl` out"),
            Self::StateLength { .. } | Self::Linalg(..) => None,
        }
    }
}
