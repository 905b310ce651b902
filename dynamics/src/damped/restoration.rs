//! Projection of positions onto the rest lengths.

mod correction;

use crate::SheetModel;
use crate::damped::ARMIJO;
use crate::linear::constrained::ConstrainedSolver;
use crate::linear::constraint_rows::VertexRows;
use crate::linear::free::penalties;
use crate::linear::primal::PrimalMatrix;
use crate::objective::Objective;
use crate::report::effort::SolverEffort;
use crate::step::residual_momentum::ResidualMomentum;
use crate::step::tuning::Tuning;
use isosheet_materials::hessian::HessianPart;
use isosheet_materials::potential::Memories;
use isosheet_model::term::Iterate;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Moves positions to the nearest ones, in the sense of the mass matrix, that have the rest
/// lengths: a Levenberg-Marquardt iteration with line search
///
/// ```text
/// (M + r G^T G) dx = -r G^T c(x),
/// ```
///
/// with `r` raised while steps contract slowly or the masses hold them back, and lowered when the line search
/// shortens them. Positive definite at any rank of `G`, so flat states are no obstacle; close to them
/// convergence is linear instead of quadratic.
///
/// Where there are barriers their Hessian joins the mass matrix. So the nearest positions press least on the
/// barriers, and nothing is passed through on the way.
pub(crate) struct Restoration {
    tuning: Tuning,
    axial: Vec<f64>,
    transverse: Vec<f64>,
    unit: Vec<f64>,
    c: Vec<f64>,
    w: Vec<f64>,
    rhs: Vec<f64>,
    dx: Vec<f64>,
    start: Vec<f64>,
    solver: ConstrainedSolver,
    /// Minus the gradient of the barriers at `start`, newtons times the factor of their energies.
    barrier_start: Vec<f64>,
    /// Momentum that the iterations of the last projection of positions gave, kilogram metres.
    pub(crate) residual_momentum: ResidualMomentum,
    /// Vertices on curves and surfaces.
    pub(crate) vertex_rows: VertexRows,
}

/// When a projection stops.
#[derive(Clone, Copy)]
pub(crate) struct RestorationGoal<'a> {
    /// Largest edge strain wanted.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
    /// Whether the positions may be far from the lengths: then a stationary iterate is left to the caller,
    /// who takes a shorter step.
    pub(crate) may_be_far: bool,
    /// Time of the vertex constraints, seconds.
    pub(crate) t: f64,
    /// What loads the vertex constraints already: one-sided ones under load are kept as equalities. May be
    /// empty.
    pub(crate) loads: &'a [Vector3<f64>],
    pub(crate) matrix: FirstMatrix,
}

/// The matrix that a projection begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FirstMatrix {
    /// One that is assembled at the positions given.
    Assembled,
    /// That which is factorised, of positions nearby. (Not used where there are vertex constraints.)
    Factorised,
}

/// Barriers that a projection has to keep.
pub(crate) struct Barriers<'a> {
    pub(crate) objective: &'a mut Objective,
    /// What potentials remember.
    pub(crate) memories: &'a Memories,
    /// Factor of their energies in the incremental potential, `h^2`.
    pub(crate) scale: f64,
}

impl Barriers<'_> {
    fn are_there(&self) -> bool {
        self.objective.has_barrier()
    }

    /// The objective, and where it is evaluated at positions `x` at time `t`.
    fn at<'a>(&'a mut self, t: f64, x: &'a [f64]) -> (&'a mut Objective, Iterate<'a>) {
        let memories = self.memories;
        (self.objective, Iterate { t, x, memories })
    }
}

/// How the linear system of an iteration went.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Solved {
    /// There is a step.
    Yes,
    /// The masses drown in the round-off of the penalty.
    PenaltyTooLarge,
    /// The linear algebra failed.
    No,
}

impl Restoration {
    pub(crate) fn new(model: &SheetModel, tuning: Tuning) -> Self {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        Self {
            tuning,
            axial: vec![0.0; m],
            transverse: vec![0.0; m],
            unit: penalties(model, 1.0),
            c: vec![0.0; m],
            w: vec![0.0; m],
            rhs: vec![0.0; n],
            dx: vec![0.0; n],
            start: vec![0.0; n],
            solver: ConstrainedSolver::new(model),
            barrier_start: vec![0.0; n],
            residual_momentum: ResidualMomentum::new(model),
            vertex_rows: VertexRows::new(model.constraints(), model.constrained_vertices(), 1.0),
        }
    }

    /// Restores the lengths of positions `x` in place; returns the strain reached, which exceeds
    /// `goal.tolerance` if `goal.max_iterations` did not suffice.
    pub(crate) fn positions(
        &mut self,
        model: &SheetModel,
        matrix: &mut PrimalMatrix,
        barriers: Option<Barriers<'_>>,
        x: &mut [f64],
        goal: RestorationGoal<'_>,
        effort: &mut SolverEffort<'_>,
    ) -> f64 {
        let tolerance = goal.tolerance;
        let (mut penalty, mut slow) = (self.tuning.restoration_penalty(), 0_usize);
        let mut barriers = barriers.filter(Barriers::are_there);
        let has_barriers = barriers.is_some();
        let mut openings = 0;
        self.begin(model, &goal, x);
        if goal.matrix == FirstMatrix::Factorised && model.constraints().is_empty() {
            let target = match barriers {
                Some(_) => self.tuning.contraction() * tolerance,
                None => tolerance,
            };
            self.correct(model, matrix, barriers.as_mut(), x, (goal.t, target));
        }
        let mut strain = self.worst(model, x);
        for _ in 0..goal.max_iterations {
            if strain <= tolerance || strain.is_nan() {
                break;
            }
            if !effort.count_factorisation() {
                break;
            }
            effort.iterations += 1;
            match self.solve(model, matrix, barriers.as_mut(), x, (goal.t, penalty)) {
                Solved::Yes => {}
                Solved::PenaltyTooLarge if penalty > 1.0 => {
                    penalty = (penalty / self.tuning.penalty_growth.powi(2)).max(1.0);
                    continue;
                }
                Solved::PenaltyTooLarge | Solved::No => break,
            }
            let before = self.error();
            self.start.copy_from_slice(x);
            let limit = self.safe_part(barriers.as_mut(), goal.t, x);
            if limit < self.tuning.shortest_part() {
                // Contact is in the way; more pressure has to build up before.
                break;
            }
            let linear = self.linearised_error(model, x);
            let (length, after) = self.line_search(model, goal.t, x, limit, before);
            self.keep_momentum(model, barriers.as_mut(), (goal.t, x), None);
            if after > self.tuning.contraction() * before && self.worst(model, x) <= tolerance {
                return self.worst(model, x);
            }
            slow = if after > self.tuning.slow * before {
                slow + 1
            } else {
                0
            };
            let is_stationary =
                length < self.tuning.shortest_part() || slow >= self.tuning.patience as usize;
            if linear > self.tuning.slow * before
                && penalty < self.tuning.last_stiffness
                && slow < self.tuning.patience as usize
            {
                // The masses hold the step back.
                penalty *= self.tuning.penalty_growth.powi(2);
            } else if is_stationary {
                let size = self.tuning.opening_growth.powi(openings) * strain.sqrt();
                if goal.may_be_far || has_barriers && openings == self.tuning.patience as i32 {
                    strain = self.worst(model, x);
                    break;
                }
                // Stationary, but not solved: the error lies across the range of G, which happens where a
                // patch is flat and asks for a fold. A displacement of order sqrt(strain), in any
                // direction, opens it.
                penalty = self.tuning.restoration_penalty();
                let size = size.min(self.tuning.iterate_strain);
                self.unfold(model, barriers.as_mut(), (goal.t, x), size);
                openings += 1;
                slow = 0;
                self.evaluate(model, goal.t, x);
            } else if length < limit {
                penalty /= self.tuning.penalty_growth;
            } else if limit == 1.0 && after > self.tuning.contraction() * before {
                penalty *= self.tuning.penalty_growth;
            }
            penalty = penalty.clamp(1.0, self.tuning.last_stiffness);
            strain = self.worst(model, x);
        }
        strain
    }

    /// Forgets earlier restorations and evaluates the constraints at positions `x`.
    fn begin(&mut self, model: &SheetModel, goal: &RestorationGoal<'_>, x: &[f64]) {
        self.residual_momentum.clear();
        for (i, c) in model.constraints().iter().enumerate() {
            let is_loaded = goal.loads.get(i).is_some_and(|l| l.x < 0.0);
            self.vertex_rows.equality[i] = is_loaded || !c.is_one_sided();
        }
        self.vertex_rows.corrected.fill(false);
        self.evaluate(model, goal.t, x);
    }

    /// Evaluates the constraints.
    fn evaluate(&mut self, model: &SheetModel, t: f64, x: &[f64]) {
        model.rods().residual_into(x, &mut self.c);
        self.vertex_rows.evaluate(model.constraints(), t, x);
    }

    /// Solves `(M + h^2 B'' + r G^T G) dx = -r G^T c`.
    fn solve(
        &mut self,
        model: &SheetModel,
        matrix: &mut PrimalMatrix,
        mut barriers: Option<&mut Barriers<'_>>,
        x: &[f64],
        (t, penalty): (f64, f64),
    ) -> Solved {
        let rods = model.rods();
        for e in 0..self.c.len() {
            self.axial[e] = penalty * self.unit[e];
            self.w[e] = -self.axial[e] * self.c[e];
        }
        self.transverse.fill(0.0);
        if let Some(barriers) = &mut barriers {
            let (objective, at) = barriers.at(t, x);
            if objective.make_room(at, matrix).is_err() {
                return Solved::No;
            }
        }
        self.keep_barrier_forces(barriers.as_deref_mut(), t, x);
        // What potentials say is semidefinite may not be so.
        let mut parts = [HessianPart::PositiveSemidefinite, HessianPart::Certain].into_iter();
        let is_factorised = parts.any(|part| {
            matrix.assemble(model, x, &self.axial, &self.transverse);
            self.rhs.fill(0.0);
            self.vertex_rows
                .add_projection(penalty, &mut matrix.sink(model), &mut self.rhs);
            if let Some(barriers) = &mut barriers {
                let scale = barriers.scale;
                let (objective, at) = barriers.at(t, x);
                objective.add_barrier_hessian(at, scale, part, matrix);
            }
            matrix.factorize().is_ok()
        });
        if !is_factorised {
            return Solved::PenaltyTooLarge;
        }
        rods.apply_transpose_add(x, &self.w, &mut self.rhs);
        matrix.solve(model, &self.rhs, &mut self.dx);
        Solved::Yes
    }

    /// Halves the step from `limit` on until the error decreases sufficiently; the part of the step and the
    /// error there.
    fn line_search(
        &mut self,
        model: &SheetModel,
        t: f64,
        x: &mut [f64],
        limit: f64,
        before: f64,
    ) -> (f64, f64) {
        let mut length = limit;
        loop {
            for (i, xi) in x.iter_mut().enumerate() {
                *xi = self.start[i] + length * self.dx[i];
            }
            self.evaluate(model, t, x);
            let after = self.error();
            let is_enough = after <= (1.0 - ARMIJO * length) * before;
            if is_enough || length < self.tuning.shortest_part() {
                return (length, after);
            }
            length *= 0.5;
        }
    }

    /// Largest strain or relative violation of a vertex constraint, those being evaluated.
    fn worst(&self, model: &SheetModel, x: &[f64]) -> f64 {
        let strain = model.constrained_strain(x);
        if model.constraints().is_empty() {
            return strain;
        }
        let violation = self.vertex_rows.largest_violation();
        // `max` would pass over a value that is not a number.
        if violation.is_nan() {
            violation
        } else {
            strain.max(violation)
        }
    }

    /// Displaces every free vertex by up to `relative` lengths of its shortest rod.
    fn unfold(
        &mut self,
        model: &SheetModel,
        barriers: Option<&mut Barriers<'_>>,
        (t, x): (f64, &mut [f64]),
        relative: f64,
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed_of(x));
        for (i, d) in self.dx.iter_mut().enumerate() {
            let size = relative * model.shortest_edge(i / 3);
            *d = rng.random_range(-size..=size);
        }
        model.clear_pinned(&mut self.dx);
        let part = self.safe_part(barriers, t, x);
        for (xi, d) in x.iter_mut().zip(&self.dx) {
            *xi += part * d;
        }
    }

    /// Largest part of the displacement that the barriers allow.
    fn safe_part(&self, barriers: Option<&mut Barriers<'_>>, t: f64, x: &[f64]) -> f64 {
        barriers.map_or(1.0, |barriers| {
            let (objective, at) = barriers.at(t, x);
            objective.safe_part(at, &self.dx).0
        })
    }

    /// Keeps the forces of the barriers at positions `x`, where an iteration starts.
    fn keep_barrier_forces(&mut self, barriers: Option<&mut Barriers<'_>>, t: f64, x: &[f64]) {
        if let Some(barriers) = barriers
            && self.residual_momentum.has_room()
        {
            self.barrier_start.fill(0.0);
            let scale = -barriers.scale;
            let (objective, at) = barriers.at(t, x);
            objective.add_barrier_gradient(at, scale, &mut self.barrier_start);
        }
    }

    /// Keeps the momentum that rods and vertex constraints gave in the iteration from `start` to positions
    /// `x`. The rods have the directions at the positions `rods_at`, or at `start` if none are given.
    fn keep_momentum(
        &mut self,
        model: &SheetModel,
        barriers: Option<&mut Barriers<'_>>,
        (t, x): (f64, &[f64]),
        rods_at: Option<&[f64]>,
    ) {
        if !self.residual_momentum.has_room() {
            return;
        }
        for ((d, x), x0) in self.dx.iter_mut().zip(x).zip(&self.start) {
            *d = x - x0;
        }
        model
            .mass()
            .apply(model.topology(), &self.dx, &mut self.rhs);
        let active = &self.vertex_rows.active;
        let sum = self.residual_momentum.push(
            rods_at.unwrap_or(&self.start),
            active,
            self.rhs.iter().copied(),
        );
        if let Some(barriers) = barriers {
            for (s, g) in sum.iter_mut().zip(&self.barrier_start) {
                *s += g;
            }
            let scale = barriers.scale;
            let (objective, at) = barriers.at(t, x);
            objective.add_barrier_gradient(at, scale, sum);
        }
    }

    /// What the linearised lengths leave of the error after the whole step.
    fn linearised_error(&mut self, model: &SheetModel, x: &[f64]) -> f64 {
        model.rods().apply(x, &self.dx, &mut self.w);
        let errors = self.c.iter().zip(&self.w).zip(&self.unit);
        errors
            .map(|((c, w), u)| u * (c + w).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// Norm of the errors, rods weighted as in the least-squares problem that a step solves.
    fn error(&self) -> f64 {
        let errors = self.c.iter().zip(&self.unit);
        let rods = errors.map(|(c, u)| c * c * u).sum::<f64>();
        (rods + self.vertex_rows.squared_error()).sqrt()
    }
}

/// A seed that depends on positions to the last bit: a displacement that did not help is not drawn again, and
/// none depends on what was done before.
fn seed_of(x: &[f64]) -> u64 {
    x.iter().fold(0, |seed: u64, x| {
        seed.rotate_left(7).wrapping_add(x.to_bits())
    })
}
