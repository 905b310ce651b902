//! A work with contact that other programs have been measured on as well: the tablecloth.

mod penetration;

use super::analysis::short;
use super::comparison::{self, COLUMNS, Entry};
use super::effort::StudyEffort;
use super::hanging::{BUMP, percent};
use super::problem::bumped;
use super::scheme::DEFAULT;
use crate::figures::{Table, rounded};
use crate::interrupt;
use crate::progress::Progress;
use crate::scale::factorisation_time;
use anyhow::Result;
use isosheet_collide::{Coefficients, ContactOptions, Contacts, Obstacle, Shape};
use isosheet_dynamics::{Method, RunEnd, SheetModel, Simulation, State, StepReport};
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::Isometry3;
use penetration::{Checker, depth};
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// What the work is, in words.
pub(crate) const ABOUT: &str = "The sheet of the hanging work, all vertices free, 1 mm above a square table of half its side (a box), 1.5 s, without \
    friction, by the methods that take contact with steps of 1/60 s; once without and once with contact of the sheet with itself. That nothing penetrates is \
    checked every tenth of a second apart from the contact code: depth of every vertex in the box, and every edge against every face of the box and, \
    with self-contact, of the sheet. The energy of the barriers counts: where the sheet starts within their reach they push it up at first.";

/// Height of the sheet's rim above the table, metres.
const CLEARANCE: f64 = 1e-3;

/// Half of the table's side, half of its thickness, metres.
const TABLE: [f64; 3] = [0.25, 0.25, 0.1];

/// Step, seconds.
pub(crate) const STEP: f64 = 1.0 / 60.0;

/// Steps: 1.5 s.
pub(crate) const STEPS: usize = 90;

/// Steps between two checks for penetration.
const CHECK: usize = 6;

/// Which pairs repel each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Pairs {
    /// Sheet and table.
    Table,
    /// Sheet and table, and the sheet with itself.
    TableAndItself,
}

impl Pairs {
    fn name(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::TableAndItself => "table, itself",
        }
    }
}

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Tablecloth {
    pub(crate) level: u32,
    pub(crate) pairs: Pairs,
    pub(crate) method: String,
    /// Wall seconds for a simulated second, checks left out; the minimum over the repetitions.
    pub(crate) wall: f64,
    pub(crate) repetitions: usize,
    /// Largest relative edge length error over the run.
    pub(crate) strain: f64,
    /// Change of energy at the end, that of the barriers included, parts of the potential energy released.
    pub(crate) balance: f64,
    /// Smallest gap over the run, metres.
    pub(crate) gap: f64,
    /// Deepest vertex in the table at a check, metres; 0 if none is inside.
    pub(crate) depth: f64,
    /// Pairs of an edge and a face that cross at a check, over all checks.
    pub(crate) crossings: usize,
    pub(crate) iterations: usize,
    pub(crate) factorisations: usize,
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    /// Seconds for one factorisation of the matrix of a step without contact.
    pub(crate) factorisation: f64,
    /// Simulated time, seconds.
    pub(crate) reached: f64,
    /// Why it did not come to the end.
    pub(crate) failure: Option<String>,
}

impl Tablecloth {
    /// Part of the wall time that the factorisations take, if each costs as much as without contact.
    fn factorising(&self) -> f64 {
        self.factorisation * self.factorisations as f64 / (self.wall * self.reached)
    }

    fn entry(&self) -> Entry {
        Entry {
            name: self.method.clone(),
            wall: self.failure.is_none().then_some(self.wall),
            strain: self.strain,
            limit: self.factorisation / STEP,
        }
    }

    fn clean(&self) -> bool {
        self.gap > 0.0 && self.depth == 0.0 && self.crossings == 0
    }
}

/// The methods that take contact.
fn methods() -> [(&'static str, Method); 2] {
    [
        (DEFAULT, Method::default()),
        ("implicit Euler", Method::ImplicitEuler(Default::default())),
    ]
}

/// Runs the work on all meshes.
pub(crate) fn make(effort: StudyEffort) -> Result<Vec<Tablecloth>> {
    let levels = effort.tablecloth_levels();
    let bar = Progress::start("tablecloth", 4 * levels.clone().count());
    let mut rows = Vec::new();
    for level in levels {
        let factorisation = factorisation_time(&bumped(level, BUMP)?)?;
        for pairs in [Pairs::Table, Pairs::TableAndItself] {
            for (name, method) in methods() {
                let row = measure(level, pairs, (name, &method), effort.tablecloth())?;
                rows.push(Tablecloth {
                    factorisation,
                    ..row
                });
                bar.step();
            }
        }
    }
    bar.finish(&format!("{} runs", rows.len()));
    Ok(rows)
}

/// Repetitions of runs that take no longer than a tenth of the patience.
const REPETITIONS: usize = 3;

fn measure(level: u32, pairs: Pairs, method: (&str, &Method), patience: f64) -> Result<Tablecloth> {
    let mut row = run(level, pairs, method, patience)?;
    let clock = Instant::now();
    let long = row.wall * row.reached > 0.1 * patience;
    while !long
        && row.failure.is_none()
        && row.repetitions < REPETITIONS
        && clock.elapsed().as_secs_f64() < 0.1 * patience
    {
        row.wall = row.wall.min(run(level, pairs, method, patience)?.wall);
        row.repetitions += 1;
    }
    Ok(row)
}

/// The sheet above the table.
pub(crate) fn scene(sheet: &Sheet, pairs: Pairs, method: Method) -> Result<Simulation> {
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped)?.with_gravity();
    let pose = Isometry3::translation(0.5, 0.5, -TABLE[2] - CLEARANCE);
    let table = Obstacle::fixed(Shape::Cuboid { half: TABLE }, pose)?;
    let mut contacts = Contacts::new(&model, ContactOptions::for_sheet(&model))?
        .with_body(table, Coefficients::FRICTIONLESS)?;
    if pairs == Pairs::TableAndItself {
        contacts = contacts.with_self_contact(Coefficients::FRICTIONLESS)?;
    }
    let start = State::at_rest(sheet.positions().to_vec());
    Ok(Simulation::new(model, start, method)?.with_contact(contacts)?)
}

fn run(
    level: u32,
    pairs: Pairs,
    (name, method): (&str, &Method),
    patience: f64,
) -> Result<Tablecloth> {
    let sheet = bumped(level, BUMP)?;
    let checker = Checker::new(&sheet)?;
    let mut simulation = scene(&sheet, pairs, method.clone())?;
    let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
    let (energy, height) = (simulation.energy(), potential(&simulation));
    let mut row = Tablecloth {
        level,
        pairs,
        method: name.into(),
        wall: 0.0,
        repetitions: 1,
        strain: 0.0,
        balance: 0.0,
        gap: f64::INFINITY,
        depth: 0.0,
        crossings: 0,
        iterations: 0,
        factorisations: 0,
        steps: 0,
        rejected: 0,
        factorisation: 0.0,
        reached: 0.0,
        failure: None,
    };
    let clock = Instant::now();
    let (mut count, mut checking) = (0_usize, Duration::ZERO);
    let mut watch = |simulation: &Simulation, report: &StepReport| {
        let before = Instant::now();
        row.strain = row.strain.max(report.strain);
        row.gap = row.gap.min(report.gap.unwrap_or(f64::INFINITY));
        row.iterations += report.iterations;
        row.factorisations += report.factorisations;
        row.steps += report.substeps;
        row.rejected += report.rejected;
        count += 1;
        if count.is_multiple_of(CHECK) {
            let x = &simulation.state().x;
            row.depth = row.depth.max(depth(x));
            row.crossings += checker.crossings(x, pairs);
        }
        checking += before.elapsed();
        if (clock.elapsed() - checking).as_secs_f64() > patience {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let duration = STEPS as f64 * STEP;
    let end = simulation.run(duration, STEP, &mut [&mut watch, &mut interrupt::observe]);
    let wall = (clock.elapsed() - checking).as_secs_f64();
    interrupt::check()?;
    row.failure = match end {
        Ok(RunEnd::Stopped) => Some(format!("given up after {patience} s of wall time")),
        // No support of this scene moves, so that no run ends taut.
        Ok(RunEnd::Complete | RunEnd::Taut) => None,
        Err(error) => Some(error.to_string()),
    };
    row.reached = simulation.state().t;
    row.wall = if row.reached > 0.0 {
        wall / row.reached
    } else {
        0.0
    };
    let released = height - potential(&simulation);
    if released > 0.0 {
        row.balance = (simulation.energy() - energy) / released;
    }
    Ok(row)
}

/// All runs as CSV.
pub(crate) fn csv(rows: &[Tablecloth]) -> String {
    let mut out = String::from(
        "mesh,contact,method,step_s,wall_s_per_simulated_s,strain,energy_balance,smallest_gap_m,depth_m,crossings,iterations,factorisations,steps,\
         rejected,factorisation_s,reached_s,repetitions,failure\n",
    );
    for r in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "M^{},\"{}\",\"{}\",{STEP:e},{:e},{:e},{:e},{:e},{:e},{},{},{},{},{},{:e},{},{},\"{}\"",
            r.level,
            r.pairs.name(),
            r.method,
            r.wall,
            r.strain,
            r.balance,
            r.gap,
            r.depth,
            r.crossings,
            r.iterations,
            r.factorisations,
            r.steps,
            r.rejected,
            r.factorisation,
            r.reached,
            r.repetitions,
            r.failure.as_deref().unwrap_or("").replace('"', "'")
        );
    }
    out
}

/// The table for people.
pub(crate) fn table(rows: &[Tablecloth]) -> Table {
    Table {
        caption: "Tablecloth: wall seconds for a simulated second on one core, as multiples of the fastest run of the scene that keeps lengths to \
                  1e-9 and of one factorisation a step; largest relative edge length error, energy balance at the end as part of the potential \
                  energy released (negative: lost), smallest gap and deepest vertex in the table"
            .into(),
        head: [
            "mesh", "contact", "method", "s/s", COLUMNS[0], COLUMNS[1], "strain", "energy", "gap (µm)", "depth (µm)", "crossings", "iterations", "factorisations", "steps",
            "rejected", "remark",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: scenes(rows)
            .flat_map(|scene| {
                let entries = entries(scene);
                scene.iter().map(move |r| cells(r, &entries))
            })
            .collect(),
    }
}

fn cells(r: &Tablecloth, scene: &[Entry]) -> Vec<String> {
    let [of_fastest, of_limit] = r.entry().cells(scene);
    vec![
        format!("M^{}", r.level),
        r.pairs.name().into(),
        r.method.clone(),
        if r.reached > 0.0 {
            short(r.wall)
        } else {
            "–".into()
        },
        of_fastest,
        of_limit,
        format!("{:.0e}", r.strain),
        percent(r.balance),
        short(1e6 * r.gap),
        short(1e6 * r.depth),
        r.crossings.to_string(),
        r.iterations.to_string(),
        r.factorisations.to_string(),
        r.steps.to_string(),
        r.rejected.to_string(),
        r.failure.as_ref().map_or(String::new(), |f| {
            format!("stopped at {} s: {}", short(r.reached), rounded(f))
        }),
    ]
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[Tablecloth]) -> Vec<String> {
    let mut all = Vec::new();
    let finished = rows.iter().filter(|r| r.failure.is_none()).count();
    let clean = rows.iter().filter(|r| r.clean()).count();
    let strain = rows.iter().map(|r| r.strain).fold(0.0, f64::max);
    all.push(format!(
        "{finished} of {} runs of the tablecloth came to the end; in {clean} of {} nothing penetrates; the largest strain is {strain:.0e}.",
        rows.len(),
        rows.len()
    ));
    for scene in scenes(rows) {
        let first = &scene[0];
        let name = format!(
            "Tablecloth M^{}, contact with {}",
            first.level,
            match first.pairs {
                Pairs::Table => "the table",
                Pairs::TableAndItself => "the table and itself",
            }
        );
        all.push(comparison::words(&name, &entries(scene)));
        all.extend(scene.iter().filter(|r| r.method == DEFAULT).map(effort));
    }
    all
}

/// Runs of the same mesh and contact.
fn scenes(rows: &[Tablecloth]) -> impl Iterator<Item = &[Tablecloth]> {
    rows.chunk_by(|a, b| (a.level, a.pairs) == (b.level, b.pairs))
}

fn entries(scene: &[Tablecloth]) -> Vec<Entry> {
    scene.iter().map(Tablecloth::entry).collect()
}

/// Where the time of a run goes.
fn effort(r: &Tablecloth) -> String {
    let mut text = format!("M^{}, {}", r.level, r.pairs.name());
    if let Some(failure) = &r.failure {
        let _ = write!(
            text,
            ", stopped at {} s ({})",
            short(r.reached),
            rounded(failure)
        );
    }
    let _ = write!(
        text,
        ": {} takes {} iterations and {} factorisations for {} steps taken and {} rejected, {} ms for a factorisation and what belongs to it; \
         one factorisation of the matrix without contact takes {} ms, which makes {:.0} % of the time. Smallest gap {} µm.",
        r.method,
        r.iterations,
        r.factorisations,
        r.steps,
        r.rejected,
        short(1e3 * r.wall * r.reached / r.factorisations.max(1) as f64),
        short(1e3 * r.factorisation),
        100.0 * r.factorising(),
        short(1e6 * r.gap)
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_cloth_comes_to_the_end_without_penetration() {
        let (name, method) = methods()[0].clone();
        let row = measure(1, Pairs::TableAndItself, (name, &method), 4.0).unwrap();
        assert_eq!(row.failure, None);
        assert!((row.reached - 1.5).abs() < 1e-9);
        assert!(row.strain < 1e-10 && row.clean(), "{row:?}");
        assert!(row.factorisations >= row.steps, "{row:?}");
        let line = csv(std::slice::from_ref(&row));
        let fields = |l: &str| l.split(',').count();
        let lines: Vec<&str> = line.lines().collect();
        // The name of the contact holds a comma of its own.
        assert_eq!(fields(lines[1]), fields(lines[0]) + 1);
    }

    #[test]
    fn words_follow_the_numbers() {
        let row = Tablecloth {
            level: 3,
            pairs: Pairs::Table,
            method: DEFAULT.into(),
            wall: 0.5,
            repetitions: 1,
            strain: 1e-12,
            balance: -0.1,
            gap: 1e-4,
            depth: 0.0,
            crossings: 0,
            iterations: 200,
            factorisations: 100,
            steps: 90,
            rejected: 0,
            factorisation: 3e-3,
            reached: 1.5,
            failure: None,
        };
        let mut faster = row.clone();
        (faster.method, faster.wall) = ("implicit Euler".into(), 0.25);
        let mut rows = [row, faster];
        let text = conclusions(&rows).join(" ");
        assert!(
            text.contains(
                "implicit Euler: 0.25 s/s, 1.4 times the 0.18 s/s of one factorisation a step"
            ),
            "{text}"
        );
        assert!(
            text.contains(
                "BDF2 (default) takes 2.0 times as long, 2.8 times one factorisation a step"
            ),
            "{text}"
        );
        assert!(
            text.contains("which makes 40 % of the time. Smallest gap 100 µm"),
            "{text}"
        );
        assert!(text.contains("in 2 of 2 nothing penetrates"), "{text}");
        let table = table(&rows);
        assert!(table.rows.iter().all(|r| r.len() == table.head.len()));
        assert_eq!(table.rows[0][4..6], ["2.0".to_owned(), "2.8".to_owned()]);
        rows[0].depth = 1e-9;
        rows[1].failure = Some("lost".into());
        let text = conclusions(&rows).join(" ");
        assert!(text.contains("in 1 of 2 nothing penetrates"), "{text}");
        assert!(
            text.contains("implicit Euler did not come to the end"),
            "{text}"
        );
    }
}
