//! The choice of an integrator and of what to do when it rejects a step.

use crate::energy_momentum::{EnergyMomentum, EnergyMomentumOptions};
use crate::implicit::{Bdf2, ImplicitEuler, ImplicitOptions};
use crate::integrator::Integrator;
use crate::options::OptionsError;
use crate::projection_step::{ProjectionStep, ProjectionStepOptions};
use crate::rattle::{Rattle, RattleComposition, RattleOptions};
use crate::{SheetModel, SimulationError};
use serde::{Deserialize, Serialize};

/// Which chart-free integrator moves the sheet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Implicit Euler with the constraints in the step: first order, strongly damped, takes any
    /// state.
    ImplicitEuler(ImplicitOptions),
    /// The second-order backward differentiation formula with the constraints in the step:
    /// second order, lightly damped, takes any state. The default: at the price of implicit
    /// Euler it loses a sixth to a half as much energy.
    Bdf2(ImplicitOptions),
    /// Predict and project: first order, damped, cheapest, takes any state.
    Projection(ProjectionStepOptions),
    /// Energy-momentum: second order, conserves energy and momenta.
    EnergyMomentum(EnergyMomentumOptions),
    /// RATTLE: second order, symplectic.
    Rattle(RattleOptions),
    /// Suzuki's fourth-order composition of RATTLE.
    RattleComposition(RattleOptions),
}

impl Method {
    /// Validates the options and analyses the model.
    pub(crate) fn build(&self, model: &SheetModel) -> Result<Box<dyn Integrator>, SimulationError> {
        Ok(match self.clone() {
            Self::ImplicitEuler(o) => {
                o.validate()?;
                Box::new(ImplicitEuler::new(model, o)?)
            }
            Self::Bdf2(o) => {
                o.validate()?;
                Box::new(Bdf2::new(model, o)?)
            }
            Self::Projection(o) => {
                o.validate()?;
                Box::new(ProjectionStep::new(model, o)?)
            }
            Self::EnergyMomentum(o) => {
                o.validate()?;
                Box::new(EnergyMomentum::new(model, o)?)
            }
            Self::Rattle(o) => {
                o.validate()?;
                Box::new(Rattle::new(model, o)?)
            }
            Self::RattleComposition(o) => {
                o.validate()?;
                Box::new(RattleComposition::new(model, o)?)
            }
        })
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::Bdf2(ImplicitOptions::default())
    }
}

/// How a simulation subdivides steps that its integrator rejects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    /// Smallest sub-step, as a fraction of the step asked for. Default 2^-14 (6e-5).
    pub min_fraction: f64,
    /// What to do when even that is rejected. Default [`Fallback::Refuse`].
    pub fallback: Fallback,
    /// What to do when moving supports ask for more than the rods allow. Default [`Unsatisfiable::Refuse`].
    pub unsatisfiable: Unsatisfiable,
}

/// What to do when moving supports ask for more than the rods allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Unsatisfiable {
    /// Return [`StepError::Unsatisfiable`](crate::StepError::Unsatisfiable).
    #[default]
    Refuse,
    /// Stop at the taut state, the last one accepted: [`Simulation::step`](crate::Simulation::step) succeeds,
    /// time stands still, and the report says so ([`StepReport::taut`](crate::StepReport::taut)).
    StopTaut,
}

/// What to do when an integrator rejects even the smallest sub-step.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Fallback {
    /// Return the error.
    #[default]
    Refuse,
    /// Take the step with implicit Euler, which accepts any state, and carry on with the
    /// integrator asked for. Reported as [`StepOutcome::Fallback`](crate::StepOutcome::Fallback); costs the energy that implicit
    /// Euler loses in that step.
    ImplicitEuler(ImplicitOptions),
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            min_fraction: 2.0_f64.powi(-14),
            fallback: Fallback::Refuse,
            unsatisfiable: Unsatisfiable::Refuse,
        }
    }
}

impl StepControl {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("min_fraction", self.min_fraction, 1e-12, 1.0)?;
        match &self.fallback {
            Fallback::Refuse => Ok(()),
            Fallback::ImplicitEuler(options) => options.validate(),
        }
    }
}
