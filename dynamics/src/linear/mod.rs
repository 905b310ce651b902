//! The matrices of a step, how they are laid out, and solvers for the multipliers of rods.

pub(crate) mod constrained;
pub(crate) mod constraint_rows;
#[cfg(test)]
mod derivative_tests;
pub(crate) mod free;
pub(crate) mod layout;
pub(crate) mod primal;
pub(crate) mod rod_least_squares;
pub(crate) mod shares;
