//! Sheets made by formula.
//!
//! All are flat in the plane z = 0 with faces counter-clockwise as seen from +z, and check their arguments.

mod delaunay;
mod error;
mod grid;
mod octagon;
mod origami;
mod outline;
mod refine;
mod round;

pub use delaunay::{delaunay, delaunay_square};
pub use error::GenerateError;
pub use grid::{
    Diagonals, anisotropic_grid, grid, isotropic_rectangle, isotropic_square, ladder, strip,
};
pub use octagon::{octagon_244, octagon_249};
pub use origami::{FoldAssignment, FoldPattern, degree_four, miura, miura_zigzags};
pub use outline::{polygon_rings, regular_outline};
pub use refine::{refine_isotropic, split_1_4};
pub use round::{annulus, disk, fan, regular_polygon};

#[cfg(test)]
pub(crate) use refine::{FaceSplit, split_faces};
