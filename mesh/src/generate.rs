//! Sheets made by formula.

mod error;
mod grid;

pub use error::GenerateError;
pub use grid::{Diagonals, grid, isotropic_square};
