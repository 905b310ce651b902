//! A run from checkpoint to checkpoint.

use crate::runs::{Course, Plan, unseen};
use anyhow::Result;
use isosheet_dynamics::Simulation;

/// What a run gave up to the last checkpoint that it reached; up to its failure if it reached none.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// Positions at the checkpoints.
    pub(super) states: Vec<Vec<f64>>,
    pub(super) course: Course,
    /// Largest kinetic energy at the start and at the checkpoints, joules.
    pub(super) energy: f64,
}

impl Motion {
    /// Runs a simulation to so many checkpoints, as planned from each of them to the next one.
    ///
    /// # Errors
    /// [`Interrupted`](crate::interrupt::Interrupted).
    pub(super) fn of(run: &mut Simulation, plan: Plan, checkpoints: usize) -> Result<Self> {
        let kinetic = |run: &Simulation| run.model().kinetic_energy(&run.state().v);
        let mut motion = Self {
            states: Vec::new(),
            course: Course::default(),
            energy: kinetic(run),
        };
        for _ in 0..checkpoints {
            let mut course = motion.course.clone();
            plan.go_on(run, &mut course, &mut unseen)?;
            if !course.is_good() && !motion.states.is_empty() {
                // Whether a run has blown up shows on the way to its failure.
                (motion.course.ending, motion.course.drift) = (course.ending, course.drift);
                break;
            }
            motion.course = course;
            if !motion.course.is_good() {
                break;
            }
            motion.energy = motion.energy.max(kinetic(run));
            motion.states.push(run.state().x.clone());
        }
        Ok(motion)
    }
}
