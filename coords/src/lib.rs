//! System coordinates of a developable mesh, after Liu, Tang and Joneja, *Modeling dynamic
//! developable meshes by the Hamilton principle*, Computer-Aided Design 39 (2007) 719-731, Sec. 3.
//!
//! A sheet of V vertices and E rigid edges has n = 3V - E degrees of freedom. *System coordinates* are
//! n numbers from which all positions follow. This crate offers two systems of them behind one
//! trait, [`Chart`]:
//!
//! * [`FrontChart`], the paper's: a front runs over the mesh and places vertex after vertex from one,
//!   two or three known neighbours ([`assignment`], [`placement`], [`FrontMap`]). Placement is exact,
//!   but the condition number grows exponentially with the number of fronts ([`condition_table`]).
//! * [`CartesianChart`]: n Cartesian coordinates of well-chosen vertices. Well conditioned, positions
//!   by Newton's method.
//!
//! Dynamics needs of a chart only its rows `s_k = dq_k/dx`: with the length equations they make the
//! square sparse matrix `A = [G; S]` ([`Linearised`]), and the mass-matrix solve of any chart is one
//! solve with the saddle-point matrix ([`SaddlePoint`]).
//!
//! [`unroll`] assigns the vertices of a developable surface coordinates in the plane: its pattern, cut open
//! where it has to be.
//!
//! States are flat slices of positions, three values per vertex; pinned vertices have no unknowns
//! ([`RodSystem`]). Sparse direct solvers over fixed patterns are in [`linalg`], a crate of its own.
//!
//! ```
//! use isosheet_coords::{BentState, CartesianChart, Chart, Choice, Linearised, RodSystem, StartVertex};
//! use isosheet_coords::{bent_square, sys_coord_assnmt_single};
//! use isosheet_mesh::{VertexId, generate};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let sheet = generate::isotropic_square(2, 1.0)?;
//! // The paper's assignment from a pinned corner: one coordinate per boundary edge is left.
//! let assignment = sys_coord_assnmt_single(&sheet, StartVertex::Pinned(VertexId(0)))?;
//! assert_eq!(assignment.dof(), 32);
//!
//! // A well-conditioned chart at a bent state, and the velocities that belong to rates of its coordinates.
//! let x = bent_square(&sheet, 2, BentState::Cylinder);
//! let system = RodSystem::new(&sheet, &[VertexId(0)])?;
//! let chart = CartesianChart::new(system.clone(), Choice::Auto, &x)?;
//! let mut linear = Linearised::new(&system, chart.pattern())?;
//! chart.linearise(&system, &mut linear, &x)?;
//! let mut v = vec![0.0; system.unknowns()];
//! linear.push(&[1.0; 32], &mut v)?;
//! # Ok(())
//! # }
//! ```

pub mod assignment;
mod cartesian_chart;
mod chart;
#[cfg(test)]
mod chart_tests;
mod condition;
mod frames;
mod front_chart;
mod linearised;
mod newton;
pub mod placement;
mod placement_error;
mod realise;
mod row_pattern;
mod saddle;
mod select;
mod system;
#[cfg(test)]
mod testing;
mod unroll;
mod vec3;

pub use assignment::{
    Assignment, AssignmentOptions, Rule, StartVertex, assign, sys_coord_assnmt_single,
};
pub use cartesian_chart::{CartesianChart, Choice};
pub use chart::{Chart, ChartError};
pub use condition::{
    BentState, ConditionRow, TableChart, bent_square, condition_table, mass_condition,
    mass_condition_estimate, mass_matrix,
};
pub use frames::{EdgeFrame, EulerParameters, SphericalFrame};
pub use front_chart::FrontChart;
pub use linearised::Linearised;
pub use placement::Branch;
pub use placement_error::PlacementError;
pub use realise::{FrontMap, RealiseError, RealiseOptions, RealiseReport};
pub use row_pattern::RowPattern;
pub use saddle::{SaddlePoint, apply_mass};
pub use system::{RodSystem, SystemError};
pub use unroll::{Piece, UnrollError, UnrollOptions, Unrolled, unroll};

/// Sparse direct solvers.
pub use isosheet_linalg as linalg;
/// Dense matrices of the signatures, such as [`Chart::jacobian`]'s.
pub use nalgebra;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
