//! Sparse direct solvers: thin, non-generic wrappers around faer, and a numerical Cholesky factorisation for
//! the matrices of sheets.
//!
//! Every solver owns its matrix (a fixed [`Pattern`] and its values), analyses the pattern
//! once, and is then refactorised numerically as often as the values change, into buffers
//! that are kept. Entries are addressed by the *slots* that [`Pattern::from_entries`]
//! returns, so assembling is a plain scatter-add.
//!
//! faer's generic code is instantiated only here, which keeps the build of every crate above short. Large
//! Cholesky factorisations are shared among the threads of rayon's current pool, and so are lists that are
//! filled by [`parallel`]; all else runs sequentially. Results do not depend on the number of threads.

mod dense;
mod dense_lu;
mod error;
mod graph;
mod ldlt;
mod llt;
mod lu;
mod multifrontal;
mod nested_dissection;
mod ordering;
pub mod parallel;
mod pattern;
mod separator;
mod symbolic;
#[cfg(test)]
mod testing;

pub use dense_lu::DenseLu;
pub use error::LinalgError;
pub use ldlt::SparseLdlt;
pub use llt::SparseLlt;
pub use lu::SparseLu;
pub use ordering::{Ordering, elimination_order};
pub use pattern::{Pattern, norm_inf};

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
