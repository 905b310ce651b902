//! What steps tell: reports, errors, traces, and the effort that they took.

pub(crate) mod checkpoint_error;
pub(crate) mod contact_error;
pub(crate) mod effort;
pub(crate) mod engine_error;
pub(crate) mod infeasibility;
pub(crate) mod potential_fault;
pub(crate) mod pressing;
pub(crate) mod reason;
pub(crate) mod simulation_error;
pub(crate) mod step_error;
pub(crate) mod support;
pub(crate) mod trace;
