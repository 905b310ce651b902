//! What simulations tell: errors, and the effort that a step took.

pub(crate) mod checkpoint_error;
pub(crate) mod effort;
pub(crate) mod simulation_error;
pub(crate) mod step_report;
pub(crate) mod totals;
