//! One step of a chart-free method: who proposes, who decides, who commits.

pub(crate) mod blocked;
pub(crate) mod checkpoint_error;
pub(crate) mod control;
pub(crate) mod effort;
pub(crate) mod energy_account;
pub(crate) mod engine;
pub(crate) mod history;
pub(crate) mod infeasibility;
pub(crate) mod integrator;
pub(crate) mod method;
pub(crate) mod motion;
pub(crate) mod pressing;
pub(crate) mod reaction;
pub(crate) mod reason;
pub(crate) mod report;
pub(crate) mod rod_forces;
pub(crate) mod simulation_error;
pub(crate) mod subdivision;
pub(crate) mod trace;
pub(crate) mod tuning;
