//! Options of the damped methods.

use crate::options::OptionsError;
use serde::{Deserialize, Serialize};

/// Options of [`Method::ImplicitEuler`](crate::Method::ImplicitEuler) and
/// [`Method::Bdf2`](crate::Method::Bdf2).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ImplicitOptions {
    /// Penalty of length errors and of vertex constraints in the merit function, relative to the masses. Default
    /// 1e4: in the augmented Lagrangian a hundred times more needs several times the iterations, a hundred times less
    /// twice the projections.
    pub stiffness: f64,
    /// Newton's method stops when the decrease it still promises is this fraction of the
    /// inertia term of the incremental potential. Default 1e-4, far below the error of the
    /// method itself; the lengths do not depend on it.
    pub tolerance: f64,
    /// Largest relative edge length error of an accepted step. Default 1e-12. Round-off sets a floor of a
    /// few units in the last place of the coordinates.
    pub strain_tolerance: f64,
    /// Largest number of iterations of Newton's method in a phase, a quarter of it in the first phase in contact. The
    /// count begins anew with each round of the augmented Lagrangian, lagged friction and saddle. Default 80.
    pub max_iterations: usize,
    /// Largest number of iterations of one restoration of the lengths. Default 400; the first phase gives up after at
    /// most 20 of these.
    pub max_projections: usize,
    /// Largest change of a normal force of friction, relative to the largest normal force, between its last
    /// two evaluations in a step. Default 1e-3. With 1e-5 sheets that drape need a fifth more factorisations;
    /// with 0.05 they need as many as with 1e-3. In the augmented Lagrangian 0.05 at least.
    pub friction_tolerance: f64,
    /// How often an iteration that has converged goes on because friction exceeds its tolerance. Default 5;
    /// without friction it never does.
    pub max_friction_updates: usize,
    /// Seed of the perturbation that decides which way a sheet folds that sits on a saddle of
    /// the incremental potential. Default 0.
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
