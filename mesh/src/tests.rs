//! What the tests of this crate share.

pub(crate) mod flat_folding;
mod invariants;
pub(crate) mod surfaces;
