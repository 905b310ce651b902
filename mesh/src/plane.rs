//! Drawings in the plane and the triangle meshes whose edges follow them.
//!
//! [`PlaneCurve`]s become a [`PlaneGraph`], which meets in its nodes alone, and that becomes a [`PlaneMesh`].

mod chords;
mod curve;
mod error;
mod graph;
mod mesh;
mod near;
mod net;
mod outline;
mod refine;
pub mod vec2;

pub use curve::{EllipticArc, PlaneCurve};
pub use error::{Gap, PlaneError};
pub use graph::{Join, Piece, PlaneGraph};
pub use mesh::{PlaneMesh, PlaneOptions};
pub use near::{gaps, near_pairs};
pub use outline::Role;
