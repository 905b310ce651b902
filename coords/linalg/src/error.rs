//! Why a sparse direct solver fails.

/// Why a sparse factorisation or solve failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinalgError {
    /// A pivot of a Cholesky factorisation was not positive.
    #[error(
        "matrix of order {order} is not positive definite (pivot {index} in elimination order)"
    )]
    NotPositiveDefinite {
        /// Order of the matrix.
        order: usize,
        /// Position of the pivot in elimination order.
        index: usize,
    },
    /// The matrix is singular, structurally or to working precision.
    #[error(
        "matrix of order {order} is singular to working precision (backward error {backward_error:.2e})"
    )]
    Singular {
        /// Order of the matrix.
        order: usize,
        /// Normwise backward error of the attempted solve; infinite if none was finite.
        backward_error: f64,
    },
    /// The pattern is too large or memory ran out.
    #[error("symbolic analysis of a matrix of order {order} failed: {reason}")]
    Symbolic {
        /// Order of the matrix.
        order: usize,
        /// The reason that faer gives.
        reason: String,
    },
}
