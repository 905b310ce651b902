//! What whole runs cost: the hanging sheet and the tablecloth with self-contact, from start to end.

use super::measure::factorisation_time;
use crate::interrupt;
use crate::speed_vs_error::comparison::Entry;
use crate::speed_vs_error::{bumped, hanging, tablecloth};
use anyhow::Result;
use isosheet_dynamics::{Method, RunEnd, Simulation, StepReport};
use std::ops::ControlFlow;
use std::time::Instant;

/// Which scene runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scene {
    /// A nearly flat sheet held at a corner, one second.
    Hanging,
    /// The same sheet, free, above a table; contact with the table and with itself, 1.5 seconds.
    Tablecloth,
}

impl Scene {
    pub(super) const ALL: [Self; 2] = [Self::Hanging, Self::Tablecloth];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Hanging => "hanging sheet",
            Self::Tablecloth => "tablecloth with self-contact",
        }
    }

    /// Simulated time, seconds.
    fn duration(self) -> f64 {
        match self {
            Self::Hanging => hanging::DURATION,
            Self::Tablecloth => tablecloth::STEPS as f64 * STEP,
        }
    }

    /// The methods that are compared; implicit steps that keep lengths, and for contact those that take it.
    pub(super) fn methods(self) -> &'static [Damped] {
        match self {
            Self::Hanging => &[Damped::Bdf2, Damped::ImplicitEuler, Damped::Projection],
            Self::Tablecloth => &[Damped::Bdf2, Damped::ImplicitEuler],
        }
    }

    fn start(self, level: u32, bump: f64, method: Method) -> Result<Simulation> {
        match self {
            Self::Hanging => hanging::scene(level, bump, method),
            Self::Tablecloth => {
                let pairs = tablecloth::Pairs::TableAndItself;
                tablecloth::scene(&bumped(level, bump)?, pairs, method)
            }
        }
    }
}

/// Methods of the runs, all with their default options.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Damped {
    Bdf2,
    ImplicitEuler,
    Projection,
}

impl Damped {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Bdf2 => "BDF2 (default)",
            Self::ImplicitEuler => "implicit Euler",
            Self::Projection => "projection",
        }
    }

    fn method(self) -> Method {
        match self {
            Self::Bdf2 => Method::default(),
            Self::ImplicitEuler => Method::ImplicitEuler(Default::default()),
            Self::Projection => Method::Projection(Default::default()),
        }
    }
}

/// Step, seconds.
pub(super) const STEP: f64 = tablecloth::STEP;

/// Height by which the bumps of two neighbouring starts differ, metres.
pub(super) const NEIGHBOUR: f64 = 1e-9;

/// Heights of the bump of the neighbouring starts, metres.
const STARTS: [f64; 2] = [hanging::BUMP, hanging::BUMP + NEIGHBOUR];

/// A run from start to end, or as far as it came.
#[derive(Clone, Debug)]
pub(crate) struct WholeRun {
    pub(crate) scene: Scene,
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    pub(crate) method: Damped,
    /// Which of the neighbouring starts, from 1.
    pub(crate) start: usize,
    /// Wall seconds of the run, set-up left out; the minimum over the repetitions.
    pub(crate) wall: f64,
    pub(crate) repetitions: usize,
    /// Simulated time, seconds.
    pub(crate) reached: f64,
    /// Steps as asked for that were completed.
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    pub(crate) iterations: usize,
    pub(crate) factorisations: usize,
    /// Largest relative edge length error.
    pub(crate) strain: f64,
    /// Smallest gap, metres, with contact.
    pub(crate) gap: Option<f64>,
    /// Seconds for one Cholesky factorisation of the matrix of a step without contact.
    pub(crate) factorisation: f64,
    /// Why it did not come to the end.
    pub(crate) failure: Option<String>,
}

impl WholeRun {
    pub(super) fn ended(&self) -> bool {
        self.failure.is_none()
    }

    /// Wall seconds for a simulated second; `None` if not a single step was completed.
    pub(super) fn rate(&self) -> Option<f64> {
        (self.reached > 0.0).then(|| self.wall / self.reached)
    }

    /// Wall seconds for a factorisation and all that belongs to it.
    pub(super) fn per_factorisation(&self) -> Option<f64> {
        (self.factorisations > 0).then(|| self.wall / self.factorisations as f64)
    }

    /// A count as a mean over the completed steps.
    pub(super) fn per_step(&self, count: usize) -> Option<f64> {
        (self.steps > 0).then(|| count as f64 / self.steps as f64)
    }

    pub(super) fn entry(&self) -> Entry {
        Entry {
            name: self.method.name().into(),
            wall: self.rate().filter(|_| self.ended()),
            strain: self.strain,
            limit: self.factorisation / STEP,
        }
    }
}

/// The runs of one scene on one mesh: every method from every start. A run ends after the first step at whose
/// end `limit` seconds of wall time are over; then it is marked and the time that it reached is kept.
pub(super) fn measure(scene: Scene, level: u32, limit: f64) -> Result<Vec<WholeRun>> {
    let sheet = bumped(level, hanging::BUMP)?;
    let factorisation = factorisation_time(&sheet)?;
    let mut runs = Vec::new();
    for method in scene.methods() {
        for (k, bump) in STARTS.into_iter().enumerate() {
            let blank = WholeRun {
                scene,
                level,
                vertices: sheet.topology().vertex_count(),
                method: *method,
                start: k + 1,
                wall: 0.0,
                repetitions: 1,
                reached: 0.0,
                steps: 0,
                rejected: 0,
                iterations: 0,
                factorisations: 0,
                strain: 0.0,
                gap: None,
                factorisation,
                failure: None,
            };
            runs.push(repeated(&blank, bump, limit)?);
        }
    }
    Ok(runs)
}

/// Repetitions of a run that takes less than [`SHORT`] seconds.
const REPETITIONS: usize = 3;
const SHORT: f64 = 0.5;

fn repeated(blank: &WholeRun, bump: f64, limit: f64) -> Result<WholeRun> {
    let mut best = run(blank.clone(), bump, limit)?;
    while best.ended() && best.wall < SHORT && best.repetitions < REPETITIONS {
        let wall = run(blank.clone(), bump, limit)?.wall;
        best.wall = best.wall.min(wall);
        best.repetitions += 1;
    }
    Ok(best)
}

fn run(mut row: WholeRun, bump: f64, limit: f64) -> Result<WholeRun> {
    let mut simulation = row.scene.start(row.level, bump, row.method.method())?;
    let duration = row.scene.duration();
    let clock = Instant::now();
    let mut watch = |simulation: &Simulation, report: &StepReport| {
        row.steps += 1;
        row.rejected += report.rejected;
        row.iterations += report.iterations;
        row.factorisations += report.factorisations;
        row.strain = row.strain.max(report.strain);
        row.gap = match (row.gap, report.gap) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        };
        // A run whose last step is late is complete.
        let over = clock.elapsed().as_secs_f64() > limit;
        if over && simulation.state().t < duration - 0.5 * STEP {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let end = simulation.run(duration, STEP, &mut [&mut watch, &mut interrupt::observe]);
    row.wall = clock.elapsed().as_secs_f64();
    interrupt::check()?;
    row.reached = simulation.state().t;
    row.failure = match end {
        Ok(RunEnd::Stopped) => Some(format!("{limit} s of wall time were over")),
        // No support of these scenes moves, so that no run ends taut.
        Ok(RunEnd::Complete | RunEnd::Taut) => None,
        Err(error) => Some(error.to_string()),
    };
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_scenes_run_to_their_end() {
        for scene in Scene::ALL {
            let runs = measure(scene, 1, 30.0).expect("coarse scenes run");
            assert_eq!(runs.len(), 2 * scene.methods().len());
            for r in &runs {
                assert_eq!(r.failure, None, "{r:?}");
                assert!((r.reached - scene.duration()).abs() < 1e-9, "{r:?}");
                assert_eq!(r.steps, (scene.duration() / STEP).round() as usize);
                assert!(r.strain < 1e-9 && r.factorisations >= r.steps, "{r:?}");
                assert_eq!(r.gap.is_some(), scene == Scene::Tablecloth);
                assert!(r.gap.is_none_or(|gap| gap > 0.0), "{r:?}");
                assert!(r.repetitions > 1 || r.wall >= SHORT);
            }
        }
    }

    #[test]
    fn a_run_out_of_time_is_marked_and_keeps_the_time_it_reached() {
        let runs = measure(Scene::Hanging, 1, 0.0).expect("the first step is taken");
        for r in &runs {
            assert!(!r.ended() && r.steps == 1 && r.entry().wall.is_none());
            assert!((r.reached - STEP).abs() < 1e-12, "{r:?}");
            assert_eq!(r.rate(), Some(r.wall / r.reached));
        }
    }
}
