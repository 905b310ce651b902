//! What to know of a run before its results are used.

use super::Summary;
use crate::scene::Warning;
use isosheet_mesh::wording::brief;

impl Summary {
    /// Part by which the chord of the sharpest bend of an elastic sheet may be shorter than its arc before
    /// the mesh counts as too coarse: one percent, 0.49 radians over a face.
    pub const CHORD_ERROR: f64 = 0.01;

    /// Part of the largest energy exchanged that errors of the balance may give to a run: second-order methods
    /// err by about that at the longest steps that resolve a motion.
    pub const ENERGY_GAIN: f64 = 0.02;

    /// What to know before the results are used.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let sharpest = self.elastic.and_then(|elastic| elastic.sharpest);
        if let Some(bend) = sharpest.filter(|bend| bend.shortening() > Self::CHORD_ERROR) {
            let message = format!(
                "the mesh is too coarse for the bends: the sheet bends over a single face by {bend}, whose chord is {} % \
                 shorter than its arc",
                brief(100.0 * bend.shortening())
            );
            let remedy = "refine the mesh there: with half the edge length the error is a quarter; the page colours \
                          faces by their strain and by the share of stretching in their energy";
            warnings.push(Warning::new(message, remedy));
        }
        let (gain, exchanged) = (self.energy.largest_gain, self.energy.largest_exchange);
        if gain > Self::ENERGY_GAIN * exchanged + self.energy.round_off {
            let message = format!(
                "the balance of the energy gains {} J, {} % of what was exchanged",
                brief(gain),
                brief(100.0 * gain / exchanged)
            );
            let remedy = "take a smaller `method.step`: forces that change within a step do work that is known roughly; \
                          the history says when energy is gained";
            warnings.push(Warning::new(message, remedy));
        }
        if let Some(f) = self.ending.residuals.folding.filter(|f| f.wrong_side > 0) {
            let message = format!(
                "{} of {} creases are folded to their wrong side: the sheet folds along another branch",
                f.wrong_side, f.creases
            );
            let remedy = "where rigid panels do not close at the angles, name what the sheet is made of, \
                          `sheet.material`, and divide its panels by `sheet.refine`; or start nearer to the fold, \
                          `sheet.start.file`";
            warnings.push(Warning::new(message, remedy));
        }
        warnings
    }
}
