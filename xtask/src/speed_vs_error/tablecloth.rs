//! A work with contact that other programs have been measured on as well: the tablecloth.

mod penetration;

use super::scheme::DEFAULT;
use crate::methods::{Named, implicit_euler};
use crate::progress::Progress;
use crate::report::{Effort, Table, rounded, short};
use crate::timing::{self, BUMP, Entry, Limits, Measured, Mesh, Pairs, STEP, Work, bumped};
use anyhow::Result;
use isosheet_dynamics::{Method, Simulation, StepReport};
use penetration::{Checker, depth};
use std::ops::ControlFlow;

/// What the work is, in words.
pub(crate) const ABOUT: &str = "The sheet of the hanging work, all vertices free, 1 mm above a square table of half its side (a box), 1.5 s, without \
    friction, by the methods that take contact with steps of 1/60 s; once without and once with contact of the sheet with itself. That nothing penetrates is \
    checked every tenth of a second apart from the contact code: depth of every vertex in the box, and every edge against every face of the box and, \
    with self-contact, of the sheet. The energy of the barriers counts: where the sheet starts within their reach they push it up at first.";

/// Steps between two checks for penetration.
const CHECK: usize = 6;

/// One run.
#[derive(Clone, Debug)]
pub(super) struct Tablecloth {
    pairs: Pairs,
    run: Measured,
    /// Deepest vertex in the table at a check, metres; 0 if none is inside.
    depth: f64,
    /// Pairs of an edge and a face that cross at a check, over all checks.
    crossings: usize,
}

impl Tablecloth {
    /// Part of the wall time that the factorisations take, if each costs as much as without contact.
    fn factorising(&self) -> f64 {
        let cost = &self.run.course.cost;
        self.run.mesh.factorisation * cost.factorisations as f64 / cost.wall
    }

    fn entry(&self) -> Entry {
        self.run.entry(self.run.method.clone())
    }

    fn clean(&self) -> bool {
        let is_apart = self.run.course.gap.is_none_or(|gap| gap > 0.0);
        is_apart && self.depth == 0.0 && self.crossings == 0
    }

    /// What the sheet touches.
    fn pairs(&self) -> &'static str {
        match self.pairs {
            Pairs::Table => "table",
            Pairs::TableAndItself => "table, itself",
        }
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
    let levels = effort.quick_or(1..=1, 2..=4);
    // Longest run, seconds of wall time.
    let patience = effort.pick(0.5, 30.0, 240.0);
    let bar = Progress::start("tablecloth", 4 * levels.clone().count());
    let mut rows = Vec::new();
    for level in levels {
        let mesh = Mesh::measured(level)?;
        for pairs in [Pairs::Table, Pairs::TableAndItself] {
            for method in methods() {
                rows.push(measure(mesh, pairs, method, patience)?);
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
        ControlFlow::Continue(())
    };
    let limits = Limits {
        patience,
        short: 0.1 * patience,
    };
    let work = Work::Tablecloth(pairs);
    let run = Measured::of(work, mesh, method, (1, STEP), limits, &mut check)?;
    Ok(Tablecloth {
        pairs,
        run,
        depth: deepest,
        crossings,
    })
}

/// All runs.
pub(super) fn table(rows: &[Tablecloth]) -> Table {
    let runs: Vec<&Measured> = rows.iter().map(|r| &r.run).collect();
    let all = |r: &Measured| {
        let of = rows
            .iter()
            .filter(|o| (o.run.mesh.level, o.run.work) == (r.mesh.level, r.work));
        of.map(Tablecloth::entry).collect()
    };
    timing::table(
        "Tablecloth: wall seconds for a simulated second on one core, as multiples of the fastest run of the scene that keeps lengths to \
         1e-9 and of one factorisation a step; largest relative edge length error, energy balance at the end as part of the potential \
         energy released (negative: lost), smallest gap and deepest vertex in the table",
        &runs,
        &all,
    )
    .with_column("depth_m", rows.iter().map(|r| r.depth.into()))
    .with_column("crossings", rows.iter().map(|r| r.crossings.into()))
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[Tablecloth]) -> Vec<String> {
    let mut all = Vec::new();
    let finished = rows.iter().filter(|r| r.run.course.is_good()).count();
    let clean = rows.iter().filter(|r| r.clean()).count();
    let strain = rows.iter().map(|r| r.run.course.strain).fold(0.0, f64::max);
    all.push(format!(
        "{finished} of {} runs of the tablecloth came to the end; in {clean} of {} nothing penetrates; the largest strain is {strain:.0e}.",
        rows.len(),
        rows.len()
    ));
    for scene in scenes(rows) {
        let first = &scene[0];
        let name = format!(
            "Tablecloth M^{}, contact with {}",
            first.run.mesh.level,
            match first.pairs {
                Pairs::Table => "the table",
                Pairs::TableAndItself => "the table and itself",
            }
        );
        all.push(timing::words(&name, &entries(scene)));
        all.extend(scene.iter().filter(|r| r.run.method == DEFAULT).map(effort));
    }
    all
}

/// Runs of the same mesh and contact.
fn scenes(rows: &[Tablecloth]) -> impl Iterator<Item = &[Tablecloth]> {
    rows.chunk_by(|a, b| (a.run.mesh.level, a.pairs) == (b.run.mesh.level, b.pairs))
}

fn entries(scene: &[Tablecloth]) -> Vec<Entry> {
    scene.iter().map(Tablecloth::entry).collect()
}

/// Where the time of a run goes.
fn effort(r: &Tablecloth) -> String {
    let (course, cost) = (&r.run.course, &r.run.course.cost);
    let stopped = course.failure().map_or(String::new(), |failure| {
        let (reached, failure) = (short(course.time), rounded(&failure));
        format!(", stopped at {reached} s ({failure})")
    });
    format!(
        "{}, {}{stopped}: {} takes {} iterations and {} factorisations for {} steps taken and {} rejected, {} ms for a factorisation and what belongs to it; \
         one factorisation of the matrix without contact takes {} ms, which makes {:.0} % of the time. Smallest gap {} µm.",
        r.run.mesh(),
        r.pairs(),
        r.run.method,
        cost.iterations,
        cost.factorisations,
        cost.substeps,
        cost.rejected,
        short(1e3 * cost.wall_per_factorisation().unwrap_or(cost.wall)),
        short(1e3 * r.run.mesh.factorisation),
        100.0 * r.factorising(),
        short(1e6 * course.gap.unwrap_or(f64::INFINITY))
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Cell;
    use crate::runs::Ending;

    #[test]
    fn a_coarse_cloth_comes_to_the_end_without_penetration() {
        let (mesh, method) = (Mesh::measured(1).unwrap(), methods()[0].clone());
        let row = measure(mesh, Pairs::TableAndItself, method, 4.0).unwrap();
        let course = &row.run.course;
        assert!(course.is_good() && (course.time - 1.5).abs() < 1e-9);
        assert!(course.strain < 1e-10 && course.gap.is_some() && row.clean());
        assert!(
            course.cost.factorisations >= course.cost.substeps,
            "{row:?}"
        );
    }

    #[test]
    fn words_follow_the_numbers() {
        let mut mesh = Mesh::measured(1).unwrap();
        mesh.factorisation = 3e-3;
        let mut row = measure(mesh, Pairs::Table, methods()[0].clone(), 0.0).unwrap();
        let course = &mut row.run.course;
        (course.ending, course.time, course.gap) = (Ending::Complete, 1.5, Some(1e-4));
        (course.cost.wall, course.cost.factorisations) = (0.75, 100);
        let mut faster = row.clone();
        faster.run.method = "implicit Euler".into();
        faster.run.course.cost.wall = 0.375;
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
        assert_eq!(table(&rows).rows[0][9], Cell::from(2.0));
        rows[0].depth = 1e-9;
        rows[1].run.course.ending = Ending::Stopped;
        let text = conclusions(&rows).join(" ");
        for part in [
            "in 1 of 2 nothing penetrates",
            "implicit Euler did not come to the end",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }
}
