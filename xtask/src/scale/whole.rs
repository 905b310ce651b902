//! What whole runs cost: the hanging sheet and the tablecloth with self-contact, from start to end.

use crate::methods::{Named, damped};
use crate::runs::unseen;
use crate::timing::{Limits, Measured, Mesh, Pairs, STEP, Work};
use anyhow::Result;

/// The scenes that run.
pub(super) const SCENES: [Work; 2] = [Work::Hanging, Work::Tablecloth(Pairs::TableAndItself)];

/// The name of a scene.
pub(super) fn name(scene: Work) -> &'static str {
    match scene {
        Work::Hanging => "hanging sheet",
        Work::Tablecloth(_) => "tablecloth with self-contact",
    }
}

/// Name of the method that simulations use when none is asked for.
pub(super) const DEFAULT: &str = "BDF2 (default)";

/// The methods that are compared: implicit steps that keep lengths, and for contact those that take it.
pub(super) fn methods(scene: Work) -> Vec<Named> {
    let [(_, bdf2), euler, projection] = damped();
    match scene {
        Work::Hanging => vec![(DEFAULT, bdf2), euler, projection],
        Work::Tablecloth(_) => vec![(DEFAULT, bdf2), euler],
    }
}

/// Neighbouring starts of every run.
const STARTS: usize = 2;

/// Whether runs differ in their starts alone.
pub(super) fn are_neighbours(a: &Measured, b: &Measured) -> bool {
    (a.mesh.level, &a.method) == (b.mesh.level, &b.method)
}

/// Runs that take less than this together are repeated, seconds.
const SHORT: f64 = 0.5;

/// The runs of one scene on one mesh: every method from every start. A run ends after the first step at whose
/// end `limit` seconds of wall time are over; then it is marked and the time that it reached is kept.
pub(super) fn measure(scene: Work, level: u32, limit: f64) -> Result<Vec<Measured>> {
    let mesh = Mesh::measured(level)?;
    let mut runs = Vec::new();
    for method in methods(scene) {
        for start in 1..=STARTS {
            let limits = Limits {
                patience: limit,
                short: SHORT,
            };
            let (method, start) = (method.clone(), (start, STEP));
            let run = Measured::of(scene, mesh, method, start, limits, &mut unseen)?;
            runs.push(run);
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
                let (course, cost) = (&r.course, &r.course.cost);
                assert_eq!(course.failure(), None, "{r:?}");
                assert!((course.time - scene.duration()).abs() < 1e-9, "{r:?}");
                let steps = (scene.duration() / STEP).round() as usize;
                assert_eq!(cost.steps, steps);
                assert!(
                    course.strain < 1e-9 && cost.factorisations >= steps,
                    "{r:?}"
                );
                assert_eq!(course.gap.is_some(), scene != Work::Hanging);
                assert!(course.gap.is_none_or(|gap| gap > 0.0), "{r:?}");
            }
        }
    }
}
