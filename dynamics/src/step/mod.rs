//! What all chart-free methods share of a step: states, proposals, forces of supports and rods, the account
//! of the energy.

pub(crate) mod accepted;
pub(crate) mod energy_account;
pub(crate) mod history;
pub(crate) mod integrator;
pub(crate) mod local_error;
pub(crate) mod motion;
pub(crate) mod reaction;
pub(crate) mod residual_momentum;
pub(crate) mod tuning;
