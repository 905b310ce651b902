//! The runs of a row: from several starts, on a number of threads.

use super::Work;
use crate::progress::Progress;
use crate::report::{Effort, extremes, peak_memory, reset_peak_memory};
use crate::runs::{Course, Ending, FigureScene, Plan};
use crate::threads;
use anyhow::{Context, Result};
use cpu_time::{ProcessTime, ThreadTime};
use isosheet_dynamics::{Simulation, StepReport};
use isosheet_io::scene::SupportForces;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::Duration;

/// How much is run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    starts: u64,
    /// Steps after which a run ends.
    steps: usize,
    /// Longest run, seconds of wall time.
    patience: f64,
}

impl Extent {
    pub(super) fn of(effort: Effort) -> Self {
        let (starts, steps, patience) = effort.pick(
            (1, 4, 10.0),
            (3, usize::MAX, 300.0),
            (5, usize::MAX, 1800.0),
        );
        Self {
            starts,
            steps,
            patience,
        }
    }
}

/// A run from one start.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) course: Course,
    /// CPU seconds of all threads.
    pub(super) cpu: f64,
    /// Largest strain of an edge of rods, or of a face of an elastic sheet.
    pub(super) strain: f64,
    /// Peak of the memory, bytes, where the system tells.
    peak: Option<f64>,
}

/// A row of the table.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    /// Name and title of the work.
    pub(super) work: String,
    pub(super) title: String,
    /// Its size in words.
    pub(super) size: String,
    /// What the sheet is made of: rods, or an elastic sheet.
    pub(super) model: String,
    pub(super) vertices: usize,
    pub(super) threads: usize,
    /// Scene and edits.
    pub(super) command: String,
    pub(super) runs: Vec<Run>,
}

impl Row {
    /// The median over the starts of a number that all runs have.
    pub(super) fn median(&self, of: impl Fn(&Run) -> Option<f64>) -> Option<f64> {
        let mut all = self.runs.iter().map(of).collect::<Option<Vec<f64>>>()?;
        all.sort_by(f64::total_cmp);
        let n = all.len();
        (n > 0).then(|| 0.5 * (all[(n - 1) / 2] + all[n / 2]))
    }

    /// Median of the CPU seconds for a simulated second.
    pub(super) fn rate(&self) -> Option<f64> {
        self.median(|r| (r.course.time > 0.0).then(|| r.cpu / r.course.time))
    }

    /// Median of the factorisations of a step.
    pub(super) fn factorisations(&self) -> Option<f64> {
        self.median(|r| r.course.cost.factorisations_per_step())
    }

    /// Whether all runs came to their ends.
    pub(super) fn is_good(&self) -> bool {
        self.runs.iter().all(|r| r.course.is_good())
    }

    pub(super) fn strain(&self) -> f64 {
        self.runs.iter().map(|r| r.strain).fold(0.0, f64::max)
    }

    pub(super) fn gap(&self) -> Option<f64> {
        self.runs
            .iter()
            .filter_map(|r| r.course.gap)
            .reduce(f64::min)
    }

    /// Smallest and largest number of factorisations of the starts, the larger one as a multiple.
    pub(super) fn spread(&self) -> Option<f64> {
        let all = self
            .runs
            .iter()
            .map(|r| r.course.cost.factorisations as f64);
        let [low, high] = extremes(all).filter(|_| self.runs.len() > 1)?;
        Some(high / low)
    }

    pub(super) fn peak(&self) -> Option<f64> {
        self.runs.iter().filter_map(|r| r.peak).reduce(f64::max)
    }
}

/// Runs a work at a size from all starts. After a run that does not end in its time, no other start is tried.
///
/// # Errors
/// A scene of which no simulation can be made; [`Interrupted`](crate::interrupt::Interrupted).
pub(super) fn measure(work: &Work, size: u32, threads: usize, extent: Extent) -> Result<Row> {
    let scene = |start| {
        let scene = work.scene(size, start)?;
        scene.context("the mesh is gone")
    };
    let setup = scene(1)?.setup()?;
    let is_elastic = setup.model.elastic_sheet().is_some();
    let mut row = Row {
        work: work.name.to_owned(),
        title: work.title.to_owned(),
        size: work.size_name(size),
        model: if is_elastic { "elastic" } else { "rods" }.to_owned(),
        vertices: setup.sheet.topology().vertex_count(),
        threads,
        command: work.command(size),
        runs: Vec::new(),
    };
    let pool = threads::pool(threads)?;
    let bar = Progress::start(work.row_name(size, threads), extent.starts as usize);
    for start in 1..=extent.starts {
        let scene = scene(start)?;
        let run = pool.install(|| run(&scene, extent))?;
        bar.step();
        let is_late = matches!(run.course.ending, Ending::WallTime(_));
        row.runs.push(run);
        if is_late {
            break;
        }
    }
    bar.finish(&format!("{:.2} CPU s/s", row.rate().unwrap_or(f64::NAN)));
    Ok(row)
}

fn run(scene: &FigureScene, extent: Extent) -> Result<Run> {
    let setup = scene.setup()?;
    let origins = setup.origins.clone();
    let mut simulation = setup.start()?;
    let supports = SupportForces::new(origins, &simulation, scene.scene().support.len());
    let stop = &scene.scene().stop;
    let (mut strain, mut looking, mut slips) = (0.0_f64, Duration::ZERO, false);
    let mut look = |simulation: &Simulation, report: &StepReport| {
        let begun = ThreadTime::now();
        let faces = simulation
            .model()
            .elastic_deformation(&simulation.state().x);
        strain = match faces {
            Some(faces) => faces.strain.into_iter().fold(strain, f64::max),
            None => strain.max(report.strain),
        };
        slips = stop.is_force_reached(|| supports.of(simulation));
        looking += begun.elapsed();
        if slips {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let steps = scene.frames().min(extent.steps);
    let plan = Plan::new(scene.frame(), steps as f64 * scene.frame()).within(extent.patience);
    reset_peak_memory();
    let clock = ProcessTime::now();
    let mut course = plan.run(&mut simulation, &mut look)?;
    let cpu = clock.elapsed().saturating_sub(looking).as_secs_f64();
    if slips {
        // The scene ends there.
        course.ending = Ending::Complete;
    }
    Ok(Run {
        course,
        cpu,
        strain,
        peak: peak_memory(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_those_of_all_starts() {
        let run = |cpu: f64, factorisations: usize| {
            let mut course = Course {
                time: 2.0,
                ..Course::default()
            };
            course.cost.factorisations = factorisations;
            Run {
                course,
                cpu,
                strain: 1e-12 * cpu,
                peak: None,
            }
        };
        let mut row = Row {
            work: "w".into(),
            title: String::new(),
            size: String::new(),
            model: String::new(),
            vertices: 9,
            threads: 1,
            command: String::new(),
            runs: vec![run(5.0, 10), run(1.0, 10), run(2.0, 15)],
        };
        assert_eq!((row.rate(), row.spread()), (Some(1.0), Some(1.5)));
        assert_eq!((row.strain(), row.gap()), (5e-12, None));
        row.runs.push(run(4.0, 10));
        assert_eq!(row.rate(), Some(1.5));
        assert!(row.is_good());
        row.runs[0].course.ending = Ending::WallTime(1.0);
        assert!(!row.is_good());
    }

    /// The strip is pushed until its support bears 3 mN.
    #[test]
    fn a_support_that_slips_ends_a_run_well() {
        let edits = ["stop.time=0.05", "stop.support_force=0.003"].map(str::to_owned);
        let scene = FigureScene::of("fig16", "jam", &edits).unwrap();
        let run = run(&scene, Extent::of(Effort::Full)).unwrap();
        assert!(run.course.is_good() && run.course.time < 0.05, "{run:?}");
        assert!(run.strain < 1e-11 && run.cpu > 0.0);
    }
}
