//! Triangle meshes whose edges are rigid rods: topology, rest data, counts and generators.
//!
//! * [`Topology`]: adjacency of vertices, edges and faces, without coordinates; validates the faces it is
//!   built from.
//! * [`Sheet`]: a topology with rest positions, lengths and areas.
//! * [`LengthConstraints`] and [`MassMatrix`]: what the dynamics needs of the rest shape.
//! * [`Dof`]: degrees of freedom by counting, with the two lemmas.
//! * [`EdgeAngles`], [`check_compatibility`], [`fold_angle`]: angles of any state; [`CreasePattern`]: where
//!   the sheet folds straight.
//! * [`FlatFoldingLaw`]: whether the creases around a vertex fold flat together.
//! * [`Ruling`], [`angle_deficits`], [`GaussCurvature`]: straight lines of a bent sheet, and how far it is
//!   from developable.
//! * [`angle_from_lengths`], [`area_from_lengths`]: triangles from the lengths of their sides.
//! * [`Part`]: one of several sheets in their union.
//! * [`orient_consistently`]: repair on request; [`Opened`]: a mesh that is cut along edges.
//! * [`generate`]: squares, grids and other sheets made by formula; [`origami`]: how some of them fold.
//!
//! Conventions: SI units, radians, `f64`; positions are flat arrays `x0 y0 z0 x1 y1 z1 ...`; faces are
//! counter-clockwise as seen from +z in the flat state.
//!
//! The model is that of Y.-J. Liu, K. Tang and A. Joneja, "Modeling dynamic developable meshes by the
//! Hamilton principle", Computer-Aided Design 39 (2007) 719-731.

mod advice;
mod angle_deficit;
mod angles;
mod area;
mod build;
mod creases;
mod cut;
mod dof;
mod edit;
mod error;
mod flat_vertex;
pub mod generate;
mod ids;
mod lengths;
mod mass;
mod opened;
pub mod origami;

mod part;
pub mod plane;
mod repair;
mod rulings;
mod sheet;
#[cfg(test)]
mod tests;
mod topology;
pub mod vec3;
pub mod wording;

pub use advice::Advice;
pub use angle_deficit::{GaussCurvature, angle_deficits};
pub use angles::{
    AngleError, AngleTriple, COMPATIBILITY_TOLERANCE, EdgeAngles, angle_from_lengths, angle_near,
    check_compatibility, fold_angle,
};
pub use area::area_from_lengths;
pub use creases::{CreaseLine, CreasePattern, FoldingDirection, LineEnds};
pub use cut::FlatCut;
pub use dof::Dof;
pub use error::{MeshError, TopologyError};
pub use flat_vertex::{FlatCrease, FlatFoldingLaw};
pub use ids::{EdgeId, FaceId, HalfEdgeId, VertexId};
pub use lengths::LengthConstraints;
pub use mass::{MassKind, MassMatrix};
pub use opened::Opened;
pub use part::Part;
pub use repair::orient_consistently;
pub use rulings::{Ruling, principal_values};
pub use sheet::Sheet;
pub use topology::Topology;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
