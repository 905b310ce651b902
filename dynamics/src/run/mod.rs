//! Simulations: a sheet and the method that moves it, from start to end.

mod arrays;
mod change;
pub(crate) mod checkpoint;
pub(crate) mod fold_start;
mod held;
pub(crate) mod observe;
pub(crate) mod simulation;
