//! What to know of a run before its results are used.

use super::{Bend, Summary};
use isosheet_mesh::Advice;
use isosheet_mesh::wording::brief;
use thiserror::Error;

/// A reason why the results of a complete run may not be those of a real sheet.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RunWarning {
    /// An elastic sheet bent more sharply than its mesh can follow, see [`Summary::CHORD_ERROR`].
    #[error(
        "the mesh is too coarse for the bends: the sheet bends over a single face by {_0}, whose chord is {} % shorter \
         than its arc",
        brief(100.0 * _0.shortening())
    )]
    Coarse(Bend),
    /// Creases that are driven to the angles of a file are folded to the other side.
    #[error(
        "{wrong} of {creases} creases are folded to their wrong side: the sheet folds along another branch"
    )]
    WrongSide {
        /// Their number.
        wrong: usize,
        /// The number of all driven creases.
        creases: usize,
    },
    /// The balance of the energy gained more than [`Summary::ENERGY_GAIN`] of what was exchanged.
    #[error(
        "the balance of the energy gains {} J, {} % of what was exchanged",
        brief(*gain), brief(100.0 * gain / exchanged)
    )]
    EnergyGain {
        /// The gain, joules.
        gain: f64,
        /// The largest energy that was exchanged, joules.
        exchanged: f64,
    },
}

impl Advice for RunWarning {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Coarse(_) => Some(
                "refine the mesh there: with half the edge length the error is a quarter; the page colours faces by \
                 their strain and by the share of stretching in their energy",
            ),
            Self::WrongSide { .. } => Some(
                "where rigid panels do not close at the angles, name what the sheet is made of, `sheet.material`, and \
                 divide its panels by `sheet.refine`; or start nearer to the fold, `sheet.start.file`",
            ),
            Self::EnergyGain { .. } => Some(
                "take a smaller `method.step`: forces that change within a step do work that is known roughly; the \
                 history says when energy is gained",
            ),
        }
    }
}

impl Summary {
    /// Part by which the chord of the sharpest bend of an elastic sheet may be shorter than its arc before
    /// the mesh counts as too coarse: one percent, 0.49 radians over a face.
    pub const CHORD_ERROR: f64 = 0.01;

    /// Part of the largest energy exchanged that errors of the balance may give to a run: second-order methods
    /// err by about that at the longest steps that resolve a motion.
    pub const ENERGY_GAIN: f64 = 0.02;

    /// What to know before the results are used.
    pub fn warnings(&self) -> Vec<RunWarning> {
        let (gain, exchanged) = (self.energy.largest_gain, self.energy.largest_exchange);
        let wrong = self.ending.residuals.folding.filter(|f| f.wrong_side > 0);
        let wrong = wrong.map(|f| RunWarning::WrongSide {
            wrong: f.wrong_side,
            creases: f.creases,
        });
        let gains = gain > Self::ENERGY_GAIN * exchanged + self.energy.round_off;
        let gained = gains.then_some(RunWarning::EnergyGain { gain, exchanged });
        let sharpest = self.elastic.and_then(|elastic| elastic.sharpest);
        let coarse = sharpest.filter(|bend| bend.shortening() > Self::CHORD_ERROR);
        coarse
            .map(RunWarning::Coarse)
            .into_iter()
            .chain(gained)
            .chain(wrong)
            .collect()
    }
}
