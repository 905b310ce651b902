//! Minimisation of an implicit step's incremental potential under the length constraints.

mod history;
mod merit;
mod newton;
mod tangent;

use crate::ImplicitOptions;
use crate::constraint::rows::VertexRows;
use crate::contact::{ContactState, ContactWork, StepContact, StepSpan};
use crate::integrator::Scene;
use crate::iterate::Iterate;
use crate::primal::{PrimalMatrix, penalties};
use crate::project::Projector;
use crate::reaction::{Balance, ForceTime};
use crate::report::{Effort, Path, StepError};
use crate::{SheetModel, State};
use isosheet_coords::linalg::LinalgError;
use merit::Merit;
use tangent::Pace;

/// Ratios of squared steps over which multipliers are carried; beyond, the motion has changed too
/// much for them to be of use.
const MULTIPLIER_RATIOS: std::ops::RangeInclusive<f64> = 0.05..=20.0;
/// Edge strain from which the projection of a sheet in contact is a small step. Where it is not, for a nearly
/// flat sheet folds by the root of its length error, the second attempt leaves nothing to the projection.
const READY: f64 = 1e-5;
/// Part of the largest fold that the tolerance of the lengths allows by which contact at rest may move.
const FOLD_PART: f64 = 0.1;
/// Vertices above which steps without contact begin at the prediction. The manifold of a nearly flat sheet is the more curved the finer
/// its mesh: hanging from near flat, 289 vertices need 3 tangent steps, 16 641 some 90, and from the prediction 8.
const MANY: usize = 1000;
/// Relative change of friction's normal forces below which they count as settled.
const SETTLED: f64 = 0.05;

/// Minimises `|x - target|_M^2 / 2 + h^2 (V(x) + B(x) + D(x - x0) - f . x)` over all positions with the rest lengths,
/// `B` and `D` being contact and its friction where a scene has any: a minimisation that always descends, in place of a
/// root finder that may not converge.
///
/// * Along the manifold: tangent steps from the start, each projected, see [`Minimiser::tangent_steps`]. First choice in contact and,
///   at a brisk pace and then at a careful one, for sheets without contact that are neither fine nor of slivers.
/// * From the prediction: an augmented Lagrangian with the impulses of the previous step as multipliers, minimised by
///   Newton's method with line search, whose Hessian is tried as it is and, where it is indefinite, with the negative part of the
///   rods' geometric stiffness left out; then a projection onto the lengths, which makes them exact.
/// * From the start: the augmented Lagrangian again, more carefully and without what is left from earlier steps.
///
/// With contact every displacement, of either stage, is cut to the part that is proven to bring nothing into contact. Pins and
/// bodies in motion start where they were and advance with the iterates.
pub(crate) struct Minimiser {
    options: ImplicitOptions,
    matrix: PrimalMatrix,
    projector: Projector,
    /// Impulse multipliers of the rods (h^2 times force densities), kept from step to step.
    multipliers: Vec<f64>,
    /// Those of the first round, whose penalty is the one that the next step begins with. (In a nearly flat sheet
    /// the ones of later rounds grow without bound.)
    first_multipliers: Vec<f64>,
    /// Those of the tangent steps, which begin with none in contact.
    tangent_multipliers: Vec<f64>,
    penalty: Vec<f64>,
    /// The penalty that every step begins with.
    first_penalty: Vec<f64>,
    along: Vec<f64>,
    across: Vec<f64>,
    density: Vec<f64>,
    c: Vec<f64>,
    change: Vec<f64>,
    /// Whether the prediction is the first choice without contact.
    is_hard_to_follow: bool,
    /// Edge strain from which the projection takes over where there is contact.
    ready: f64,
    /// Vertices on curves and surfaces.
    vertex_rows: VertexRows,
    /// Where inertia alone would take the sheet.
    pub(crate) target: Vec<f64>,
    force: Vec<f64>,
    /// Non-conservative forces, constant over the step.
    pub(crate) applied: Vec<f64>,
    gradient: Vec<f64>,
    difference: Vec<f64>,
    weighted: Vec<f64>,
    dx: Vec<f64>,
    /// The iterate and, after [`Minimiser::minimise`], the result.
    iterate: Iterate,
    start: Vec<f64>,
    /// Where prescribed motions end, at the pinned vertices.
    end: Vec<f64>,
    pub(crate) balance: Balance,
}

/// Ways to a minimum that are tried before the careful one.
#[derive(Clone, Copy)]
enum Way {
    /// [`Minimiser::go_along_manifold`].
    Manifold(Pace),
    /// [`Minimiser::go_from_prediction`].
    Prediction,
}

/// The problem of one step.
struct Step<'a, 'b> {
    scene: &'a mut Scene<'b>,
    state: &'a State,
    /// Time at the end, seconds.
    t: f64,
    /// Effective step, the root of the factor of the forces, seconds.
    h: f64,
}

impl Step<'_, '_> {
    fn has_contact(&self) -> bool {
        self.scene.contact.is_some()
    }
}

impl<'b> Step<'_, 'b> {
    fn contact(&self) -> Option<&StepContact<'b>> {
        self.scene.contact.as_ref()
    }

    fn contact_mut(&mut self) -> Option<&mut StepContact<'b>> {
        self.scene.contact.as_mut()
    }
}

impl Minimiser {
    pub(crate) fn new(model: &SheetModel, options: ImplicitOptions) -> Result<Self, LinalgError> {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Ok(Self {
            matrix: PrimalMatrix::new(model)?,
            projector: Projector::new(model),
            multipliers: vec![0.0; m],
            first_multipliers: vec![0.0; m],
            tangent_multipliers: vec![0.0; m],
            penalty: penalties(model, options.stiffness),
            first_penalty: penalties(model, options.stiffness),
            along: vec![0.0; m],
            across: vec![0.0; m],
            density: vec![0.0; m],
            c: vec![0.0; m],
            change: vec![0.0; m],
            is_hard_to_follow: model.topology().vertex_count() > MANY
                || tangent::has_slivers(model),
            ready: READY,
            vertex_rows: VertexRows::new(
                model.constraints(),
                model.constrained_vertices(),
                options.stiffness,
            ),
            target: vec![0.0; n],
            force: vec![0.0; n],
            applied: vec![0.0; n],
            gradient: vec![0.0; n],
            difference: vec![0.0; n],
            weighted: vec![0.0; n],
            dx: vec![0.0; n],
            iterate: Iterate::new(n),
            start: vec![0.0; n],
            end: vec![0.0; n],
            balance: Balance::with_trail(model, ForceTime::End),
            options,
        })
    }

    /// The result, positions of `3V` coordinates.
    pub(crate) fn x(&self) -> &[f64] {
        self.iterate.x()
    }

    /// The contacts at the result.
    pub(crate) fn contact_state(&self) -> Option<&ContactState> {
        self.iterate.contact_state()
    }

    /// Minimises the incremental potential over all positions with the rest lengths, with
    /// [`Minimiser::target`] and [`Minimiser::applied`] set. `span` is the step, `h` the effective step, the
    /// factor of the acceleration being `h^2`; forces are those at the end.
    ///
    /// The positions at the start have the rest lengths too, so a result with a higher
    /// incremental potential than theirs is no minimum, and would create energy: then the
    /// minimisation starts anew, from them. (Where pins or bodies move, the start is not among the
    /// positions to choose from, and there is no such bound.)
    ///
    /// Returns the relative Newton decrement, the path and what contact did.
    pub(crate) fn minimise(
        &mut self,
        mut scene: Scene<'_>,
        state: &State,
        span: f64,
        h: f64,
        effort: &mut Effort,
    ) -> Result<(f64, Path, ContactWork), StepError> {
        let mut step = Step {
            scene: &mut scene,
            state,
            t: state.t + span,
            h,
        };
        self.begin(&mut step, span);
        let driven = self.is_driven(&step) || step.scene.model.has_drives();
        let bound = (!driven).then(|| self.merit(&step));
        let bound = bound.as_ref();
        let ways: &[Way] = if step.has_contact() {
            // Resting in contact is a matter of nearly dependent rods.
            &[Way::Manifold(Pace::Careful), Way::Prediction]
        } else if self.is_hard_to_follow {
            &[Way::Prediction, Way::Manifold(Pace::Careful)]
        } else {
            &[
                Way::Manifold(Pace::Brisk),
                Way::Manifold(Pace::Careful),
                Way::Prediction,
            ]
        };
        let mut found = None;
        for (attempt, way) in ways.iter().enumerate() {
            if attempt > 0 {
                self.begin(&mut step, span);
            }
            found = match *way {
                Way::Prediction => self.go_from_prediction(&mut step, effort),
                Way::Manifold(pace) => self.go_along_manifold(&mut step, pace, effort),
            };
            found = found.filter(|_| self.is_below(bound, &step));
            if found.is_some() {
                break;
            }
        }
        let (residual, path) = match found {
            Some(found) => found,
            None => {
                self.begin(&mut step, span);
                self.go_from_start(&mut step, bound, effort)?
            }
        };
        let mut work = self.iterate.contact_work(step.contact());
        if let Some(terms) = self.iterate.terms(step.contact()) {
            let gap = terms.active.gap();
            work.length_slack = self.length_slack(&step);
            if gap <= 0.0 || gap.is_nan() {
                self.forget();
                return Err(StepError::Contact {
                    t: state.t,
                    h: span,
                    gap,
                });
            }
        }
        Ok((residual, path, work))
    }

    /// Tangent steps from the positions at the start. In contact, where motions are small or blocked, they need a fraction of the
    /// factorisations of the other ways, and come to rest; without contact, half to two thirds. Bodies in motion
    /// advance with the iterates; supports in motion are left to the other ways.
    fn go_along_manifold(
        &mut self,
        step: &mut Step<'_, '_>,
        pace: Pace,
        effort: &mut Effort,
    ) -> Option<(f64, Path)> {
        if step.scene.model.has_drives() {
            return None;
        }
        let residual = self.tangent_steps(step, pace, effort)?;
        self.multipliers.copy_from_slice(&self.tangent_multipliers);
        Some((residual, Path::Newton))
    }

    /// The augmented Lagrangian from where inertia alone would go.
    fn go_from_prediction(
        &mut self,
        step: &mut Step<'_, '_>,
        effort: &mut Effort,
    ) -> Option<(f64, Path)> {
        self.predict(step);
        self.ready = READY;
        self.descend(step, effort).ok()
    }

    /// The augmented Lagrangian from the positions at the start, without what is left from earlier steps.
    fn go_from_start(
        &mut self,
        step: &mut Step<'_, '_>,
        bound: Option<&Merit>,
        effort: &mut Effort,
    ) -> Result<(f64, Path), StepError> {
        let (model, state) = (step.scene.model, step.state);
        self.forget();
        self.ready = self.options.strain_tolerance;
        if !step.has_contact() {
            model.place_pins(step.t, self.iterate.x_mut());
        }
        let (residual, path) = self.descend(step, effort)?;
        if !self.is_below(bound, step) {
            self.forget();
            let strain = model.rods().max_strain(self.iterate.x());
            let span = step.t - state.t;
            return Err(not_converged(state.t, span, effort, residual, strain));
        }
        Ok((residual, path.max(Path::Globalised)))
    }

    /// Forces of the supports at the iterate, with what it leaves unbalanced.
    fn set_balance(&mut self, step: &Step<'_, '_>) {
        let (model, state, per) = (step.scene.model, step.state, 1.0 / (step.h * step.h));
        let (x, target) = (self.iterate.x(), &self.target);
        if !self.balance.begin(model, |i| per * (x[i] - target[i])) {
            return;
        }
        self.balance.add_potentials(model, step.t, x, 1.0);
        self.balance
            .add_applied(model, state.t, &state.x, &state.v, 1.0);
        if let Some(terms) = self.iterate.terms(step.contact()) {
            self.balance.add_contact(&terms);
        }
        let x = self.iterate.x();
        self.balance.add_rods(model, x, &self.multipliers, per);
        let rows = &self.vertex_rows;
        self.balance.add_constraints(rows, &rows.multipliers, per);
        self.balance.leave(model, x, &rows.active);
    }

    /// Drops the multipliers.
    fn forget(&mut self) {
        self.multipliers.fill(0.0);
        self.vertex_rows.clear();
    }

    /// Puts the iterate, pins' ends and bodies where a step of `h` seconds starts.
    fn begin(&mut self, step: &mut Step<'_, '_>, h: f64) {
        let state = step.state;
        self.end.copy_from_slice(&state.x);
        step.scene.model.place_pins(step.t, &mut self.end);
        let span = StepSpan { t0: state.t, h };
        self.iterate.begin(step.contact_mut(), span, &state.x);
    }

    /// Whether bodies or pins are on their way.
    fn is_driven(&self, step: &Step<'_, '_>) -> bool {
        let x = self.iterate.x();
        self.iterate.progress() < 1.0
            || step
                .scene
                .model
                .moving_pins()
                .any(|v| (3 * v..3 * v + 3).any(|i| x[i] != self.end[i]))
    }

    /// Starts the iteration where inertia alone would go, unless something is in the way.
    fn predict(&mut self, step: &mut Step<'_, '_>) {
        let model = step.scene.model;
        self.start.copy_from_slice(&self.target);
        model.place_pins(step.t, &mut self.start);
        if step.has_contact() {
            for ((d, x), x0) in self.dx.iter_mut().zip(&self.start).zip(self.iterate.x()) {
                *d = x - x0;
            }
            if self.iterate.safe_fraction(step.contact_mut(), &self.dx) < 1.0 {
                return;
            }
            self.iterate.advance_bodies(1.0);
        }
        self.iterate.x_mut().copy_from_slice(&self.start);
    }

    /// Whether the incremental potential at the iterate is not above `bound`, but for what the
    /// tolerance of the lengths and round-off allow.
    fn is_below(&mut self, bound: Option<&Merit>, step: &Step<'_, '_>) -> bool {
        let Some(bound) = bound else { return true };
        let now = self.merit(step);
        let length_slack = if step.has_contact() {
            step.h * step.h * self.length_slack(step)
        } else {
            0.0
        };
        let slack = length_slack
            + 10.0 * (now.round_off + bound.round_off)
            + 10.0 * self.options.strain_tolerance * now.rod_scale.max(bound.rod_scale);
        now.potential <= bound.potential + slack
    }

    /// Energy that the tolerance of the lengths leaves open to a sheet at rest in contact, joules. A flat
    /// sheet folds by the root of a length error; its weight is lifted by a part of that.
    fn length_slack(&self, step: &Step<'_, '_>) -> f64 {
        let fold = self.options.strain_tolerance.sqrt() * step.scene.model.mean_length();
        FOLD_PART * fold * self.force.iter().map(|f| f.abs()).sum::<f64>()
    }
}

pub(crate) fn not_converged(
    t: f64,
    h: f64,
    effort: &Effort,
    residual: f64,
    strain: f64,
) -> StepError {
    StepError::NotConverged {
        t,
        h,
        iterations: effort.iterations,
        residual,
        strain,
    }
}
