//! Sheets made by formula.
//!
//! All but [`strip_between`] are flat in the plane z = 0 with faces counter-clockwise as seen from +z. All
//! check their arguments.

mod delaunay;
mod error;
mod grid;
mod hypar;
mod kresling;
mod octagon;
mod origami;
mod outline;
mod refine;
mod round;
mod space_curve;
mod square_twist;
mod strip_between;
mod waterbomb;
mod yoshimura;

pub use delaunay::{delaunay, delaunay_square};
pub use error::GenerateError;
pub use grid::{Diagonals, anisotropic_grid, grid, isotropic_square, ladder, strip};
pub use hypar::hypar;
pub use kresling::kresling;
pub use octagon::octagon_244;
pub use origami::{FoldAssignment, FoldPattern, degree_four, miura, miura_zigzags};
pub use outline::{polygon_rings, regular_outline};
pub use refine::{refine_isotropic, split_1_4};
pub use round::{annulus, disk, fan};
pub use square_twist::square_twist;
pub use strip_between::{RuledStrip, strip_between};
pub use waterbomb::waterbomb;
pub use yoshimura::yoshimura;

#[cfg(test)]
pub(crate) use refine::{FaceSplit, split_faces};
