//! Sparse direct solvers: thin, non-generic wrappers around faer.
//!
//! Every solver owns its matrix (a fixed [`Pattern`] and its values), analyses the pattern
//! once, and is then refactorised numerically as often as the values change, into buffers
//! that are kept. Entries are addressed by the *slots* that [`Pattern::from_entries`]
//! returns, so assembling is a plain scatter-add.
//!
//! faer's generic code is instantiated only here, which keeps the build of every crate
//! above short. Factorisation and solves run sequentially: at all sizes up to 198 147 unknowns two
//! threads inside one factorisation were measured to be slower than one
//! ([`SparseLlt::factorize_on`]), and sequential solves are bitwise reproducible, which
//! those on several threads are not.

mod graph;
mod ldlt;
mod llt;
mod lu;
mod nested_dissection;
mod ordering;
mod pattern;
mod separator;

pub use ldlt::SparseLdlt;
pub use llt::SparseLlt;
pub use lu::SparseLu;
pub use ordering::{Fill, Ordering, delay_multipliers, elimination_order};
pub use pattern::{Pattern, norm_inf};

/// Why a sparse factorisation or solve failed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
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
        "matrix of order {order} is singular to working precision (backward error {backward_error:e})"
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
        /// faer's own words.
        reason: String,
    },
}
