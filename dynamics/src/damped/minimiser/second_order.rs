//! Second-order corrections of a step: for contact, and for the strains of an elastic sheet.

use super::lagrangian::Lagrangian;
use super::problem::StepProblem;
use crate::report::effort::SolverEffort;
use isosheet_model::Cut;

impl Lagrangian {
    /// Corrects the step `-dx`, of which only the part `limit` is safe, for gaps that close faster than to
    /// first order. Keeps the correction where a larger part of the corrected step is safe; the part that is
    /// safe of what it keeps. The step has to be the motion that was checked last, its matrix the one that
    /// is factorised, and no body or pin may be on its way.
    ///
    /// The linear system knows gaps to first order. A face that rolls on a ball of radius `R` while it tilts
    /// by an angle `a` comes closer by `R a^2 / 2`, several activation distances at five degrees: such a step
    /// is cut again and again, and the gap halves each time. With `q < 0` the part of a gap's change that is
    /// left out, the corrected step solves the same system with the barrier force of the gap at the end of
    /// the step,
    ///
    /// ```text
    /// K dx' = K dx - sum phi''(g) q dg/dx,
    /// ```
    ///
    /// which takes a solve but no factorisation. (Nocedal and Wright, "Numerical Optimization", 2006, Sec.
    /// 15.6. A disk of 688 vertices on a ball needs 12.2 factorisations a step with the correction and 16.0
    /// without; a second pass changes nothing.)
    pub(super) fn correct_gaps(
        &mut self,
        problem: &mut StepProblem<'_>,
        limit: f64,
        effort: &mut SolverEffort<'_>,
    ) -> f64 {
        self.uncorrected.copy_from_slice(&self.dx);
        for (w, d) in self.weighted.iter_mut().zip(&self.dx) {
            *w = -d;
        }
        self.difference.fill(0.0);
        let scale = problem.h().powi(2);
        let (step, force) = (&self.weighted, &mut self.difference);
        let (objective, at) = problem.objective_at(&self.x);
        if !objective.add_correction(at, step, scale, force) {
            return limit;
        }
        let model = problem.model;
        model.clear_pinned(&mut self.difference);
        let (b, change) = (&self.difference, &mut self.weighted);
        if self.matrix.solve_whole(model, b, change, effort).is_err() {
            return limit;
        }
        for (d, change) in self.dx.iter_mut().zip(&self.weighted) {
            *d -= change;
        }
        if self.slope() >= 0.0 {
            self.dx.copy_from_slice(&self.uncorrected);
            return limit;
        }
        let corrected = self.safe_part(problem);
        if corrected > limit {
            return corrected;
        }
        self.dx.copy_from_slice(&self.uncorrected);
        self.safe_part(problem)
    }

    /// Curves the step `-dx` of an elastic sheet, so that it turns faces and does not stretch them; whether
    /// it has become curved. The matrix of the step has to be the one that is factorised, and no pin may be
    /// on its way.
    ///
    /// The linear system knows strains to first order: along a straight step, a face that turns by an angle
    /// `a` is stretched by `a^2 / 2`, beyond a limit of one per cent from eight degrees on. The step of
    /// length `s` becomes `-s dx - s^2 w`, with the `w` that takes back what is of second order, by the
    /// matrix `K` of the step and the tangent law `C` of the faces,
    ///
    /// ```text
    /// K w = h^2 sum_T (dc/dx)^T C_T (|dx_a - dx_b|^2 / 2),
    /// ```
    ///
    /// for a solve and no factorisation, as in the second-order correction of constraints (Nocedal and
    /// Wright, "Numerical Optimization", 2006, Sec. 15.6).
    pub(super) fn correct_strains(&mut self, problem: &mut StepProblem<'_>) -> bool {
        let (model, scale) = (problem.model, problem.h().powi(2));
        let force = &mut self.difference;
        force.fill(0.0);
        let (objective, at) = problem.objective_at(&self.x);
        if !objective.add_second_order(at, &self.dx, scale, force) {
            return false;
        }
        model.clear_pinned(force);
        self.matrix.solve(model, force, &mut self.curved);
        self.is_curved = true;
        true
    }

    /// Puts the iterate at what is safe of the chord from the start of the line search to the part `length`
    /// of the curved step; that part of the step, or nothing if the strain is beyond the limit there.
    pub(super) fn move_along_curve(
        &mut self,
        problem: &mut StepProblem<'_>,
        length: f64,
    ) -> Option<f64> {
        for (w, (d, c)) in self
            .weighted
            .iter_mut()
            .zip(self.dx.iter().zip(&self.curved))
        {
            *w = -length * (d + length * c);
        }
        let (objective, at) = problem.objective_at(&self.start);
        let free = objective.safe_chord(at, &self.weighted);
        let displaced = self.start.iter().zip(&self.weighted);
        for (x, (start, w)) in self.x.iter_mut().zip(displaced) {
            *x = start + free * w;
        }
        self.cut = match free {
            1.0 => Cut::Nothing,
            _ => Cut::Contact,
        };
        let (objective, at) = problem.objective_at(&self.start);
        let is_within = objective.stays_within(at, &self.x);
        is_within.then_some(free * length)
    }
}
