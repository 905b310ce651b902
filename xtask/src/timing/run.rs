//! Runs with a limit of wall time.

use super::comparison::Entry;
use super::factorisation::factorisation_time;
use super::scene::{BUMP, Work, bumped};
use crate::interrupt::{self, Interrupted};
use crate::methods::Named;
use crate::report::{Cost, rounded, short};
use anyhow::Result;
use isosheet_dynamics::{RunEnd, Simulation, StepReport};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// A run from start to end, or as far as it came.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Timed {
    pub(crate) cost: Cost,
    /// Largest relative edge length error.
    pub(crate) strain: f64,
    /// Change of the energy at the end, and its largest change on the way, joules.
    pub(crate) gained: f64,
    pub(crate) drift: f64,
    /// Potential energy at the start less that at the end, joules.
    pub(crate) released: f64,
    /// Smallest gap, metres; nothing without contact.
    pub(crate) gap: Option<f64>,
    /// Simulated time, seconds.
    pub(crate) reached: f64,
    /// Why it did not come to the end.
    pub(crate) failure: Option<String>,
    /// Runs from the same start, of which the wall time is that of the fastest.
    pub(crate) repetitions: usize,
}

impl Timed {
    /// Wall seconds for a simulated second; nothing if not a single step was completed.
    pub(crate) fn rate(&self) -> Option<f64> {
        (self.reached > 0.0).then(|| self.cost.wall / self.reached)
    }

    /// Change of the energy at the end, as part of the potential energy released; 0 if none was.
    pub(crate) fn balance(&self) -> f64 {
        self.part(self.gained)
    }

    /// Largest change of the energy on the way, as part of the potential energy released; 0 if none was.
    pub(crate) fn relative_drift(&self) -> f64 {
        self.part(self.drift)
    }

    fn part(&self, energy: f64) -> f64 {
        if self.released > 0.0 {
            energy / self.released
        } else {
            0.0
        }
    }

    /// Whether the run came to its end.
    pub(crate) fn ended(&self) -> bool {
        self.failure.is_none()
    }
}

/// A run of a scene, to be compared with others.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Measured {
    pub(crate) work: Work,
    /// The mesh `M^level`, and its number of vertices.
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    pub(crate) method: String,
    /// Which of some neighbouring starts, from 1.
    pub(crate) start: usize,
    /// Step asked for, seconds.
    pub(crate) step: f64,
    /// Seconds for one Cholesky factorisation of the matrix of a damped step without contact.
    pub(crate) factorisation: f64,
    pub(crate) run: Timed,
}

/// A mesh, and what a factorisation of its matrix takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mesh {
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    /// See [`factorisation_time`].
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

impl Measured {
    /// Runs a scene by a method with steps of `step` seconds from a start, within limits as [`repeated`]
    /// has them.
    ///
    /// # Errors
    /// Those of [`repeated`].
    pub(crate) fn of(
        work: Work,
        mesh: Mesh,
        (name, method): Named,
        (start, step): (usize, f64),
        limits: [f64; 2],
        look: &mut dyn FnMut(&Simulation, &StepReport),
    ) -> Result<Self> {
        let bump = BUMP + NEIGHBOUR * (start - 1) as f64;
        let begin = || work.start(mesh.level, bump, method.clone());
        Ok(Self {
            work,
            level: mesh.level,
            vertices: mesh.vertices,
            method: name.to_owned(),
            start,
            step,
            factorisation: mesh.factorisation,
            run: repeated(&begin, [work.duration(), step], limits, look)?,
        })
    }

    /// Wall seconds for a simulated second, for people.
    pub(crate) fn rate(&self) -> String {
        self.run.rate().map_or("–".into(), short)
    }

    /// What a comparison needs; `name` tells the run from the others.
    pub(crate) fn entry(&self, name: String) -> Entry {
        Entry {
            name,
            wall: self.run.rate().filter(|_| self.run.ended()),
            strain: self.run.strain,
            limit: self.factorisation / self.step,
        }
    }

    /// How far a run came that did not come to the end, and why; empty otherwise.
    pub(crate) fn remark(&self) -> String {
        self.run.failure.as_ref().map_or(String::new(), |failure| {
            let (reached, failure) = (short(self.run.reached), rounded(failure));
            format!("stopped at {reached} s: {failure}")
        })
    }

    /// The name of the mesh.
    pub(crate) fn mesh(&self) -> String {
        format!("M^{}", self.level)
    }
}

/// Runs from start to end or as [`timed`] says, again and again, up to three times in all, until the runs
/// together take `short` seconds.
///
/// # Errors
/// Those of `start`; [`Interrupted`].
fn repeated(
    start: &dyn Fn() -> Result<Simulation>,
    span: [f64; 2],
    [patience, short]: [f64; 2],
    look: &mut dyn FnMut(&Simulation, &StepReport),
) -> Result<Timed> {
    let mut run = timed(&mut start()?, span, patience, look)?;
    let mut spent = run.cost.wall;
    while run.ended() && run.repetitions < REPETITIONS && spent < short {
        let again = timed(&mut start()?, span, patience, &mut |_, _| {})?;
        spent += again.cost.wall;
        run.cost.wall = run.cost.wall.min(again.cost.wall);
        run.repetitions += 1;
    }
    Ok(run)
}

/// Most repetitions of a run.
const REPETITIONS: usize = 3;

/// Runs for `duration` in steps of `step` seconds, or until `patience` seconds of wall time are over at the
/// end of a step that is not the last. `look` sees every step; the time that it takes does not count.
///
/// # Errors
/// [`Interrupted`]. An error of the solver ends the run, and is no error of this function.
fn timed(
    simulation: &mut Simulation,
    [duration, step]: [f64; 2],
    patience: f64,
    look: &mut dyn FnMut(&Simulation, &StepReport),
) -> Result<Timed, Interrupted> {
    let mut run = Timed {
        repetitions: 1,
        ..Timed::default()
    };
    let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
    let (energy, height) = (simulation.energy(), potential(simulation));
    let (start, clock) = (simulation.state().t, Instant::now());
    let mut looking = Duration::ZERO;
    let mut watch = |simulation: &Simulation, report: &StepReport| {
        let before = Instant::now();
        run.cost.add(report);
        run.strain = run.strain.max(report.strain);
        run.drift = run.drift.max(report.energy_drift.abs());
        run.gap = [run.gap, report.gap].into_iter().flatten().reduce(f64::min);
        look(simulation, report);
        looking += before.elapsed();
        let is_late = (clock.elapsed() - looking).as_secs_f64() > patience;
        if is_late && simulation.state().t < start + duration - 0.5 * step {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let end = simulation.run(duration, step, &mut [&mut watch, &mut interrupt::observe]);
    run.cost.wall = (clock.elapsed() - looking).as_secs_f64();
    interrupt::check()?;
    run.gained = simulation.energy() - energy;
    run.released = height - potential(simulation);
    run.reached = simulation.state().t;
    run.failure = match end {
        Ok(RunEnd::Stopped) => Some(format!("{patience} s of wall time were over")),
        // Where a sheet is pulled taut, nothing is left to simulate.
        Ok(RunEnd::Complete | RunEnd::Taut) => None,
        Err(error) => Some(error.to_string()),
    };
    Ok(run)
}

#[cfg(test)]
mod tests {
    use super::super::scene::STEP;
    use super::*;

    #[test]
    fn a_run_out_of_time_is_marked_and_keeps_the_time_it_reached() {
        let start = || Work::Hanging.start(1, 1e-3, Default::default());
        let run = |limits| repeated(&start, [1.0, STEP], limits, &mut |_, _| {}).unwrap();
        let cut = run([0.0, 1.0]);
        assert!(
            !cut.ended() && (cut.cost.steps, cut.repetitions) == (1, 1),
            "{cut:?}"
        );
        assert!((cut.reached - STEP).abs() < 1e-12, "{cut:?}");
        assert_eq!(cut.rate(), Some(cut.cost.wall / cut.reached));
        let whole = run([60.0, 60.0]);
        assert!(whole.ended() && (whole.cost.steps, whole.repetitions) == (60, 3));
        assert!((-0.9..0.01).contains(&whole.balance()) && whole.strain < 1e-11);
    }
}
