//! Dynamics of developable meshes: sheets of rigid rods moved by Hamilton's principle, after Liu,
//! Tang and Joneja, *Modeling dynamic developable meshes by the Hamilton principle*,
//! Computer-Aided Design 39 (2007) 719-731, Secs. 2, 4 and 5.
//!
//! A [`SheetModel`] says what moves: rods, masses, pins, potentials, forces, damping. A
//! [`Simulation`] moves it and reports on every step ([`StepReport`]).
//!
//! | method | order | energy | takes flat states | solve |
//! |---|---|---|---|---|
//! | [`Method::Bdf2`] (default) | 2 | lightly damped | yes | Cholesky, `3V` unknowns |
//! | [`Method::ImplicitEuler`] | 1 | strongly damped | yes | Cholesky, `3V` unknowns |
//! | [`Method::Projection`] | 1 | strongly damped | yes | Cholesky, `3V` unknowns |
//! | [`Method::EnergyMomentum`] | 2 | conserved | unloaded ones | LU, `3V + E` unknowns |
//! | [`Method::Rattle`] | 2 | bounded error | unloaded ones | LU, `3V + E` unknowns |
//! | [`Method::RattleComposition`] | 4 | bounded error | unloaded ones | LU, `3V + E` unknowns |
//! | [`Simulation::in_chart`]: the paper's scheme and relatives | 1 or 4 | | no | see [`chart`] |
//!
//! # Why not the paper's scheme
//!
//! Where a sheet is flat, one length constraint for each interior vertex depends on the others,
//! and the paper's system coordinates do not exist; near flat, the rigidity matrix is
//! nearly singular. Every sheet starts there. The damped methods minimise an incremental
//! potential over the positions with the right lengths, which has a solution at any rank of the
//! constraints; the conservative ones solve for rod impulses, shorten their steps near
//! singular states, and refuse loaded flat ones with [`StepError::RankDeficient`]: start them from
//! a folded state, displace the sheet with [`leave_flat`], or allow a [`Fallback`].
//!
//! Every accepted step has the rest lengths to the tolerance of its method (a relative 1e-12 or better by
//! default, or the round-off of the coordinates where that is larger), finite energies, and, with a damped
//! method or the fallback, an energy gain of at most a tenth of the kinetic energy in a step and a fiftieth of the
//! largest kinetic energy in all steps together: compressed rods that snap through can feed any implicit method. Such
//! steps are taken with implicit Euler, or shortened.
//!
//! # Isometry
//!
//! What keeps the lengths is chosen with the model ([`Isometry`]). The default are rigid rods along all
//! edges. An elastic sheet ([`SheetModel::with_elastic_sheet`]) stretches as the material does, up to a limit: it
//! bends smoothly in every direction and along clamps of any line. It is for BDF2 and implicit Euler.
//! [`StepReport::strain`] is the strain of edges whatever keeps them;
//! [`StepReport::constrained_strain`] is what an accepted step holds below its tolerance.
//!
//! # Limits
//!
//! Constraints that leave a vertex no room at all, such as two pins that stretch a straight line of rods
//! taut, are approached only as far as the square root of round-off allows. With pins at rest such vertices
//! become pins, and cost nothing, as far as they are found ([`Simulation::immobile_vertices`]). Sheets of rods
//! that are clamped flat along anything but a line of the mesh lock as a whole, and their steps are refused
//! after a bounded effort ([`StepError::Locked`]): model them as elastic.
//! [`SheetModel::clamps_across_the_mesh`] finds such clamps beforehand. Conservative runs on fine, nearly flat
//! sheets are slow: the exact motion flutters on ever smaller scales there.
//!
//! # Conventions
//!
//! SI units; positions, velocities and forces are flat slices of length `3V`; gravity acts along
//! -z. Length constraints are `c_e = (|x_a - x_b|^2 - l_e^2) / 2` with Jacobian `G`; a positive
//! rod multiplier in [`chart`] and in the implicit methods is a tension.
//!
//! # Contact, constraints and reactions
//!
//! [`Simulation::with_contact`] takes a [`contact::Contact`]: a barrier potential whose Hessian couples more
//! vertices than the mesh does, and a bound on every displacement. BDF2 and implicit Euler take it; in a
//! chart contact acts by impulses ([`ChartSimulation::with_contact`](chart::ChartSimulation::with_contact)).
//! Every method takes moving pins ([`SheetModel::with_moving_pin`]) and vertices on curves and surfaces
//! ([`SheetModel::with_constraint`]), one-sided ones the damped methods only. [`Simulation::reactions`] are
//! the forces of pins and constraints on the sheet, [`Simulation::body_loads`] those of the sheet on the
//! bodies, [`Simulation::contact_forces`] those of contact on each vertex of the sheet,
//! [`Simulation::rod_forces`] the tensions of the rods.
#![doc = include_str!("paper.md")]

pub mod chart;
mod conservative;
pub mod constraint;
pub mod contact;
mod damped;
mod linear;
mod material;
mod model;
mod motion;
mod options;
mod run;
mod step;
mod vectors;

pub use conservative::energy_momentum::EnergyMomentumOptions;
pub use conservative::rattle::RattleOptions;
pub use constraint::VertexConstraint;
pub use damped::options::ImplicitOptions;
pub use damped::projection_step::ProjectionStepOptions;
pub use damped::start::{leave_flat, project_positions};
pub use linear::rank::{RodRank, rod_rank};
pub use material::crease::{CreaseError, CreaseSpring, CreaseSprings, RestAngle};
pub use material::elastic_sheet::{ElasticDeformation, ElasticSheet, ElasticSheetError};
pub use material::plate_bending::{PlateBending, PlateBendingError};
pub use material::{Isotropic, Material, NamedMaterial, UnknownMaterial};
pub use model::clamps::ClampAcrossMesh;
pub use model::immobile::immobile_vertices;
pub use model::load::{AccelerationField, LoadError, VertexLoad};
pub use model::potential::{Force, Gravity, HessianSink, PAPER_GRAVITY, Potential, PotentialShape};
pub use model::state::State;
pub use model::support::Support;
pub use model::{Isometry, ModelError, SheetModel};
pub use motion::profile::{Interpolation, Profile, ProfileError};
pub use motion::{
    AxisRotation, Keyframe, Kinematics, MotionError, PointMotion, PointProfile, RigidDisplacement,
    RigidMotion, RigidProfile,
};
pub use options::OptionsError;
pub use run::checkpoint::Checkpoint;
pub use run::observe::{Frames, History, Observer, RunEnd};
pub use run::simulation::Simulation;
pub use step::checkpoint_error::CheckpointError;
pub use step::effort::StepProgress;
pub use step::infeasibility::Infeasibility;
pub use step::method::{Fallback, Method, StepControl, Unsatisfiable};
pub use step::reaction::Reaction;
pub use step::reason::Reason;
pub use step::report::{StepError, StepOutcome, StepReport};
pub use step::simulation_error::SimulationError;
pub use step::trace::{Continuation, Cut, TraceEvent};
#[doc(hidden)]
pub use step::tuning::{Constant, Tuning};

pub use model::potential;
pub use nalgebra;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
