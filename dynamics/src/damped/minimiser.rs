//! Minimisation of an implicit step's incremental potential under the length constraints.

mod lagrangian;
mod newton;
mod phase;
pub(crate) mod problem;
mod second_order;
#[cfg(test)]
mod tests;
mod workspace;

use crate::report::effort::SolverEffort;
use crate::report::totals::not_converged;
use crate::step::history::History;
use crate::step::integrator::Attempt;
use crate::step::reaction::Balance;
use crate::step::tuning::Tuning;
use crate::{ImplicitOptions, SheetModel};
use isosheet_linalg::LinalgError;
use isosheet_linalg::parallel::Awake;
use isosheet_model::Reason;
use isosheet_model::StepError;
use isosheet_model::TraceEvent;
use isosheet_model::term::Exchange;
pub(crate) use lagrangian::Stability;
use lagrangian::{Merit, OPERATIONS};
use nalgebra::Vector3;
use newton::{Failure, Minimum, Newton};
use phase::{Faces, MultiplierUpdate, Phase};
use problem::StepProblem;
use workspace::Workspace;

/// Finds the positions with the rest lengths that minimise the incremental potential of a step: a
/// minimisation that always descends, in place of a root finder that may not converge.
///
/// One iteration, [`Newton`], is applied in the phases of the table at [`Phase::table`] until one ends at a
/// minimum that is not above the start.
///
/// With contact every displacement is cut to the part that is proven to bring nothing into contact. Pins and
/// bodies in motion start where they were and advance with the iterates.
pub(crate) struct Minimiser {
    work: Workspace,
    faces: Faces,
    /// The arrays of [`StepStart`]: `y`, the prediction, and where the velocities lead.
    ///
    /// [`StepStart`]: isosheet_model::term::StepStart
    pub(crate) start: [Vec<f64>; 3],
}

impl Minimiser {
    pub(crate) fn new(
        model: &SheetModel,
        options: ImplicitOptions,
        tuning: &Tuning,
    ) -> Result<Self, LinalgError> {
        let n = model.coordinate_count();
        Ok(Self {
            work: Workspace::new(model, options, *tuning)?,
            faces: Faces::of(model, tuning),
            start: [(); 3].map(|()| vec![0.0; n]),
        })
    }

    /// The result, positions of `3V` coordinates.
    pub(crate) fn x(&self) -> &[f64] {
        &self.work.lagrangian.x
    }

    /// Forces of the supports at the result.
    pub(crate) fn balance(&self) -> &Balance {
        &self.work.balance
    }

    /// Takes over the history of an attempt; `h` is the effective step.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn recall(
        &mut self,
        model: &SheetModel,
        attempt: &Attempt<'_>,
        h: f64,
    ) -> Result<(), LinalgError> {
        let work = &mut self.work;
        let last = attempt.multipliers();
        work.remembered.fill(0.0);
        work.lagrangian.clear_multipliers();
        // Whatever the ratio: what holds a sheet at rest, or parts whose rods lock, is the same in shorter
        // steps.
        if last.step > 0.0 {
            let ratio = (h / last.step).powi(2);
            for (m, l) in work.remembered.iter_mut().zip(&last.rods) {
                *m = ratio * l;
            }
            let constraints = &mut work.lagrangian.vertex_rows.multipliers;
            for (m, l) in constraints.iter_mut().zip(&last.constraints) {
                *m = ratio * l;
            }
        }
        work.rod_stiffness = attempt.rod_stiffness();
        work.lagrangian.matrix.begin();
        work.lagrangian.matrix.reserve(model, attempt.couplings())
    }

    /// Whether the equilibrium that was found last is stable: it is a minimum of steps of so many seconds.
    pub(crate) fn stability(
        &mut self,
        problem: &mut StepProblem<'_>,
        length: f64,
        effort: &mut SolverEffort<'_>,
    ) -> Stability {
        let Workspace {
            lagrangian,
            options,
            tuning,
            ..
        } = &mut self.work;
        // Rods are springs here, as stiff as in the step.
        let longer = length / problem.h();
        lagrangian.set_stiffness(
            tuning.first_stiffness * longer * longer,
            options.stiffness * longer * longer,
        );
        lagrangian.scale_multipliers(longer);
        problem.start.h = length;
        lagrangian.merit(problem);
        let stability = lagrangian.stability(problem, options.seed, effort);
        lagrangian.scale_multipliers(1.0 / longer);
        stability
    }

    /// Displaces what was found last at random; it is in [`Minimiser::x`].
    pub(crate) fn disturb(&mut self, problem: &mut StepProblem<'_>, part: f64) {
        let Workspace {
            lagrangian,
            options,
            ..
        } = &mut self.work;
        lagrangian.perturb(problem, options.seed, part);
    }

    /// Makes the multipliers of the last minimisation the first guess of the next, whose effective step is so
    /// many times as long.
    pub(crate) fn recall_last(&mut self, longer: f64) {
        let Workspace {
            lagrangian,
            remembered,
            ..
        } = &mut self.work;
        lagrangian.scale_multipliers(longer);
        remembered.copy_from_slice(&lagrangian.multipliers);
    }

    /// Forgets the multipliers.
    pub(crate) fn forget(&mut self) {
        self.work.remembered.fill(0.0);
        self.work.lagrangian.clear_multipliers();
    }

    /// The multipliers of rods and of vertex constraints at the result.
    pub(crate) fn multipliers(&self) -> (Vec<f64>, Vec<Vector3<f64>>) {
        let lagrangian = &self.work.lagrangian;
        let constraints = lagrangian.vertex_rows.multipliers.clone();
        (lagrangian.multipliers.clone(), constraints)
    }

    /// Leaves what the step that was just minimised gives to the next; `h` is the effective step.
    pub(crate) fn remember(&self, h: f64, history: &mut History) {
        let work = &self.work;
        let lagrangian = &work.lagrangian;
        let constraints = lagrangian.vertex_rows.multipliers.iter().copied();
        let multipliers = &mut history.multipliers;
        multipliers.set(h, &lagrangian.multipliers, constraints);
        history.rod_stiffness = work.rod_stiffness;
        history.couplings.clear();
        let pairs = lagrangian.matrix.extra_pairs();
        history.couplings.extend_from_slice(pairs);
    }

    /// Minimises the incremental potential over all positions with the rest lengths; the result is in
    /// [`Minimiser::x`], the forces of the supports in [`Minimiser::balance`].
    ///
    /// The positions at the start have the rest lengths too, so a result with a higher
    /// incremental potential than theirs is no minimum, and would create energy: then the
    /// next phase is tried. (Where pins or bodies move, the start is not among the
    /// positions to choose from, and there is no such bound.)
    ///
    /// # Errors
    /// [`StepError::NotConverged`] with the reason of the last phase; [`StepError::Contact`] if the step
    /// would end in contact.
    pub(crate) fn minimise(
        &mut self,
        problem: &mut StepProblem<'_>,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(Minimum, Exchange), StepError> {
        // An iteration has many short pieces between the factorisations that are shared.
        let _awake = self.work.lagrangian.matrix.is_shared().then(Awake::new);
        self.work.refusal = None;
        self.work.lagrangian.begin(problem)?;
        let is_driven = self.work.lagrangian.is_driven(problem) || problem.model.has_drives();
        let bound = (!is_driven).then(|| self.work.lagrangian.merit(problem));
        let phases = Phase::table(problem, self.faces, &self.work.options, &self.work.tuning);
        let mut found = Err(Failure {
            reason: Reason::Iterations,
            residual: f64::INFINITY,
        });
        for (rank, phase) in phases.into_iter().flatten().enumerate() {
            if rank > 0 {
                self.work.lagrangian.begin(problem)?;
            }
            effort.trace(|| TraceEvent::Phase {
                t: problem.state().t,
                h: problem.start.span,
                phase: phase.name,
            });
            found = Newton::new(&mut self.work, problem, effort, phase).run();
            if let Ok(Minimum { residual, .. }) = found
                && !self.is_below(bound.as_ref(), &phase, problem)
            {
                let reason = Reason::AboveStart;
                found = Err(Failure { reason, residual });
            }
            let Err(Failure { reason, .. }) = found else {
                break;
            };
            effort.trace(|| TraceEvent::Failed {
                phase: phase.name,
                reason,
                strain: problem.model.constrained_strain(self.x()),
            });
        }
        let minimum = found.map_err(|Failure { reason, residual }| {
            let strain = problem.model.constrained_strain(self.x());
            let (t, h) = (problem.state().t, problem.start.span);
            let refusal = self.work.refusal.take();
            refusal.unwrap_or_else(|| not_converged(t, h, effort, reason, residual, strain))
        })?;
        let start = problem.start;
        let (objective, at) = problem.objective_at(&self.work.lagrangian.x);
        let mut exchange = objective.finish(&start, at)?;
        exchange.length_slack = self.length_slack(problem);
        Ok((minimum, exchange))
    }

    /// Whether the incremental potential at the iterate is not above `bound`, but for what the tolerance of
    /// the lengths and round-off allow. (Where multipliers were solved for no allowance is made for the
    /// lengths: at rest they are due to round-off, and to correct round-off in the lengths of a nearly flat
    /// sheet would set it in motion.)
    fn is_below(
        &mut self,
        bound: Option<&Merit>,
        phase: &Phase,
        problem: &mut StepProblem<'_>,
    ) -> bool {
        let Some(bound) = bound else { return true };
        let now = self.work.lagrangian.merit(problem);
        let rod_scale = match phase.multipliers {
            MultiplierUpdate::Solved => 0.0,
            MultiplierUpdate::Rounds => now.rod_scale.max(bound.rod_scale),
        };
        let slack = problem.h().powi(2) * self.length_slack(problem)
            + OPERATIONS
                * (now.round_off
                    + bound.round_off
                    + self.work.options.strain_tolerance * rod_scale);
        now.potential <= bound.potential + slack
    }

    /// Energy that the tolerance of the lengths leaves open, joules.
    ///
    /// In contact, at rest: a flat sheet folds by the root of a length error; its weight is lifted by a part
    /// of that.
    fn length_slack(&self, problem: &StepProblem<'_>) -> f64 {
        if !problem.has_contact() {
            return 0.0;
        }
        let fold = self.work.options.strain_tolerance.sqrt() * problem.model.mean_length();
        fold * problem.objective.force_sum()
    }
}
