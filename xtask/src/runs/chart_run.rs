//! The paper's own scheme on the same sheet: forward Euler in system coordinates, with the published step
//! control.

use super::{Course, Ending, FigureScene};
use crate::interrupt;
use crate::progress::Progress;
use anyhow::{Context, Result};
use cpu_time::ThreadTime;
use isosheet_charts::{ChartDynamicsError, ChartSimulation};
use std::time::Instant;

/// What a run of the paper's scheme did.
#[derive(Clone, Debug)]
pub(crate) struct ChartSummary {
    pub(crate) run: FigureScene,
    /// Without a step of a run that was refused at the start.
    pub(crate) course: Course,
    /// Shortest and longest step, seconds; `None` without a step.
    pub(crate) step_range: Option<[f64; 2]>,
    pub(crate) frames_per_second: f64,
}

/// Runs a scene in a chart until it ends or cannot go on, which is a result and not an error; it is given up
/// after `patience` seconds of the processor.
///
/// Unlike [`Simulation::step`](isosheet_dynamics::Simulation::step), which cuts the last part of a step
/// short, the scheme chooses the length of all its steps here: these lengths are what the paper reports.
///
/// # Errors
/// Ctrl-C, and what has nothing to do with the scheme.
pub(crate) fn chart_run(name: &str, scene: &FigureScene, patience: f64) -> Result<ChartSummary> {
    let mut summary = ChartSummary {
        run: scene.clone(),
        course: Course::default(),
        step_range: None,
        frames_per_second: 0.0,
    };
    let bar = Progress::start(name, scene.frames());
    let course = &mut summary.course;
    match start(scene)? {
        Err(error) => course.ending = Ending::of(&error, &error),
        Ok(mut simulation) => {
            let (clock, cpu, mut frames) = (Instant::now(), ThreadTime::now(), 0);
            // The scheme chooses the lengths of its steps, so that their number is not known beforehand.
            while simulation.time() < scene.scene().stop.time && course.is_good() {
                interrupt::check()?;
                match simulation.step() {
                    Ok(report) => course.strain = course.strain.max(report.strain),
                    Err(error) => course.ending = Ending::of(&error, &error),
                }
                while simulation.time() >= (frames + 1) as f64 * scene.frame() {
                    frames += 1;
                    bar.step();
                }
                course.cost.wall = clock.elapsed().as_secs_f64();
                course.cost.cpu = cpu.elapsed().as_secs_f64();
                if course.is_good() && course.cost.cpu > patience {
                    course.ending = Ending::CpuTime(patience);
                }
            }
            course.time = simulation.time();
            let range = simulation.step_range();
            course.cost.steps = range.steps as usize;
            summary.step_range = (range.steps > 0).then_some([range.min, range.max]);
            summary.frames_per_second = course.time / scene.frame() / course.cost.wall.max(1e-9);
        }
    }
    let (time, steps) = (course.time, course.cost.steps);
    bar.finish(&format!("{time:.3} s simulated, {steps} steps"));
    Ok(summary)
}

/// Sets the scheme up; the inner error is that of the scheme.
fn start(scene: &FigureScene) -> Result<Result<ChartSimulation, ChartDynamicsError>> {
    let settings = scene.scene().method.chart.clone();
    let settings = settings.context("a scene with a chart")?;
    let setup = scene.setup()?;
    let (x, v) = (setup.start.x, setup.start.v);
    Ok(
        match settings.build(&setup.facts.sheet, &setup.model.pins(), &x) {
            Ok(chart) => ChartSimulation::new(setup.model, chart, settings.options(), &x, &v),
            Err(error) => Err(error.into()),
        },
    )
}
