//! A sheet as a mechanical system: what a scene is made of, before anything moves.
//!
//! A [`SheetModel`] has rods or an elastic sheet, masses, potentials, forces, damping, supports and rigid
//! bodies. What acts in a step besides potentials is a [`term::Term`] of the objective that a step minimises,
//! and what may go wrong in a step is a [`StepError`]. `isosheet-dynamics` solves for the motion of a model.
//!
//! | add | by |
//! |---|---|
//! | elasticity, or another potential | [`SheetModel::with_elastic_sheet`], [`SheetModel::with_potential`] |
//! | weight, loads, pressure, gas, air | [`SheetModel::with_gravity`], `with_force`, [`LoadedFaces`], [`Air`] |
//! | supports | [`SheetModel::with_pins`], `with_moving_pin`, `with_constraint`, [`Hand`] |
//! | damping | [`SheetModel::with_damping`] |
//! | bodies that respond | [`RigidBody`], [`Attachment`], [`JointSpring`] |
//! | a force of velocities that is stiff, or a barrier | [`SheetModel::with_implicit_force`] |
//!
//! SI units; positions, velocities and forces are slices of length `3V`; gravity acts along -z. Length
//! constraints are `c_e = (|x_a - x_b|^2 - l_e^2) / 2`.

pub mod constraint;
mod report;
mod rigid_body;
mod sheet_model;
mod state;
pub mod term;

pub use constraint::VertexConstraint;
pub use report::contact_error::{
    BarrierError, BodyMotionError, ContactError, ContactPair, FrictionError, FrictionLawFault,
};
pub use report::engine_error::{AdvisedError, EngineError};
pub use report::infeasibility::{Driver, Infeasibility};
pub use report::no_equilibrium::NoEquilibrium;
pub use report::potential_fault::{BadPotential, PotentialFault};
pub use report::pressing::Pressing;
pub use report::reason::Reason;
pub use report::step_error::StepError;
pub use report::support::Support;
pub use report::trace::{Continuation, Cut, TraceEvent};
pub use rigid_body::{
    Attachment, BodyForce, BodyTorque, CarriedPoint, JointCoordinate, JointError, JointSpring,
    RigidBody, RigidBodyError, Solid, SolidError,
};
pub use sheet_model::air::{Air, AirError, Wind};
pub use sheet_model::breaks::{Breaks, Start};
pub use sheet_model::clamps::ClampAcrossMesh;
pub use sheet_model::edge_moment::EdgeMoment;
pub use sheet_model::elastic_deformation::ElasticDeformation;
pub use sheet_model::gas::{EnclosedGas, Gas, GasError, GasState};
pub use sheet_model::hand::{Hand, HandError};
pub use sheet_model::immobile::immobile_vertices;
pub use sheet_model::load::{AccelerationField, LoadError, VertexLoad};
pub use sheet_model::load_scale::{LoadScale, constant_acceleration};
pub use sheet_model::loaded_faces::{LoadedFaces, LoadedFacesError};
pub use sheet_model::of_material::{SheetOfMaterial, SheetOfMaterialError};
pub use sheet_model::part::PotentialOfPart;
pub use sheet_model::round_off::{strain_floor, velocity_round_off};
pub use sheet_model::turning_load::TurningLoad;
pub use sheet_model::{Isometry, ModelError, PINNED, SheetModel};
pub use state::State;

/// The code of the README is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
