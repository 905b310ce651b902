//! The geometry of contact: distances, collision times, candidate pairs, barriers and obstacles.
//!
//! * [`distance`]: squared distances of points, edges and triangles with closest points, gradients
//!   and Hessians; [`ParallelMollifier`] smooths two edges that become parallel.
//! * [`Jet`]: value, gradient and Hessian on a stencil of points, with product and chain rule.
//! * [`CcdOptions`]: how far a motion may go before two primitives touch.
//! * [`BroadPhase`]: pairs of primitives that may meet, of a sheet with itself or with an obstacle; bulk queries over
//!   these pairs, and [`crossings`] as a check that uses none of them.
//! * [`Barrier`] and [`Friction`]: the energies of contact, as functions of these distances.
//! * [`Contacts`]: all of it together, as a step of `isosheet_dynamics` asks for it.
//! * [`Obstacle`]: half-space, box, ball, cylinder, capsule or [`TriangleSurface`], at rest or in a prescribed [`Motion`].
//!
//! Everything is free of absolute tolerances: a sheet of a micrometre and one of a kilometre are
//! treated alike. SI units and `f64` throughout.

mod barrier;
mod broad_phase;
mod ccd;
mod contact_mesh;
mod contacts;
pub mod distance;
mod friction;
mod jet;
mod mollifier;
mod motion;
mod narrow_phase;
mod obstacle;
mod signed_distance;
mod surface;
#[cfg(test)]
mod testing;

pub use barrier::{Barrier, BarrierError};
pub use broad_phase::{BroadPhase, Candidates, CrossCandidates};
pub use ccd::{CcdOptions, CcdOptionsError};
pub use contact_mesh::{ContactMesh, ContactMeshError};
pub use contacts::{Coefficients, ContactOptions, Contacts, ContactsError, Stiffness};
pub use distance::{Closest, Feature};
pub use friction::{Friction, FrictionError, LaggedContact};
pub use jet::Jet;
pub use mollifier::ParallelMollifier;
pub use motion::{Keyframe, Motion, MotionError};
pub use narrow_phase::{Moving, crossings, crossings_between};
pub use obstacle::{ContactGeometry, Obstacle, ObstacleError, Shape};
pub use signed_distance::SignedDistance;
pub use surface::{SurfaceError, TriangleSurface};
