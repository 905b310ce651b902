//! Distances and continuous collision detection of triangle meshes and simple shapes, for whatever moves.
//!
//! * [`CcdOptions`]: how far a motion may go before a point meets a triangle, or an edge an edge. It never
//!   misses.
//! * [`RigidPath`]: the same of points that meet a rigid body which moves and turns, on the true curved path.
//! * [`distance`]: squared distances of points, edges and triangles with closest points, gradients and
//!   Hessians.
//! * [`BroadPhase`]: the pairs of primitives that may meet during a motion, of a [`ContactMesh`] with itself
//!   or with another one; [`Candidates::safe_part`] says how far all of them may go.
//! * [`Shape`]: half-space, box, ball, cylinder, capsule or [`TriangleSurface`], with [`SignedDistance`]s,
//!   their gradients and their second derivatives.
//! * [`crossings()`]: edges that pass through faces, as a check without a tree or a distance.
//!
//! No mechanics: [`isosheet-collide`](https://docs.rs/isosheet-collide) makes contact of this.
//!
//! # Two edges, a point and a triangle
//!
//! A motion is given by positions and displacements, along which the points go on straight lines. The answer
//! is a time from 0 to 1 up to which they stay apart, a little before they meet:
//!
//! ```
//! use isosheet_geometry::CcdOptions;
//! use isosheet_geometry::nalgebra::{Vector3, vector};
//!
//! let options = CcdOptions::default();
//! let rest = Vector3::zeros();
//!
//! // A point two metres above a triangle falls by four: it may take nearly half of the way.
//! let triangle = [vector![-1.0, -1.0, 0.0], vector![1.0, -1.0, 0.0], vector![0.0, 1.0, 0.0]];
//! let x = [vector![0.0, 0.0, 2.0], triangle[0], triangle[1], triangle[2]];
//! let dx = [vector![0.0, 0.0, -4.0], rest, rest, rest];
//! let time = options.point_triangle(&x, &dx, 1.0);
//! assert!((0.44..0.5).contains(&time));
//!
//! // Two edges that cross as seen from above, a tenth of a metre apart; the upper one falls and turns.
//! let x = [
//!     vector![-1.0, 0.0, 0.1], vector![1.0, 0.0, 0.1],
//!     vector![0.0, -1.0, 0.0], vector![0.0, 1.0, 0.0],
//! ];
//! let dx = [vector![0.0, 0.0, -0.5], vector![0.0, 0.3, -0.3], rest, rest];
//! let time = options.edge_edge(&x, &dx, 1.0);
//! assert!((0.2..0.25).contains(&time));
//! ```
//!
//! # A ball that is cast at a mesh
//!
//! A radius is a distance that has to remain:
//!
//! ```
//! use isosheet_geometry::CcdOptions;
//! use isosheet_geometry::nalgebra::{Vector3, vector};
//! use isosheet_mesh::generate;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A square of one metre in the plane z = 0.
//! let mesh = generate::isotropic_square(2, 1.0)?;
//! let radius = 0.1;
//! let options = CcdOptions { separation: radius, ..CcdOptions::default() };
//! let (centre, way) = (vector![0.3, 0.4, 1.0], vector![0.1, 0.0, -100.0]);
//! let rest = Vector3::zeros();
//! let time = mesh.topology().faces().iter().fold(1.0, |time, face| {
//!     let [a, b, c] = face.map(|v| Vector3::from(mesh.position(v)));
//!     options.point_triangle(&[centre, a, b, c], &[way, rest, rest, rest], time)
//! });
//! // It would touch after 0.9 m; a tenth of the gap is left, or a little more.
//! let height = (centre + time * way).z;
//! assert!(height > radius && height < 0.2);
//! # Ok(())
//! # }
//! ```
//!
//! # A mesh that is thrown about
//!
//! ```
//! use isosheet_geometry::{BroadPhase, Candidates, CcdOptions, ContactMesh, MeshMotion, crossings};
//! use isosheet_mesh::generate;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let sheet = generate::isotropic_square(2, 1.0)?;
//! let mesh = ContactMesh::from_topology(sheet.topology());
//! let x = sheet.positions();
//! // Every vertex is thrown somewhere else, and the mesh would pass through itself.
//! let dx: Vec<f64> = (0..x.len()).map(|k| 0.5 * (13.7 * (k * k) as f64).sin()).collect();
//! let goal: Vec<f64> = x.iter().zip(&dx).map(|(x, dx)| x + dx).collect();
//! assert!(!crossings(&mesh, &goal).is_empty());
//!
//! let mut boxes = BroadPhase::new(mesh.clone(), x);
//! boxes.update(x, &goal, 0.0);
//! let mut pairs = Candidates::default();
//! boxes.self_candidates(&mut pairs);
//! let motion = MeshMotion { mesh: &mesh, x, dx: &dx };
//! let part = pairs.safe_part(&CcdOptions::default(), motion);
//! let stopped: Vec<f64> = x.iter().zip(&dx).map(|(x, dx)| x + part * dx).collect();
//! assert!(part > 0.0 && part < 1.0);
//! assert!(crossings(&mesh, &stopped).is_empty());
//! # Ok(())
//! # }
//! ```
//!
//! # What is guaranteed
//!
//! What moves up to the time that is returned stays further apart than the separation at all times until
//! then, in floating point and for every input: there are no false negatives. Nothing is solved for, so that
//! there is no root to lose. Each advance is a time for which a plane between the two primitives stays clear,
//! whatever plane that is, and the round-off of it is taken off. Where two primitives touch to begin with the
//! time is 0, and so it is where a coordinate is not a number.
//!
//! What comes closer than the gap that a motion is to leave ([`CcdOptions::remainder`], by default a tenth of
//! the first gap) is stopped there, also if it would pass; what does not gets the whole motion, unless
//! [`CcdOptions::max_iterations`] ends the search early.
//!
//! The tests decide exactly, with rational numbers and isolated roots of polynomials, whether and when
//! primitives meet in 4200 random motions, most of them degenerate: no collision is missed. Others have
//! grazing motions, double roots, edges that turn into each other and motions over a thousand times the size
//! of the primitives, in sizes from a micrometre to a kilometre.
//!
//! # Conventions
//!
//! SI units (metres, radians) and `f64` throughout; nothing depends on the unit, as there are no absolute
//! tolerances. Positions are lists of three coordinates for each vertex, or points. Faces are
//! counter-clockwise as seen from outside. Distances from solids are negative inside, with the outward normal
//! as gradient. Of two primitives the difference runs from the second to the first. Results do not depend on
//! the number of threads, as there is one.

mod broad_phase;
mod candidates;
mod ccd;
mod contact_mesh;
mod crossings;
pub mod distance;
mod rigid_path;
mod shapes;
mod signed_distance;
#[cfg(test)]
mod testing;
pub mod vectors;

pub use broad_phase::BroadPhase;
pub use candidates::{Candidates, CrossCandidates, MeshMotion};
pub use ccd::{CcdOptions, CcdOptionsError};
pub use contact_mesh::{ContactMesh, ContactMeshError};
pub use crossings::{crossings, crossings_between, pierces};
pub use distance::{Closest, Feature, Jet};
pub use nalgebra;
pub use rigid_path::{PointCourse, RigidPath};
pub use shapes::{
    ContactGeometry, Form, Moments, Shape, ShapeError, Skin, SurfaceError, Symmetry,
    TriangleSurface, Triangles, rounded_line,
};
pub use signed_distance::SignedDistance;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
