//! Causes of failed iterations.

use serde::Serialize;
use std::fmt;

/// Cause of a failed iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Reason {
    /// The line search found no decrease of the merit function.
    NoDescent,
    /// The lengths were not restored: the rods are linearly dependent, or nearly so.
    DependentRods,
    /// Contact or the strain limit allows no displacement.
    Blocked,
    /// The number of iterations reached its limit.
    Iterations,
    /// The incremental potential at the minimum exceeds that at the start.
    AboveStart,
    /// The linear algebra failed.
    LinearAlgebra,
    /// Loads that follow the sheet differ from the loads at its place at the end of the step.
    UnsettledLoads,
    /// The watch of the step or the limit of factorisations ended the iteration.
    Ended,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoDescent => "no part of the search direction decreases the merit function",
            Self::DependentRods => "the lengths of nearly dependent rods were not restored",
            Self::Blocked => "contact or the limit of the strain leaves no part of a displacement",
            Self::Iterations => "all iterations were used",
            Self::AboveStart => "the minimum found is above the start of the step",
            Self::LinearAlgebra => "the linear algebra failed",
            Self::UnsettledLoads => "loads that follow the sheet have not settled",
            Self::Ended => "the step was ended",
        })
    }
}
