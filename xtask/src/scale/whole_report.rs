//! Tables and words on whole runs.

use super::findings::power;
use super::whole::{Damped, NEIGHBOUR, WholeRun, methods, name};
use crate::report::{Cell, Table, short};
use crate::timing::{self, COLUMNS, Entry, STEP, Timed, Work};
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
pub(super) fn findings(runs: &[&WholeRun]) -> Vec<String> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let mut all: Vec<String> = methods(first.scene)
        .iter()
        .map(|method| powers(runs, *method))
        .collect();
    all.extend(apart(runs));
    for level in levels(runs) {
        let entries = entries(runs, level);
        all.push(timing::words(&format!("M^{level}"), &entries));
    }
    let strain = runs
        .iter()
        .map(|r| r.measured.run.strain)
        .fold(0.0, f64::max);
    let mut extremes =
        format!("The largest strain of an edge in any of these runs is {strain:.0e}");
    if let Some(gap) = runs
        .iter()
        .filter_map(|r| r.measured.run.gap)
        .reduce(f64::min)
    {
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
fn powers(runs: &[&WholeRun], method: Damped) -> String {
    let ended: Vec<&&WholeRun> = runs
        .iter()
        .filter(|r| r.method == method && r.measured.run.ended())
        .collect();
    let fit = |value: &dyn Fn(&Timed) -> Option<f64>| {
        let points: Vec<[f64; 2]> = ended
            .iter()
            .filter_map(|r| Some([r.vertices as f64, value(&r.measured.run)?]))
            .collect();
        power(&points)
    };
    format!(
        "{}, fitted powers of V from {} runs on {} meshes that ended: time per simulated second {}, time per factorisation {}, factorisations per step {}, \
         iterations per step {}.",
        method.name(),
        ended.len(),
        ended
            .chunk_by(|a, b| a.measured.level == b.measured.level)
            .count(),
        fit(&Timed::rate),
        fit(&|run| run.cost.wall_per_factorisation()),
        fit(&|run| run.cost.factorisations_per_step()),
        fit(&|run| run.cost.iterations_per_step()),
    )
}

/// How far the neighbouring starts are apart in cost, by the number of factorisations, which has no noise of
/// the clock.
fn apart(runs: &[&WholeRun]) -> Option<String> {
    let mut parts = Vec::new();
    for level in levels(runs) {
        let largest = runs
            .chunk_by(|a, b| a.is_neighbour(b))
            .filter(|pair| {
                pair[0].measured.level == level && pair.iter().all(|r| r.measured.run.ended())
            })
            .filter_map(difference)
            .reduce(f64::max);
        if let Some(part) = largest {
            parts.push(format!("M^{level} {:.0} %", 100.0 * part));
        }
    }
    (!parts.is_empty()).then(|| {
        format!(
            "Factorisations of neighbouring starts differ by at most: {}.",
            parts.join(", ")
        )
    })
}

/// The larger number of factorisations over the smaller one, less 1.
fn difference(pair: &[&WholeRun]) -> Option<f64> {
    let counts = pair
        .iter()
        .map(|r| r.measured.run.cost.factorisations as f64);
    let [low, high] = counts
        .map(|n| [n; 2])
        .reduce(|[l, h], [a, b]| [l.min(a), h.max(b)])?;
    (pair.len() > 1 && low > 0.0).then(|| high / low - 1.0)
}

fn levels(runs: &[&WholeRun]) -> Vec<u32> {
    let mut levels: Vec<u32> = runs.iter().map(|r| r.measured.level).collect();
    levels.dedup();
    levels
}

/// The methods on one mesh: means over the starts, of methods that came to the end from all of them.
fn entries(runs: &[&WholeRun], level: u32) -> Vec<Entry> {
    runs.chunk_by(|a, b| a.is_neighbour(b))
        .filter(|starts| starts[0].measured.level == level)
        .map(|starts| {
            let walls: Option<Vec<f64>> = starts.iter().map(|r| r.entry().wall).collect();
            Entry {
                wall: walls.map(|w| w.iter().sum::<f64>() / w.len() as f64),
                strain: starts
                    .iter()
                    .map(|r| r.measured.run.strain)
                    .fold(0.0, f64::max),
                ..starts[0].entry()
            }
        })
        .collect()
}

/// How far a run came that did not come to the end.
fn unfinished(r: &WholeRun) -> Option<String> {
    let (mesh, method, remark) = (r.measured.mesh(), r.method.name(), r.measured.remark());
    (!r.measured.run.ended()).then(|| format!("{mesh}, {method}, start {}: {remark}", r.start))
}

fn cell(value: Option<f64>) -> Cell {
    value.map_or("–".into(), short).into()
}

/// The runs of one scene.
pub(super) fn table(scene: Work, runs: &[&WholeRun]) -> Table {
    let with = |r: &&WholeRun| {
        (
            (*r).clone(),
            r.entry().cells(&entries(runs, r.measured.level)),
        )
    };
    let run = |r: &(WholeRun, [String; 2])| r.0.measured.run.clone();
    Table::of(
        format!(
            "Whole runs of the {}: wall seconds for a simulated second, set-up left out, of runs that did not end up to the time they reached; \
             the time as a multiple of that of the fastest method on the mesh that keeps lengths, and of the time of one factorisation a step.",
            name(scene)
        ),
        runs.iter().map(with),
        &[
            ("mesh", &|(r, _)| r.measured.mesh().into()),
            ("V", &|(r, _)| r.vertices.into()),
            ("method", &|(r, _)| r.method.name().into()),
            ("start", &|(r, _)| r.start.into()),
            ("s/s", &|r| cell(run(r).rate())),
            ("iterations per step", &|r| {
                cell(run(r).cost.iterations_per_step())
            }),
            ("factorisations per step", &|r| {
                cell(run(r).cost.factorisations_per_step())
            }),
            ("ms per factorisation", &|r| {
                cell(run(r).cost.wall_per_factorisation().map(|s| 1e3 * s))
            }),
            (COLUMNS[0], &|(_, c)| c[0].as_str().into()),
            (COLUMNS[1], &|(_, c)| c[1].as_str().into()),
            ("rejected", &|r| run(r).cost.rejected.into()),
            ("strain", &|r| format!("{:.0e}", run(r).strain).into()),
            ("smallest gap, µm", &|r| {
                cell(run(r).gap.map(|gap| 1e6 * gap))
            }),
            ("remark", &|(r, _)| r.measured.remark().into()),
        ],
    )
}

/// All runs, for programs.
pub(super) fn data(runs: &[WholeRun]) -> Table {
    let of = |r: &WholeRun| (r.clone(), r.measured.run.clone());
    Table::of(
        "",
        runs.iter().map(of),
        &[
            ("scene", &|(r, _)| name(r.scene).into()),
            ("level", &|(r, _)| r.measured.level.into()),
            ("vertices", &|(r, _)| r.vertices.into()),
            ("method", &|(r, _)| r.method.name().into()),
            ("start", &|(r, _)| r.start.into()),
            ("step_s", &|_| STEP.into()),
            ("wall_s", &|(_, run)| run.cost.wall.into()),
            ("repetitions", &|(_, run)| run.repetitions.into()),
            ("reached_s", &|(_, run)| run.reached.into()),
            ("steps", &|(_, run)| run.cost.steps.into()),
            ("rejected", &|(_, run)| run.cost.rejected.into()),
            ("iterations", &|(_, run)| run.cost.iterations.into()),
            ("factorisations", &|(_, run)| run.cost.factorisations.into()),
            ("factorisation_s", &|(r, _)| r.measured.factorisation.into()),
            ("strain", &|(_, run)| run.strain.into()),
            ("gap_m", &|(_, run)| run.gap.into()),
            ("not_ended", &|(_, run)| run.failure.clone().into()),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Cost;
    use crate::timing::Measured;

    /// A run of the hanging sheet with made-up numbers: `cost` times `V^2` seconds, `V^1.5` of them for each
    /// factorisation.
    fn made_up(level: u32, method: Damped, start: usize, cost: f64) -> WholeRun {
        let vertices = (2_usize.pow(level + 1) + 1).pow(2);
        let v = vertices as f64;
        let cost = Cost {
            steps: 60,
            substeps: 60,
            rejected: 0,
            iterations: 240,
            factorisations: (1e6 * cost * v.sqrt()) as usize,
            wall: cost * v * v,
        };
        WholeRun {
            scene: Work::Hanging,
            vertices,
            method,
            start,
            measured: Measured {
                level,
                method: String::new(),
                step: STEP,
                factorisation: 1e-6 * v * v * STEP,
                run: Timed {
                    cost,
                    strain: 1e-12,
                    reached: 1.0,
                    repetitions: 1,
                    ..Timed::default()
                },
            },
        }
    }

    fn made_up_runs() -> Vec<WholeRun> {
        let mut runs = Vec::new();
        for level in 1..=3 {
            for (method, cost) in [
                (Damped::Bdf2, 4e-5),
                (Damped::ImplicitEuler, 2e-5),
                (Damped::Projection, 8e-5),
            ] {
                runs.push(made_up(level, method, 1, cost));
                runs.push(made_up(level, method, 2, cost));
            }
        }
        runs
    }

    #[test]
    fn fitted_powers_are_those_of_the_numbers() {
        let runs = made_up_runs();
        let all: Vec<&WholeRun> = runs.iter().collect();
        let text = findings(&all).join("\n");
        assert!(
            text.contains(
                "BDF2 (default), fitted powers of V from 6 runs on 3 meshes that ended: time per simulated second 2.00, time per factorisation 1.5"
            ),
            "{text}"
        );
        assert!(text.contains("iterations per step 0.00"), "{text}");
        assert!(
            text.contains("differ by at most: M^1 0 %, M^2 0 %, M^3 0 %"),
            "{text}"
        );
        assert!(
            text.contains("M^2: the fastest method that keeps lengths to 1e-9 is implicit Euler"),
            "{text}"
        );
        assert!(
            text.contains(
                "BDF2 (default) takes 2.0 times as long, 40 times one factorisation a step"
            ),
            "{text}"
        );
        assert!(!text.contains("Not ended"), "{text}");
    }

    #[test]
    fn runs_that_do_not_end_are_marked_and_left_out_of_the_fits() {
        let mut runs = made_up_runs();
        let lost = runs
            .iter_mut()
            .find(|r| r.measured.level == 3)
            .map(|r| &mut r.measured.run)
            .expect("a run of M^3");
        (lost.cost.wall, lost.reached) = (1e9, 0.25);
        lost.failure = Some("600 s of wall time were over".into());
        let all: Vec<&WholeRun> = runs.iter().collect();
        let text = findings(&all).join("\n");
        assert!(
            text.contains("from 5 runs on 3 meshes that ended: time per simulated second 2.00"),
            "{text}"
        );
        assert!(
            text.contains("Not ended: M^3, BDF2 (default), start 1: stopped at 0.25 s: 600 s"),
            "{text}"
        );
        assert!(
            text.contains("BDF2 (default) did not come to the end"),
            "{text}"
        );
        let table = table(Work::Hanging, &all);
        let says = |c: &Cell| matches!(c, Cell::Text(t) if t.starts_with("stopped at 0.25 s"));
        let marked = table.rows.iter().filter(|r| r.last().is_some_and(says));
        assert_eq!(marked.count(), 1);
    }

    #[test]
    fn neighbouring_starts_are_compared_by_their_factorisations() {
        let mut runs = made_up_runs();
        let first = runs[0].measured.run.cost.factorisations;
        runs[1].measured.run.cost.factorisations = first * 4 / 3;
        let all: Vec<&WholeRun> = runs.iter().collect();
        let text = apart(&all).expect("pairs of runs");
        assert!(text.contains("M^1 33 %, M^2 0 %"), "{text}");
    }
}
