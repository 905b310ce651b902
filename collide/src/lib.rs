//! The geometry of contact: distances, collision times, candidate pairs and obstacles.
//!
//! * [`distance`]: squared distances of points, edges and triangles with closest points, gradients
//!   and Hessians.
//! * [`CcdOptions`]: how far a motion may go before two primitives touch.
//! * [`BroadPhase`]: pairs of primitives that may meet, of a sheet with itself or with an obstacle.
//! * [`crossings`]: edges that pass through faces, as a check without a tree or a distance.
//! * [`Contacts`]: all of it together, as a step of [`isosheet_dynamics::contact`] asks for it, where barrier
//!   and friction are functions of these distances.
//! * [`Obstacle`]: half-space, box, ball, cylinder, capsule or [`TriangleSurface`], at rest or in a
//!   prescribed [`RigidMotion`]; [`Obstacle::constraint`] constrains a vertex to one.
//! * [`BodyMesh`]: a shape as triangles, for pictures and files.
//!
//! A sheet falls on a table and rests with every gap open:
//!
//! ```
//! use isosheet_collide::{Coefficients, Contacts, Obstacle, Shape};
//! use isosheet_dynamics::{Method, SheetModel, Simulation, State};
//! use isosheet_mesh::{MassKind, generate};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let sheet = generate::isotropic_square(1, 1.0)?;
//! let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?.with_gravity();
//! let table = Obstacle::at(Shape::Cuboid { half: [0.25, 0.25, 0.1] }, [0.5, 0.5, -0.101])?;
//! let contacts = Contacts::for_sheet(&model, [table], Coefficients::equal(0.3))?;
//! let start = State::at_rest(sheet.positions().to_vec());
//! let mut simulation = Simulation::new(model, start, Method::default())?.with_contact(contacts)?;
//! for _ in 0..30 {
//!     let report = simulation.step(1.0 / 60.0)?;
//!     assert!(report.gap.is_some_and(|gap| gap > 0.0));
//! }
//! // It hangs over the edges; the table carries part of its weight.
//! assert!(simulation.obstacle_forces()[0][2] < 0.0);
//! # Ok(())
//! # }
//! ```
//!
//! Everything is free of absolute tolerances: a sheet of a micrometre and one of a kilometre are
//! treated alike. SI units and `f64` throughout.

mod body_mesh;
mod broad_phase;
mod ccd;
mod constraint;
mod contact_mesh;
mod contacts;
mod crossings;
pub mod distance;
mod obstacle;
mod signed_distance;
mod surface;
#[cfg(test)]
mod testing;
mod vectors;

pub use body_mesh::BodyMesh;
pub use broad_phase::{BroadPhase, Candidates, CrossCandidates};
pub use ccd::{CcdOptions, CcdOptionsError};
pub use contact_mesh::{ContactMesh, ContactMeshError};
pub use contacts::{ContactOptions, Contacts, ContactsError, RoundBody};
pub use crossings::{crossings, crossings_between};
pub use distance::{Closest, Feature, Jet};
pub use isosheet_dynamics::contact::{Coefficients, FrictionError, Stiffness};
pub use nalgebra;
pub use obstacle::{ContactGeometry, Obstacle, ObstacleError, Shape};
pub use signed_distance::SignedDistance;
pub use surface::{SurfaceError, TriangleSurface, rounded_line};

#[doc(no_inline)]
pub use isosheet_dynamics::{Keyframe, MotionError, RigidMotion};

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
