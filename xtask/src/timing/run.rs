//! Runs of the scenes with a limit of wall time, repeated where they are short.

use super::comparison::Entry;
use super::factorisation::factorisation_time;
use super::scene::{BUMP, Work, bumped};
use crate::methods::Named;
use crate::report::{rounded, short};
use crate::runs::{Course, Plan, unseen};
use anyhow::Result;
use isosheet_dynamics::{Simulation, StepReport};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// A mesh, and what a factorisation of its matrix takes.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Mesh {
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    /// Seconds for one Cholesky factorisation of the matrix of a damped step without contact.
    pub(crate) factorisation: f64,
}

impl Mesh {
    /// Measures the factorisation of `M^level`.
    pub(crate) fn measured(level: u32) -> Result<Self> {
        let sheet = bumped(level, BUMP)?;
        Ok(Self {
            level,
            vertices: sheet.topology().vertex_count(),
            factorisation: factorisation_time(&sheet)?,
        })
    }
}

/// Height by which the bumps of two neighbouring starts differ, metres.
pub(crate) const NEIGHBOUR: f64 = 1e-9;

/// Limits of wall time, seconds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Of a run.
    pub(crate) patience: f64,
    /// A run that takes less is repeated, up to three times in all, until all take this long together.
    pub(crate) short: f64,
}

/// A run of a scene, to be compared with others.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Measured {
    pub(crate) work: Work,
    pub(crate) mesh: Mesh,
    pub(crate) method: String,
    /// Which of some neighbouring starts, from 1.
    pub(crate) start: usize,
    /// Step asked for, seconds.
    pub(crate) step: f64,
    pub(crate) course: Course,
    /// Change of the energy at the end, joules.
    pub(crate) gained: f64,
    /// Potential energy at the start less that at the end, joules.
    pub(crate) released: f64,
    /// Runs from the same start, of which the wall time is that of the fastest.
    pub(crate) repetitions: usize,
}

/// Most repetitions of a run.
const REPETITIONS: usize = 3;

impl Measured {
    /// Runs a scene by a method with steps of `step` seconds from a start; `look` sees every step of the
    /// first run.
    ///
    /// # Errors
    /// Values of which no simulation can be made; [`Interrupted`](crate::interrupt::Interrupted).
    pub(crate) fn of(
        work: Work,
        mesh: Mesh,
        (name, method): Named,
        (start, step): (usize, f64),
        limits: Limits,
        look: &mut dyn FnMut(&Simulation, &StepReport) -> ControlFlow<()>,
    ) -> Result<Self> {
        let bump = BUMP + NEIGHBOUR * (start - 1) as f64;
        let begin = || work.start(mesh.level, bump, method.clone());
        let plan = Plan::new(step, work.duration()).within(limits.patience);
        let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
        let mut run = begin()?;
        let (energy, height) = (run.energy(), potential(&run));
        let mut measured = Self {
            work,
            mesh,
            method: name.to_owned(),
            start,
            step,
            course: plan.run(&mut run, look)?,
            gained: run.energy() - energy,
            released: height - potential(&run),
            repetitions: 1,
        };
        let course = &mut measured.course;
        let mut spent = course.cost.wall;
        while course.is_good() && measured.repetitions < REPETITIONS && spent < limits.short {
            let again = plan.run(&mut begin()?, &mut unseen)?.cost.wall;
            spent += again;
            course.cost.wall = course.cost.wall.min(again);
            measured.repetitions += 1;
        }
        Ok(measured)
    }

    /// Change of the energy at the end, as part of the potential energy released; 0 if none was.
    pub(crate) fn balance(&self) -> f64 {
        self.part(self.gained)
    }

    /// Largest change of the energy on the way, as part of the potential energy released; 0 if none was.
    pub(crate) fn relative_drift(&self) -> f64 {
        self.part(self.course.drift)
    }

    fn part(&self, energy: f64) -> f64 {
        if self.released > 0.0 {
            energy / self.released
        } else {
            0.0
        }
    }

    /// Wall seconds for a simulated second, for people.
    pub(crate) fn rate(&self) -> String {
        self.course.rate().map_or("–".into(), short)
    }

    /// What a comparison needs; `name` tells the run from the others.
    pub(crate) fn entry(&self, name: String) -> Entry {
        Entry {
            name,
            wall: self.course.rate().filter(|_| self.course.is_good()),
            strain: self.course.strain,
            limit: self.mesh.factorisation / self.step,
        }
    }

    /// How far a run came that did not come to the end, and why; empty otherwise.
    pub(crate) fn remark(&self) -> String {
        self.course.failure().map_or(String::new(), |failure| {
            let (reached, failure) = (short(self.course.time), rounded(&failure));
            format!("stopped at {reached} s: {failure}")
        })
    }

    /// The name of the mesh.
    pub(crate) fn mesh(&self) -> String {
        format!("M^{}", self.mesh.level)
    }
}

#[cfg(test)]
mod tests {
    use super::super::scene::STEP;
    use super::*;

    #[test]
    fn short_runs_are_repeated_and_runs_out_of_time_keep_what_they_reached() {
        let mesh = Mesh {
            level: 1,
            ..Mesh::default()
        };
        let run = |patience, short| {
            let limits = Limits { patience, short };
            let (method, start) = (("BDF2", Default::default()), (1, STEP));
            Measured::of(Work::Hanging, mesh, method, start, limits, &mut unseen).unwrap()
        };
        let cut = run(0.0, 1.0);
        assert_eq!((cut.course.cost.steps, cut.repetitions), (1, 1), "{cut:?}");
        assert!(
            cut.remark()
                .starts_with("stopped at 0.017 s: 0 s of wall time")
        );
        let whole = run(60.0, 60.0);
        assert!(whole.course.is_good() && (whole.course.cost.steps, whole.repetitions) == (60, 3));
        assert!((-0.9..0.01).contains(&whole.balance()) && whole.course.strain < 1e-11);
    }
}
