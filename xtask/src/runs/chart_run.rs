//! The paper's own scheme on the same sheet: forward Euler in system coordinates, with the published step
//! control.

use super::FigureScene;
use crate::interrupt;
use crate::progress::Progress;
use anyhow::{Context, Result};
use isosheet_dynamics::chart::{ChartDynamicsError, ChartSimulation};
use serde::Serialize;
use std::time::Instant;

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
#[derive(Clone, Debug, Serialize)]
pub(crate) struct ChartSummary {
    pub(crate) run: FigureScene,
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

/// Runs a scene in a chart until it ends or cannot go on, which is a result and not an error; it is given up
/// after `patience` seconds of wall time.
///
/// Unlike [`Simulation::step`](isosheet_dynamics::Simulation::step), which cuts the last part of a step
/// short, the scheme chooses the length of all its steps here: these lengths are what the paper reports.
///
/// # Errors
/// Ctrl-C, and what has nothing to do with the scheme.
pub(crate) fn chart_run(name: &str, scene: &FigureScene, patience: f64) -> Result<ChartSummary> {
    let (frame, duration) = (scene.frame(), scene.scene().stop.time);
    let mut summary = ChartSummary {
        run: scene.clone(),
        fate: Fate::Finished,
        steps: 0,
        step_range: None,
        time: 0.0,
        wall: 0.0,
        frames_per_second: 0.0,
        max_strain: 0.0,
    };
    let bar = Progress::start(name, scene.frames());
    let mut simulation = match start(scene)? {
        Ok(simulation) => simulation,
        Err(error) => {
            summary.fate = Fate::Refused {
                reason: error.to_string(),
            };
            bar.finish("refused at the start");
            return Ok(summary);
        }
    };
    let clock = Instant::now();
    let mut frames = 0;
    // The scheme chooses the lengths of its steps, so that their number is not known beforehand.
    while simulation.time() < duration {
        interrupt::check()?;
        match simulation.step() {
            Ok(report) => summary.max_strain = summary.max_strain.max(report.strain),
            Err(error) => {
                summary.fate = Fate::Stopped {
                    t: simulation.time(),
                    reason: error.to_string(),
                };
                break;
            }
        }
        while simulation.time() >= (frames + 1) as f64 * frame {
            frames += 1;
            bar.step();
        }
        if clock.elapsed().as_secs_f64() > patience {
            summary.fate = Fate::OutOfPatience {
                t: simulation.time(),
            };
            break;
        }
    }
    summary.wall = clock.elapsed().as_secs_f64();
    summary.time = simulation.time();
    summary.frames_per_second = summary.time / frame / summary.wall.max(1e-9);
    let range = simulation.step_range();
    summary.steps = range.steps;
    summary.step_range = (range.steps > 0).then_some([range.min, range.max]);
    bar.finish(&format!(
        "{:.3} s simulated, {} steps",
        summary.time, summary.steps
    ));
    Ok(summary)
}

/// Sets the scheme up; the inner error is that of the scheme.
fn start(scene: &FigureScene) -> Result<Result<ChartSimulation, ChartDynamicsError>> {
    let settings = scene.scene().method.chart.clone();
    let settings = settings.context("a scene with a chart")?;
    let setup = scene.setup()?;
    let (x, v) = (setup.start.x, setup.start.v);
    Ok(
        match settings.build(&setup.sheet, &setup.model.pins(), &x) {
            Ok(chart) => ChartSimulation::new(setup.model, chart, settings.options(), &x, &v),
            Err(error) => Err(error.into()),
        },
    )
}
