//! The geometry of contact: distances, collision times, candidate pairs, barriers and obstacles.
//!
//! * [`distance`]: squared distances of points, edges and triangles with closest points, gradients
//!   and Hessians; [`ParallelMollifier`] smooths two edges that become parallel.
//! * [`Jet`]: value, gradient and Hessian on a stencil of points, with product and chain rule.
//! * [`CcdOptions`]: how far a motion may go before two primitives touch.
//! * [`BroadPhase`]: pairs of primitives that may meet, of a sheet with itself or with an obstacle.
//! * [`Barrier`] and [`Friction`]: the energies of contact, as functions of these distances.
//!
//! Everything is free of absolute tolerances: a sheet of a micrometre and one of a kilometre are
//! treated alike. SI units and `f64` throughout.

mod barrier;
mod broad_phase;
mod ccd;
mod contact_mesh;
pub mod distance;
mod friction;
mod jet;
mod mollifier;
#[cfg(test)]
mod testing;

pub use barrier::{Barrier, BarrierError};
pub use broad_phase::{BroadPhase, Candidates, CrossCandidates};
pub use ccd::{CcdOptions, CcdOptionsError};
pub use contact_mesh::{ContactMesh, ContactMeshError};
pub use distance::{Closest, Feature};
pub use friction::{Friction, FrictionError, LaggedContact};
pub use jet::Jet;
pub use mollifier::ParallelMollifier;
