//! From a scene to a simulation.

pub(crate) mod build;
pub(crate) mod engine_problem;
pub(crate) mod setup;
pub(crate) mod support_forces;
pub(crate) mod warnings;
