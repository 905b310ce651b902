//! Tables and words on whole runs.

use super::Results;
use super::findings::power;
use super::whole::{Damped, NEIGHBOUR, STEP, Scene, WholeRun};
use crate::figures::{Table, rounded};
use crate::speed_vs_error::comparison::{self, COLUMNS, Entry};
use crate::speed_vs_error::short;
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
    let mut all: Vec<String> = first
        .scene
        .methods()
        .iter()
        .map(|method| powers(runs, *method))
        .collect();
    all.extend(apart(runs));
    for level in levels(runs) {
        let entries = entries(runs, level);
        all.push(comparison::words(&format!("M^{level}"), &entries));
    }
    let strain = runs.iter().map(|r| r.strain).fold(0.0, f64::max);
    let mut extremes =
        format!("The largest strain of an edge in any of these runs is {strain:.0e}");
    if let Some(gap) = runs.iter().filter_map(|r| r.gap).reduce(f64::min) {
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
        .filter(|r| r.method == method && r.ended())
        .collect();
    let fit = |value: &dyn Fn(&WholeRun) -> Option<f64>| {
        let points: Vec<[f64; 2]> = ended
            .iter()
            .filter_map(|r| Some([r.vertices as f64, value(r)?]))
            .collect();
        power(&points)
    };
    format!(
        "{}, fitted powers of V from {} runs on {} meshes that ended: time per simulated second {}, time per factorisation {}, factorisations per step {}, \
         iterations per step {}.",
        method.name(),
        ended.len(),
        ended.chunk_by(|a, b| a.level == b.level).count(),
        fit(&WholeRun::rate),
        fit(&WholeRun::per_factorisation),
        fit(&|r| r.per_step(r.factorisations)),
        fit(&|r| r.per_step(r.iterations)),
    )
}

/// How far the neighbouring starts are apart in cost, by the number of factorisations, which has no noise of
/// the clock.
fn apart(runs: &[&WholeRun]) -> Option<String> {
    let mut parts = Vec::new();
    for level in levels(runs) {
        let largest = runs
            .chunk_by(|a, b| (a.level, a.method) == (b.level, b.method))
            .filter(|pair| pair[0].level == level && pair.iter().all(|r| r.ended()))
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
    let counts = pair.iter().map(|r| r.factorisations as f64);
    let [low, high] = counts
        .map(|n| [n; 2])
        .reduce(|[l, h], [a, b]| [l.min(a), h.max(b)])?;
    (pair.len() > 1 && low > 0.0).then(|| high / low - 1.0)
}

fn levels(runs: &[&WholeRun]) -> Vec<u32> {
    let mut levels: Vec<u32> = runs.iter().map(|r| r.level).collect();
    levels.dedup();
    levels
}

/// The methods on one mesh: means over the starts, of methods that came to the end from all of them.
fn entries(runs: &[&WholeRun], level: u32) -> Vec<Entry> {
    runs.chunk_by(|a, b| (a.level, a.method) == (b.level, b.method))
        .filter(|starts| starts[0].level == level)
        .map(|starts| {
            let walls: Option<Vec<f64>> = starts.iter().map(|r| r.entry().wall).collect();
            Entry {
                wall: walls.map(|w| w.iter().sum::<f64>() / w.len() as f64),
                strain: starts.iter().map(|r| r.strain).fold(0.0, f64::max),
                ..starts[0].entry()
            }
        })
        .collect()
}

/// How far a run came that did not come to the end.
fn unfinished(r: &WholeRun) -> Option<String> {
    r.failure.as_ref().map(|failure| {
        format!(
            "M^{}, {}, start {}: reached {} s ({})",
            r.level,
            r.method.name(),
            r.start,
            short(r.reached),
            rounded(failure)
        )
    })
}

fn cell(value: Option<f64>) -> String {
    value.map_or("–".into(), short)
}

/// The runs of one scene.
pub(super) fn table(scene: Scene, runs: &[&WholeRun]) -> Table {
    let head = [
        "mesh",
        "V",
        "method",
        "start",
        "s/s",
        "iterations per step",
        "factorisations per step",
        "ms per factorisation",
    ];
    let tail = ["rejected", "strain", "smallest gap, µm", "remark"];
    Table {
        caption: format!(
            "Whole runs of the {}: wall seconds for a simulated second, set-up left out, of runs that did not end up to the time they reached; \
             the time as a multiple of that of the fastest method on the mesh that keeps lengths, and of the time of one factorisation a step.",
            scene.name()
        ),
        head: head
            .iter()
            .chain(&COLUMNS)
            .chain(&tail)
            .map(|h| (*h).to_owned())
            .collect(),
        rows: runs
            .iter()
            .map(|r| row(r, &entries(runs, r.level)))
            .collect(),
    }
}

fn row(r: &WholeRun, entries: &[Entry]) -> Vec<String> {
    let mut cells = vec![
        format!("M^{}", r.level),
        r.vertices.to_string(),
        r.method.name().into(),
        r.start.to_string(),
        cell(r.rate()),
        cell(r.per_step(r.iterations)),
        cell(r.per_step(r.factorisations)),
        cell(r.per_factorisation().map(|s| 1e3 * s)),
    ];
    cells.extend(r.entry().cells(entries));
    cells.extend([
        r.rejected.to_string(),
        format!("{:.0e}", r.strain),
        cell(r.gap.map(|gap| 1e6 * gap)),
        r.failure.as_ref().map_or(String::new(), |failure| {
            format!(
                "not ended, reached {} s: {}",
                short(r.reached),
                rounded(failure)
            )
        }),
    ]);
    cells
}

/// All runs for a terminal.
pub(super) fn text(results: &Results) -> String {
    let mut out = format!(
        "whole runs, at most {} s of wall time each\n",
        results.limit
    );
    for scene in Scene::ALL {
        let runs = results.whole_of(scene);
        let _ = writeln!(
            out,
            "{}\nmesh  vertices  method          start       s/s  iterations  factorisations  strain   gap, µm",
            scene.name()
        );
        for r in &runs {
            let _ = writeln!(
                out,
                "M^{:<3} {:>8}  {:<14} {:>6} {:>9} {:>11} {:>15} {:>7.0e} {:>9}{}",
                r.level,
                r.vertices,
                r.method.name(),
                r.start,
                cell(r.rate()),
                cell(r.per_step(r.iterations)),
                cell(r.per_step(r.factorisations)),
                r.strain,
                cell(r.gap.map(|gap| 1e6 * gap)),
                if r.ended() { "" } else { "  not ended" }
            );
        }
        for words in findings(&runs) {
            let _ = writeln!(out, "{words}");
        }
    }
    out
}

/// All runs as CSV.
pub(super) fn csv(runs: &[WholeRun]) -> String {
    let mut out = String::from(
        "scene,level,vertices,method,start,step_s,wall_s,repetitions,reached_s,steps,rejected,iterations,factorisations,factorisation_s,\
         strain,gap_m,not_ended\n",
    );
    for r in runs {
        let gap = r.gap.map_or(String::new(), |gap| format!("{gap:e}"));
        let _ = writeln!(
            out,
            "{},{},{},{},{},{STEP:e},{:e},{},{},{},{},{},{},{:e},{:e},{gap},\"{}\"",
            r.scene.name(),
            r.level,
            r.vertices,
            r.method.name(),
            r.start,
            r.wall,
            r.repetitions,
            r.reached,
            r.steps,
            r.rejected,
            r.iterations,
            r.factorisations,
            r.factorisation,
            r.strain,
            r.failure.as_deref().unwrap_or("").replace('"', "'")
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of the hanging sheet with made-up numbers: `cost` times `V^2` seconds, `V^1.5` of them for each
    /// factorisation.
    fn made_up(level: u32, method: Damped, start: usize, cost: f64) -> WholeRun {
        let vertices = (2_usize.pow(level + 1) + 1).pow(2);
        let v = vertices as f64;
        WholeRun {
            scene: Scene::Hanging,
            level,
            vertices,
            method,
            start,
            wall: cost * v * v,
            repetitions: 1,
            reached: 1.0,
            steps: 60,
            rejected: 0,
            iterations: 240,
            factorisations: (1e6 * cost * v.sqrt()) as usize,
            strain: 1e-12,
            gap: None,
            factorisation: 1e-6 * v * v * STEP,
            failure: None,
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
            .find(|r| r.level == 3)
            .expect("a run of M^3");
        (lost.wall, lost.reached) = (1e9, 0.25);
        lost.failure = Some("600 s of wall time were over".into());
        let all: Vec<&WholeRun> = runs.iter().collect();
        let text = findings(&all).join("\n");
        assert!(
            text.contains("from 5 runs on 3 meshes that ended: time per simulated second 2.00"),
            "{text}"
        );
        assert!(
            text.contains("Not ended: M^3, BDF2 (default), start 1: reached 0.25 s (600 s"),
            "{text}"
        );
        assert!(
            text.contains("BDF2 (default) did not come to the end"),
            "{text}"
        );
        let table = table(Scene::Hanging, &all);
        assert!(table.rows.iter().all(|r| r.len() == table.head.len()));
        let marked = table.rows.iter().filter(|r| {
            r.last()
                .is_some_and(|c| c.starts_with("not ended, reached 0.25 s"))
        });
        assert_eq!(marked.count(), 1);
    }

    #[test]
    fn neighbouring_starts_are_compared_by_their_factorisations() {
        let mut runs = made_up_runs();
        runs[1].factorisations = runs[0].factorisations * 4 / 3;
        let all: Vec<&WholeRun> = runs.iter().collect();
        let text = apart(&all).expect("pairs of runs");
        assert!(text.contains("M^1 33 %, M^2 0 %"), "{text}");
    }
}
