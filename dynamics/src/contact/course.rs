//! How a step makes velocities, for friction.

use super::{ContactLaws, SurfacePoints};
use isosheet_model::term::StepStart;

/// The step of a method: where it starts, and how it makes velocities.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Positions at the start, `3V`, metres.
    pub start: &'a [f64],
    /// The positions `y` of `x1 = y + tau v1`, `3V`, metres. Coulomb's law does not look at them.
    pub rest: &'a [f64],
    /// The effective step `tau`, seconds.
    pub tau: f64,
    /// The length of the step, seconds: Coulomb's law has its speeds in metres a step.
    pub span: f64,
}

impl<'a> Course<'a> {
    /// A step of `h` seconds whose velocities are displacements over its length.
    pub fn from_start(start: &'a [f64], h: f64) -> Self {
        Self {
            start,
            rest: start,
            tau: h,
            span: h,
        }
    }
}

/// How the velocities at the end of a step follow from the positions there, `v1 = (x1 - y) / tau`.
#[derive(Debug, Default)]
pub(super) struct EndVelocity {
    /// The points at `y`; none without other laws of friction than Coulomb's.
    rest: Vec<f64>,
    tau: f64,
    span: f64,
}

impl EndVelocity {
    /// Of the step that begins; reuses memory.
    pub(super) fn update(
        &mut self,
        laws: &ContactLaws,
        points: Option<&SurfacePoints>,
        start: &StepStart<'_>,
    ) {
        self.tau = start.h;
        self.span = start.sliding_time;
        self.rest.clear();
        if laws.has_other_laws() {
            let rest = SurfacePoints::placed(points, start.rest);
            self.rest.extend_from_slice(&rest);
        }
    }

    /// The step that starts at these points.
    pub(super) fn course<'a>(&'a self, start: &'a [f64]) -> Course<'a> {
        Course {
            start,
            rest: &self.rest,
            tau: self.tau,
            span: self.span,
        }
    }
}
