//! Dynamics of developable meshes.

pub mod chart;
mod energy_momentum;
mod implicit;
mod integrator;
mod method;
mod minimiser;
mod model;
pub mod potential;
mod primal;
mod project;
mod projection_step;
mod rank;
mod rattle;
mod report;
mod saddle;
mod simulation;
mod start;
mod state;
mod subdivide;

pub use energy_momentum::{EnergyMomentum, EnergyMomentumOptions};
pub use implicit::{Bdf2, ImplicitEuler, ImplicitOptions};
pub use integrator::{Integrator, OptionsError};
pub use method::{Fallback, Method, StepControl};
pub use model::{ModelError, SheetModel};
pub use potential::{Force, Gravity, HessianSink, Potential, PotentialShape, STANDARD_GRAVITY};
pub use projection_step::{ProjectionStep, ProjectionStepOptions};
pub use rank::{RodRank, rod_rank};
pub use rattle::{Rattle, RattleComposition, RattleOptions};
pub use report::{Accepted, Effort, Path, StepError, StepReport};
pub use simulation::{Simulation, SimulationError};
pub use start::{leave_flat, project_positions};
pub use state::State;
