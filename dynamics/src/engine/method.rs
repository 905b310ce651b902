//! Integrators and step control.

use crate::conservative::energy_momentum::{EnergyMomentum, EnergyMomentumOptions};
use crate::conservative::rattle::{Rattle, RattleOptions};
use crate::damped::equilibrium::Equilibrium;
use crate::damped::implicit::Implicit;
use crate::damped::options::ImplicitOptions;
use crate::step::integrator::Integrator;
use crate::step::tuning::Tuning;
use crate::{SheetModel, SimulationError};
use isosheet_materials::OptionsError;
use isosheet_model::term::Formula;
use serde::{Deserialize, Serialize};

/// A chart-free integrator.
///
/// Notation: positions `x0`, `x1` and velocities `v0`, `v1` at the start and the end of a step of `h`
/// seconds, mass matrix `M`, force `f` (newtons), length constraints `c(x) = 0` with Jacobian `G`, rod
/// impulses `L`. Velocity damping ([`SheetModel::with_damping`]) leaves each method its order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Implicit Euler method: first order, strongly dissipative.
    ///
    /// ```text
    /// M (v1 - v0) = h f(x1) + G(x1)^T L,   x1 = x0 + h v1,   c(x1) = 0.
    /// ```
    ///
    /// `x1` minimises the incremental potential `|x - x0 - h v0|_M^2 / 2 + h^2 V(x)` subject to `c(x) = 0`.
    /// It is found by Newton's method with a line search, in sequential quadratic programming or an augmented
    /// Lagrangian, and projected onto the lengths. Non-conservative forces `f(t, x, v)` are those at the end
    /// of the step, `f(t1, x0 + h v0, v0)`.
    ImplicitEuler(ImplicitOptions),
    /// Second-order backward differentiation formula (BDF2), lightly dissipative, the default. With the ratio
    /// `w = h / h_` of the step to the one before:
    ///
    /// ```text
    /// x1 = a x0 - b x_ + k h v1,   M v1 = M (a v0 - b v_) + k h f(x1) + G(x1)^T L,   c(x1) = 0,
    /// a = (1 + w)^2 / (1 + 2w),   b = w^2 / (1 + 2w),   k = (1 + w) / (1 + 2w).
    /// ```
    ///
    /// `x_` and `v_` belong to the start of the step before. Solved as [`Method::ImplicitEuler`] with the
    /// step `k h`. Non-conservative forces are those at the end of the step, with velocities extrapolated to
    /// it, `f(t1, x0 + h v0, v0 + w (v0 - v_))`: of second order.
    ///
    /// The first step, the first after a change of the state from outside or at a
    /// [break](SheetModel::with_breaks), and steps with `w > 2` have no use for a step before, and are
    /// implicit Euler (`w = 0`). One such step leaves the order two.
    Bdf2(ImplicitOptions),
    /// Equilibria: each step ends at rest, where the forces at its end balance,
    ///
    /// ```text
    /// 0 = f(x1) + G(x1)^T L,   v1 = 0,   c(x1) = 0.
    /// ```
    ///
    /// `x1` is a local minimum of the potential energy `V(x)` subject to `c(x) = 0`. It is the limit of steps
    /// of [`Method::ImplicitEuler`] that begin at rest and grow: each minimises `|x - x_k|_M^2 / 2 + h_k^2
    /// V(x)`, the proximal point method (R. T. Rockafellar, SIAM J. Control Optim. 14, 1976), and the inertia
    /// vanishes with growing `h_k`. The search ends where forces are balanced to a millionth of the largest,
    /// a step changes the energy by a millionth of it at most (what friction holds creeps, and is excepted),
    /// and no small disturbance grows. The time says which loads and supports are meant. Drag and dampers
    /// have no place. Friction acts against the displacement in each of these steps, with the sliding that
    /// counts as rest in the first of them.
    Equilibrium(ImplicitOptions),
    /// Energy-momentum method (after Simo and Gonzalez): second order, symmetric. With `w = (v0 + v1) / 2`,
    /// `x1 = x0 + h w` and `xm = (x0 + x1) / 2`:
    ///
    /// ```text
    /// 2 M (w - v0) = h f + G(xm)^T L,   c(x1) = 0.
    /// ```
    ///
    /// `G(xm)` is the exact discrete gradient of the quadratic `c`; nonlinear potentials enter by Gonzalez'
    /// discrete gradient. Energy, linear and angular momentum are conserved to the tolerance of Newton's
    /// method.
    EnergyMomentum(EnergyMomentumOptions),
    /// RATTLE (Andersen 1983; Hairer, Lubich and Wanner, "Geometric Numerical Integration", Sec. VII.1.4).
    /// Second order, symmetric, symplectic.
    ///
    /// ```text
    /// M (u - v0) = h/2 f(x0) + G(x0)^T L,   x1 = x0 + h u,   c(x1) = 0,
    /// M (v1 - u) = h/2 f(x1) + G(x1)^T L',                   G(x1) v1 = 0.
    /// ```
    ///
    /// Momenta are conserved to round-off. Steps shrink with the smallest singular value of `G`; a loaded
    /// state with dependent rods is refused with
    /// [`StepError::RankDeficient`](crate::StepError::RankDeficient).
    Rattle(RattleOptions),
    /// Suzuki's composition of five RATTLE steps of the lengths `a h, a h, (1 - 4a) h, a h, a h` with
    /// `a = 1 / (4 - 4^(1/3))` (Hairer, Lubich and Wanner, Example II.4.3). Fourth order, symmetric,
    /// symplectic.
    RattleComposition(RattleOptions),
}

impl Method {
    /// Whether a step is a minimum of an incremental potential, which needs no rods.
    pub(crate) fn is_minimising(&self) -> bool {
        matches!(
            self,
            Self::ImplicitEuler(_) | Self::Bdf2(_) | Self::Equilibrium(_)
        )
    }

    /// Validates the options and analyses the model.
    pub(crate) fn build(
        &self,
        model: &SheetModel,
        tuning: &Tuning,
    ) -> Result<Box<dyn Integrator>, SimulationError> {
        Ok(match self.clone() {
            Self::ImplicitEuler(o) => {
                o.validate()?;
                Box::new(Implicit::new(Formula::OneStep, model, o, tuning)?)
            }
            Self::Bdf2(o) => {
                o.validate()?;
                Box::new(Implicit::new(Formula::TwoStep, model, o, tuning)?)
            }
            Self::Equilibrium(o) => {
                o.validate()?;
                Box::new(Equilibrium::new(model, o, tuning)?)
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
                Box::new(Rattle::composed(model, o)?)
            }
        })
    }
}

impl Default for Method {
    fn default() -> Self {
        Self::Bdf2(ImplicitOptions::default())
    }
}

/// Subdivision of steps that the integrator rejects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StepControl {
    /// Largest estimated error that a sub-step of BDF2 or implicit Euler may add to the positions, metres, as
    /// the root of the mean square over the vertices that are not pinned. Sub-steps are halved until it is
    /// met, down to `min_fraction`, and doubled again where the estimate of twice the length meets it. With
    /// the lengths `h` of a sub-step and `h / w` of the one before it is
    ///
    /// ```text
    /// h (1 + w) / (3 (1 + 2 w)) |v1 - v0 - w (v0 - v_)|   for BDF2,   h / 2 |v1 - v0|   for implicit Euler,
    /// ```
    ///
    /// which is of third and of second order in `h` for smooth motions, and of first order in impacts. Errors
    /// of sub-steps add up, and what the motion makes of them later is not in it. Default none: sub-steps are
    /// as long as they are asked for.
    pub accuracy: Option<f64>,
    /// Smallest sub-step relative to the step asked for. Default 2^-14.
    pub min_fraction: f64,
    /// Largest number of factorisations in a sub-step of a sheet of rods with supports at two vertices or
    /// more. Beyond, the step is refused with [`StepError::Locked`](crate::StepError::Locked) if the rods
    /// block the motion, or are dependent while supports and bodies rest; otherwise it continues down to
    /// `min_fraction`. Default 500.
    pub max_factorisations: usize,
    /// What follows when the smallest sub-step is rejected. Default [`Fallback::Refuse`].
    pub fallback: Fallback,
    /// What follows when moving supports are infeasible. Default [`Unsatisfiable::Refuse`].
    pub unsatisfiable: Unsatisfiable,
}

/// What follows when moving supports ask for more than the rods allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Unsatisfiable {
    /// Return [`StepError::Unsatisfiable`](crate::StepError::Unsatisfiable).
    #[default]
    Refuse,
    /// Stop at the last accepted, taut state: the step succeeds without advancing time and sets
    /// [`StepReport::taut`](crate::StepReport::taut).
    StopTaut,
}

/// What follows when an integrator rejects the smallest sub-step.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Fallback {
    /// Return [`StepError::StepTooSmall`](crate::StepError::StepTooSmall), or
    /// [`StepError::Locked`](crate::StepError::Locked) where rods block the motion.
    #[default]
    Refuse,
    /// Take the sub-step with implicit Euler and continue with the integrator asked for
    /// ([`StepOutcome::Fallback`](crate::StepOutcome::Fallback)).
    ImplicitEuler(ImplicitOptions),
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
            accuracy: None,
            min_fraction: 2.0_f64.powi(-14),
            max_factorisations: 500,
            fallback: Fallback::Refuse,
            unsatisfiable: Unsatisfiable::Refuse,
        }
    }
}

impl StepControl {
    /// # Errors
    /// [`OptionsError`] naming the option that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        if let Some(accuracy) = self.accuracy {
            OptionsError::check_range("accuracy", accuracy, f64::MIN_POSITIVE, f64::MAX)?;
        }
        OptionsError::check_range("min_fraction", self.min_fraction, 1e-12, 1.0)?;
        OptionsError::check_count("max_factorisations", self.max_factorisations)?;
        match &self.fallback {
            Fallback::Refuse => Ok(()),
            Fallback::ImplicitEuler(options) => options.validate(),
        }
    }
}
