//! Triangle meshes whose edges are rigid rods: topology, rest data, counts and generators.
//!
//! * [`Topology`]: who meets whom, without coordinates; validates what it is built from.
//! * [`Sheet`]: a topology with rest positions, lengths and areas.
//! * [`LengthConstraints`] and [`MassMatrix`]: what the dynamics needs of the rest shape.
//! * [`generate`]: squares, grids and other sheets made by formula.
//!
//! Conventions: SI units, radians, `f64`; positions are flat arrays `x0 y0 z0 x1 y1 z1 ...`; faces are
//! counter-clockwise as seen from +z in the flat state.
//!
//! The model is that of Y.-J. Liu, K. Tang and A. Joneja, "Modeling dynamic developable meshes by the Hamilton principle",
//! Computer-Aided Design 39 (2007) 719-731.

mod build;
mod error;
pub mod generate;
mod ids;
mod lengths;
mod mass;
mod sheet;
mod topology;
mod vec3;

pub use error::{MeshError, TopologyError};
pub use ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
pub use lengths::LengthConstraints;
pub use mass::{MassKind, MassMatrix};
pub use sheet::Sheet;
pub use topology::Topology;
