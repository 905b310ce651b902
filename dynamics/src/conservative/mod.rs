//! The methods that keep the energy: they solve for the impulses of the rods.

pub(crate) mod constraints;
pub(crate) mod energy_momentum;
mod newton;
pub(crate) mod rattle;
pub(crate) mod saddle;
