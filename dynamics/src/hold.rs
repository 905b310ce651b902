//! The step that leaves a sheet where it is.

use crate::contact::StepSpan;
use crate::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::iterate::Iterate;
use crate::report::{SolverEffort, StepError, StepOutcome, not_converged};
use crate::{SheetModel, State};

/// Positions stay, velocities become zero, see [`Fallback::Hold`](crate::Fallback::Hold).
///
/// The positions at the start of a step have the rest lengths and touch nothing, so that the step that ends
/// there is admissible. It is the answer for a sheet whose rods lock: to first order it can move, and no
/// motion exists. An impact of this kind takes all the kinetic energy.
pub(crate) struct Hold {
    iterate: Iterate,
    /// Work arrays: where the pins are at the end, and no motion.
    end: Vec<f64>,
    zeros: Vec<f64>,
}

/// The momentum balance of a held sheet is not solved: all of it is left over.
const RESIDUAL: f64 = 1.0;
/// Violation of the constraints of vertices in mean rod lengths, below which it is as good as none: the default
/// tolerance of the steps.
const VIOLATION: f64 = 1e-12;
/// Largest number of parts in which bodies are moved. Ten leave a thousandth of a gap.
const MAX_PARTS: usize = 10;

impl Hold {
    pub(crate) fn new(model: &SheetModel) -> Self {
        let n = model.coordinate_count();
        Self {
            iterate: Iterate::new(n),
            end: vec![0.0; n],
            zeros: vec![0.0; n],
        }
    }

    /// Whether the supports of the sheet allow it to stay where it is until time `t`.
    fn is_supported(&mut self, model: &SheetModel, state: &State, t: f64) -> bool {
        self.end.copy_from_slice(&state.x);
        model.place_pins(t, &mut self.end);
        let before = model.largest_violation(state.t, &state.x).unwrap_or(0.0);
        let after = model.largest_violation(t, &state.x).unwrap_or(0.0);
        self.end == state.x && after <= before.max(VIOLATION * model.mean_length())
    }
}

impl Integrator for Hold {
    fn traits(&self) -> MethodTraits {
        MethodTraits::minimising()
    }

    fn propose(
        &mut self,
        scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort,
    ) -> Result<(), StepError> {
        let Scene { model, mut contact } = scene;
        let (state, h) = (attempt.state, attempt.h);
        let t = state.t + h;
        let refusal = || {
            let strain = model.constrained_strain(&state.x);
            Err(not_converged(state.t, h, effort, RESIDUAL, strain))
        };
        if !self.is_supported(model, state, t) {
            return refusal();
        }
        let span = StepSpan { t0: state.t, h };
        self.iterate.begin(contact.as_mut(), span, &state.x);
        // Bodies that come closer are moved in parts, each of which leaves half a gap.
        for _ in 0..MAX_PARTS {
            if self.iterate.progress() == 1.0 {
                break;
            }
            let part = self.iterate.safe_fraction(contact.as_mut(), &self.zeros);
            self.iterate.advance_bodies(part);
        }
        if self.iterate.progress() < 1.0 {
            return refusal();
        }
        let work = self.iterate.contact_work(contact.as_ref());
        let moment = &mut proposal.moment;
        moment.state.copy_from(state);
        moment.state.v.fill(0.0);
        moment.state.t = t;
        moment.history.previous = None;
        moment.history.multipliers.clear();
        moment.history.rod_stiffness = attempt.rod_stiffness();
        moment.history.couplings.clear();
        let couplings = attempt.couplings();
        moment.history.couplings.extend_from_slice(couplings);
        moment.balance.clear();
        moment.balance.unassigned.clear();
        moment.set_contacts(self.iterate.contact_state());
        proposal.account = StepAccount {
            residual: RESIDUAL,
            work: 0.0,
            outcome: StepOutcome::Held,
            contact: work,
        };
        Ok(())
    }
}
