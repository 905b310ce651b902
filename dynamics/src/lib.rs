//! Dynamics of developable meshes.

mod model;
pub mod potential;

pub use model::{ModelError, SheetModel};
pub use potential::{Force, Gravity, HessianSink, Potential, PotentialShape, STANDARD_GRAVITY};
