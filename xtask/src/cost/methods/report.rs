//! What the runs say.

use super::run::Run;
use crate::cost::DEFAULT;
use crate::report::{Bound, Finding, Table};
use crate::runs::STEP;

/// The columns that the page shows.
pub(super) const SHOWN: &str = "mesh contact method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance largest_energy_change smallest_gap_m depth_m crossings iterations \
    factorisations steps rejected failure";

/// The columns that the book shows.
pub(super) const IN_THE_BOOK: &str = "mesh vertices method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance \
    failure";

/// All runs.
pub(super) fn table(runs: &[Run]) -> Table {
    Table::of(
        "CPU seconds for a simulated second, of runs that did not end up to the time that they reached; as multiples of the fastest run of \
         the scene and mesh that keeps lengths to 1e-9; largest relative edge length error, energy balance at the end as part of the potential energy released (negative: lost), its largest change on the way",
        runs,
        &[
            ("scene", &|r| r.scene()[0].into()),
            ("contact", &|r| r.scene()[1].into()),
            ("mesh", &|r| r.mesh().into()),
            ("vertices", &|r| r.mesh.vertices.into()),
            ("method", &|r| r.method.as_str().into()),
            ("step_s", &|r| r.step.into()),
            ("cpu_s_per_simulated_s", &|r| r.course.cpu_rate().into()),
            ("times_fastest_exact", &|r| times_fastest(r, runs).into()),
            ("strain", &|r| r.course.strain.into()),
            ("energy_balance", &|r| r.balance().into()),
            ("largest_energy_change", &|r| r.relative_drift().into()),
            ("smallest_gap_m", &|r| r.course.gap.into()),
            ("depth_m", &|r| r.depth.into()),
            ("crossings", &|r| r.crossings.into()),
            ("iterations", &|r| r.course.cost.iterations.into()),
            ("factorisations", &|r| r.course.cost.factorisations.into()),
            ("wall_s_per_simulated_s", &|r| r.course.rate().into()),
            ("steps", &|r| r.course.cost.substeps.into()),
            ("rejected", &|r| r.course.cost.rejected.into()),
            ("repetitions", &|r| r.repetitions.into()),
            ("failure", &|r| r.remark().into()),
        ],
    )
}

/// The runs of the default with its default step, for the README.
pub(super) fn default(runs: &[Run]) -> Table {
    let is_default = |r: &&Run| r.method == DEFAULT && r.step == STEP;
    Table::of(
        "A square sheet that hangs by a corner and moves for one second, in steps of 1/60 s on one core.",
        runs.iter().filter(is_default),
        &[
            ("vertices", &|r| r.mesh.vertices.into()),
            ("CPU seconds", &|r| r.course.cost.cpu.into()),
            ("largest relative error of a length", &|r| {
                r.course.strain.into()
            }),
            ("change of energy, part of that released", &|r| {
                r.balance().into()
            }),
        ],
    )
}

/// Nothing may pass through anything in a run by a method with contact, as checked beside the contact code.
pub(super) fn required(runs: &[Run]) -> Vec<Finding> {
    let touching: Vec<&Run> = runs.iter().filter(|r| !r.scene()[1].is_empty()).collect();
    if touching.is_empty() {
        return Vec::new();
    }
    let worst = |quantity: &str, bound, of: &dyn Fn(&Run) -> f64| {
        let values: Vec<_> = touching.iter().map(|r| Some(of(r))).collect();
        Finding::worst("contact", quantity, bound, &values)
    };
    let none = Bound::AtMost(0.0);
    vec![
        worst("edges that cross faces", none, &|r| r.crossings as f64),
        worst("depth of a vertex in the table, m", none, &|r| r.depth),
        worst("smallest gap, m", Bound::Above(0.0), &|r| {
            r.course.gap.unwrap_or(f64::INFINITY)
        }),
    ]
}

/// Whether two runs are of one scene on one mesh.
fn are_alike(a: &Run, b: &Run) -> bool {
    (a.work, a.mesh.level) == (b.work, b.mesh.level)
}

/// The fastest run that came to the end and kept the lengths, with its CPU seconds for a simulated second.
fn fastest<'a>(runs: impl IntoIterator<Item = &'a Run>) -> Option<(&'a Run, f64)> {
    let exact = runs.into_iter().filter(|r| r.is_exact());
    let timed = exact.filter_map(|r| Some((r, r.rate()?)));
    timed.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The time of a run as a multiple of that of the fastest exact run of its scene and mesh.
fn times_fastest(run: &Run, runs: &[Run]) -> Option<f64> {
    let (_, least) = fastest(runs.iter().filter(|r| are_alike(run, r)))?;
    Some(run.rate()? / least)
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::super::run::Mesh;
    use super::*;
    use crate::report::Cell;
    use crate::runs::{Ending, Work};

    /// A run is compared with the fastest that ended on its mesh with its lengths kept.
    #[test]
    fn the_fastest_exact_run_is_the_unit() {
        let (method, step) = Scene::Hanging.methods()[0].clone();
        let run = Run::of(Work::Hanging, Mesh::of(1), method, step, 1.0).unwrap();
        let [mut best, mut slow, mut loose, mut lost, mut finer] = [(); 5].map(|()| run.clone());
        best.course.cost.cpu = 0.6;
        slow.course.cost.cpu = 1.8;
        (loose.course.strain, loose.course.cost.cpu) = (1e-3, 0.3);
        (lost.course.ending, lost.course.cost.cpu) = (Ending::Stopped, 0.1);
        (finer.mesh.level, finer.course.cost.cpu) = (2, 0.2);
        let times = table(&[best, slow, loose, lost, finer]).select("", "times_fastest_exact");
        let numbers: Vec<Option<f64>> = times
            .rows
            .iter()
            .map(|row| match row[0] {
                Cell::Number(value) => Some((1e9 * value).round() / 1e9),
                _ => None,
            })
            .collect();
        assert_eq!(numbers, [Some(1.0), Some(3.0), Some(0.5), None, Some(1.0)]);
    }
}
