//! The step that keeps the shape of a sheet.

use crate::constraint::rows::point;
use crate::contact::StepSpan;
use crate::effort::SolverEffort;
use crate::integrator::{Attempt, Integrator, MethodTraits, Proposal, Scene, StepAccount};
use crate::iterate::Iterate;
use crate::primal::strain_floor;
use crate::report::{StepError, StepOutcome, not_converged};
use crate::rigid_fit::{RigidFit, balance_as_rigid};
use crate::{SheetModel, State};
use isosheet_mesh::VertexId;

/// The sheet stays where it is or, where its pins move as one rigid body, goes with them, see
/// [`Fallback::Hold`](crate::Fallback::Hold).
///
/// The positions at the start of a step have the rest lengths and touch nothing, so that the step that ends
/// there is admissible. It is the answer for a sheet whose rods lock: to first order it can move, and no
/// motion exists. The step is an impact after which all of the sheet has the velocity of the supports, and
/// the forces of the supports are those that do this to a rigid body.
pub(crate) struct Hold {
    strain_tolerance: f64,
    iterate: Iterate,
    /// Work arrays: the displacement, and the non-conservative forces or the change of the velocities.
    displacement: Vec<f64>,
    applied: Vec<f64>,
}

/// The momentum balance of a held sheet is not solved: all of it is left over.
const RESIDUAL: f64 = 1.0;
/// Largest number of parts in which bodies are moved. Ten leave a thousandth of a gap.
const MAX_PARTS: usize = 10;

impl Hold {
    /// For sheets whose accepted steps have strains up to `strain_tolerance`.
    pub(crate) fn new(model: &SheetModel, strain_tolerance: f64) -> Self {
        let n = model.coordinate_count();
        Self {
            strain_tolerance,
            iterate: Iterate::new(n),
            displacement: vec![0.0; n],
            applied: vec![0.0; n],
        }
    }

    /// Sets the displacement of the sheet from `state` until time `t`.
    fn displace(&mut self, model: &SheetModel, state: &State, t: f64) {
        let x = &state.x;
        let end = &mut self.displacement;
        end.copy_from_slice(x);
        model.place_pins(t, end);
        if end != x {
            let ends = |v: VertexId| [point(x, v), point(end, v)];
            let pins: Vec<_> = model.pins().into_iter().map(ends).collect();
            let fit = RigidFit::of(&pins);
            let vertices = model.topology().vertex_ids();
            for v in vertices.filter(|v| !model.is_pinned(*v)) {
                let place = fit.apply(&point(x, v));
                end[3 * v.index()..3 * v.index() + 3].copy_from_slice(place.as_slice());
            }
        }
        for (d, x) in end.iter_mut().zip(x) {
            *d -= x;
        }
    }

    /// Moves sheet and bodies to the end of their motions, as far as nothing is in the way; whether they get
    /// there. Bodies that come closer are moved in parts, each of which leaves half a gap.
    fn go(&mut self, scene: &mut Scene<'_>) -> bool {
        for _ in 0..MAX_PARTS {
            let contact = scene.contact.as_mut();
            let part = self.iterate.safe_fraction(contact, &self.displacement);
            self.iterate.advance_bodies(part);
            let places = self.iterate.x_mut().iter_mut();
            for (x, d) in places.zip(&mut self.displacement) {
                *x += part * *d;
                *d *= 1.0 - part;
            }
            if part == 1.0 {
                return true;
            }
        }
        false
    }

    /// Whether the iterate has the rest lengths to the tolerance of the method, or as well as the positions at
    /// the start of the step, and satisfies the constraints of vertices as well as these.
    fn is_admissible(&self, model: &SheetModel, state: &State, t: f64) -> bool {
        let x = self.iterate.x();
        if *x != state.x {
            let before = model.constrained_strain(&state.x);
            let floor = strain_floor(model, state);
            if model.constrained_strain(x) > before.max(self.strain_tolerance).max(floor) {
                return false;
            }
        }
        model.keeps_constraints(state, t, x)
    }
}

impl Integrator for Hold {
    fn traits(&self) -> MethodTraits {
        MethodTraits::minimising()
    }

    fn propose(
        &mut self,
        mut scene: Scene<'_>,
        attempt: Attempt<'_>,
        proposal: &mut Proposal,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(), StepError> {
        let (model, state, h) = (scene.model, attempt.state, attempt.h);
        let t = state.t + h;
        let span = StepSpan { t0: state.t, h };
        self.displace(model, state, t);
        self.iterate.begin(scene.contact.as_mut(), span, &state.x);
        if !self.go(&mut scene) || !self.is_admissible(model, state, t) {
            let strain = model.constrained_strain(&state.x);
            return Err(not_converged(state.t, h, effort, RESIDUAL, strain));
        }
        let contact = self.iterate.contact_work(scene.contact.as_ref());
        let moment = &mut proposal.moment;
        moment.state.t = t;
        moment.state.x.copy_from_slice(self.iterate.x());
        model.place_pins(t, &mut moment.state.x);
        model.applied_force(state.t, &state.x, &state.v, &mut self.applied);
        let mut work = 0.0;
        for i in 0..state.x.len() {
            let moved = moment.state.x[i] - state.x[i];
            moment.state.v[i] = moved / h;
            work += self.applied[i] * moved;
        }
        moment.history.previous = None;
        moment.history.multipliers.clear();
        moment.history.rod_stiffness = attempt.rod_stiffness();
        moment.history.couplings.clear();
        let couplings = attempt.couplings();
        moment.history.couplings.extend_from_slice(couplings);
        let State { x, v, .. } = &moment.state;
        let change = v.iter().zip(&state.v);
        for (c, (v, v0)) in self.applied.iter_mut().zip(change) {
            *c = v - v0;
        }
        let impact = model.kinetic_energy(&self.applied);
        let balance = &mut moment.balance;
        if balance.begin(model, |i| (v[i] - state.v[i]) / h) {
            balance.add_potentials(model, t, x, 1.0);
            balance.add_applied(model, state.t, &state.x, &state.v, 1.0);
            if let Some(terms) = self.iterate.terms(scene.contact.as_ref()) {
                balance.add_contact(&terms);
            }
            balance_as_rigid(balance, model, t, x);
        }
        moment.set_contacts(self.iterate.contact_state());
        proposal.account = StepAccount {
            residual: RESIDUAL,
            work,
            impact,
            outcome: StepOutcome::Held,
            contact,
        };
        Ok(())
    }
}
