//! Steps of an integrator, subdivided where it rejects them.

use crate::contact::{Contact, ContactError, RunContact};
use crate::energy_account::EnergyAccount;
use crate::feasibility::{Excess, excess};
use crate::implicit::ImplicitEuler;
use crate::integrator::{Integrator, RodDemand, Scene};
use crate::rank::rod_rank;
use crate::reaction::Balance;
use crate::report::{Effort, Path, StepError};
use crate::{Fallback, Method, SheetModel, SimulationError, State, StepControl, Unsatisfiable};

/// What was done on the way to the end of a step, kept also if it fails half-way.
#[derive(Debug)]
pub(crate) struct Tally {
    pub(crate) substeps: usize,
    pub(crate) rejected: usize,
    pub(crate) effort: Effort,
    pub(crate) residual: f64,
    pub(crate) path: Path,
    pub(crate) work: f64,
    pub(crate) dissipated: f64,
    pub(crate) friction: f64,
    pub(crate) taut: Option<Excess>,
}

impl Default for Tally {
    fn default() -> Self {
        Self {
            substeps: 0,
            rejected: 0,
            effort: Effort::default(),
            residual: 0.0,
            path: Path::Newton,
            work: 0.0,
            dissipated: 0.0,
            friction: 0.0,
            taut: None,
        }
    }
}

/// Sub-steps accepted after a rejection before a longer one is tried: a singular state takes a few
/// steps to pass, and trying too soon is what most rejections were.
const PATIENCE: usize = 4;

/// An integrator with step control.
pub(crate) struct Subdivided {
    pub(crate) model: SheetModel,
    integrator: Box<dyn Integrator>,
    control: StepControl,
    fallback: Option<ImplicitEuler>,
    before: State,
    pub(crate) contact: Option<RunContact>,
    /// Forces of the supports in the last accepted sub-step.
    pub(crate) balance: Option<Balance>,
    account: EnergyAccount,
}

impl Subdivided {
    pub(crate) fn new(model: SheetModel, method: Method) -> Result<Self, SimulationError> {
        let integrator = method.build(&model)?;
        if !integrator.takes_one_sided()
            && let Some(index) = model.constraints().iter().position(|c| c.is_one_sided())
        {
            return Err(SimulationError::OneSided { index });
        }
        Ok(Self {
            integrator,
            control: StepControl::default(),
            fallback: None,
            before: State::at_rest(vec![0.0; model.coordinate_count()]),
            contact: None,
            balance: None,
            account: EnergyAccount::default(),
            model,
        })
    }

    /// Adds contact.
    pub(crate) fn set_contact(
        &mut self,
        contact: Box<dyn Contact>,
        state: &State,
    ) -> Result<(), SimulationError> {
        if !self.integrator.takes_contact() {
            return Err(ContactError::Method.into());
        }
        self.contact = Some(RunContact::new(contact, &self.model, state)?);
        Ok(())
    }

    pub(crate) fn set_control(&mut self, control: StepControl) -> Result<(), SimulationError> {
        control.validate()?;
        self.fallback = match &control.fallback {
            Fallback::Refuse => None,
            Fallback::ImplicitEuler(o) => Some(ImplicitEuler::new(&self.model, o.clone())?),
        };
        self.control = control;
        Ok(())
    }

    /// Advances `state` by `h`; sub-steps are `h / 2^level` on a binary grid, so that they end
    /// at `h` exactly. On failure the state is that of the last accepted sub-step.
    pub(crate) fn advance(
        &mut self,
        state: &mut State,
        h: f64,
        tally: &mut Tally,
    ) -> Result<(), StepError> {
        let start = state.t;
        let min_step = self.control.min_fraction * h;
        let (mut fraction, mut done) = (1.0, 0.0);
        let mut patience = 0;
        let mut restarted = false;
        // The conservative methods keep the energy by themselves.
        let guarded = self.integrator.demand() == RodDemand::Nothing;
        let driven = self.model.has_drives();
        let driven_potentials = self.model.has_driven_potentials();
        while done < 1.0 {
            let effort = &mut tally.effort;
            if guarded || driven || driven_potentials {
                self.before.copy_from(state);
            }
            self.check_pins(state.t + fraction * h)?;
            let mut tried = self.integrator.step(
                scene(&self.model, &mut self.contact),
                state,
                fraction * h,
                effort,
            );
            if let Ok(accepted) = &mut tried
                && driven
            {
                let (now, kept) = (self.integrator.balance(), self.balance.as_ref());
                accepted.driven = drive_work(&self.model, now, kept, &self.before, state);
            }
            if guarded
                && let Ok(accepted) = &tried
                && let Err(error) = self
                    .account
                    .enter(&self.model, &self.before, state, accepted)
            {
                state.copy_from(&self.before);
                tried = Err(error);
            }
            if let Err(StepError::EnergyGain { .. }) = tried
                && !restarted
            {
                // Contact came or went, or rods snapped through: the history of the motion does not continue.
                restarted = self.integrator.restart();
                if restarted {
                    tally.rejected += 1;
                    continue;
                }
            }
            restarted = false;
            let mut fell_back = false;
            if let Err(cause) = tried {
                tally.rejected += 1;
                if 0.5 * fraction * h >= min_step {
                    fraction *= 0.5;
                    patience = PATIENCE;
                    continue;
                }
                let Some(fallback) = &mut self.fallback else {
                    return self.stop(state, start + h, min_step, cause, tally);
                };
                fraction = largest_fraction(done);
                tried = fallback.step(
                    scene(&self.model, &mut self.contact),
                    state,
                    fraction * h,
                    effort,
                );
                if let Ok(accepted) = &mut tried
                    && driven
                {
                    let (now, kept) = (fallback.balance(), self.balance.as_ref());
                    accepted.driven = drive_work(&self.model, now, kept, &self.before, state);
                }
                fell_back = true;
                tally.path = Path::Fallback;
            }
            let accepted = match tried {
                Ok(accepted) => accepted,
                Err(cause) => return self.stop(state, start + h, min_step, cause, tally),
            };
            if self.model.has_supports() {
                let balance = match &self.fallback {
                    Some(fallback) if fell_back => fallback.balance(),
                    _ => self.integrator.balance(),
                };
                match &mut self.balance {
                    Some(kept) => kept.copy_from(balance),
                    none => *none = Some(balance.clone()),
                }
            }
            if let Some(contact) = &mut self.contact {
                let state = match &self.fallback {
                    Some(fallback) if fell_back => fallback.contact_state(),
                    _ => self.integrator.contact_state(),
                };
                if let Some(state) = state {
                    contact.state.copy_from(state);
                }
            }
            done += fraction;
            if driven_potentials {
                let (before, after) = (&self.before, &*state);
                let ends = ((before.t, &before.x[..]), (after.t, &after.x[..]));
                tally.work += self.model.potential_work(ends.0, ends.1);
            }
            // The end of the step is set by the caller, free of accumulated round-off.
            state.t = start + done * h;
            tally.substeps += 1;
            tally.residual = tally.residual.max(accepted.residual);
            tally.path = tally.path.max(accepted.path);
            tally.work += accepted.work + accepted.driven + accepted.contact.bodies;
            tally.friction += accepted.contact.friction;
            let dissipated = damp(&self.model, state, fraction * h);
            tally.dissipated += dissipated;
            self.account.spend(dissipated);
            patience = patience.saturating_sub(1);
            let growth = if patience == 0 { 2.0 } else { 1.0 };
            fraction = largest_fraction(done).min(growth * fraction);
        }
        Ok(())
    }

    /// Refuses prescribed motions that are not finite.
    fn check_pins(&self, t: f64) -> Result<(), StepError> {
        match self.model.find_bad_motion(t) {
            None => Ok(()),
            Some((support, value)) => Err(StepError::NonFiniteMotion { support, value, t }),
        }
    }

    /// Ends a step that no sub-step was accepted in: at a taut state, or with the reason.
    fn stop(
        &self,
        state: &State,
        end: f64,
        min_step: f64,
        cause: StepError,
        tally: &mut Tally,
    ) -> Result<(), StepError> {
        if self.model.has_drives()
            && let Some(excess) = excess(&self.model, state, end)
        {
            return match self.control.unsatisfiable {
                Unsatisfiable::Refuse => Err(StepError::Unsatisfiable { t: state.t, excess }),
                Unsatisfiable::StopTaut => {
                    tally.taut = Some(excess);
                    Ok(())
                }
            };
        }
        Err(self.diagnose(state, min_step, cause))
    }

    /// Says why no step was accepted: dependent rods, if that is what they are.
    fn diagnose(&self, state: &State, min_step: f64, cause: StepError) -> StepError {
        if self.integrator.demand() == RodDemand::Independent
            && let Some(rank) = rod_rank(&self.model, &state.x)
            && rank.smallest < DEPENDENT_RODS
        {
            return StepError::RankDeficient {
                t: state.t,
                rank_deficiency: rank.deficiency,
                smallest_singular_value: rank.smallest,
            };
        }
        StepError::StepTooSmall {
            t: state.t,
            min_step,
            cause: Box::new(cause),
        }
    }
}

/// Work of the moving supports in the sub-step between two states, `kept` being the forces in the one before.
fn drive_work(
    model: &SheetModel,
    balance: &Balance,
    kept: Option<&Balance>,
    before: &State,
    after: &State,
) -> f64 {
    balance.drive_work(model, kept, (before.t, &before.x), (after.t, &after.x))
}

fn scene<'a>(model: &'a SheetModel, contact: &'a mut Option<RunContact>) -> Scene<'a> {
    Scene {
        model,
        contact: contact.as_mut().map(RunContact::step),
    }
}

/// Applies velocity damping over a step; returns the energy taken out.
fn damp(model: &SheetModel, state: &mut State, h: f64) -> f64 {
    if model.damping() == 0.0 {
        return 0.0;
    }
    let before = model.kinetic_energy(&state.v);
    let factor = (-model.damping() * h).exp();
    state.v.iter_mut().for_each(|v| *v *= factor);
    before * (1.0 - factor * factor)
}

/// The largest sub-step `2^-k` that may start after the fraction `done` of a step.
fn largest_fraction(done: f64) -> f64 {
    let mut fraction = 1.0;
    while (done / fraction).fract() != 0.0 {
        fraction *= 0.5;
    }
    fraction
}

/// Smallest singular value (of the rigidity matrix with unit rods) below which dependence of
/// the rods is named as the reason of a failure: the referee integrations of the smoothest
/// known runs pass values down to 1e-6 only with steps of a microsecond.
const DEPENDENT_RODS: f64 = 1e-5;
