//! The augmented Lagrangian of a step at an iterate: value, gradient and Hessian.

use super::problem::StepProblem;
use crate::SheetModel;
use crate::diagnosis::potentials::{Differences, find_fault};
use crate::linear::constrained::{
    ConstrainedSolver, ConstrainedSystem, MultiplierGoal, RowValues, SupportRows,
};
use crate::linear::constraint_rows::{RowLoad, VertexRows};
use crate::linear::free::penalties;
use crate::linear::primal::PrimalMatrix;
use crate::report::effort::SolverEffort;
use crate::step::tuning::Tuning;
use isosheet_linalg::{LinalgError, norm_inf};
use isosheet_materials::Refused;
use isosheet_materials::hessian::HessianPart;
use isosheet_materials::vectors::dot;
use isosheet_mesh::VertexId;
use isosheet_model::Cut;
use isosheet_model::PINNED;
use isosheet_model::StepError;
use isosheet_model::term::Lagging;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Bound on the number of operations that a term of the merit function goes through, for its round-off; its
/// square for the squares of length errors that are themselves round-off of the positions. A minimum may be
/// above the start of its step by so many times the round-off of both.
pub(super) const OPERATIONS: f64 = 8.0;

/// Penalty of vertex constraints that are solved for, relative to the stiffness of masses and potentials at
/// their vertices: a solution of the linear system leaves a millionth of an error, and round-off that is as
/// far below the stiffness along the surface.
const SUPPORT_STIFFNESS: f64 = 1e6;

/// Most steps of the inverse iteration for the least eigenvalue. Two modes whose frequencies are a hundredth
/// apart are told by it to 1e-4 of the lower one.
const INVERSE_ITERATIONS: usize = 200;

/// Change of the eigenvalue from one step to the next at which the iteration ends, relative.
const EIGENVALUE_ACCURACY: f64 = 1e-6;

/// Whether a sheet stays at an equilibrium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Stability {
    /// A disturbance grows.
    Unstable,
    /// It can move without a force.
    Free,
    /// Each disturbance swings.
    Stable {
        /// Lowest frequency of free vibrations, hertz.
        frequency: f64,
    },
}

/// The augmented Lagrangian at an iterate,
///
/// ```text
/// L(x) = Phi(x) + sum_e (L_e + r_e c_e(x) / 2) c_e(x) + (terms of the vertex constraints, see VertexRows),
/// ```
///
/// with the multipliers `L_e` of the rods (`h^2` times force densities, tension positive) and penalties
/// `r_e`.
pub(crate) struct Lagrangian {
    pub(super) tuning: Tuning,
    /// The iterate, `3V`, metres.
    pub(super) x: Vec<f64>,
    pub(super) matrix: PrimalMatrix,
    pub(super) multipliers: Vec<f64>,
    /// Multipliers before a linear system was solved.
    kept: RowValues,
    solver: ConstrainedSolver,
    pub(super) vertex_rows: VertexRows,
    /// Penalties `r_e` of equations as stiff as the masses.
    unit_penalty: Vec<f64>,
    /// How many times as stiff as the masses rods are in the value.
    stiffness: f64,
    /// Length errors `c_e` at the last evaluation, square metres.
    pub(super) c: Vec<f64>,
    /// `L_e + r_e c_e` at the last gradient.
    estimates: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    /// Solution of the last linear system: minus the search direction.
    pub(super) dx: Vec<f64>,
    /// What cut that step.
    pub(super) cut: Cut,
    /// The part of the step that grows with the square of its length, see [`Lagrangian::correct_strains`].
    pub(super) curved: Vec<f64>,
    pub(super) is_curved: bool,
    /// Where the line search starts.
    pub(super) start: Vec<f64>,
    /// Where prescribed motions end, at the pinned vertices.
    end: Vec<f64>,
    axial: Vec<f64>,
    pub(super) transverse: Vec<f64>,
    pub(super) difference: Vec<f64>,
    /// The step before its second-order correction.
    pub(super) uncorrected: Vec<f64>,
    pub(super) weighted: Vec<f64>,
}

/// The augmented Lagrangian at an iterate, and what its parts say about round-off.
#[derive(Debug, Clone, Copy)]
pub(super) struct Merit {
    /// Its inertia term in the frames of the parts that fall.
    pub(super) relative_inertia: f64,
    /// The incremental potential `Phi`.
    pub(super) potential: f64,
    /// Size of the multipliers' terms, `sum |L| l^2`.
    pub(super) rod_scale: f64,
    /// Its value.
    pub(super) value: f64,
    /// Round-off in the value.
    pub(super) round_off: f64,
}

/// Whether the Hessian was positive definite as it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Definiteness {
    /// It was.
    Definite,
    /// It was not, and a positive definite part of it was factorised.
    Modified,
}

impl Lagrangian {
    pub(super) fn new(model: &SheetModel, tuning: Tuning) -> Result<Self, LinalgError> {
        let (n, m) = (model.coordinate_count(), model.rods().len());
        let vertices = model.constrained_vertices();
        Ok(Self {
            tuning,
            x: vec![0.0; n],
            matrix: PrimalMatrix::new(model)?,
            multipliers: vec![0.0; m],
            kept: RowValues::new(model),
            solver: ConstrainedSolver::new(model),
            vertex_rows: VertexRows::new(model.constraints(), vertices, 1.0),
            unit_penalty: penalties(model, 1.0),
            stiffness: 1.0,
            c: vec![0.0; m],
            estimates: vec![0.0; m],
            gradient: vec![0.0; n],
            dx: vec![0.0; n],
            cut: Cut::Nothing,
            curved: vec![0.0; n],
            is_curved: false,
            start: vec![0.0; n],
            end: vec![0.0; n],
            axial: vec![0.0; m],
            transverse: vec![0.0; m],
            difference: vec![0.0; n],
            uncorrected: vec![0.0; n],
            weighted: vec![0.0; n],
        })
    }

    /// Puts the iterate, the ends of prescribed motions and the terms where a step starts.
    ///
    /// # Errors
    /// [`StepError`] if what acts in the step is not finite.
    pub(super) fn begin(&mut self, problem: &mut StepProblem<'_>) -> Result<(), StepError> {
        let start = &problem.state().x;
        self.x.copy_from_slice(start);
        self.end.copy_from_slice(start);
        problem.model.place_pins(problem.t(), &mut self.end);
        problem.objective.begin(&problem.start)
    }

    /// Sets the penalties of rods and of vertex constraints: so many times as stiff as the masses.
    pub(super) fn set_stiffness(&mut self, rods: f64, constraints: f64) {
        self.vertex_rows.set_stiffness(constraints);
        self.stiffness = rods;
    }

    /// Penalty of a rod, kilograms per square metre.
    pub(super) fn penalty(&self, e: usize) -> f64 {
        self.stiffness * self.unit_penalty[e]
    }

    /// Drops the multipliers.
    pub(super) fn clear_multipliers(&mut self) {
        self.multipliers.fill(0.0);
        self.vertex_rows.clear();
    }

    /// Whether bodies or pins have not arrived yet.
    pub(super) fn is_driven(&self, problem: &mut StepProblem<'_>) -> bool {
        let has_arrived = |v: usize| self.x[3 * v..3 * v + 3] == self.end[3 * v..3 * v + 3];
        problem.objective.progress() < 1.0 || !problem.model.moving_pins().all(has_arrived)
    }

    /// Evaluates value and constraints at the iterate.
    pub(super) fn merit(&mut self, problem: &mut StepProblem<'_>) -> Merit {
        let (model, t, h) = (problem.model, problem.t(), problem.h());
        model.rods().residual_into(&self.x, &mut self.c);
        self.vertex_rows.evaluate(model.constraints(), t, &self.x);
        let size = norm_inf(&self.x);
        // Round-off of c is that of the squared lengths; and where inertia alone has the right lengths
        // already, nothing but the round-off of the positions is left to minimise.
        let (mut rods, mut rod_scale, mut squares) = (0.0, 0.0, 0.0);
        for (e, l) in model.rods().lengths().iter().enumerate() {
            let (m, p, c) = (self.multipliers[e], self.penalty(e), self.c[e]);
            rods += (m + 0.5 * p * c) * c;
            rod_scale += m.abs() * (l * l);
            squares += p * (f64::EPSILON * (l * size + l * l)).powi(2);
        }
        rods += self.vertex_rows.value();
        let (vertex_scale, vertex_squares) = self.vertex_rows.scales(size);
        rod_scale += vertex_scale;
        let (objective, at) = problem.objective_at(&self.x);
        let potential = objective.value(at, h);
        squares += vertex_squares + potential.round_off;
        let sizes = potential.size + rods.abs() + rod_scale;
        Merit {
            relative_inertia: potential.relative_inertia,
            value: potential.value + rods,
            potential: potential.value,
            rod_scale,
            round_off: OPERATIONS * f64::EPSILON * sizes + OPERATIONS.powi(2) * squares,
        }
    }

    /// Sets the gradient at the iterate, whose constraints have to be current. While bodies or pins move,
    /// with what the rest of their motions will change the gradient by, to first order.
    pub(super) fn set_gradient(&mut self, problem: &mut StepProblem<'_>) {
        let (model, h) = (problem.model, problem.h());
        let is_driven = self.is_driven(problem);
        let (objective, at) = problem.objective_at(&self.x);
        objective.set_gradient(at, h, &mut self.gradient);
        for e in 0..self.c.len() {
            self.estimates[e] = self.multipliers[e] + self.penalty(e) * self.c[e];
        }
        let rods = model.rods();
        rods.apply_transpose_add(&self.x, &self.estimates, &mut self.gradient);
        self.vertex_rows.add_gradient(&mut self.gradient);
        if is_driven {
            self.add_drive(problem);
        }
        model.clear_pinned(&mut self.gradient);
    }

    /// Adds the change of the gradient by the motions to come of bodies and pins, to first order.
    fn add_drive(&mut self, problem: &mut StepProblem<'_>) {
        let (model, h) = (problem.model, problem.h());
        let free = model.free_index();
        for (e, &[a, b]) in model.rods().edges().iter().enumerate() {
            let (pin, end) = match (free[a] == PINNED, free[b] == PINNED) {
                (true, false) => (a, b),
                (false, true) => (b, a),
                _ => continue,
            };
            let at = |x: &[f64], v: usize| Vector3::new(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
            let here = at(&self.x, pin);
            let (d, u) = (at(&self.x, end) - here, at(&self.end, pin) - here);
            let stretch = self.penalty(e) * d.dot(&u);
            let change = self.estimates[e] * u + stretch * d;
            for k in 0..3 {
                self.gradient[3 * end + k] -= change[k];
            }
        }
        self.weighted.fill(0.0);
        for i in model.moving_pins().flat_map(|v| 3 * v..3 * v + 3) {
            self.weighted[i] = self.end[i] - self.x[i];
        }
        let (objective, at) = problem.objective_at(&self.x);
        objective.add_drive(at, h, &self.weighted, &mut self.gradient);
    }

    /// Factorises the Hessian at the iterate; where it is indefinite, or `part` asks for no more, a
    /// positive definite part: the rods' geometric stiffness and the curvature of vertex constraints
    /// projected onto the semidefinite matrices, and if that does not help, without the curvature of the
    /// potentials.
    ///
    /// # Errors
    /// [`StepError::Linalg`] if even that cannot be factorised, which takes a coefficient that is not a
    /// number; [`StepError::Interrupted`].
    pub(super) fn factorize(
        &mut self,
        problem: &mut StepProblem<'_>,
        load: RowLoad,
        part: HessianPart,
        effort: &mut SolverEffort<'_>,
    ) -> Result<Definiteness, StepError> {
        let t0 = problem.state().t;
        let failed = |source| StepError::Linalg { t: t0, source };
        let mut count = || match effort.count_factorisation() {
            true => Ok(()),
            false => Err(StepError::Interrupted { t: t0 }),
        };
        let (objective, at) = problem.objective_at(&self.x);
        objective.make_room(at, &mut self.matrix).map_err(failed)?;
        for e in 0..self.c.len() {
            self.axial[e] = self.penalty(e);
        }
        match load {
            RowLoad::Multipliers => self.transverse.copy_from_slice(&self.multipliers),
            RowLoad::Estimates => self.transverse.copy_from_slice(&self.estimates),
        }
        if part == HessianPart::Full {
            count()?;
            self.assemble(problem, HessianPart::Full, load);
            self.check_blocks(problem)?;
            if self.matrix.factorize().is_ok() {
                return Ok(Definiteness::Definite);
            }
        }
        self.project_rods(problem.model, load);
        count()?;
        self.assemble(problem, HessianPart::PositiveSemidefinite, load);
        self.check_blocks(problem)?;
        if self.matrix.factorize().is_err() {
            // A Hessian that is not a number is no reason to go on without one.
            self.check_potentials(problem)?;
            count()?;
            self.assemble(problem, HessianPart::Certain, load);
            self.matrix.factorize().map_err(failed)?;
        }
        Ok(Definiteness::Modified)
    }

    /// Refuses blocks for which the matrix has no place.
    ///
    /// # Errors
    /// [`StepError::Potential`], or [`StepError::Refused`] for a term.
    fn check_blocks(&self, problem: &StepProblem<'_>) -> Result<(), StepError> {
        if !self.matrix.has_misplaced() {
            return Ok(());
        }
        self.check_potentials(problem)?;
        let refused = Refused {
            by: "the matrix of the step".into(),
            why: "a term gives a block of its Hessian of a pair that it has not named, or of a vertex that there is not".into(),
            remedy: Some("name all pairs in `Term::append_couplings`"),
        };
        Err(StepError::Refused {
            t: problem.state().t,
            refused: Box::new(refused),
        })
    }

    /// Refuses potentials whose Hessians cannot be used at the iterate, though their energies are finite
    /// there.
    ///
    /// # Errors
    /// [`StepError::Potential`].
    fn check_potentials(&self, problem: &StepProblem<'_>) -> Result<(), StepError> {
        let here = (problem.t(), &self.x[..]);
        match find_fault(problem.model, problem.memories, here, Differences::Skip) {
            Some(bad) if bad.fault.is_of_hessian() => Err(StepError::Potential {
                t: problem.state().t,
                bad: Box::new(bad),
            }),
            _ => Ok(()),
        }
    }

    /// Replaces each rod's own Hessian, with eigenvalues `p` across and `p + r |d|^2` along the rod, by its
    /// positive semidefinite part. (With multipliers far from the estimates the part along the rod stays as
    /// it is.)
    fn project_rods(&mut self, model: &SheetModel, load: RowLoad) {
        let along = load == RowLoad::Estimates;
        for e in 0..self.transverse.len() {
            if self.transverse[e] < 0.0 {
                if along {
                    let l = model.rods().lengths()[e];
                    let squared = (l * l + 2.0 * self.c[e]).max(f64::MIN_POSITIVE);
                    self.axial[e] = (self.axial[e] + self.transverse[e] / squared).max(0.0);
                }
                self.transverse[e] = 0.0;
            }
        }
    }

    /// Sets the matrix: the terms of the objective, rods and vertex constraints.
    fn assemble(&mut self, problem: &mut StepProblem<'_>, part: HessianPart, load: RowLoad) {
        let (model, h) = (problem.model, problem.h());
        self.matrix.clear();
        let (objective, at) = problem.objective_at(&self.x);
        objective.add_hessian(at, h, part, &mut self.matrix);
        if load == RowLoad::Multipliers {
            let matrix = &self.matrix;
            let stiffness = |v: VertexId| matrix.largest_diagonal(v);
            self.vertex_rows.stiffen(SUPPORT_STIFFNESS, stiffness);
        }
        self.matrix
            .add_rods(model, &self.x, &self.axial, &self.transverse);
        self.vertex_rows
            .add_hessian(part, load, &mut self.matrix.sink(model));
    }

    /// Solves for minus the search direction; the slope of the value along the search direction.
    ///
    /// # Errors
    /// [`LinalgError::NotPositiveDefinite`] if the Hessian turns out not to be positive definite.
    pub(super) fn solve(
        &mut self,
        model: &SheetModel,
        effort: &mut SolverEffort<'_>,
    ) -> Result<f64, LinalgError> {
        self.matrix
            .solve_whole(model, &self.gradient, &mut self.dx, effort)?;
        Ok(self.slope())
    }

    /// Keeps the multipliers, for [`Lagrangian::restore_multipliers`].
    pub(super) fn keep_multipliers(&mut self) {
        self.kept.rods.copy_from_slice(&self.multipliers);
        let supports = &self.vertex_rows.multipliers;
        self.kept.supports.copy_from_slice(supports);
    }

    /// Takes back what has changed the multipliers since they were kept.
    pub(super) fn restore_multipliers(&mut self) {
        self.multipliers.copy_from_slice(&self.kept.rods);
        let supports = &mut self.vertex_rows.multipliers;
        supports.copy_from_slice(&self.kept.supports);
    }

    /// Improves the multipliers of rods and supports and the step `-dx` that was solved for with them; the
    /// violation of the linearised equations that is left, as a strain.
    pub(super) fn improve_multipliers(&mut self, model: &SheetModel, goal: MultiplierGoal) -> f64 {
        let Self {
            solver,
            multipliers,
            vertex_rows: rows,
            dx,
            ..
        } = self;
        solver.multipliers.rods.copy_from_slice(multipliers);
        solver
            .multipliers
            .supports
            .copy_from_slice(&rows.multipliers);
        solver.residual.rods.copy_from_slice(&self.c);
        for (i, r) in solver.residual.supports.iter_mut().enumerate() {
            *r = rows.equality_value(i);
        }
        let mut system = ConstrainedSystem {
            model,
            matrix: &mut self.matrix,
            supports: SupportRows::Equalities { rows, penalty: 1.0 },
        };
        solver.subtract(&system, dx);
        let violation = solver.improve(&mut system, dx, goal);
        multipliers.copy_from_slice(&solver.multipliers.rods);
        rows.multipliers
            .copy_from_slice(&solver.multipliers.supports);
        violation
    }

    /// Slope of the value along `-dx`, the gradient being current.
    pub(super) fn slope(&self) -> f64 {
        -dot(&self.dx, &self.gradient)
    }

    /// Begins a line search at the iterate: the largest part of the step `-dx` that is safe, pinned vertices
    /// going to their ends.
    pub(super) fn begin_line_search(&mut self, problem: &mut StepProblem<'_>) -> f64 {
        self.is_curved = false;
        self.start.copy_from_slice(&self.x);
        self.safe_part(problem)
    }

    /// Brings the iterate back to the start of the line search, where contact knows the motion that the next
    /// trial is part of.
    pub(super) fn return_to_start(&mut self, problem: &mut StepProblem<'_>) {
        self.x.copy_from_slice(&self.start);
        if !self.is_curved {
            self.safe_part(problem);
        }
    }

    /// Puts the iterate, which is at the start of the line search, at the part `length` of the step, or of a
    /// curved step at what of it is safe in contact: that part, or nothing if the strain is beyond the limit
    /// there.
    pub(super) fn go_to(&mut self, problem: &mut StepProblem<'_>, length: f64) -> Option<f64> {
        match self.is_curved {
            true => self.move_along_curve(problem, length),
            false => {
                self.move_along(length);
                Some(length)
            }
        }
    }

    pub(super) fn safe_part(&mut self, problem: &mut StepProblem<'_>) -> f64 {
        for i in problem.model.moving_pins().flat_map(|v| 3 * v..3 * v + 3) {
            self.dx[i] = self.x[i] - self.end[i];
        }
        self.cut = Cut::Nothing;
        if !problem.is_bounded() {
            return 1.0;
        }
        for (w, d) in self.weighted.iter_mut().zip(&self.dx) {
            *w = -d;
        }
        let (objective, at) = problem.objective_at(&self.x);
        let (part, by) = objective.safe_part(at, &self.weighted);
        self.cut = by.into();
        part
    }

    /// What cut the step for which the safe part was asked last.
    pub(super) fn cut(&self) -> Cut {
        self.cut
    }

    /// Puts the iterate at the part `length` of the step `-dx` from the start of the line search.
    pub(super) fn move_along(&mut self, length: f64) {
        let displaced = self.start.iter().zip(&self.dx);
        for (x, (start, dx)) in self.x.iter_mut().zip(displaced) {
            *x = start - length * dx;
        }
    }

    /// Moves sheet, pins and bodies on together by a part of the rest of their motions.
    pub(super) fn drive(&mut self, problem: &mut StepProblem<'_>, part: f64) {
        self.move_along(part);
        if part == 1.0 {
            for v in problem.model.moving_pins() {
                self.x[3 * v..3 * v + 3].copy_from_slice(&self.end[3 * v..3 * v + 3]);
            }
        }
        problem.objective.advance(part);
    }

    /// Puts the iterate where inertia alone would take the sheet, unless contact or the limit of the strain
    /// is in the way, and pins and bodies to the ends of their motions.
    pub(super) fn predict(&mut self, problem: &mut StepProblem<'_>) {
        self.start.copy_from_slice(problem.start.prediction);
        problem.model.place_pins(problem.t(), &mut self.start);
        if problem.is_bounded() {
            for ((d, x), x0) in self.dx.iter_mut().zip(&self.start).zip(&self.x) {
                *d = x - x0;
            }
            let (objective, at) = problem.objective_at(&self.x);
            if objective.safe_part(at, &self.dx).0 < 1.0 {
                return;
            }
            objective.advance(1.0);
        }
        self.x.copy_from_slice(&self.start);
    }

    /// Puts pins in motion where they are at the end of the step.
    pub(super) fn place_pins(&mut self, problem: &StepProblem<'_>) {
        problem.model.place_pins(problem.t(), &mut self.x);
    }

    /// Brings what lags to the iterate where it has not settled, such as the normal forces of friction;
    /// whether it had not.
    pub(super) fn renew(&mut self, problem: &mut StepProblem<'_>, settled: Lagging) -> bool {
        let (objective, at) = problem.objective_at(&self.x);
        objective.renew(at, settled)
    }

    /// Displaces the iterate off a saddle, in the direction that belongs to `seed`: for sheets that may be
    /// exactly flat, where one direction of negative curvature is not enough; by `part` of the shortest edge
    /// at each vertex at most.
    pub(super) fn perturb(&mut self, problem: &mut StepProblem<'_>, seed: u64, part: f64) {
        let model = problem.model;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for (i, d) in self.dx.iter_mut().enumerate() {
            let size = part * model.shortest_edge(i / 3);
            *d = rng.random_range(-size..=size);
        }
        model.clear_pinned(&mut self.dx);
        let (objective, at) = problem.objective_at(&self.x);
        let (part, _) = objective.safe_part(at, &self.dx);
        for (x, d) in self.x.iter_mut().zip(&self.dx) {
            *x += part * d;
        }
    }

    /// Leaves a saddle: moves the iterate along a direction of negative curvature, if that lowers the value
    /// by more than `least`; whether the iterate has moved. The matrix that is factorised has to be the
    /// modified one.
    ///
    /// Factorising the Hessian `H` took out `N`, the pressure of the rods: `d^T N d` is the sum of `max(-(L +
    /// r c), 0) |d_a - d_b|^2` over the rods. The curvature `d^T H d` is negative where the Rayleigh quotient
    /// of `N` and `H + N` exceeds one. Power iterations that start from the direction that belongs to `seed`
    /// find the largest quotient.
    pub(super) fn leave_saddle(
        &mut self,
        problem: &mut StepProblem<'_>,
        seed: u64,
        least: f64,
        effort: &mut SolverEffort<'_>,
    ) -> bool {
        let model = problem.model;
        if !self.find_negative_curvature(model, seed, effort) {
            return false;
        }
        let before = self.merit(problem);
        self.start.copy_from_slice(&self.x);
        for size in [self.tuning.perturbation, 0.1 * self.tuning.perturbation] {
            let scale = size * model.mean_length();
            for (w, d) in self.weighted.iter_mut().zip(&self.dx) {
                *w = scale * d;
            }
            let (objective, at) = problem.objective_at(&self.x);
            let (part, _) = objective.safe_part(at, &self.weighted);
            let displaced = self.start.iter().zip(&self.weighted);
            for (x, (x0, d)) in self.x.iter_mut().zip(displaced) {
                *x = x0 + part * d;
            }
            if self.merit(problem).value < before.value - least - before.round_off {
                return true;
            }
            self.x.copy_from_slice(&self.start);
        }
        self.merit(problem);
        false
    }

    /// Scales the multipliers to equal forces in steps that are so many times as long.
    pub(super) fn scale_multipliers(&mut self, longer: f64) {
        let ratio = longer * longer;
        self.multipliers.iter_mut().for_each(|l| *l *= ratio);
        let constraints = self.vertex_rows.multipliers.iter_mut();
        constraints.for_each(|l| *l *= ratio);
    }

    /// Whether the Hessian at the iterate is positive definite, and its least eigenvalue in the metric of the
    /// masses by inverse iteration: the square of the frequency times that of the step, and one more, the
    /// inertia.
    pub(super) fn stability(
        &mut self,
        problem: &mut StepProblem<'_>,
        seed: u64,
        effort: &mut SolverEffort<'_>,
    ) -> Stability {
        self.set_gradient(problem);
        let full = self.factorize(problem, RowLoad::Multipliers, HessianPart::Full, effort);
        if !matches!(full, Ok(Definiteness::Definite)) {
            return Stability::Unstable;
        }
        let Some(least) = self.least_eigenvalue(problem.model, seed, effort) else {
            return Stability::Free;
        };
        let without = least - 1.0;
        match without > EIGENVALUE_ACCURACY * least {
            true => Stability::Stable {
                frequency: without.sqrt() / (std::f64::consts::TAU * problem.h()),
            },
            false => Stability::Free,
        }
    }

    /// The least eigenvalue of the matrix that was factorised last; nothing where the iteration breaks down.
    fn least_eigenvalue(
        &mut self,
        model: &SheetModel,
        seed: u64,
        effort: &mut SolverEffort<'_>,
    ) -> Option<f64> {
        self.set_random_direction(model, seed);
        let mut least = f64::INFINITY;
        for _ in 0..INVERSE_ITERATIONS {
            model.apply_mass(&self.dx, &mut self.weighted);
            model.clear_pinned(&mut self.weighted);
            let (b, dx) = (&self.weighted, &mut self.dx);
            self.matrix.solve_whole(model, b, dx, effort).ok()?;
            // With K y = M v: the quotient of y is v.M.y over y.M.y.
            let product = dot(&self.dx, &self.weighted);
            model.apply_mass(&self.dx, &mut self.difference);
            let quotient = product / dot(&self.dx, &self.difference);
            let largest = norm_inf(&self.dx);
            self.dx.iter_mut().for_each(|d| *d /= largest);
            if !quotient.is_finite() {
                return None;
            }
            let is_settled = (least - quotient).abs() <= EIGENVALUE_ACCURACY * quotient;
            least = quotient;
            if is_settled {
                break;
            }
        }
        Some(least)
    }

    /// Sets `dx`, of largest component one, to a direction of negative curvature; whether there is one.
    fn find_negative_curvature(
        &mut self,
        model: &SheetModel,
        seed: u64,
        effort: &mut SolverEffort<'_>,
    ) -> bool {
        self.set_random_direction(model, seed);
        let mut quotient = 0.0;
        for _ in 0..self.tuning.repetitions as usize {
            self.apply_pressure(model);
            self.difference.copy_from_slice(&self.weighted);
            let (b, dx) = (&self.difference, &mut self.dx);
            if self.matrix.solve_whole(model, b, dx, effort).is_err() {
                return false;
            }
            let curvature = dot(&self.dx, &self.difference);
            // Where no rod is under pressure there is no direction.
            if !(curvature.is_finite() && curvature > 0.0) {
                return false;
            }
            self.apply_pressure(model);
            quotient = dot(&self.dx, &self.weighted) / curvature;
            let largest = self.dx.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
            self.dx.iter_mut().for_each(|d| *d /= largest);
        }
        quotient > 1.0
    }

    /// Sets `dx` to the direction that belongs to `seed`, of components up to one.
    fn set_random_direction(&mut self, model: &SheetModel, seed: u64) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        for d in &mut self.dx {
            *d = rng.random_range(-1.0..=1.0);
        }
        model.clear_pinned(&mut self.dx);
    }

    /// Sets `weighted = N dx`, see [`Lagrangian::leave_saddle`].
    fn apply_pressure(&mut self, model: &SheetModel) {
        self.weighted.fill(0.0);
        for (e, &[a, b]) in model.rods().edges().iter().enumerate() {
            let pressure = (-self.estimates[e]).max(0.0);
            for k in 0..3 {
                let w = pressure * (self.dx[3 * a + k] - self.dx[3 * b + k]);
                self.weighted[3 * a + k] += w;
                self.weighted[3 * b + k] -= w;
            }
        }
        model.clear_pinned(&mut self.weighted);
    }
}
