//! A work with contact that other programs have been measured on as well: the tablecloth.

mod penetration;

use super::analysis::short;
use super::effort::StudyEffort;
use super::hanging::{BUMP, percent};
use super::problem::bumped;
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
    friction, by the default method with steps of 1/60 s; once without and once with contact of the sheet with itself. That nothing penetrates is \
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

    fn clean(&self) -> bool {
        self.gap > 0.0 && self.depth == 0.0 && self.crossings == 0
    }
}

/// Runs the work on all meshes.
pub(crate) fn make(effort: StudyEffort) -> Result<Vec<Tablecloth>> {
    let levels = effort.tablecloth_levels();
    let bar = Progress::start("tablecloth", 2 * levels.clone().count());
    let mut rows = Vec::new();
    for level in levels {
        for pairs in [Pairs::Table, Pairs::TableAndItself] {
            rows.push(measure(level, pairs, effort.tablecloth())?);
            bar.step();
        }
    }
    bar.finish(&format!("{} runs", rows.len()));
    Ok(rows)
}

/// Repetitions of runs that take no longer than a tenth of the patience.
const REPETITIONS: usize = 3;

fn measure(level: u32, pairs: Pairs, patience: f64) -> Result<Tablecloth> {
    let mut row = run(level, pairs, patience)?;
    let clock = Instant::now();
    let long = row.wall * row.reached > 0.1 * patience;
    while !long
        && row.failure.is_none()
        && row.repetitions < REPETITIONS
        && clock.elapsed().as_secs_f64() < 0.1 * patience
    {
        row.wall = row.wall.min(run(level, pairs, patience)?.wall);
        row.repetitions += 1;
    }
    row.factorisation = factorisation_time(&bumped(level, BUMP)?)?;
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

fn run(level: u32, pairs: Pairs, patience: f64) -> Result<Tablecloth> {
    let sheet = bumped(level, BUMP)?;
    let checker = Checker::new(&sheet)?;
    let mut simulation = scene(&sheet, pairs, Method::default())?;
    let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
    let (energy, height) = (simulation.energy(), potential(&simulation));
    let mut row = Tablecloth {
        level,
        pairs,
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
        "mesh,contact,step_s,wall_s_per_simulated_s,strain,energy_balance,smallest_gap_m,depth_m,crossings,iterations,factorisations,steps,\
         rejected,factorisation_s,reached_s,repetitions,failure\n",
    );
    for r in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "M^{},\"{}\",{STEP:e},{:e},{:e},{:e},{:e},{:e},{},{},{},{},{},{:e},{},{},\"{}\"",
            r.level,
            r.pairs.name(),
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
        caption: "Tablecloth: wall seconds for a simulated second on one core, largest relative edge length error, energy balance at the end as \
                  part of the potential energy released (negative: lost), smallest gap and deepest vertex in the table"
            .into(),
        head: [
            "mesh", "contact", "s/s", "strain", "energy", "gap (µm)", "depth (µm)", "crossings", "iterations", "factorisations", "steps",
            "rejected", "remark",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows
            .iter()
            .map(|r| {
                vec![
                    format!("M^{}", r.level),
                    r.pairs.name().into(),
                    if r.reached > 0.0 { short(r.wall) } else { "–".into() },
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
            })
            .collect(),
    }
}

/// The mesh of the targets, the wall seconds for a simulated second asked for and hoped for, and the largest
/// strain.
const TARGET: (u32, f64, f64, f64) = (3, 0.7, 0.17, 1e-10);

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
    all.extend(
        rows.iter()
            .filter(|r| r.level == TARGET.0)
            .map(target_words),
    );
    all
}

fn target_words(r: &Tablecloth) -> String {
    let (level, limit, goal, strain) = TARGET;
    let mut text = format!(
        "Tablecloth M^{level}, contact with {}: {} s/s",
        match r.pairs {
            Pairs::Table => "the table",
            Pairs::TableAndItself => "the table and itself",
        },
        short(r.wall)
    );
    if let Some(failure) = &r.failure {
        let _ = write!(
            text,
            " up to {} s, where it stopped ({})",
            short(r.reached),
            rounded(failure)
        );
    }
    let ended = r.failure.is_none();
    let verdict = |met: bool| if met { "met" } else { "missed" };
    let _ = write!(
        text,
        ". Below {limit}: {}; below {goal}: {}; strain below {strain:.0e}: {} ({:.0e}); no penetration: {} (smallest gap {} µm).",
        verdict(ended && r.wall < limit),
        verdict(ended && r.wall < goal),
        verdict(ended && r.strain < strain),
        r.strain,
        verdict(ended && r.clean()),
        short(1e6 * r.gap)
    );
    if !ended || r.wall >= goal {
        let _ = write!(
            text,
            " Where the time goes: {} iterations and {} factorisations for {} steps taken and {} rejected, {} ms for a factorisation and what \
             belongs to it; one factorisation of the matrix without contact takes {} ms, which makes {:.0} % of the time.",
            r.iterations,
            r.factorisations,
            r.steps,
            r.rejected,
            short(1e3 * r.wall * r.reached / r.factorisations.max(1) as f64),
            short(1e3 * r.factorisation),
            100.0 * r.factorising()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_cloth_comes_to_the_end_without_penetration() {
        let row = measure(1, Pairs::TableAndItself, 4.0).unwrap();
        assert_eq!(row.failure, None);
        assert!((row.reached - 1.5).abs() < 1e-9);
        assert!(row.strain < 1e-10 && row.clean(), "{row:?}");
        assert!(
            row.factorisations >= row.steps && row.factorisation > 0.0,
            "{row:?}"
        );
        let line = csv(std::slice::from_ref(&row));
        let fields = |l: &str| l.split(',').count();
        let lines: Vec<&str> = line.lines().collect();
        // The name of the contact holds a comma of its own.
        assert_eq!(fields(lines[1]), fields(lines[0]) + 1);
    }

    #[test]
    fn words_follow_the_numbers() {
        let mut row = Tablecloth {
            level: 3,
            pairs: Pairs::Table,
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
        let text = conclusions(std::slice::from_ref(&row)).join(" ");
        assert!(
            text.contains("Below 0.7: met; below 0.17: missed;"),
            "{text}"
        );
        assert!(text.contains("which makes 40 % of the time"), "{text}");
        assert!(
            text.contains("no penetration: met (smallest gap 100 µm)"),
            "{text}"
        );
        row.depth = 1e-9;
        row.strain = 2e-10;
        row.wall = 0.1;
        let text = target_words(&row);
        assert!(text.contains("strain below 1e-10: missed"), "{text}");
        assert!(text.contains("no penetration: missed"), "{text}");
        row.failure = Some("lost".into());
        assert!(target_words(&row).contains("Below 0.7: missed"));
    }
}
