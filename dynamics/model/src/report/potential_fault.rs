//! What is wrong with a potential.

use isosheet_mesh::Advice;
use isosheet_mesh::wording::brief;

/// A potential that cannot be used, and why.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("potential {index} (`{name}`) cannot be used: {fault}")]
pub struct BadPotential {
    /// Index in the order of addition, an elastic sheet last.
    pub index: usize,
    /// Its type, as [`Debug`](std::fmt::Debug) names it.
    pub name: String,
    /// What is wrong.
    pub fault: PotentialFault,
}

/// What is wrong with a potential.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PotentialFault {
    /// An energy or a derivative is not finite.
    #[error("its {quantity} is {value}", value = brief(*value))]
    NotFinite {
        /// Which of them.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// The Hessian has a block for which the matrix of a step has no place.
    #[error("its Hessian has a block of {block}, which it does not name or the sheet has not")]
    Block {
        /// The block, in words.
        block: String,
    },
    /// The gradient is not the derivative of the energy.
    #[error("its gradient differs from the derivative of its energy by the part {part}", part = brief(*part))]
    Gradient {
        /// The difference, as a part of the gradient.
        part: f64,
    },
}

impl PotentialFault {
    /// Whether it is of the Hessian alone.
    pub fn is_of_hessian(&self) -> bool {
        match self {
            Self::NotFinite { quantity, .. } => *quantity == "Hessian",
            Self::Block { .. } => true,
            Self::Gradient { .. } => false,
        }
    }
}

impl Advice for BadPotential {
    fn advice(&self) -> Option<&'static str> {
        Some(match self.fault {
            PotentialFault::NotFinite { .. } => {
                "check the potential at the positions where the step begins"
            }
            PotentialFault::Block { .. } => {
                "take vertices and edges of the sheet, and name all pairs without a common edge in `Potential::couplings`, or leave the block out, which costs iterations"
            }
            PotentialFault::Gradient { .. } => {
                "compare the derivatives of the potential with differences by `check_derivatives`"
            }
        })
    }
}
