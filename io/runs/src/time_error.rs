//! What the lengths of the steps leave as an error, by the estimates of the method.

use isosheet_dynamics::StepReport;
use isosheet_mesh::wording::brief;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The largest estimated error that a step, or a part of one, added to the positions: see
/// [`StepControl::accuracy`](isosheet_dynamics::StepControl::accuracy).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeError {
    /// Root of the mean square over the vertices, metres.
    pub size: f64,
    /// Time at the end of the step, seconds.
    pub t: f64,
    /// What was asked for, `method.accuracy`, metres; none if nothing was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asked: Option<f64>,
}

impl fmt::Display for TimeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (size, t) = (brief(self.size), brief(self.t));
        write!(f, "{size} m at {t} s")
    }
}

impl TimeError {
    /// The error of a step, or that of the steps `before` if it is larger; none of methods without an
    /// estimate.
    pub(crate) fn after(
        report: &StepReport,
        asked: Option<f64>,
        before: Option<Self>,
    ) -> Option<Self> {
        let now = report.error.map(|size| Self {
            size,
            t: report.t,
            asked,
        });
        let is_larger = |now: &Self| before.is_none_or(|before| now.size > before.size);
        now.filter(is_larger).or(before)
    }

    /// What was asked for, if it was not met.
    pub(crate) fn unmet(&self) -> Option<f64> {
        self.asked.filter(|asked| self.size > *asked)
    }
}
