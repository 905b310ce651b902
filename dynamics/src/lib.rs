//! Dynamics of developable meshes after Liu, Tang and Joneja, *Modeling dynamic developable meshes by the
//! Hamilton principle*, Computer-Aided Design 39 (2007) 719-731, Secs. 2, 4 and 5.
//!
//! A [`SheetModel`] has rods or an elastic sheet, masses, supports, potentials, forces and damping. A
//! [`Simulation`] advances it in time, with a [`StepReport`] for each step.
//!
//! | method | order | energy | takes flat states | solve |
//! |---|---|---|---|---|
//! | [`Method::Bdf2`] (default) | 2 | lightly damped | yes | Cholesky, `3V` unknowns |
//! | [`Method::ImplicitEuler`] | 1 | strongly damped | yes | Cholesky, `3V` unknowns |
//! | [`Method::EnergyMomentum`] | 2 | conserved | unloaded ones | LU, `3V + E` unknowns |
//! | [`Method::Rattle`] | 2 | bounded error | unloaded ones | LU, `3V + E` unknowns |
//! | [`Method::RattleComposition`] | 4 | bounded error | unloaded ones | LU, `3V + E` unknowns |
//!
//! The paper's own scheme, in system coordinates, is an [engine](engine::Engine) from outside, in the crate
//! `isosheet-charts`.
//!
//! # Singular states
//!
//! In a flat state one length constraint per interior vertex is linearly dependent, and the paper's system
//! coordinates do not exist. The damped methods minimise an incremental potential, which has a solution at
//! any rank of the constraints. The steps of the conservative methods shrink near singular states, and loaded
//! flat states are refused with [`StepError::RankDeficient`]: start from a folded state, displace the sheet
//! with [`leave_flat`], or allow a [`Fallback`].
//!
//! An accepted step has the rest lengths to the tolerance of its method (by default a relative 1e-12, or the
//! round-off of the coordinates) and finite energies. With a damped method or the fallback a step gains at
//! most a tenth of the kinetic energy, and all steps together a fiftieth of the largest kinetic energy.
//!
//! # Isometry
//!
//! The edges are rigid rods by default ([`Isometry`]). An elastic sheet ([`SheetModel::with_elastic_sheet`];
//! BDF2 and implicit Euler) stretches up to a strain limit, and bends along any line. [`StepReport::strain`]
//! is the strain of the edges, [`StepReport::constrained_strain`] the one below the tolerance of the method.
//!
//! # Limits
//!
//! Vertices that supports at rest hold in place become pins where this is detected
//! ([`Simulation::immobile_vertices`]); other taut states are reached to the square root of round-off. A
//! sheet of rods that is clamped flat along anything but a line of edges locks ([`StepError::Locked`]): use
//! an elastic sheet. [`SheetModel::clamps_across_the_mesh`] finds such clamps. Conservative runs on fine,
//! nearly flat sheets are slow.
//!
//! # Conventions
//!
//! SI units; positions, velocities and forces are slices of length `3V`; gravity acts along -z. Length
//! constraints are `c_e = (|x_a - x_b|^2 - l_e^2) / 2` with Jacobian `G`; positive rod multipliers are
//! tensions in BDF2 and implicit Euler.
//!
//! # Contact and supports
//!
//! [`Simulation::with_contact`] takes a [`contact::Contact`], a barrier potential, for BDF2 and implicit
//! Euler. Supports are pins, moving pins
//! ([`SheetModel::with_moving_pin`]), and curves and surfaces ([`SheetModel::with_constraint`]; one-sided
//! ones for the damped methods only). Their forces are [`Simulation::reactions`].

mod conservative;
pub mod contact;
mod damped;
mod diagnosis;
pub mod engine;
mod linear;
mod objective;
mod report;
mod run;
pub mod sensitivity;
mod step;

pub use conservative::energy_momentum::EnergyMomentumOptions;
pub use conservative::rattle::RattleOptions;
pub use damped::options::ImplicitOptions;
pub use damped::start::{leave_flat, leave_flat_in, project_positions};
pub use diagnosis::derivatives::{DerivativeErrors, check_derivatives};
pub use diagnosis::friction_law::check_friction_law;
pub use diagnosis::rank::{RodRank, rod_rank};
pub use engine::method::{Fallback, Method, StepControl, Unsatisfiable};
pub use isosheet_materials::*;
pub use isosheet_model::{
    AccelerationField, Air, AirError, Attachment, BadPotential, BodyForce, BodyTorque,
    ClampAcrossMesh, Continuation, Cut, Driver, EdgeMoment, ElasticDeformation, EnclosedGas, Gas,
    GasError, GasState, Hand, HandError, Infeasibility, Isometry, JointCoordinate, JointError,
    JointSpring, LoadError, LoadedFaces, LoadedFacesError, ModelError, NoEquilibrium,
    PotentialFault, PotentialOfPart, Pressing, Reason, RigidBody, RigidBodyError, SheetModel,
    SheetOfMaterial, SheetOfMaterialError, Solid, SolidError, State, StepError, Support,
    TraceEvent, TurningLoad, VertexConstraint, VertexLoad, Wind, constraint, immobile_vertices,
    term,
};
pub use isosheet_motion::*;
pub use report::checkpoint_error::CheckpointError;
pub use report::effort::StepProgress;
pub use report::simulation_error::SimulationError;
pub use report::step_report::{StepOutcome, StepReport};
pub use run::checkpoint::Checkpoint;
pub use run::fold_start::start_of_folding;
pub use run::observe::{Frames, History, Observer, RunEnd};
pub use run::simulation::Simulation;
pub use step::reaction::{Imbalance, Reaction};
#[doc(hidden)]
pub use step::tuning::Tuning;

pub use nalgebra;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
