//! Why no step is found: rods that block or depend on each other, supports and bodies that ask for too much.

pub(crate) mod blocked;
pub(crate) mod derivatives;
pub(crate) mod friction_law;
pub(crate) mod infeasibility;
pub(crate) mod potentials;
pub(crate) mod pressing;
pub(crate) mod rank;
