//! Gradients of runs by the discrete adjoint.

mod blocks;
mod error;
mod factor;
mod family;
mod gradient;
mod krylov;
mod loss;
mod memory;
mod options;
mod rows;
mod run;
mod sweep;
mod system;

pub use error::{AdjointError, SceneError};
pub use family::{Family, Plan, Scene};
pub use gradient::{Effort, Gradient, PassedBy};
pub use isosheet_dynamics::sensitivity::OfState;
pub use loss::{Loss, Share, coordinate, squared_distances};
pub use options::{AdjointOptions, Branches, Kept};
pub use run::Run;
