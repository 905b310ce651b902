//! A work with contact that other programs have been measured on as well: the tablecloth.

mod penetration;

use super::scheme::DEFAULT;
use crate::methods::{Named, implicit_euler};
use crate::progress::Progress;
use crate::report::{Effort, Table, percent, rounded, short};
use crate::timing::{self, BUMP, COLUMNS, Entry, Measured, Mesh, Pairs, STEP, Timed, Work, bumped};
use anyhow::Result;
use isosheet_dynamics::{Method, Simulation, StepReport};
use penetration::{Checker, depth};
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// What the work is, in words.
pub(crate) const ABOUT: &str = "The sheet of the hanging work, all vertices free, 1 mm above a square table of half its side (a box), 1.5 s, without \
    friction, by the methods that take contact with steps of 1/60 s; once without and once with contact of the sheet with itself. That nothing penetrates is \
    checked every tenth of a second apart from the contact code: depth of every vertex in the box, and every edge against every face of the box and, \
    with self-contact, of the sheet. The energy of the barriers counts: where the sheet starts within their reach they push it up at first.";

/// Steps between two checks for penetration.
const CHECK: usize = 6;

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Tablecloth {
    pairs: Pairs,
    measured: Measured,
    /// Deepest vertex in the table at a check, metres; 0 if none is inside.
    depth: f64,
    /// Pairs of an edge and a face that cross at a check, over all checks.
    crossings: usize,
}

impl Tablecloth {
    fn run(&self) -> &Timed {
        &self.measured.run
    }

    /// Part of the wall time that the factorisations take, if each costs as much as without contact.
    fn factorising(&self) -> f64 {
        let effort = &self.measured.run.cost;
        self.measured.factorisation * effort.factorisations as f64 / effort.wall
    }

    fn entry(&self) -> Entry {
        self.measured.entry(self.measured.method.clone())
    }

    fn clean(&self) -> bool {
        let is_apart = self.measured.run.gap.is_none_or(|gap| gap > 0.0);
        is_apart && self.depth == 0.0 && self.crossings == 0
    }
}

/// The methods that take contact.
fn methods() -> [Named; 2] {
    [
        (DEFAULT, Method::default()),
        ("implicit Euler", implicit_euler()),
    ]
}

/// Runs the work on all meshes.
pub(crate) fn make(effort: Effort) -> Result<Vec<Tablecloth>> {
    let levels = effort.tablecloth_levels();
    let bar = Progress::start("tablecloth", 4 * levels.clone().count());
    let mut rows = Vec::new();
    for level in levels {
        let mesh = Mesh::measured(level)?;
        for pairs in [Pairs::Table, Pairs::TableAndItself] {
            for method in methods() {
                rows.push(measure(mesh, pairs, method, effort.tablecloth())?);
                bar.step();
            }
        }
    }
    bar.finish(&format!("{} runs", rows.len()));
    Ok(rows)
}

fn measure(mesh: Mesh, pairs: Pairs, method: Named, patience: f64) -> Result<Tablecloth> {
    let checker = Checker::new(&bumped(mesh.level, BUMP)?)?;
    let (mut count, mut deepest, mut crossings) = (0_usize, 0.0_f64, 0);
    let mut check = |simulation: &Simulation, _: &StepReport| {
        count += 1;
        if count.is_multiple_of(CHECK) {
            let x = &simulation.state().x;
            deepest = deepest.max(depth(x));
            crossings += checker.crossings(x, pairs);
        }
    };
    let (work, limits) = (Work::Tablecloth(pairs), [patience, 0.1 * patience]);
    let measured = Measured::of(work, mesh, method, (1, STEP), limits, &mut check)?;
    Ok(Tablecloth {
        pairs,
        measured,
        depth: deepest,
        crossings,
    })
}

/// What the sheet touches.
fn pairs(r: &Tablecloth) -> &'static str {
    match r.pairs {
        Pairs::Table => "table",
        Pairs::TableAndItself => "table, itself",
    }
}

/// The smallest gap, micrometres.
fn gap(r: &Tablecloth) -> String {
    short(1e6 * r.measured.run.gap.unwrap_or(f64::INFINITY))
}

/// All runs, for programs.
pub(crate) fn data(rows: &[Tablecloth]) -> Table {
    Table::of(
        "",
        rows.iter().map(|r| (r, &r.measured, &r.measured.run)),
        &[
            ("mesh", &|(_, m, _)| m.mesh().into()),
            ("contact", &|(r, ..)| pairs(r).into()),
            ("method", &|(_, m, _)| m.method.as_str().into()),
            ("step_s", &|(_, m, _)| m.step.into()),
            ("wall_s_per_simulated_s", &|(.., r)| r.rate().into()),
            ("strain", &|(.., r)| r.strain.into()),
            ("energy_balance", &|(.., r)| r.balance().into()),
            ("smallest_gap_m", &|(.., r)| r.gap.into()),
            ("depth_m", &|(r, ..)| r.depth.into()),
            ("crossings", &|(r, ..)| r.crossings.into()),
            ("iterations", &|(.., r)| r.cost.iterations.into()),
            ("factorisations", &|(.., r)| r.cost.factorisations.into()),
            ("steps", &|(.., r)| r.cost.substeps.into()),
            ("rejected", &|(.., r)| r.cost.rejected.into()),
            ("factorisation_s", &|(_, m, _)| m.factorisation.into()),
            ("reached_s", &|(.., r)| r.reached.into()),
            ("repetitions", &|(.., r)| r.repetitions.into()),
            ("failure", &|(.., r)| r.failure.clone().into()),
        ],
    )
}

/// The table for people.
pub(crate) fn table(rows: &[Tablecloth]) -> Table {
    let rows = scenes(rows).flat_map(|scene| {
        let entries = entries(scene);
        let with = move |r: &Tablecloth| (r.clone(), r.entry().cells(&entries));
        scene.iter().map(with)
    });
    Table::of(
        "Tablecloth: wall seconds for a simulated second on one core, as multiples of the fastest run of the scene that keeps lengths to \
         1e-9 and of one factorisation a step; largest relative edge length error, energy balance at the end as part of the potential \
         energy released (negative: lost), smallest gap and deepest vertex in the table",
        rows,
        &[
            ("mesh", &|(r, _)| r.measured.mesh().into()),
            ("contact", &|(r, _)| pairs(r).into()),
            ("method", &|(r, _)| r.measured.method.as_str().into()),
            ("s/s", &|(r, _)| r.measured.rate().into()),
            (COLUMNS[0], &|(_, c)| c[0].as_str().into()),
            (COLUMNS[1], &|(_, c)| c[1].as_str().into()),
            ("strain", &|(r, _)| format!("{:.0e}", r.run().strain).into()),
            ("energy", &|(r, _)| percent(r.run().balance()).into()),
            ("gap (µm)", &|(r, _)| gap(r).into()),
            ("depth (µm)", &|(r, _)| short(1e6 * r.depth).into()),
            ("crossings", &|(r, _)| r.crossings.into()),
            ("iterations", &|(r, _)| r.run().cost.iterations.into()),
            ("factorisations", &|(r, _)| {
                r.run().cost.factorisations.into()
            }),
            ("steps", &|(r, _)| r.run().cost.substeps.into()),
            ("rejected", &|(r, _)| r.run().cost.rejected.into()),
            ("remark", &|(r, _)| r.measured.remark().into()),
        ],
    )
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[Tablecloth]) -> Vec<String> {
    let mut all = Vec::new();
    let finished = rows.iter().filter(|r| r.run().ended()).count();
    let clean = rows.iter().filter(|r| r.clean()).count();
    let strain = rows.iter().map(|r| r.run().strain).fold(0.0, f64::max);
    all.push(format!(
        "{finished} of {} runs of the tablecloth came to the end; in {clean} of {} nothing penetrates; the largest strain is {strain:.0e}.",
        rows.len(),
        rows.len()
    ));
    for scene in scenes(rows) {
        let first = &scene[0];
        let name = format!(
            "Tablecloth M^{}, contact with {}",
            first.measured.level,
            match first.pairs {
                Pairs::Table => "the table",
                Pairs::TableAndItself => "the table and itself",
            }
        );
        all.push(timing::words(&name, &entries(scene)));
        all.extend(
            scene
                .iter()
                .filter(|r| r.measured.method == DEFAULT)
                .map(effort),
        );
    }
    all
}

/// Runs of the same mesh and contact.
fn scenes(rows: &[Tablecloth]) -> impl Iterator<Item = &[Tablecloth]> {
    rows.chunk_by(|a, b| (a.measured.level, a.pairs) == (b.measured.level, b.pairs))
}

fn entries(scene: &[Tablecloth]) -> Vec<Entry> {
    scene.iter().map(Tablecloth::entry).collect()
}

/// Where the time of a run goes.
fn effort(r: &Tablecloth) -> String {
    let (run, effort) = (&r.measured.run, &r.measured.run.cost);
    let mut text = format!("{}, {}", r.measured.mesh(), pairs(r));
    if let Some(failure) = &run.failure {
        let _ = write!(
            text,
            ", stopped at {} s ({})",
            short(run.reached),
            rounded(failure)
        );
    }
    let _ = write!(
        text,
        ": {} takes {} iterations and {} factorisations for {} steps taken and {} rejected, {} ms for a factorisation and what belongs to it; \
         one factorisation of the matrix without contact takes {} ms, which makes {:.0} % of the time. Smallest gap {} µm.",
        r.measured.method,
        effort.iterations,
        effort.factorisations,
        effort.substeps,
        effort.rejected,
        short(1e3 * effort.wall_per_factorisation().unwrap_or(effort.wall)),
        short(1e3 * r.measured.factorisation),
        100.0 * r.factorising(),
        gap(r)
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Cell;

    #[test]
    fn a_coarse_cloth_comes_to_the_end_without_penetration() {
        let (mesh, method) = (Mesh::measured(1).unwrap(), methods()[0].clone());
        let row = measure(mesh, Pairs::TableAndItself, method, 4.0).unwrap();
        let run = &row.measured.run;
        assert_eq!(run.failure, None);
        assert!((run.reached - 1.5).abs() < 1e-9 && run.gap.is_some());
        assert!(run.strain < 1e-10 && row.clean(), "{row:?}");
        assert!(run.cost.factorisations >= run.cost.substeps, "{row:?}");
    }

    #[test]
    fn words_follow_the_numbers() {
        let mut mesh = Mesh::measured(1).unwrap();
        mesh.factorisation = 3e-3;
        let mut row = measure(mesh, Pairs::Table, methods()[0].clone(), 0.0).unwrap();
        let run = &mut row.measured.run;
        (run.failure, run.reached, run.gap) = (None, 1.5, Some(1e-4));
        (run.cost.wall, run.cost.factorisations) = (0.75, 100);
        let mut faster = row.clone();
        faster.measured.method = "implicit Euler".into();
        faster.measured.run.cost.wall = 0.375;
        let mut rows = [row, faster];
        let text = conclusions(&rows).join(" ");
        for part in [
            "implicit Euler: 0.25 s/s, 1.4 times the 0.18 s/s of one factorisation a step",
            "BDF2 (default) takes 2.0 times as long, 2.8 times one factorisation a step",
            "which makes 40 % of the time. Smallest gap 100 µm",
            "in 2 of 2 nothing penetrates",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
        let cells = &table(&rows).rows[0];
        assert_eq!(cells[4..6], [Cell::from("2.0"), Cell::from("2.8")]);
        rows[0].depth = 1e-9;
        rows[1].measured.run.failure = Some("lost".into());
        let text = conclusions(&rows).join(" ");
        for part in [
            "in 1 of 2 nothing penetrates",
            "implicit Euler did not come to the end",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }
}
