//! Minimisation of an implicit step's incremental potential under the length constraints.

mod augmented_lagrangian;
mod lagrangian;
pub(crate) mod problem;
mod second_order;
mod sqp;
#[cfg(test)]
mod tests;

use crate::ImplicitOptions;
use crate::contact::{ContactState, ContactWork};
use crate::damped::restoration::{FirstMatrix, Restoration, RestorationContact, RestorationGoal};
use crate::model::round_off::strain_floor;
use crate::step::effort::SolverEffort;
use crate::step::history::History;
use crate::step::integrator::Attempt;
use crate::step::reaction::{Balance, ForceTime};
use crate::step::report::{self, StepError, StepOutcome};
use crate::{Isometry, SheetModel};
use augmented_lagrangian::{AugmentedLagrangian, Rounds};
use isosheet_coords::linalg::LinalgError;
use isosheet_mesh::area_from_lengths;
use lagrangian::{Lagrangian, Merit};
use problem::StepProblem;
use sqp::Sqp;

/// Part of the largest fold that the tolerance of the lengths allows by which contact at rest may move.
const FOLD_PART: f64 = 0.1;
/// Allowance for round-off, in units of its estimate, when two values of the incremental potential are
/// compared.
const COMPARISON_SLACK: f64 = 10.0;

/// Finds the positions with the rest lengths that minimise the incremental potential of a step: a
/// minimisation that always descends, in place of a root finder that may not converge.
///
/// Strategies are tried in this order until one ends at a minimum that is not above the start:
///
/// | strategy | from | without contact | in contact |
/// |---|---|---|---|
/// | [`Sqp`] | the start | first | first, unless supports move |
/// | [`AugmentedLagrangian`] | the prediction, without multipliers | second | second |
/// | [`AugmentedLagrangian`], exact rounds | the start, without multipliers | last, but not at rest | last |
///
/// At rest and without contact the last two strategies are the same.
///
/// Elastic sheets have no rods that programming would solve for, and are minimised by the last two
/// strategies.
///
/// Sheets with slivers, without contact, begin with the augmented Lagrangian from the prediction and its own
/// multipliers; programming comes after that.
///
/// With contact every displacement is cut to the part that is proven to bring nothing into contact. Pins and
/// bodies in motion start where they were and advance with the iterates.
pub(crate) struct Minimiser {
    options: ImplicitOptions,
    lagrangian: Lagrangian,
    restoration: Restoration,
    faces: Faces,
    /// Forces of the supports at the result.
    pub(crate) balance: Balance,
    /// Multipliers of the step before, scaled to this one; zero where there are none.
    remembered: Vec<f64>,
    /// Stiffness of the rods in the linear systems, in units of that of the masses: that of the step before,
    /// and after a minimisation that of this one. Zero where there was none.
    rod_stiffness: f64,
    /// Where inertia alone would take the sheet.
    pub(crate) prediction: Vec<f64>,
    /// Non-conservative forces, constant over the step.
    pub(crate) applied: Vec<f64>,
}

/// Altitude of a face, in parts of its longest side, from which rods 1e10 times as stiff as the masses hold
/// the face: a length error `d` of the long sides moves the apex of a face of altitude `a l` by `d l / a`, so
/// that slimmer faces need less than the 1e-10 that such rods let through for an error of 1e-4 in the
/// altitude.
const SLIMMEST: f64 = 1e-3;

/// What the slimmest face of a sheet allows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Faces {
    /// Any strategy.
    Compact,
    /// Strategies that are exact in the altitudes of slivers first.
    Slivers,
}

impl Faces {
    fn of(model: &SheetModel) -> Self {
        let lengths = model.rods().lengths();
        let is_sliver = |f| {
            let sides = model.topology().face_edges(f).map(|e| lengths[e.index()]);
            let longest = sides.iter().fold(0.0, |longest, side| side.max(longest));
            // (Rounded lengths of a sliver may make no triangle; its area is zero.)
            2.0 * area_from_lengths(sides) < SLIMMEST * longest * longest
        };
        if model.topology().face_ids().any(is_sliver) {
            Self::Slivers
        } else {
            Self::Compact
        }
    }
}

/// How a minimisation ended.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Minimum {
    /// Relative Newton decrement before the last iteration.
    pub(crate) residual: f64,
    /// What it took.
    pub(crate) outcome: StepOutcome,
}

/// What a restoration of the lengths is to reach.
#[derive(Debug, Clone, Copy)]
struct LengthGoal {
    /// Largest strain of the isometry.
    strain: f64,
    max_iterations: usize,
    matrix: FirstMatrix,
}

/// A strategy of the table at [`Minimiser`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Strategy {
    Sqp,
    FromPrediction,
    FromStart,
}

impl Strategy {
    /// In the order in which they are tried.
    fn list(problem: &StepProblem<'_>, faces: Faces) -> &'static [Self] {
        const ALL: [Strategy; 3] = [Strategy::Sqp, Strategy::FromPrediction, Strategy::FromStart];
        const SLIVERS: [Strategy; 3] =
            [Strategy::FromPrediction, Strategy::Sqp, Strategy::FromStart];
        let model = problem.model;
        let list: &[Self] = match (model.isometry(), problem.has_contact(), model.has_drives()) {
            (Isometry::Elastic, _, _) | (_, true, true) => &ALL[1..],
            (Isometry::Rods, false, _) if faces == Faces::Slivers => &SLIVERS,
            _ => &ALL,
        };
        // At rest the last strategy would repeat the one before it.
        let repeats = faces == Faces::Compact
            && !problem.has_contact()
            && problem.prediction == problem.state.x;
        &list[..list.len() - usize::from(repeats)]
    }
}

impl Minimiser {
    pub(crate) fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        let n = model.coordinate_count();
        Ok(Self {
            lagrangian: Lagrangian::new(model)?,
            restoration: Restoration::new(model),
            faces: Faces::of(model),
            balance: Balance::with_unassigned(model, ForceTime::End),
            remembered: vec![0.0; model.rods().len()],
            rod_stiffness: 0.0,
            prediction: vec![0.0; n],
            applied: vec![0.0; n],
            options,
        })
    }

    /// The result, positions of `3V` coordinates.
    pub(crate) fn x(&self) -> &[f64] {
        self.lagrangian.iterate.x()
    }

    /// The contacts at the result.
    pub(crate) fn contact_state(&self) -> Option<&ContactState> {
        self.lagrangian.iterate.contact_state()
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
        let last = attempt.multipliers();
        self.remembered.fill(0.0);
        self.lagrangian.clear_multipliers();
        // Whatever the ratio: what holds a sheet at rest, or parts whose rods lock, is the same in shorter
        // steps.
        if last.step > 0.0 {
            let ratio = (h / last.step).powi(2);
            for (m, l) in self.remembered.iter_mut().zip(&last.rods) {
                *m = ratio * l;
            }
            let constraints = &mut self.lagrangian.vertex_rows.multipliers;
            for (m, l) in constraints.iter_mut().zip(&last.constraints) {
                *m = ratio * l;
            }
        }
        self.rod_stiffness = attempt.rod_stiffness();
        self.lagrangian.matrix.begin();
        self.lagrangian.matrix.reserve(model, attempt.couplings())
    }

    /// Leaves what the step that was just minimised gives to the next; `h` is the effective step.
    pub(crate) fn remember(&self, h: f64, history: &mut History) {
        let lagrangian = &self.lagrangian;
        let constraints = lagrangian.vertex_rows.multipliers.iter().copied();
        let multipliers = &mut history.multipliers;
        multipliers.set(h, &lagrangian.multipliers, constraints);
        history.rod_stiffness = self.rod_stiffness;
        history.couplings.clear();
        let pairs = lagrangian.matrix.extra_pairs();
        history.couplings.extend_from_slice(pairs);
    }

    /// Minimises the incremental potential over all positions with the rest lengths; the result is in
    /// [`Minimiser::x`], the forces of the supports in `balance`.
    ///
    /// The positions at the start have the rest lengths too, so a result with a higher
    /// incremental potential than theirs is no minimum, and would create energy: then the
    /// next strategy is tried. (Where pins or bodies move, the start is not among the
    /// positions to choose from, and there is no such bound.)
    ///
    /// # Errors
    /// That of the last strategy; [`StepError::Contact`] if the step would end in contact.
    pub(crate) fn minimise(
        &mut self,
        mut problem: StepProblem<'_>,
        effort: &mut SolverEffort<'_>,
    ) -> Result<(Minimum, ContactWork), StepError> {
        let problem = &mut problem;
        self.lagrangian.begin(problem);
        let is_driven = self.lagrangian.is_driven(problem) || problem.model.has_drives();
        let bound = (!is_driven).then(|| self.lagrangian.merit(problem));
        let mut outcome = None;
        for (rank, strategy) in Strategy::list(problem, self.faces).iter().enumerate() {
            if rank > 0 {
                self.lagrangian.begin(problem);
            }
            let found = self.apply(*strategy, problem, effort);
            let is_minimum = found.is_ok() && self.is_below(bound.as_ref(), *strategy, problem);
            outcome = Some(found);
            if is_minimum {
                break;
            }
            if let Some(Ok(minimum)) = outcome {
                let strain = problem.model.constrained_strain(self.x());
                let residual = minimum.residual;
                outcome = Some(Err(not_converged(problem, effort, residual, strain)));
            }
        }
        let minimum = outcome.expect("there is always a strategy")?;
        let mut work = self.lagrangian.iterate.contact_work(problem.contact());
        work.length_slack = self.length_slack(problem);
        if let Some(terms) = self.lagrangian.iterate.terms(problem.contact()) {
            let gap = terms.active.gap();
            if gap <= 0.0 || gap.is_nan() {
                return Err(StepError::Contact {
                    t: problem.state.t,
                    h: problem.span,
                    gap,
                });
            }
        }
        Ok((minimum, work))
    }

    fn apply(
        &mut self,
        strategy: Strategy,
        problem: &mut StepProblem<'_>,
        effort: &mut SolverEffort<'_>,
    ) -> Result<Minimum, StepError> {
        match strategy {
            Strategy::Sqp => {
                // In contact the multipliers of nearly dependent rods are arbitrary from step to step.
                if problem.has_contact() {
                    self.lagrangian.multipliers.fill(0.0);
                } else {
                    let remembered = &self.remembered;
                    self.lagrangian.multipliers.copy_from_slice(remembered);
                }
                let found = Sqp::new(self, problem, effort).run();
                let residual = found.ok_or_else(|| {
                    let strain = problem.model.constrained_strain(self.x());
                    not_converged(problem, effort, f64::INFINITY, strain)
                })?;
                let outcome = StepOutcome::Newton;
                Ok(Minimum { residual, outcome })
            }
            Strategy::FromPrediction => {
                // The multipliers of sequential quadratic programming grow without bound where rods are
                // nearly dependent, and are no start here; those of this strategy, which slivers begin with,
                // are.
                match self.faces {
                    Faces::Slivers => {
                        let remembered = &self.remembered;
                        self.lagrangian.multipliers.copy_from_slice(remembered);
                    }
                    Faces::Compact => self.lagrangian.clear_multipliers(),
                }
                self.lagrangian.predict(problem);
                AugmentedLagrangian::new(self, problem, Rounds::Loose, effort).run()
            }
            Strategy::FromStart => {
                self.lagrangian.clear_multipliers();
                if !problem.is_bounded() {
                    self.lagrangian.place_pins(problem);
                }
                let minimum =
                    AugmentedLagrangian::new(self, problem, Rounds::Exact, effort).run()?;
                Ok(Minimum {
                    outcome: minimum.outcome.max(StepOutcome::Globalised),
                    ..minimum
                })
            }
        }
    }

    /// Restores the lengths at the iterate against the given loads of the supports and the contact forces.
    /// Returns the strain reached. The forces of the supports are those before, with their share in the
    /// restoration.
    fn restore(
        &mut self,
        problem: &mut StepProblem<'_>,
        to: LengthGoal,
        effort: &mut SolverEffort<'_>,
    ) -> f64 {
        let per = 1.0 / (problem.h * problem.h);
        let is_last = to.strain <= self.strain_tolerance(problem);
        if is_last {
            self.set_balance(problem);
        }
        let (model, t) = (problem.model, problem.t());
        let lagrangian = &mut self.lagrangian;
        let goal = RestorationGoal {
            tolerance: to.strain,
            max_iterations: to.max_iterations.min(self.options.max_projections),
            t,
            loads: &lagrangian.vertex_rows.multipliers,
            matrix: to.matrix,
        };
        let contact = problem.contact_mut().map(|contact| RestorationContact {
            contact,
            scale: 1.0 / per,
        });
        let (matrix, iterate) = (&mut lagrangian.matrix, &mut lagrangian.iterate);
        let strain = self
            .restoration
            .positions(model, matrix, contact, iterate, goal, effort);
        if is_last {
            self.balance
                .unassigned
                .append(&self.restoration.unassigned, per);
        }
        strain
    }

    /// Edge strain that accepted positions may have.
    fn strain_tolerance(&self, problem: &StepProblem<'_>) -> f64 {
        let floor = strain_floor(problem.model, problem.state);
        self.options.strain_tolerance.max(floor)
    }

    /// Forces of the supports at the iterate, with what it leaves unbalanced.
    fn set_balance(&mut self, problem: &StepProblem<'_>) {
        let (model, state) = (problem.model, problem.state);
        let per = 1.0 / (problem.h * problem.h);
        let lagrangian = &mut self.lagrangian;
        let (x, prediction) = (lagrangian.iterate.x(), problem.prediction);
        if !self.balance.begin(model, |i| per * (x[i] - prediction[i])) {
            return;
        }
        self.balance.add_potentials(model, problem.t(), x, 1.0);
        self.balance
            .add_applied(model, state.t, &state.x, &state.v, 1.0);
        if let Some(terms) = lagrangian.iterate.terms(problem.contact()) {
            self.balance.add_contact(&terms);
        }
        let (rows, x) = (&lagrangian.vertex_rows, lagrangian.iterate.x());
        self.balance
            .add_rods(model, x, &lagrangian.multipliers, per);
        self.balance.add_constraints(rows, &rows.multipliers, per);
        self.balance.leave(model, x, &rows.active);
    }

    /// Whether the incremental potential at the iterate is not above `bound`, but for what the tolerance of
    /// the lengths and round-off allow. (Of sequential quadratic programming no allowance is made for the
    /// lengths: at rest its multipliers are those of round-off, and to correct round-off in the lengths of a
    /// nearly flat sheet would set it in motion.)
    fn is_below(
        &mut self,
        bound: Option<&Merit>,
        strategy: Strategy,
        problem: &StepProblem<'_>,
    ) -> bool {
        let Some(bound) = bound else { return true };
        let now = self.lagrangian.merit(problem);
        let rod_scale = match strategy {
            Strategy::Sqp => 0.0,
            Strategy::FromPrediction | Strategy::FromStart => now.rod_scale.max(bound.rod_scale),
        };
        let slack = problem.h * problem.h * self.length_slack(problem)
            + COMPARISON_SLACK * (now.round_off + bound.round_off)
            + COMPARISON_SLACK * self.options.strain_tolerance * rod_scale;
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
        let fold = self.options.strain_tolerance.sqrt() * problem.model.mean_length();
        let force = &self.lagrangian.force;
        FOLD_PART * fold * force.iter().map(|f| f.abs()).sum::<f64>()
    }
}

/// The error of a minimisation that did not converge.
fn not_converged(
    problem: &StepProblem<'_>,
    effort: &SolverEffort<'_>,
    residual: f64,
    strain: f64,
) -> StepError {
    report::not_converged(problem.state.t, problem.span, effort, residual, strain)
}
