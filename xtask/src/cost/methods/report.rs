//! What the runs say: tables and words.

use super::CONSERVATIVE;
use super::run::{EXACT, Run};
use crate::cost::DEFAULT;
use crate::report::{Table, percent, short};
use crate::runs::STEP;
use std::fmt::Write;

/// The columns that the page shows.
pub(super) const SHOWN: &str = "mesh contact method step_s cpu_s_per_simulated_s times_fastest_exact \
    times_one_factorisation_a_step strain energy_balance largest_energy_change smallest_gap_m depth_m crossings iterations \
    factorisations steps rejected failure";

/// The columns that the book shows.
pub(super) const IN_THE_BOOK: &str = "mesh vertices method step_s cpu_s_per_simulated_s times_fastest_exact strain energy_balance \
    failure";

/// All runs.
pub(super) fn table(runs: &[Run]) -> Table {
    Table::of(
        "CPU seconds for a simulated second, of runs that did not end up to the time that they reached; as multiples of the fastest run of \
         the scene and mesh that keeps lengths to 1e-9, and of one factorisation a step; largest relative edge length error, energy balance \
         at the end as part of the potential energy released (negative: lost), its largest change on the way",
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
            ("times_one_factorisation_a_step", &|r| {
                r.rate().map(|rate| rate / r.limit()).into()
            }),
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
            ("factorisation_s", &|r| r.mesh.factorisation.into()),
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

/// How the methods compare on each mesh.
pub(super) fn comparisons(runs: &[Run]) -> Vec<String> {
    runs.chunk_by(are_alike).map(comparison).collect()
}

fn comparison(runs: &[Run]) -> String {
    let first = &runs[0];
    let [scene, contact] = first.scene();
    let mut text = format!("{scene} {}", first.mesh());
    if !contact.is_empty() {
        let _ = write!(text, ", contact with {contact}");
    }
    text[..1].make_ascii_uppercase();
    let Some((best, least)) = fastest(runs) else {
        return format!("{text}: no run came to the end with lengths kept to {EXACT:.0e}.");
    };
    let _ = write!(
        text,
        ": the fastest method that keeps lengths to {EXACT:.0e} is {}: {} s/s, {} times the {} s/s of one factorisation a step.",
        best.name(),
        short(least),
        short(least / best.limit()),
        short(best.limit())
    );
    for other in runs.iter().filter(|r| r.name() != best.name()) {
        let _ = match other.rate() {
            None => write!(text, " {} did not come to the end.", other.name()),
            Some(rate) => {
                let (times, of_limit) = (short(rate / least), short(rate / other.limit()));
                let name = other.name();
                let strain = match other.is_exact() {
                    true => String::new(),
                    false => format!(", and strains edges by {:.0e}", other.course.strain),
                };
                write!(
                    text,
                    " {name} takes {times} times as long, {of_limit} times one factorisation a step{strain}."
                )
            }
        };
    }
    text
}

/// Gain of energy, as part of the potential energy released, that is worth a word.
const GAIN: f64 = 1e-3;

/// What else the runs say: how many ended, what penetrates, what gains energy.
pub(super) fn details(runs: &[Run]) -> Vec<String> {
    let ended = || runs.iter().filter(|r| r.course.is_good());
    let strain = ended().map(|r| r.course.strain).fold(0.0, f64::max);
    let clean = runs.iter().filter(|r| r.is_clean()).count();
    let mut all = vec![format!(
        "{} of {} runs came to the end; none of these strains an edge by more than {strain:.0e}. In {clean} of all runs nothing penetrates.",
        ended().count(),
        runs.len()
    )];
    let conservative = ended().filter(|r| r.method == CONSERVATIVE);
    all.extend(conservative.map(|r| {
        format!(
            "{}: {CONSERVATIVE} takes {} s/s and keeps the energy to {:.0e}.",
            r.mesh(),
            short(r.rate().unwrap_or(f64::NAN)),
            r.relative_drift()
        )
    }));
    let gains = ended().filter(|r| r.balance() > GAIN);
    let gains: Vec<String> = gains
        .map(|r| format!("{} on {} by {}", r.name(), r.mesh(), percent(r.balance())))
        .collect();
    if !gains.is_empty() {
        all.push(format!(
            "These runs end with more energy than they started with, as part of the energy released: {}.",
            gains.join("; ")
        ));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::super::run::Mesh;
    use super::*;
    use crate::report::Cell;
    use crate::runs::{Ending, Pairs, Work};

    #[test]
    fn comparisons_follow_the_numbers() {
        let (method, step) = Scene::Hanging.methods()[0].clone();
        let mesh = Mesh::measured(1).unwrap();
        let mut run = Run::of(Work::Hanging, mesh, method, step, 1.0).unwrap();
        run.course.cost.cpu = 0.6 * run.course.time;
        run.mesh.factorisation = 0.1 * run.step;
        let mut other = run.clone();
        other.method = CONSERVATIVE.into();
        other.course.cost.cpu *= 3.0;
        let (mut loose, mut lost, mut finer) = (run.clone(), run.clone(), run.clone());
        loose.method = "loose".into();
        (loose.course.strain, loose.course.cost.cpu) = (1e-3, 0.3 * loose.course.time);
        lost.method = "lost".into();
        lost.course.ending = Ending::Stopped;
        finer.mesh.level = 2;
        let mut cloth = run.clone();
        cloth.work = Work::Tablecloth(Pairs::TableAndItself);
        cloth.depth = 1e-9;
        let all = [run, other, loose, lost, finer, cloth];
        let text = comparisons(&all);
        assert_eq!(text.len(), 3, "one for each scene and mesh");
        for part in [
            "BDF2 (default) at 16.7 ms: 0.60 s/s, 6.0 times the 0.10 s/s of one factorisation",
            "energy-momentum at 16.7 ms takes 3.0 times as long, 18 times one factorisation a step.",
            "loose at 16.7 ms takes 0.50 times as long, 3.0 times one factorisation a step, and strains edges by 1e-3.",
            "lost at 16.7 ms did not come to the end.",
        ] {
            assert!(text[0].contains(part), "{part} is missing in {text:?}");
        }
        assert!(
            text[2].starts_with("Tablecloth M^1, contact with table, itself: the fastest"),
            "{text:?}"
        );
        assert!(comparison(&all[2..4]).contains("no run came to the end with lengths kept"));
        let table = table(&all);
        assert_eq!(
            table.rows[1][7],
            Cell::from(all[1].rate().unwrap() / all[0].rate().unwrap())
        );
        let details = details(&all).join(" ");
        assert!(
            details.starts_with("5 of 6 runs came to the end"),
            "{details}"
        );
        assert!(
            details.contains("In 5 of all runs nothing penetrates"),
            "{details}"
        );
    }
}
