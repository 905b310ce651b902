//! The paper's own scheme on the same sheet: forward Euler in the coordinates of the front, with the published step control.

use super::Scene;
use crate::interrupt;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_coords::{AssignmentOptions, FrontChart};
use isosheet_dynamics::chart::{
    ChartDynamicsError, ChartMethod, ChartOptions, ChartSimulation, ChartStepControl, Equations, MassSolverKind, PositionUpdate, Rebase,
};
use isosheet_dynamics::{Method, Simulation, State};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// A run of the paper's scheme.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChartScene {
    pub(crate) scene: Scene,
    /// Random displacement at the start, mean edge lengths; 0 is exactly flat.
    pub(crate) bump: f64,
    /// Bound on the change of the Hamiltonian in a step, as part of the energy that the fall of half a side releases.
    pub(crate) tolerance: f64,
    /// Smallest and largest step, seconds.
    pub(crate) steps: [f64; 2],
    /// Wall time after which the run is given up, seconds.
    pub(crate) patience: f64,
    /// What happens to the momenta from step to step.
    pub(crate) momenta: Momenta,
}

/// What happens to the momenta from step to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Momenta {
    /// Carried over, as published.
    Carried,
    /// Formed anew from the velocities.
    Reformed,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub(crate) enum Fate {
    /// It reached the end.
    Finished,
    /// It was refused at the start.
    Refused { reason: String },
    /// It stopped at the given time, seconds.
    Stopped { t: f64, reason: String },
    /// It was too slow to go on.
    OutOfPatience { t: f64 },
}

/// What a run of the paper's scheme did.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct ChartSummary {
    pub(crate) run: ChartScene,
    pub(crate) fate: Fate,
    pub(crate) steps: u64,
    /// Shortest and longest step, seconds; `None` without a step.
    pub(crate) step_range: Option<[f64; 2]>,
    /// Simulated time, seconds.
    pub(crate) time: f64,
    pub(crate) wall: f64,
    pub(crate) frames_per_second: f64,
    pub(crate) max_strain: f64,
}

/// Largest number of coordinates for which the mass matrix is inverted by Cramer's rule as published.
const CRAMER: usize = 16;

/// Runs the paper's scheme until it ends or cannot go on, which is a result and not an error.
///
/// # Errors
/// Ctrl-C, and what has nothing to do with the scheme.
pub(crate) fn chart_run(name: &str, run: &ChartScene) -> Result<ChartSummary> {
    let scene = &run.scene;
    let duration = scene.frame * scene.frames as f64;
    let mut summary = ChartSummary {
        run: run.clone(),
        fate: Fate::Finished,
        steps: 0,
        step_range: None,
        time: 0.0,
        wall: 0.0,
        frames_per_second: 0.0,
        max_strain: 0.0,
    };
    let bar = Progress::start(name, scene.frames);
    let mut simulation = match start(run)? {
        Ok(simulation) => simulation,
        Err(error) => {
            summary.fate = Fate::Refused { reason: error.to_string() };
            bar.finish("refused at the start");
            return Ok(summary);
        }
    };
    let clock = Instant::now();
    let mut frame = 0;
    while simulation.time() < duration {
        interrupt::check()?;
        match simulation.step() {
            Ok(report) => summary.max_strain = summary.max_strain.max(report.strain),
            Err(error) => {
                summary.fate = Fate::Stopped { t: simulation.time(), reason: error.to_string() };
                break;
            }
        }
        while simulation.time() >= (frame + 1) as f64 * scene.frame {
            frame += 1;
            bar.step();
        }
        if clock.elapsed().as_secs_f64() > run.patience {
            summary.fate = Fate::OutOfPatience { t: simulation.time() };
            break;
        }
    }
    summary.wall = clock.elapsed().as_secs_f64();
    summary.time = simulation.time();
    summary.frames_per_second = summary.time / scene.frame / summary.wall.max(1e-9);
    let range = simulation.step_range();
    summary.steps = range.steps;
    summary.step_range = (range.steps > 0).then_some([range.min, range.max]);
    bar.finish(&format!("{:.3} s simulated, {} steps", summary.time, summary.steps));
    Ok(summary)
}

/// Sets the scheme up; the inner error is that of the scheme.
fn start(run: &ChartScene) -> Result<Result<ChartSimulation, ChartDynamicsError>> {
    let scene = &run.scene;
    let sheet = scene.sheet()?;
    let mut simulation =
        Simulation::new(scene.model(&sheet)?, State::at_rest(sheet.positions().to_vec()), Method::default())?;
    if run.bump > 0.0 {
        simulation.leave_flat(run.bump, 1)?;
    }
    let x = &simulation.state().x;
    let model = scene.model(&sheet)?;
    let assignment = AssignmentOptions { pins: vec![scene.pin()], ..AssignmentOptions::default() };
    let chart = match FrontChart::new(&sheet, &assignment, x) {
        Ok(chart) => chart,
        Err(error) => return Ok(Err(error.into())),
    };
    let released = scene.mass() * 9.8 * 0.5 * scene.side;
    let [min, max] = run.steps;
    let options = ChartOptions {
        method: ChartMethod::ForwardEuler,
        equations: match run.momenta {
            Momenta::Carried => Equations::Published,
            Momenta::Reformed => Equations::Reformed,
        },
        position: PositionUpdate::Linear,
        control: ChartStepControl::Adaptive { tolerance: run.tolerance * released, min, max },
        solver: if chart.kept().len() <= CRAMER { MassSolverKind::Cramer } else { MassSolverKind::DenseLu },
        rebase: Rebase::Never,
        ..ChartOptions::default()
    };
    Ok(ChartSimulation::new(model, Box::new(chart), options, x, &vec![0.0; x.len()]))
}
