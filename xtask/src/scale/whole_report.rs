//! Tables and words on whole runs.

use super::findings::power;
use super::whole::{are_neighbours, methods};
use crate::report::{Table, extremes, short};
use crate::runs::Course;
use crate::timing::{self, Entry, Measured, NEIGHBOUR, STEP};
use std::fmt::Write;

/// What the runs are.
pub(super) fn about(limit: f64) -> String {
    format!(
        "The sheet of 1 m and 0.1 kg with a bump of 1 mm, in whole runs with steps of {:.1} ms: held at a corner for 1 s without contact, and \
         free above a table for 1.5 s with contact with the table and with itself. Every method runs from two neighbouring starts, whose bumps \
         differ by {NEIGHBOUR:.0e} m in height. A run has {limit} s of wall time, looked at after each step; a run that needs more is marked with the \
         simulated time that it reached, and no power is fitted to it. Powers are those of the number of vertices V.",
        1e3 * STEP
    )
}

/// How far the numbers can be relied on.
pub(super) const CHAOS: &str = "The motion of rods without bending stiffness on fine meshes is chaotic down to single edges: the sheet crumples into \
    folds as small as the mesh allows, and the smallest difference at the start leads to other folds. The cost of two runs from neighbouring starts \
    can differ by a third, although the mesh, the method and the motion to the eye are the same. Costs of single runs, comparisons of \
    methods by single runs, and powers fitted to a few meshes are uncertain by as much; how far the two starts are apart is stated for every mesh.";

/// What the runs of one scene say.
pub(super) fn findings(runs: &[&Measured]) -> Vec<String> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let mut all: Vec<String> = methods(first.work)
        .iter()
        .map(|(method, _)| powers(runs, method))
        .collect();
    all.extend(apart(runs));
    for level in levels(runs) {
        let entries = entries(runs, level);
        all.push(timing::words(&format!("M^{level}"), &entries));
    }
    let strain = runs.iter().map(|r| r.course.strain).fold(0.0, f64::max);
    let mut extremes =
        format!("The largest strain of an edge in any of these runs is {strain:.0e}");
    if let Some(gap) = runs.iter().filter_map(|r| r.course.gap).reduce(f64::min) {
        let _ = write!(extremes, ", the smallest gap {} µm", short(1e6 * gap));
    }
    all.push(extremes + ".");
    let unfinished: Vec<String> = runs.iter().filter_map(|r| unfinished(r)).collect();
    if !unfinished.is_empty() {
        all.push(format!("Not ended: {}.", unfinished.join("; ")));
    }
    all
}

/// The fitted powers of a method.
fn powers(runs: &[&Measured], method: &str) -> String {
    let ended = runs
        .iter()
        .filter(|r| r.method == method && r.course.is_good());
    let ended: Vec<&&Measured> = ended.collect();
    let fit = |value: fn(&Course) -> Option<f64>| {
        let points = ended
            .iter()
            .filter_map(|r| Some([r.mesh.vertices as f64, value(&r.course)?]));
        power(&points.collect::<Vec<_>>())
    };
    let meshes = ended.chunk_by(|a, b| a.mesh.level == b.mesh.level).count();
    format!(
        "{method}, fitted powers of V from {} runs on {meshes} meshes that ended: time per simulated second {}, time per factorisation {}, factorisations per step {}, \
         iterations per step {}.",
        ended.len(),
        fit(Course::rate),
        fit(|run| run.cost.wall_per_factorisation()),
        fit(|run| run.cost.factorisations_per_step()),
        fit(|run| run.cost.iterations_per_step()),
    )
}

/// How far the neighbouring starts are apart in cost, by the number of factorisations, which has no noise of
/// the clock.
fn apart(runs: &[&Measured]) -> Option<String> {
    let of_level = |level: u32| {
        let pairs = runs.chunk_by(|a, b| are_neighbours(a, b));
        let pairs =
            pairs.filter(|p| p[0].mesh.level == level && p.iter().all(|r| r.course.is_good()));
        let part = pairs.filter_map(difference).reduce(f64::max)?;
        Some(format!("M^{level} {:.0} %", 100.0 * part))
    };
    let parts: Vec<String> = levels(runs).into_iter().filter_map(of_level).collect();
    let parts = (!parts.is_empty()).then(|| parts.join(", "))?;
    Some(format!(
        "Factorisations of neighbouring starts differ by at most: {parts}."
    ))
}

/// The larger number of factorisations over the smaller one, less 1.
fn difference(pair: &[&Measured]) -> Option<f64> {
    let [low, high] = extremes(pair.iter().map(|r| r.course.cost.factorisations as f64))?;
    (pair.len() > 1 && low > 0.0).then(|| high / low - 1.0)
}

fn levels(runs: &[&Measured]) -> Vec<u32> {
    let mut levels: Vec<u32> = runs.iter().map(|r| r.mesh.level).collect();
    levels.dedup();
    levels
}

/// The methods on one mesh: means over the starts, of methods that came to the end from all of them.
fn entries(runs: &[&Measured], level: u32) -> Vec<Entry> {
    let of_starts = |starts: &[&Measured]| {
        let first = starts[0].entry(starts[0].method.clone());
        let walls = starts.iter().map(|r| r.entry(String::new()).wall);
        let walls: Option<Vec<f64>> = walls.collect();
        Entry {
            wall: walls.map(|w| w.iter().sum::<f64>() / w.len() as f64),
            strain: starts.iter().map(|r| r.course.strain).fold(0.0, f64::max),
            ..first
        }
    };
    let groups = runs.chunk_by(|a, b| are_neighbours(a, b));
    groups
        .filter(|starts| starts[0].mesh.level == level)
        .map(of_starts)
        .collect()
}

/// How far a run came that did not come to the end.
fn unfinished(r: &Measured) -> Option<String> {
    let (mesh, method, remark) = (r.mesh(), &r.method, r.remark());
    (!r.course.is_good()).then(|| format!("{mesh}, {method}, start {}: {remark}", r.start))
}

/// The runs of all scenes.
pub(super) fn table(runs: &[&Measured]) -> Table {
    let all = |r: &Measured| {
        let of_scene: Vec<&Measured> = runs.iter().copied().filter(|o| o.work == r.work).collect();
        entries(&of_scene, r.mesh.level)
    };
    timing::table(
        "Whole runs: wall seconds for a simulated second, set-up left out, of runs that did not end up to the time they reached; \
         the time as a multiple of that of the fastest method on the mesh that keeps lengths, and of the time of one factorisation a step.",
        runs,
        &all,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::{Cell, Cost};
    use crate::runs::Ending;
    use crate::timing::{Mesh, Work};

    /// A run of the hanging sheet with made-up numbers: `cost` times `V^2` seconds, `V^1.5` of them for each
    /// factorisation.
    fn made_up(level: u32, method: &str, start: usize, cost: f64) -> Measured {
        let vertices = (2_usize.pow(level + 1) + 1).pow(2);
        let v = vertices as f64;
        let cost = Cost {
            steps: 60,
            substeps: 60,
            rejected: 0,
            iterations: 240,
            factorisations: (1e6 * cost * v.sqrt()) as usize,
            wall: cost * v * v,
            cpu: cost * v * v,
        };
        Measured {
            work: Work::Hanging,
            mesh: Mesh {
                level,
                vertices,
                factorisation: 1e-6 * v * v * STEP,
            },
            method: method.to_owned(),
            start,
            step: STEP,
            course: Course {
                cost,
                time: 1.0,
                strain: 1e-12,
                ..Course::default()
            },
            gained: 0.0,
            released: 1.0,
            repetitions: 1,
        }
    }

    fn made_up_runs() -> Vec<Measured> {
        let mut runs = Vec::new();
        for level in 1..=3 {
            for ((method, _), cost) in methods(Work::Hanging).iter().zip([4e-5, 2e-5, 8e-5]) {
                runs.extend([1, 2].map(|start| made_up(level, method, start, cost)));
            }
        }
        runs
    }

    #[test]
    fn fitted_powers_are_those_of_the_numbers() {
        let runs = made_up_runs();
        let all: Vec<&Measured> = runs.iter().collect();
        let text = findings(&all).join("\n");
        for part in [
            "BDF2 (default), fitted powers of V from 6 runs on 3 meshes that ended: time per simulated second 2.00, time per factorisation 1.5",
            "iterations per step 0.00",
            "differ by at most: M^1 0 %, M^2 0 %, M^3 0 %",
            "M^2: the fastest method that keeps lengths to 1e-9 is implicit Euler",
            "BDF2 (default) takes 2.0 times as long, 40 times one factorisation a step",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        assert!(!text.contains("Not ended"), "{text}");
    }

    #[test]
    fn runs_that_do_not_end_are_marked_and_left_out_of_the_fits() {
        let mut runs = made_up_runs();
        let lost = runs
            .iter_mut()
            .find(|r| r.mesh.level == 3)
            .map(|r| &mut r.course)
            .expect("a run of M^3");
        (lost.cost.wall, lost.time) = (1e9, 0.25);
        lost.ending = Ending::WallTime(600.0);
        let all: Vec<&Measured> = runs.iter().collect();
        let text = findings(&all).join("\n");
        for part in [
            "from 5 runs on 3 meshes that ended: time per simulated second 2.00",
            "Not ended: M^3, BDF2 (default), start 1: stopped at 0.25 s: 600 s",
            "BDF2 (default) did not come to the end",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        let table = table(&all);
        let says = |c: &Cell| matches!(c, Cell::Text(t) if t.starts_with("600 s of wall time"));
        let marked = table.rows.iter().filter(|r| r.last().is_some_and(says));
        assert_eq!(marked.count(), 1);
    }

    #[test]
    fn neighbouring_starts_are_compared_by_their_factorisations() {
        let mut runs = made_up_runs();
        let first = runs[0].course.cost.factorisations;
        runs[1].course.cost.factorisations = first * 4 / 3;
        let all: Vec<&Measured> = runs.iter().collect();
        let text = apart(&all).expect("pairs of runs");
        assert!(text.contains("M^1 33 %, M^2 0 %"), "{text}");
    }
}
