//! What a minimisation takes over from the step before, and leaves to the next.

use super::{MULTIPLIER_RATIOS, Minimiser};
use crate::SheetModel;
use crate::history::History;
use crate::integrator::Attempt;
use isosheet_coords::linalg::LinalgError;

impl Minimiser {
    /// Takes over the history of an attempt; `h` is the effective step, the root of the factor of the forces.
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
        let ratio = (h / last.step).powi(2);
        if MULTIPLIER_RATIOS.contains(&ratio) {
            for (m, l) in self.multipliers.iter_mut().zip(&last.rods) {
                *m = ratio * l;
            }
            let constraints = &mut self.vertex_rows.multipliers;
            for (m, l) in constraints.iter_mut().zip(&last.constraints) {
                *m = ratio * l;
            }
        } else {
            self.forget();
        }
        self.tangent_multipliers.copy_from_slice(&self.multipliers);
        self.matrix.reserve(model, attempt.couplings())
    }

    /// Leaves what the step that was just minimised gives to the next; `h` is the effective step.
    pub(crate) fn remember(&self, h: f64, history: &mut History) {
        let constraints = self.vertex_rows.multipliers.iter().copied();
        history.multipliers.set(h, &self.multipliers, constraints);
        history.couplings.clear();
        history
            .couplings
            .extend_from_slice(self.matrix.extra_pairs());
    }
}
