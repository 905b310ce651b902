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

mod error;
mod graph;
mod ldlt;
mod llt;
mod lu;
mod nested_dissection;
mod ordering;
mod pattern;
mod separator;
mod symbolic;
mod triangular;

pub use error::LinalgError;
pub use ldlt::SparseLdlt;
pub use llt::SparseLlt;
pub use lu::SparseLu;
pub use ordering::{Fill, Ordering, delay_multipliers, elimination_order};
pub use pattern::{Pattern, norm_inf};
