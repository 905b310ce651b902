//! Why an iteration found no step.

use serde::Serialize;
use std::fmt;

/// Why an iteration ended without a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// No part of the search direction decreases the merit function.
    NoDescent,
    /// The rods depend on each other, or nearly so: the lengths could not be restored.
    DependentRods,
    /// Contact or the limit of the strain leaves no part of a displacement.
    Blocked,
    /// All iterations were used.
    Iterations,
    /// The minimum that was found has a higher incremental potential than the start of the step.
    AboveStart,
    /// The linear algebra failed.
    LinearAlgebra,
    /// The watch of the step, or its bound of factorisations, ended the iteration.
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
            Self::Ended => "the step was ended",
        })
    }
}
