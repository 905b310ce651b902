//! Ends of steps for which no strategy finds a minimum.

use super::lagrangian::Merit;
use super::problem::StepProblem;
use super::{LengthGoal, Minimiser};
use crate::effort::SolverEffort;
use crate::restoration::FirstMatrix;

/// Ratio of successive parts of the displacement, and the smallest part: from there on a step is as good as
/// none.
const RATIO: f64 = 0.7;
const SMALLEST_PART: f64 = 0.05;
/// Largest number of iterations of a restoration. Two or three suffice away from singular positions, and
/// hundreds do not at such.
const MAX_RESTORATION: usize = 6;

impl Minimiser {
    /// Keeps the displacement of the sheet since the start of the step, for [`Minimiser::find_descent`].
    pub(super) fn keep_displacement(&mut self, problem: &StepProblem<'_>) {
        let ends = self.lagrangian.iterate.x().iter().zip(&problem.state.x);
        for (d, (x, x0)) in self.displacement.iter_mut().zip(ends) {
            *d = x - x0;
        }
    }

    /// Puts the iterate at the largest of the tried parts of the kept displacement near which there are
    /// positions with the rest lengths that have a lower incremental potential than the start, `bound`; whether
    /// there is one. The multipliers become zero.
    ///
    /// A sheet of rods descends until it is taut, at positions where the rods are dependent: there are no
    /// finite multipliers, so that Newton's method does not converge, and a restoration of the lengths halves
    /// their error at best. A part of the displacement ends before that, at positions where two or three
    /// iterations restore the lengths; and the next step starts there.
    pub(super) fn find_descent(
        &mut self,
        problem: &mut StepProblem<'_>,
        bound: &Merit,
        effort: &mut SolverEffort<'_>,
    ) -> bool {
        let to = LengthGoal {
            strain: self.strain_tolerance(problem),
            max_iterations: MAX_RESTORATION,
            matrix: FirstMatrix::Assembled,
        };
        self.lagrangian.clear_multipliers();
        let mut part = RATIO;
        while part >= SMALLEST_PART {
            if self.displace(problem, part)
                && self.restore(problem, to, effort) <= to.strain
                && self.has_moved(problem, to.strain)
            {
                let now = self.lagrangian.merit(problem);
                if now.potential < bound.potential - now.round_off {
                    return true;
                }
            }
            part *= RATIO;
        }
        false
    }

    /// Puts the iterate at a part of the kept displacement from the start; whether it gets there without
    /// contact.
    fn displace(&mut self, problem: &mut StepProblem<'_>, part: f64) -> bool {
        self.lagrangian.begin(problem);
        for (p, d) in self.part.iter_mut().zip(&self.displacement) {
            *p = part * d;
        }
        let iterate = &mut self.lagrangian.iterate;
        if iterate.safe_fraction(problem.contact_mut(), &self.part) < 1.0 {
            return false;
        }
        for (x, p) in iterate.x_mut().iter_mut().zip(&self.part) {
            *x += p;
        }
        true
    }

    /// Whether the iterate has moved by more than the tolerance of the lengths leaves open: a rod of length `l`
    /// with a relative error `e` lets its ends move across it by `l sqrt(2 e)`.
    fn has_moved(&self, problem: &StepProblem<'_>, strain: f64) -> bool {
        let open = (2.0 * strain).sqrt() * problem.model.mean_length();
        let mut ends = self.lagrangian.iterate.x().iter().zip(&problem.state.x);
        ends.any(|(x, x0)| (x - x0).abs() > open)
    }
}
