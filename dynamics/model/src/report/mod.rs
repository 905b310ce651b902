//! What a step says where it fails, and on its way.

pub(crate) mod contact_error;
pub(crate) mod engine_error;
pub(crate) mod infeasibility;
pub(crate) mod no_equilibrium;
pub(crate) mod potential_fault;
pub(crate) mod pressing;
pub(crate) mod reason;
pub(crate) mod step_error;
pub(crate) mod support;
pub(crate) mod trace;
