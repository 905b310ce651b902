//! What runs cost.

use isosheet_dynamics::StepReport;
use serde::{Deserialize, Serialize};

/// What steps cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Cost {
    /// Steps as asked for that were completed.
    pub(crate) steps: usize,
    /// Sub-steps that they were made of.
    pub(crate) substeps: usize,
    /// Sub-steps that were rejected.
    pub(crate) rejected: usize,
    pub(crate) iterations: usize,
    pub(crate) factorisations: usize,
    /// Wall time, seconds.
    pub(crate) wall: f64,
    /// Time of the processor, seconds: that of the thread that took the steps.
    pub(crate) cpu: f64,
}

impl Cost {
    /// Counts a step; its times are known to the caller alone.
    pub(crate) fn add(&mut self, report: &StepReport) {
        self.steps += 1;
        self.substeps += report.substeps;
        self.rejected += report.rejected;
        self.iterations += report.iterations;
        self.factorisations += report.factorisations;
    }

    /// Counts the steps of another run.
    pub(crate) fn add_run(&mut self, other: &Self) {
        self.steps += other.steps;
        self.substeps += other.substeps;
        self.rejected += other.rejected;
        self.iterations += other.iterations;
        self.factorisations += other.factorisations;
        self.wall += other.wall;
        self.cpu += other.cpu;
    }

    /// A number as a mean over the steps; nothing where no step was completed.
    fn per_step(&self, all: f64) -> Option<f64> {
        (self.steps > 0).then(|| all / self.steps as f64)
    }

    /// Iterations of a step in the mean.
    pub(crate) fn iterations_per_step(&self) -> Option<f64> {
        self.per_step(self.iterations as f64)
    }

    /// Factorisations of a step in the mean.
    pub(crate) fn factorisations_per_step(&self) -> Option<f64> {
        self.per_step(self.factorisations as f64)
    }
}
