//! Steps of a chart-free simulation: who proposes, who decides, who commits.

pub(crate) mod method;
mod outside;
pub(crate) mod rod_forces;
pub(crate) mod subdivision;
pub(crate) mod substeps;

pub use outside::{
    AcceptedSubstep, AdvisedError, Balance, Engine, EngineError, ForceTime, Progress, supports,
};
