#![doc = include_str!("../README.md")]
//!
//! * [`MassSolver`]: `qdot = C^-1 p` by Cramer's minors as published, by dense factorisations, or by one
//!   sparse saddle-point solve;
//! * [`ChartMechanics`]: p, H and their derivatives at a state;
//! * [`ChartSimulation`]: forward Euler with the published step control and Runge-Kutta in
//!   a chart, in the published, re-formed and full equations of motion. A chart eliminates the pins it was
//!   built with; more pins, moving ones, curves and surfaces are closure equations
//!   ([`ChartSimulation::from_state`]);
//! * [`in_chart`]: all that as a [`Simulation`](isosheet_dynamics::Simulation), with balance of energy and
//!   checkpoints.
#![doc = include_str!("paper.md")]

mod energy_bound;
mod engine;
mod error;
mod mechanics;
mod mobility;
mod options;
mod resume;
mod simulation;
mod solver;
mod state;
mod stepping;
mod substep;

pub use engine::{IN_CHART, REBASED, in_chart, of_simulation, resume_in_chart};
pub use error::ChartDynamicsError;
pub use mechanics::{ChartMechanics, Equations};
pub use options::{ChartMethod, ChartOptions, ChartStepControl, PositionUpdate, Rebase};
pub use simulation::{ChartSimulation, ChartStepReport};
pub use solver::{MassSolver, MassSolverKind};
use state::ChartState;
pub use state::StepRange;

#[cfg(test)]
mod tests;
