//! Mechanics in system coordinates (Liu, Tang and Joneja 2007, Sec. 4): momenta, Hamiltonian, mass-matrix
//! solvers, equations of motion and explicit integrators in a chart.
//!
//! * [`MassSolver`]: `qdot = C^-1 p` by Cramer's minors as published, by dense factorisations, or by one
//!   sparse saddle-point solve;
//! * [`ChartMechanics`]: p, H and their derivatives at a state;
//! * [`ChartSimulation`]: forward Euler with the published step control and Runge-Kutta in
//!   a chart, in the published, re-formed and full equations of motion. A chart eliminates the pins it was
//!   built with; more pins, moving ones, curves and surfaces are closure equations
//!   ([`ChartSimulation::from_state`]). Contact acts by impulses ([`ChartSimulation::with_contact`]).

mod contact;
mod energy_bound;
pub(crate) mod engine;
mod impact;
mod mechanics;
mod mobility;
mod options;
mod resume;
mod simulation;
mod solver;
mod state;
mod stepping;
mod substep;

pub use crate::report::chart_error::ChartDynamicsError;
pub use impact::ContactImpulse;
pub use mechanics::{ChartMechanics, Equations};
pub use options::{ChartMethod, ChartOptions, ChartStepControl, PositionUpdate, Rebase};
pub use simulation::{ChartSimulation, ChartStepReport};
pub use solver::{MassSolver, MassSolverKind};
pub(crate) use state::ChartState;
pub use state::StepRange;

#[cfg(test)]
mod tests;
