//! The problem of one implicit step.

use crate::contact::StepContact;
use crate::damped::air_step::AirStep;
use crate::model::memory::Memories;
use crate::step::integrator::Phases;
use crate::{SheetModel, State};

/// Minimise `Phi(x) = |x - x^|_M^2 / 2 + h^2 (V(x, t) + B(x) + D(x - x0) + R(x) - f . x)` over the positions
/// with the rest lengths and with the vertex constraints kept at time `t`.
///
/// `x^` is where inertia alone would take the sheet, `V` the potentials, `B` and `D` contact and its
/// friction, `R` the incremental potential of the air, `f` the other non-conservative forces at the start of
/// the step.
pub(crate) struct StepProblem<'a> {
    /// The sheet.
    pub(crate) model: &'a SheetModel,
    /// What its potentials remember.
    pub(crate) memories: &'a Memories,
    /// Contact, in scenes that name it.
    pub(crate) contact: Option<StepContact<'a>>,
    /// The state at the start of the step.
    pub(crate) state: &'a State,
    /// Length of the step, seconds.
    pub(crate) span: f64,
    /// Effective step, the root of the factor of the forces, seconds: `k h` in a formula with
    /// `x1 = ... + k h v1`.
    pub(crate) h: f64,
    /// Inertial prediction `x^`, `3V`, metres.
    pub(crate) prediction: &'a [f64],
    /// Non-conservative forces `f`, `3V`, newtons.
    pub(crate) applied: &'a [f64],
    /// The air, in scenes that name it.
    pub(crate) air: Option<&'a AirStep>,
    /// Phases that may be tried.
    pub(crate) phases: Phases,
}

impl<'a> StepProblem<'a> {
    /// Time at the end of the step, seconds.
    pub(crate) fn t(&self) -> f64 {
        self.state.t + self.span
    }

    pub(crate) fn has_contact(&self) -> bool {
        self.contact.is_some()
    }

    /// Whether displacements are bounded: by contact or by a limit of the strain. Then pins in motion start
    /// where they were, and advance with the iterates.
    pub(crate) fn is_bounded(&self) -> bool {
        self.has_contact() || self.model.has_strain_limit()
    }

    pub(crate) fn contact(&self) -> Option<&StepContact<'a>> {
        self.contact.as_ref()
    }

    pub(crate) fn contact_mut(&mut self) -> Option<&mut StepContact<'a>> {
        self.contact.as_mut()
    }
}
