//! The choice of an integrator and of what to do when it rejects a step.

use crate::conservative::energy_momentum::{EnergyMomentum, EnergyMomentumOptions};
use crate::conservative::rattle::{Rattle, RattleComposition, RattleOptions};
use crate::damped::implicit::{Bdf2, ImplicitEuler};
use crate::damped::options::ImplicitOptions;
use crate::damped::projection_step::{ProjectionStep, ProjectionStepOptions};
use crate::options::OptionsError;
use crate::step::integrator::Integrator;
use crate::step::tuning::Tuning;
use crate::{SheetModel, SimulationError};
use serde::{Deserialize, Serialize};

/// Which chart-free integrator moves the sheet.
///
/// In the formulas `x0` and `v0` are positions and velocities at the start of a step of `h` seconds, `x1` and
/// `v1` those at its end; `M` is the mass matrix, `f` the force (newtons), `c(x) = 0` the length constraints
/// with Jacobian `G`, and `L` the impulses of the rods. Velocity damping
/// ([`SheetModel::with_damping`]) acts after the step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// Implicit Euler with the constraints in the step:
    ///
    /// ```text
    /// M (v1 - v0) = h f(x1) + G(x1)^T L,   x1 = x0 + h v1,   c(x1) = 0.
    /// ```
    ///
    /// Equivalently `x1` minimises the incremental potential `|x - x0 - h v0|_M^2 / 2 + h^2 V(x)` over all
    /// positions with the rest lengths. Newton's method with a line search finds the minimum: first with the
    /// multipliers of the rods from the linear systems (sequential quadratic programming), and where that fails,
    /// for elastic sheets, and in contact with supports that move, with those of an augmented Lagrangian. A
    /// projection then makes the lengths exact. Non-conservative forces are taken at the start of the step.
    ///
    /// First order, strongly dissipative, stable at any step. A sheet that starts exactly flat needs no
    /// special treatment.
    ImplicitEuler(ImplicitOptions),
    /// The second-order backward differentiation formula with the constraints in the step, with the ratio
    /// `w = h / h_` of the step to the one before:
    ///
    /// ```text
    /// x1 = a x0 - b x_ + k h v1,   M v1 = M (a v0 - b v_) + k h f(x1) + G(x1)^T L,   c(x1) = 0,
    /// a = (1 + w)^2 / (1 + 2w),   b = w^2 / (1 + 2w),   k = (1 + w) / (1 + 2w).
    /// ```
    ///
    /// Here `x_` and `v_` belong to the time one step before `x0` and `v0`. The minimisation is that of
    /// [`Method::ImplicitEuler`] with the effective step `k h`, at the same price. The method is second order
    /// and lightly damped, and takes any state: it keeps the motions that the step resolves and damps the
    /// ones that it does not. The first step, the first after the state was changed from outside, and a step
    /// that is more than twice as long as the one before are implicit Euler (`w = 0`). Non-conservative
    /// forces are taken at the start of the step, which makes them first order.
    ///
    /// The default: at the price of implicit Euler it loses a sixth to a half as much energy.
    Bdf2(ImplicitOptions),
    /// Predicts the positions with the forces, projects them onto the rest lengths, takes the velocity from
    /// the displacement and projects the velocity onto `G(x1) v = 0`, in the manner of Goldenthal et al.,
    /// "Efficient simulation of inextensible cloth", ACM Transactions on Graphics 26 (2007).
    ///
    /// First order, dissipative, stable at any step, cheapest; takes any state, because the linear systems
    /// are positive definite at any rank of `G`.
    Projection(ProjectionStepOptions),
    /// The energy-momentum method (after Simo and Gonzalez): with the midpoint velocity
    /// `w = (v0 + v1) / 2`, `x1 = x0 + h w` and `xm = (x0 + x1) / 2`,
    ///
    /// ```text
    /// 2 M (w - v0) = h f + G(xm)^T L,   c(x1) = 0.
    /// ```
    ///
    /// Because `c` is quadratic, `G(xm)` is its exact discrete gradient: the rods do no work, and energy,
    /// linear and angular momentum are conserved to the tolerance of the solver. Potentials that are not
    /// linear enter by Gonzalez' discrete gradient. Second order, symmetric.
    ///
    /// The equations are solved by Newton's method with one sparse LU factorisation in each iteration. The
    /// unknowns are the impulses `L`, which stay moderate where the multipliers `L / h` do not.
    EnergyMomentum(EnergyMomentumOptions),
    /// RATTLE (Andersen 1983; Hairer, Lubich and Wanner, "Geometric Numerical Integration", Sec. VII.1.4):
    ///
    /// ```text
    /// M (u - v0) = h/2 f(x0) + G(x0)^T L,   x1 = x0 + h u,   c(x1) = 0,
    /// M (v1 - u) = h/2 f(x1) + G(x1)^T L',                   G(x1) v1 = 0.
    /// ```
    ///
    /// Second order, symmetric, symplectic; momenta are conserved to round-off. The method needs independent
    /// rods: next to a flat state its steps shrink with the smallest singular value of `G`, and where the
    /// rods are dependent and loaded it has no solution, which is reported as
    /// [`StepError::RankDeficient`](crate::StepError::RankDeficient).
    Rattle(RattleOptions),
    /// Suzuki's composition of five RATTLE steps of the lengths `a h, a h, (1 - 4a) h, a h, a h` with
    /// `a = 1 / (4 - 4^(1/3))`: fourth order, symmetric, symplectic, with error constants far below those of
    /// the composition of three steps (Hairer, Lubich and Wanner, Example II.4.3).
    RattleComposition(RattleOptions),
}

impl Method {
    /// Whether a step is a minimum of an incremental potential, which needs no rods.
    pub(crate) fn is_minimising(&self) -> bool {
        matches!(self, Self::ImplicitEuler(_) | Self::Bdf2(_))
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
                Box::new(ImplicitEuler::new(model, o, tuning)?)
            }
            Self::Bdf2(o) => {
                o.validate()?;
                Box::new(Bdf2::new(model, o, tuning)?)
            }
            Self::Projection(o) => {
                o.validate()?;
                Box::new(ProjectionStep::new(model, o, tuning)?)
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
    /// Largest number of factorisations from an accepted state to the next for sheets of rods with supports at two
    /// vertices or more. Beyond, a sheet is refused ([`StepError::Locked`](crate::StepError::Locked)) if its rods
    /// block the motion that inertia and loads ask for, or depend on each other while supports and bodies rest;
    /// others go on until `min_fraction`. Nothing that is accepted depends on this number. Default 500: of 200
    /// clamped sheets 36 reach the end of 2 s, and 164 are refused.
    pub max_factorisations: usize,
    /// What to do when even the smallest sub-step is rejected. Default [`Fallback::Refuse`].
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
    /// time does not advance, and the report says so ([`StepReport::taut`](crate::StepReport::taut)).
    StopTaut,
}

/// What to do when an integrator rejects even the smallest sub-step.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub enum Fallback {
    /// Return [`StepError::StepTooSmall`](crate::StepError::StepTooSmall), or
    /// [`StepError::Locked`](crate::StepError::Locked) where rods block the motion.
    #[default]
    Refuse,
    /// Take the step with implicit Euler, which accepts any state, and carry on with the integrator asked
    /// for. Reported as [`StepOutcome::Fallback`](crate::StepOutcome::Fallback); costs the energy that
    /// implicit Euler loses in that step.
    ImplicitEuler(ImplicitOptions),
}

impl Default for StepControl {
    fn default() -> Self {
        Self {
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
        OptionsError::check_range("min_fraction", self.min_fraction, 1e-12, 1.0)?;
        OptionsError::check_count("max_factorisations", self.max_factorisations)?;
        match &self.fallback {
            Fallback::Refuse => Ok(()),
            Fallback::ImplicitEuler(options) => options.validate(),
        }
    }
}
