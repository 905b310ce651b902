//! Second-order correction of a step for contact.

use super::lagrangian::Lagrangian;
use super::problem::StepProblem;
use crate::step::effort::SolverEffort;

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
        let scale = problem.h * problem.h;
        let (step, force) = (&self.weighted, &mut self.difference);
        let contact = problem.contact();
        if !self.iterate.add_gap_correction(contact, step, scale, force) {
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
}
