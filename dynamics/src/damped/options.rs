//! Options of the damped methods.

use crate::SheetModel;
use isosheet_materials::OptionsError;
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
    /// inertia term of the incremental potential; of what nothing holds that is the one in the frame that
    /// falls freely, where it is less there. Default: [`ImplicitOptions::tolerance_of`] the model. Lengths
    /// have a tolerance of their own.
    pub tolerance: Option<f64>,
    /// Largest relative error of an edge length after a step, above the round-off of the coordinates. Default
    /// 1e-12.
    pub strain_tolerance: f64,
    /// Largest number of Newton iterations per solver phase, a quarter of it in the first phase with contact;
    /// counted anew in each round of the augmented Lagrangian and of lagged friction. Default 80.
    pub max_iterations: usize,
    /// Largest number of iterations per projection onto the lengths, in SQP a quarter of `max_iterations` at
    /// most. Default 400.
    pub max_projections: usize,
    /// Largest change of a normal force between the last two updates of lagged friction, relative to the
    /// largest normal force, at least 0.05 in the augmented Lagrangian; and of loads that follow the sheet,
    /// relative to the largest load, at most 1e-3. Default 1e-3.
    pub friction_tolerance: f64,
    /// Largest number of updates of lagged friction, and of loads that follow the sheet, per sub-step.
    /// Default 5.
    pub max_friction_updates: usize,
    /// Seed of the perturbation of a state at a saddle point of the incremental potential. Default 0.
    pub seed: u64,
}

impl Default for ImplicitOptions {
    fn default() -> Self {
        Self {
            stiffness: 1e4,
            tolerance: None,
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
    /// The tolerance of the steps of a model: 1e-4 where it has rods, else 1e-3. With it the error of a step
    /// of an elastic sheet is that of the time step alone (a square that falls from a corner: the same to 0.1
    /// % at any tolerance from 1e-8 to 1e-2), and what is left of the forces, in the norm of the inverse
    /// masses, is at most the root of 1e-3, three hundredths, of what accelerates the sheet or holds it at
    /// rest.
    pub fn tolerance_of(&self, model: &SheetModel) -> f64 {
        let usual = if model.rods().is_empty() { 1e-3 } else { 1e-4 };
        self.tolerance.unwrap_or(usual)
    }

    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("stiffness", self.stiffness, 1.0, 1e8)?;
        if let Some(tolerance) = self.tolerance {
            OptionsError::check_range("tolerance", tolerance, 1e-14, 0.1)?;
        }
        OptionsError::check_range("strain_tolerance", self.strain_tolerance, 1e-15, 1e-2)?;
        OptionsError::check_range("friction_tolerance", self.friction_tolerance, 1e-12, 1.0)?;
        OptionsError::check_count("max_iterations", self.max_iterations)?;
        OptionsError::check_count("max_projections", self.max_projections)
    }
}
