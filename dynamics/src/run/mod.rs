//! Simulations: a sheet and the method that moves it, from start to end.

pub(crate) mod checkpoint;
pub(crate) mod observe;
pub(crate) mod simulation;
