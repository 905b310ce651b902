//! What whole runs cost: the hanging sheet and the tablecloth with self-contact, from start to end.

use crate::timing::{
    BUMP, Entry, Measured, Pairs, STEP, Work, bumped, factorisation_time, repeated,
};
use anyhow::Result;
use isosheet_dynamics::Method;

/// The scenes that run.
pub(super) const SCENES: [Work; 2] = [Work::Hanging, Work::Tablecloth(Pairs::TableAndItself)];

/// The name of a scene.
pub(super) fn name(scene: Work) -> &'static str {
    match scene {
        Work::Hanging => "hanging sheet",
        Work::Tablecloth(_) => "tablecloth with self-contact",
    }
}

/// The methods that are compared; implicit steps that keep lengths, and for contact those that take it.
pub(super) fn methods(scene: Work) -> &'static [Damped] {
    match scene {
        Work::Hanging => &[Damped::Bdf2, Damped::ImplicitEuler, Damped::Projection],
        Work::Tablecloth(_) => &[Damped::Bdf2, Damped::ImplicitEuler],
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

/// Height by which the bumps of two neighbouring starts differ, metres.
pub(super) const NEIGHBOUR: f64 = 1e-9;

/// Heights of the bump of the neighbouring starts, metres.
const STARTS: [f64; 2] = [BUMP, BUMP + NEIGHBOUR];

/// A run from start to end, or as far as it came.
#[derive(Clone, Debug)]
pub(crate) struct WholeRun {
    pub(super) scene: Work,
    pub(super) vertices: usize,
    pub(super) method: Damped,
    /// Which of the neighbouring starts, from 1.
    pub(super) start: usize,
    pub(super) measured: Measured,
}

impl WholeRun {
    pub(super) fn entry(&self) -> Entry {
        self.measured.entry(self.method.name().into())
    }

    /// Runs that differ in their starts alone.
    pub(super) fn is_neighbour(&self, other: &Self) -> bool {
        (self.measured.level, self.method) == (other.measured.level, other.method)
    }
}

/// Runs that take less than this together are repeated, seconds.
const SHORT: f64 = 0.5;

/// The runs of one scene on one mesh: every method from every start. A run ends after the first step at whose
/// end `limit` seconds of wall time are over; then it is marked and the time that it reached is kept.
pub(super) fn measure(scene: Work, level: u32, limit: f64) -> Result<Vec<WholeRun>> {
    let sheet = bumped(level, BUMP)?;
    let factorisation = factorisation_time(&sheet)?;
    let mut runs = Vec::new();
    for &method in methods(scene) {
        for (k, bump) in STARTS.into_iter().enumerate() {
            let start = || scene.start(level, bump, method.method());
            let span = [scene.duration(), STEP];
            let run = repeated(&start, span, [limit, SHORT], &mut |_, _| {})?;
            runs.push(WholeRun {
                scene,
                vertices: sheet.topology().vertex_count(),
                method,
                start: k + 1,
                measured: Measured {
                    level,
                    method: method.name().into(),
                    step: STEP,
                    factorisation,
                    run,
                },
            });
        }
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_scenes_run_to_their_end() {
        for scene in SCENES {
            let runs = measure(scene, 1, 30.0).expect("coarse scenes run");
            assert_eq!(runs.len(), 2 * methods(scene).len());
            for r in &runs {
                let run = &r.measured.run;
                assert_eq!(run.failure, None, "{r:?}");
                assert!((run.reached - scene.duration()).abs() < 1e-9, "{r:?}");
                let (steps, effort) = ((scene.duration() / STEP).round() as usize, &run.cost);
                assert_eq!(effort.steps, steps);
                assert!(run.strain < 1e-9 && effort.factorisations >= steps, "{r:?}");
                assert_eq!(run.gap.is_some(), scene != Work::Hanging);
                assert!(run.gap.is_none_or(|gap| gap > 0.0), "{r:?}");
            }
        }
    }
}
