//! Options of the damped methods.

use crate::options::OptionsError;
use serde::{Deserialize, Serialize};

/// Options of [`Method::ImplicitEuler`](crate::Method::ImplicitEuler) and
/// [`Method::Bdf2`](crate::Method::Bdf2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImplicitOptions {
    /// Penalty on errors of lengths and vertex constraints in the merit function, relative to the masses.
    /// Default 1e4.
    pub stiffness: f64,
    /// Newton's method stops when the decrease predicted by its quadratic model is below this fraction of the
    /// inertia term of the incremental potential. Default 1e-4. Lengths have a tolerance of their own.
    pub tolerance: f64,
    /// Largest relative error of an edge length after a step, above the round-off of the coordinates. Default
    /// 1e-12.
    pub strain_tolerance: f64,
    /// Largest number of Newton iterations per solver phase, a quarter of it in the first phase with contact;
    /// counted anew in each round of the augmented Lagrangian and of lagged friction. Default 80.
    pub max_iterations: usize,
    /// Largest number of iterations per projection onto the lengths, in SQP a quarter of `max_iterations` at most.
    /// Default 400.
    pub max_projections: usize,
    /// Largest change of a normal force between the last two updates of lagged friction, relative to the
    /// largest normal force. Default 1e-3; at least 0.05 in the augmented Lagrangian.
    pub friction_tolerance: f64,
    /// Largest number of updates of lagged friction, and of loads that follow the sheet, per sub-step. Default 5.
    pub max_friction_updates: usize,
    /// Seed of the perturbation of a state at a saddle point of the incremental potential. Default 0.
    pub seed: u64,
}

impl Default for ImplicitOptions {
    fn default() -> Self {
        Self {
            stiffness: 1e4,
            tolerance: 1e-4,
            strain_tolerance: 1e-12,
            max_iterations: 80,
            max_projections: 400,
            friction_tolerance: 1e-3,
            max_friction_updates: 5,
            seed: 0,
        }
    }
}

impl ImplicitOptions {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("stiffness", self.stiffness, 1.0, 1e8)?;
        OptionsError::check_range("tolerance", self.tolerance, 1e-14, 0.1)?;
        OptionsError::check_range("strain_tolerance", self.strain_tolerance, 1e-15, 1e-2)?;
        OptionsError::check_range("friction_tolerance", self.friction_tolerance, 1e-12, 1.0)?;
        OptionsError::check_count("max_iterations", self.max_iterations)?;
        OptionsError::check_count("max_projections", self.max_projections)
    }
}
