//! A work that other programs have been measured on as well: the hanging sheet.

use super::analysis::short;
use super::comparison::{self, COLUMNS, Entry};
use super::effort::StudyEffort;
use super::problem::{bumped, corner};
use super::scheme::DEFAULT;
use crate::figures::{Table, rounded};
use crate::interrupt;
use crate::progress::Progress;
use crate::scale::factorisation_time;
use anyhow::Result;
use isosheet_dynamics::{
    ImplicitOptions, Method, ProjectionStepOptions, RunEnd, SheetModel, Simulation, State,
    StepReport,
};
use isosheet_mesh::MassKind;
use serde::{Deserialize, Serialize};
use std::fmt::Write;
use std::ops::ControlFlow;
use std::time::Instant;

/// What the work is, in words.
pub(crate) const ABOUT: &str = "Square sheet, side 1 m, union-jack mesh M^k, mass 0.1 kg lumped by thirds of the incident areas, horizontal with \
    z = 1e-3 sin(πx) sin(πy), rest lengths those of the start, corner (0, 1) pinned, gravity 9.8 m/s², no bending stiffness, no contact, no \
    damping, 1.0 s.";

/// Height of the bump, metres: nearly flat, so that the length constraints are nearly dependent.
pub(crate) const BUMP: f64 = 1e-3;

/// Simulated time, seconds.
pub(crate) const DURATION: f64 = 1.0;

/// One run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Hanging {
    pub(crate) level: u32,
    pub(crate) method: String,
    /// Step asked for, seconds.
    pub(crate) step: f64,
    /// Wall seconds for a simulated second, the minimum over the repetitions.
    pub(crate) wall: f64,
    pub(crate) repetitions: usize,
    /// Largest relative edge length error over the run.
    pub(crate) strain: f64,
    /// Change of energy at the end, parts of the potential energy released.
    pub(crate) balance: f64,
    /// Largest change of energy on the way, parts of the same.
    pub(crate) drift: f64,
    pub(crate) factorisations: usize,
    pub(crate) steps: usize,
    pub(crate) rejected: usize,
    /// Seconds for one Cholesky factorisation of the matrix of a damped step.
    pub(crate) factorisation: f64,
    /// Simulated time, seconds.
    pub(crate) reached: f64,
    /// Why it did not come to the end.
    pub(crate) failure: Option<String>,
}

/// Name of the method that conserves energy.
const CONSERVATIVE: &str = "energy-momentum";

/// The methods and steps of the work.
fn methods() -> [(&'static str, Method, f64); 6] {
    // For those who look at the sheet and do not compute with it.
    let quick = Method::Bdf2(ImplicitOptions {
        tolerance: 1e-3,
        strain_tolerance: 1e-9,
        ..Default::default()
    });
    let loose = Method::Projection(ProjectionStepOptions {
        strain_tolerance: 1e-9,
        ..Default::default()
    });
    [
        (DEFAULT, Method::default(), 1.0 / 60.0),
        (DEFAULT, Method::default(), 5e-3),
        (
            "BDF2, lengths to 1e-9, decrement to 1e-3",
            quick,
            1.0 / 60.0,
        ),
        ("projection, lengths to 1e-9", loose.clone(), 1.0 / 60.0),
        ("projection, lengths to 1e-9", loose, 5e-3),
        (
            CONSERVATIVE,
            Method::EnergyMomentum(Default::default()),
            2e-3,
        ),
    ]
}

/// Runs the work on all meshes.
pub(crate) fn make(effort: StudyEffort) -> Result<Vec<Hanging>> {
    let levels = 1..=effort.hanging_level();
    let bar = Progress::start("hanging sheet", levels.clone().count() * methods().len());
    let mut rows = Vec::new();
    for level in levels {
        let factorisation = factorisation_time(&bumped(level, BUMP)?)?;
        for (name, method, step) in methods() {
            let row = measure(level, name, &method, step, effort.hanging())?;
            rows.push(Hanging {
                factorisation,
                ..row
            });
            bar.step();
        }
    }
    bar.finish(&format!("{} runs", rows.len()));
    Ok(rows)
}

/// Repetitions of runs that take no longer than a twentieth of the patience.
const REPETITIONS: usize = 3;

fn measure(level: u32, name: &str, method: &Method, step: f64, patience: f64) -> Result<Hanging> {
    let mut best: Option<Hanging> = None;
    let clock = Instant::now();
    loop {
        let mut row = run(level, name, method, step, patience)?;
        let repetitions = best.as_ref().map_or(0, |b| b.repetitions) + 1;
        if let Some(b) = &best {
            row.wall = row.wall.min(b.wall);
        }
        row.repetitions = repetitions;
        let done = row.failure.is_some()
            || repetitions == REPETITIONS
            || clock.elapsed().as_secs_f64() > 0.1 * patience;
        if done {
            return Ok(row);
        }
        best = Some(row);
    }
}

/// The sheet `M^level` with a bump of the given height (metres), held at its corner.
pub(crate) fn scene(level: u32, bump: f64, method: Method) -> Result<Simulation> {
    let sheet = bumped(level, bump)?;
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?
        .with_gravity()
        .with_pins(&[corner(level)])?;
    let start = State::at_rest(sheet.positions().to_vec());
    Ok(Simulation::new(model, start, method)?)
}

fn run(level: u32, name: &str, method: &Method, step: f64, patience: f64) -> Result<Hanging> {
    let mut simulation = scene(level, BUMP, method.clone())?;
    let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
    let (energy, height) = (simulation.energy(), potential(&simulation));
    let mut row = Hanging {
        level,
        method: name.into(),
        step,
        wall: 0.0,
        repetitions: 1,
        strain: 0.0,
        balance: 0.0,
        drift: 0.0,
        factorisations: 0,
        steps: 0,
        rejected: 0,
        factorisation: 0.0,
        reached: 0.0,
        failure: None,
    };
    let clock = Instant::now();
    let mut watch = |_: &Simulation, report: &StepReport| {
        row.strain = row.strain.max(report.strain);
        row.drift = row.drift.max(report.energy_drift.abs());
        row.factorisations += report.factorisations;
        row.steps += report.substeps;
        row.rejected += report.rejected;
        if clock.elapsed().as_secs_f64() > patience {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let end = simulation.run(DURATION, step, &mut [&mut watch, &mut interrupt::observe]);
    interrupt::check()?;
    row.failure = match end {
        Ok(RunEnd::Stopped) => Some(format!("given up after {patience} s of wall time")),
        // No support of this scene moves, so that no run ends taut.
        Ok(RunEnd::Complete | RunEnd::Taut) => None,
        Err(error) => Some(error.to_string()),
    };
    row.reached = simulation.state().t;
    let wall = clock.elapsed().as_secs_f64();
    row.wall = if row.reached > 0.0 {
        wall / row.reached
    } else {
        0.0
    };
    let released = height - potential(&simulation);
    if released > 0.0 {
        row.balance = (simulation.energy() - energy) / released;
        row.drift /= released;
    }
    Ok(row)
}

/// All runs as CSV.
pub(crate) fn csv(rows: &[Hanging]) -> String {
    let mut out = String::from(
        "mesh,method,step_s,wall_s_per_simulated_s,strain,energy_balance,largest_energy_change,factorisations,steps,rejected,\
         factorisation_s,reached_s,repetitions,failure\n",
    );
    for r in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "M^{},\"{}\",{:e},{:e},{:e},{:e},{:e},{},{},{},{:e},{},{},\"{}\"",
            r.level,
            r.method,
            r.step,
            r.wall,
            r.strain,
            r.balance,
            r.drift,
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

/// A signed part as a percentage with the digits that matter.
pub(super) fn percent(part: f64) -> String {
    let p = 100.0 * part;
    let text = if p.abs() >= 0.1 {
        format!("{p:.1} %")
    } else {
        format!("{p:.0e} %")
    };
    text.replace('-', "−")
}

/// The table for people.
pub(crate) fn table(rows: &[Hanging]) -> Table {
    Table {
        caption: "Hanging sheet: wall seconds for a simulated second on one core, as multiples of the fastest run on the mesh that keeps lengths to \
                  1e-9 and of one factorisation a step; largest relative edge length error, energy balance at the end as part of the potential \
                  energy released (negative: lost), and its largest change on the way"
            .into(),
        head: [
            "mesh", "method", "step (ms)", "s/s", COLUMNS[0], COLUMNS[1], "strain", "energy", "largest change", "factorisations", "steps", "rejected", "remark",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows
            .chunk_by(|a, b| a.level == b.level)
            .flat_map(|mesh| {
                let entries = entries(mesh);
                mesh.iter().map(move |r| cells(r, &entries))
            })
            .collect(),
    }
}

fn cells(r: &Hanging, mesh: &[Entry]) -> Vec<String> {
    let [of_fastest, of_limit] = r.entry().cells(mesh);
    vec![
        format!("M^{}", r.level),
        r.method.clone(),
        format!("{:.1}", 1e3 * r.step),
        if r.reached > 0.0 {
            short(r.wall)
        } else {
            "–".into()
        },
        of_fastest,
        of_limit,
        format!("{:.0e}", r.strain),
        percent(r.balance),
        percent(r.drift),
        r.factorisations.to_string(),
        r.steps.to_string(),
        r.rejected.to_string(),
        r.failure.as_ref().map_or(String::new(), |f| {
            format!("stopped at {} s: {}", short(r.reached), rounded(f))
        }),
    ]
}

/// What the rows say.
pub(crate) fn conclusions(rows: &[Hanging]) -> Vec<String> {
    let finished: Vec<&Hanging> = rows.iter().filter(|r| r.failure.is_none()).collect();
    let mut all = Vec::new();
    if let Some(strain) = finished.iter().map(|r| r.strain).reduce(f64::max) {
        all.push(format!(
            "{} of {} runs of the hanging sheet came to the end; none of these strains an edge by more than {strain:.0e}.",
            finished.len(),
            rows.len()
        ));
    }
    let mut levels: Vec<u32> = rows.iter().map(|r| r.level).collect();
    levels.dedup();
    for level in levels {
        let here = || finished.iter().filter(|r| r.level == level);
        let damped = here()
            .filter(|r| r.method != CONSERVATIVE)
            .min_by(|a, b| a.wall.total_cmp(&b.wall));
        let mut text = match damped {
            Some(r) => format!(
                "M^{level}: the cheapest damped run is {} at {:.1} ms, {} s/s with strain {:.0e}",
                r.method,
                1e3 * r.step,
                short(r.wall),
                r.strain
            ),
            None => format!("M^{level}: no damped run came to the end"),
        };
        match here().find(|r| r.method == CONSERVATIVE) {
            Some(r) => {
                let _ = write!(
                    text,
                    "; the conservative one takes {} s/s and keeps the energy to {:.0e}.",
                    short(r.wall),
                    r.drift
                );
            }
            None => text.push_str("; the conservative one did not come to the end."),
        }
        all.push(text);
    }
    let gains: Vec<String> = finished
        .iter()
        .filter(|r| r.balance > GAIN)
        .map(|r| {
            format!(
                "{} on M^{} at {:.1} ms by {}",
                r.method,
                r.level,
                1e3 * r.step,
                percent(r.balance)
            )
        })
        .collect();
    if !gains.is_empty() {
        all.push(format!(
            "These runs end with more energy than they started with, as part of the energy released: {}.",
            gains.join("; ")
        ));
    }
    all
}

/// How the runs on each mesh compare in time.
pub(crate) fn comparisons(rows: &[Hanging]) -> Vec<String> {
    rows.chunk_by(|a, b| a.level == b.level)
        .map(|mesh| {
            let scene = format!("Hanging sheet M^{}", mesh[0].level);
            comparison::words(&scene, &entries(mesh))
        })
        .collect()
}

fn entries(mesh: &[Hanging]) -> Vec<Entry> {
    mesh.iter().map(Hanging::entry).collect()
}

impl Hanging {
    fn entry(&self) -> Entry {
        Entry {
            name: format!("{} at {:.1} ms", self.method, 1e3 * self.step),
            wall: self.failure.is_none().then_some(self.wall),
            strain: self.strain,
            limit: self.factorisation / self.step,
        }
    }
}

/// Gain of energy, as part of the potential energy released, that is worth a word.
const GAIN: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coarsest_mesh_hangs() {
        let (name, method, step) = methods()[0].clone();
        let row = measure(1, name, &method, step, 1.0).unwrap();
        assert_eq!(row.failure, None);
        assert!((row.reached - DURATION).abs() < 1e-9);
        assert!(row.strain < 1e-11 && row.factorisations > 60, "{row:?}");
        assert!((-0.9..0.01).contains(&row.balance), "{}", row.balance);
        assert!(csv(std::slice::from_ref(&row)).contains("M^1,\"BDF2 (default)\""));
        assert!(conclusions(&[row])[1].starts_with("M^1: the cheapest damped run is BDF2"));
    }

    #[test]
    fn comparisons_follow_the_numbers() {
        let (name, method, step) = methods()[0].clone();
        let mut row = measure(1, name, &method, step, 1.0).unwrap();
        (row.wall, row.factorisation) = (0.6, 0.1 * step);
        let mut other = row.clone();
        (other.method, other.wall) = (CONSERVATIVE.into(), 1.8);
        let mut finer = row.clone();
        finer.level = 2;
        let all = [row, other, finer];
        let text = comparisons(&all);
        assert_eq!(text.len(), 2, "one for each mesh");
        assert!(
            text[0].contains(
                "BDF2 (default) at 16.7 ms: 0.60 s/s, 6.0 times the 0.10 s/s of one factorisation"
            ),
            "{text:?}"
        );
        assert!(
            text[0].contains(
                "energy-momentum at 16.7 ms takes 3.0 times as long, 18 times one factorisation"
            ),
            "{text:?}"
        );
        let table = table(&all);
        assert!(table.rows.iter().all(|r| r.len() == table.head.len()));
        assert_eq!(table.rows[1][4..6], ["3.0".to_owned(), "18".to_owned()]);
    }

    #[test]
    fn percentages() {
        assert_eq!(percent(-0.143), "−14.3 %");
        assert_eq!(percent(2e-7), "2e−5 %");
    }
}
