//! The paper's own scheme on the same sheet: forward Euler in system coordinates, with the published step
//! control.

use super::hanging::gravity;
use super::{FigureScene, Hanging};
use crate::interrupt;
use crate::progress::Progress;
use anyhow::Result;
use isosheet_coords::assignment::Degenerate;
use isosheet_coords::{
    AssignmentOptions, CartesianChart, Chart, ChartError, Choice, FrontChart, RodSystem,
};
use isosheet_dynamics::chart::{
    ChartDynamicsError, ChartMethod, ChartOptions, ChartSimulation, ChartStepControl, Equations,
    MassSolverKind, PositionUpdate, Rebase,
};
use isosheet_io::scene::Setup;
use serde::Serialize;
use std::time::Instant;

/// A run of the paper's scheme.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ChartTrial {
    /// The sheet, how it is held and how it starts; the method of the scene is not used.
    pub(crate) scene: FigureScene,
    /// Bound on the change of the Hamiltonian in a step, as part of the energy that the fall of half a side
    /// releases.
    pub(crate) tolerance: f64,
    /// Smallest and largest step, seconds.
    pub(crate) steps: [f64; 2],
    /// Wall time after which the run is given up, seconds.
    pub(crate) patience: f64,
    pub(crate) scheme: ChartScheme,
}

/// The paper's scheme, with ever more help.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ChartScheme {
    /// As published: coordinates of `sys_coord_assnmt_single`, momenta carried over, positions to first
    /// order.
    Published,
    /// The same, with a coordinate for every vertex whose three known neighbours do not determine it (Fig.
    /// 7).
    FreeCreases,
    /// The same, with momenta formed anew from the velocities after every step.
    Reformed,
    /// The same, with positions projected onto the edge lengths, in a well-conditioned chart that is renewed
    /// when needed.
    Projected,
}

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
    pub(crate) run: ChartTrial,
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
pub(crate) fn chart_run(name: &str, run: &ChartTrial) -> Result<ChartSummary> {
    let scene = &run.scene;
    let (frame, duration) = (scene.frame(), scene.scene().stop.time);
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
    let bar = Progress::start(name, scene.frames());
    let mut simulation = match start(run)? {
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
        if clock.elapsed().as_secs_f64() > run.patience {
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
fn start(run: &ChartTrial) -> Result<Result<ChartSimulation, ChartDynamicsError>> {
    let setup = run.scene.setup()?;
    let chart = match chart(run, &setup) {
        Ok(chart) => chart,
        Err(error) => return Ok(Err(error.into())),
    };
    let mass = run.scene.scene().sheet.density * setup.sheet.area();
    let released = mass * gravity(run.scene.scene()) * 0.5 * Hanging::of(&run.scene)?.side;
    let [min, max] = run.steps;
    let projected = run.scheme == ChartScheme::Projected;
    let options = ChartOptions {
        method: ChartMethod::ForwardEuler,
        equations: match run.scheme {
            ChartScheme::Published | ChartScheme::FreeCreases => Equations::Published,
            ChartScheme::Reformed | ChartScheme::Projected => Equations::Reformed,
        },
        position: if projected {
            PositionUpdate::Projected
        } else {
            PositionUpdate::Linear
        },
        control: ChartStepControl::Adaptive {
            tolerance: run.tolerance * released,
            min,
            max,
        },
        solver: if chart.dimension() <= CRAMER {
            MassSolverKind::Cramer
        } else {
            MassSolverKind::DenseLu
        },
        rebase: if projected {
            Rebase::WhenNeeded
        } else {
            Rebase::Never
        },
        ..ChartOptions::default()
    };
    Ok(ChartSimulation::new(
        setup.model,
        chart,
        options,
        &setup.start.x,
        &setup.start.v,
    ))
}

fn chart(run: &ChartTrial, setup: &Setup) -> Result<Box<dyn Chart>, ChartError> {
    let (sheet, pins, x) = (&setup.sheet, setup.model.pins(), &setup.start.x);
    let degenerate = match run.scheme {
        ChartScheme::Projected => {
            let system = RodSystem::new(sheet, &pins)?;
            return Ok(Box::new(CartesianChart::new(system, Choice::Auto, x)?));
        }
        ChartScheme::Published => Degenerate::Carry,
        ChartScheme::FreeCreases | ChartScheme::Reformed => Degenerate::Assign,
    };
    let options = AssignmentOptions {
        pins,
        degenerate,
        ..AssignmentOptions::default()
    };
    Ok(Box::new(FrontChart::new(sheet, &options, x)?))
}
