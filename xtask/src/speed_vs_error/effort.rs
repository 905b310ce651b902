//! How much time the study may take.

use super::problem::Problem;
use super::reference::Work;
use crate::report::Effort;
use std::ops::RangeInclusive;

/// Work of about a tenth of a second: the energy-momentum method takes 0.14 s for the 1149 factorisations of
/// one second of the hanging sheet M^1, which has 25 vertices, on one core at 2.6 GHz.
const TENTH: Work = 20_000;

/// The limits that follow from the effort. Times are wall times in seconds.
impl Effort {
    /// Longest run without a chart: steps are halved until a run takes longer.
    pub(crate) fn run(self) -> f64 {
        self.pick(0.01, 1.0, 8.0)
    }

    /// Longest run in a chart, of which there are 24 for each problem.
    pub(crate) fn chart_run(self) -> f64 {
        self.pick(0.004, 0.25, 3.0)
    }

    /// Most work of one reference and of its second opinion, each. Counted, so that results do not depend on
    /// the clock.
    pub(crate) fn reference(self, problem: Problem) -> Work {
        let tenths = match problem {
            // The search for contacts takes several times as long as the factorisations.
            Problem::Cloth(_) => self.pick(2, 30, 120),
            Problem::Sheet(2..) => self.pick(1, 150, 600),
            // Runs in charts, whose steps cost the cube of its links, take most of what they may.
            Problem::Strip(64..) => self.pick(1, 30, 600),
            _ => self.pick(1, 50, 600),
        };
        tenths * TENTH
    }

    /// Longest run of the hanging sheet, one for each mesh and method.
    pub(crate) fn hanging(self) -> f64 {
        self.pick(0.3, 20.0, 240.0)
    }

    /// Finest mesh of the hanging sheet.
    pub(crate) fn hanging_level(self) -> u32 {
        self.pick(1, 4, 4)
    }

    /// Longest run of the tablecloth, one for each mesh and kind of contact.
    pub(crate) fn tablecloth(self) -> f64 {
        self.pick(0.5, 30.0, 240.0)
    }

    /// Meshes of the tablecloth.
    pub(crate) fn tablecloth_levels(self) -> RangeInclusive<u32> {
        self.pick(1..=1, 2..=4, 2..=4)
    }

    /// Longest measurement of one solver on one matrix, all repetitions together.
    pub(crate) fn solver(self) -> f64 {
        self.pick(0.02, 2.0, 20.0)
    }

    /// Finest mesh of the solver study.
    pub(crate) fn solver_level(self) -> u32 {
        self.pick(2, 6, 7)
    }
}
