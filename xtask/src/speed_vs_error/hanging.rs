//! A work that other programs have been measured on as well: the hanging sheet.

use super::analysis::short;
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
        caption: "Hanging sheet: wall seconds for a simulated second on one core, largest relative edge length error, energy balance at the end as \
                  part of the potential energy released (negative: lost), and its largest change on the way"
            .into(),
        head: [
            "mesh", "method", "step (ms)", "s/s", "strain", "energy", "largest change", "factorisations", "steps", "rejected", "remark",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows
            .iter()
            .map(|r| {
                vec![
                    format!("M^{}", r.level),
                    r.method.clone(),
                    format!("{:.1}", 1e3 * r.step),
                    if r.reached > 0.0 { short(r.wall) } else { "–".into() },
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
            })
            .collect(),
    }
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

/// Whether the rows reach what is asked of them.
pub(crate) fn targets(rows: &[Hanging]) -> Vec<String> {
    TARGETS.iter().filter_map(|t| t.words(rows)).collect()
}

/// What is asked of the cheapest run of a mesh that is exact enough.
struct Target {
    level: u32,
    conservative: bool,
    /// Wall seconds for a simulated second: asked for and hoped for.
    walls: [f64; 2],
    /// Largest error: of energy for a conservative run, strain for a damped one.
    error: f64,
}

const TARGETS: [Target; 2] = [
    Target {
        level: 3,
        conservative: false,
        walls: [0.25, 0.12],
        error: 1e-9,
    },
    Target {
        level: 2,
        conservative: true,
        walls: [2.0, 0.25],
        error: 1e-8,
    },
];

impl Target {
    fn error(&self, r: &Hanging) -> f64 {
        if self.conservative { r.drift } else { r.strain }
    }

    /// Whether the runs reach it; nothing if there are none.
    fn words(&self, rows: &[Hanging]) -> Option<String> {
        let (level, error) = (self.level, self.error);
        let mut candidates = rows
            .iter()
            .filter(|r| r.level == level && (r.method == CONSERVATIVE) == self.conservative)
            .peekable();
        candidates.peek()?;
        let (kind, of) = if self.conservative {
            ("conservative", "energy error")
        } else {
            ("damped or projected", "strain")
        };
        let best = candidates
            .filter(|r| r.failure.is_none() && self.error(r) <= error)
            .min_by(|a, b| a.wall.total_cmp(&b.wall));
        let Some(r) = best else {
            return Some(format!(
                "Hanging sheet M^{level}, {kind}: no run has {of} of at most {error:.0e}: missed."
            ));
        };
        let verdict = |wall| if r.wall < wall { "met" } else { "missed" };
        let [limit, goal] = self.walls;
        let mut text = format!(
            "Hanging sheet M^{level}, {kind}, {of} at most {error:.0e}: {} s/s by {} at {:.1} ms with {:.0e}. Below {limit}: {}; below {goal}: {}.",
            short(r.wall),
            r.method,
            1e3 * r.step,
            self.error(r),
            verdict(limit),
            verdict(goal)
        );
        if r.wall >= goal {
            let _ = write!(
                text,
                " Where the time goes: {} factorisations for {} steps taken and {} rejected, {} ms for a factorisation and what belongs to it",
                r.factorisations,
                r.steps,
                r.rejected,
                short(1e3 * r.wall * r.reached / r.factorisations.max(1) as f64)
            );
            if !self.conservative {
                let _ = write!(
                    text,
                    "; one factorisation alone takes {} ms, which makes {:.0} % of the time",
                    short(1e3 * r.factorisation),
                    100.0 * r.factorisation * r.factorisations as f64 / (r.wall * r.reached)
                );
            }
            text.push('.');
        }
        Some(text)
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
    fn targets_follow_the_numbers() {
        let (name, method, step) = methods()[0].clone();
        let mut row = measure(1, name, &method, step, 1.0).unwrap();
        let [damped, conservative] = &TARGETS;
        assert_eq!(damped.words(std::slice::from_ref(&row)), None);
        (row.level, row.wall, row.strain) = (3, 0.2, 1e-12);
        let text = damped.words(std::slice::from_ref(&row)).unwrap();
        assert!(
            text.contains("Below 0.25: met; below 0.12: missed. Where"),
            "{text}"
        );
        row.wall = 0.1;
        let text = damped.words(std::slice::from_ref(&row)).unwrap();
        assert!(text.ends_with("below 0.12: met."), "{text}");
        row.strain = 1e-8;
        let text = damped.words(std::slice::from_ref(&row)).unwrap();
        assert!(text.ends_with("at most 1e-9: missed."), "{text}");
        (row.level, row.method, row.drift) = (2, CONSERVATIVE.into(), 1e-7);
        let text = conservative.words(std::slice::from_ref(&row)).unwrap();
        assert!(text.ends_with("at most 1e-8: missed."), "{text}");
    }

    #[test]
    fn percentages() {
        assert_eq!(percent(-0.143), "−14.3 %");
        assert_eq!(percent(2e-7), "2e−5 %");
    }
}
