//! One run of a scene by a method, repeated where it is short.

use super::penetration::Checker;
use crate::report::{rounded, short};
use crate::runs::{BUMP, Course, Pairs, Plan, Work, bumped, unseen};
use anyhow::Result;
use isosheet_dynamics::{Simulation, StepReport};
use isosheet_tests::Named;
use std::ops::ControlFlow;

/// A mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mesh {
    pub(super) level: u32,
    pub(super) vertices: usize,
}

impl Mesh {
    /// The mesh `M^level`.
    pub(super) fn of(level: u32) -> Self {
        Self {
            level,
            vertices: bumped(level, BUMP).topology().vertex_count(),
        }
    }
}

/// A run, to be compared with others.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) work: Work,
    pub(super) mesh: Mesh,
    pub(super) method: String,
    /// Step asked for, seconds.
    pub(super) step: f64,
    pub(super) course: Course,
    /// Change of the energy at the end, joules.
    gained: f64,
    /// Potential energy at the start less that at the end, joules.
    released: f64,
    /// Runs from the same start, of which the times are those of the fastest.
    pub(super) repetitions: usize,
    /// Deepest vertex in the table at a check, metres; 0 if none is inside.
    pub(super) depth: f64,
    /// Pairs of an edge and a face that cross at a check, over all checks.
    pub(super) crossings: usize,
}

/// Most repetitions of a run.
const REPETITIONS: usize = 3;

/// A run is repeated until all together have taken this part of the patience.
const SHORT: f64 = 0.1;

/// Steps between two checks for penetration.
const CHECK: usize = 6;

/// Largest relative edge length error of a run that counts as exact: the loosest tolerance that the runs of
/// the report ask for. Programs that let edges stretch are at 1e-5 and above.
pub(super) const EXACT: f64 = 1e-9;

impl Run {
    /// Runs a scene by a method with steps of `step` seconds; it is given up after `patience` seconds of wall
    /// time.
    ///
    /// # Errors
    /// Values of which no simulation can be made; [`Interrupted`](crate::interrupt::Interrupted).
    pub(super) fn of(
        work: Work,
        mesh: Mesh,
        (name, method): Named,
        step: f64,
        patience: f64,
    ) -> Result<Self> {
        let checker = match work {
            Work::Hanging => None,
            Work::Tablecloth(pairs) => Some((Checker::new(&bumped(mesh.level, BUMP))?, pairs)),
        };
        let begin = || work.start(mesh.level, BUMP, method.clone());
        let plan = Plan::new(step, work.duration()).within(patience);
        let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
        let mut simulation = begin()?;
        let (energy, height) = (simulation.energy(), potential(&simulation));
        let (mut count, mut depth, mut crossings) = (0_usize, 0.0_f64, 0);
        let mut check = |simulation: &Simulation, _: &StepReport| {
            count += 1;
            if let Some((checker, pairs)) = &checker
                && count.is_multiple_of(CHECK)
            {
                let x = &simulation.state().x;
                depth = depth.max(super::penetration::depth(x));
                crossings += checker.crossings(x, *pairs);
            }
            ControlFlow::Continue(())
        };
        let mut course = plan.run(&mut simulation, &mut check)?;
        let (mut repetitions, mut spent) = (1, course.cost.wall);
        while course.is_good() && repetitions < REPETITIONS && spent < SHORT * patience {
            let again = plan.run(&mut begin()?, &mut unseen)?.cost;
            spent += again.wall;
            if again.cpu < course.cost.cpu {
                (course.cost.cpu, course.cost.wall) = (again.cpu, again.wall);
            }
            repetitions += 1;
        }
        Ok(Self {
            work,
            mesh,
            method: name.to_owned(),
            step,
            course,
            gained: simulation.energy() - energy,
            released: height - potential(&simulation),
            repetitions,
            depth,
            crossings,
        })
    }

    /// Change of the energy at the end, as part of the potential energy released; 0 if none was.
    pub(super) fn balance(&self) -> f64 {
        self.part(self.gained)
    }

    /// Largest change of the energy on the way, as part of the potential energy released; 0 if none was.
    pub(super) fn relative_drift(&self) -> f64 {
        self.part(self.course.drift)
    }

    fn part(&self, energy: f64) -> f64 {
        if self.released > 0.0 {
            energy / self.released
        } else {
            0.0
        }
    }

    /// CPU seconds for a simulated second, of a run that came to the end.
    pub(super) fn rate(&self) -> Option<f64> {
        self.course.cpu_rate().filter(|_| self.course.is_good())
    }

    /// Whether the lengths are kept.
    pub(super) fn is_exact(&self) -> bool {
        self.course.strain <= EXACT
    }

    /// What moves, and what it touches.
    pub(super) fn scene(&self) -> [&'static str; 2] {
        match self.work {
            Work::Hanging => ["hanging sheet", ""],
            Work::Tablecloth(Pairs::Table) => ["tablecloth", "table"],
            Work::Tablecloth(Pairs::TableAndItself) => ["tablecloth", "table, itself"],
        }
    }

    /// The name of the mesh.
    pub(super) fn mesh(&self) -> String {
        format!("M^{}", self.mesh.level)
    }

    /// How far a run came that did not come to the end, and why.
    pub(super) fn remark(&self) -> Option<String> {
        let failure = rounded(&self.course.failure()?);
        Some(format!("{} s: {failure}", short(self.course.time)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_runs_are_repeated_and_runs_out_of_time_keep_what_they_reached() {
        let mesh = Mesh::of(1);
        let step = crate::runs::STEP;
        let run = |work, patience| {
            Run::of(work, mesh, ("BDF2", Default::default()), step, patience).unwrap()
        };
        let cut = run(Work::Hanging, 0.0);
        assert_eq!((cut.course.cost.steps, cut.repetitions), (0, 1), "{cut:?}");
        let remark = cut.remark().unwrap();
        assert!(remark.starts_with("0 s: 0 s of wall time"), "{remark}");
        assert_eq!(cut.rate(), None);
        let whole = run(Work::Hanging, 60.0);
        assert!(whole.course.is_good() && (whole.course.cost.steps, whole.repetitions) == (60, 3));
        assert!((-0.9..0.01).contains(&whole.balance()) && whole.is_exact());
        let cloth = run(Work::Tablecloth(Pairs::TableAndItself), 60.0);
        let course = &cloth.course;
        assert!(course.is_good() && (course.time - 1.5).abs() < 1e-9);
        assert!(course.strain < 1e-10 && course.gap.is_some_and(|gap| gap > 0.0));
        assert!(cloth.depth == 0.0 && cloth.crossings == 0);
        assert!(course.cost.factorisations >= course.cost.substeps);
    }
}
