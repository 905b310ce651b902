//! The runs of a row: from several starts, by a method, on a number of threads.

use super::Task;
use super::kinds::PreparedRun;
use crate::progress::Progress;
use crate::report::{Effort, extremes, median, number, peak_memory, reset_peak_memory, rounded};
use crate::runs::{Course, Ending, Plan};
use anyhow::{Context, Result};
use cpu_time::{ProcessTime, ThreadTime};
use isosheet_dynamics::{Simulation, StepReport};
use rayon::ThreadPoolBuilder;
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use std::time::Duration;

/// A run from one start.
#[derive(Clone, Debug, Default)]
struct TimedRun {
    /// Its CPU time is that of all threads, its strain that of the edges of rods or of the faces of an
    /// elastic sheet.
    course: Course,
    /// Change of the energy at the end, and the largest one on the way, joules.
    changes: [f64; 2],
    /// Potential energy at the start less that at the end, joules.
    released: f64,
    /// Peak of the memory, bytes, where the system tells.
    peak: Option<f64>,
}

impl TimedRun {
    /// A change of the energy as part of the potential energy released; 0 if none was.
    fn part(&self, k: usize) -> f64 {
        let part = self.changes[k] / self.released;
        if self.released > 0.0 { part } else { 0.0 }
    }
}

/// A row of the table: medians over the starts where nothing else is said. The fields are the columns, by
/// their names.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct WorkRow {
    pub(super) work: String,
    pub(super) what_happens: String,
    pub(super) size: String,
    pub(super) vertices: usize,
    /// What the sheet is made of: rods, or an elastic sheet.
    pub(super) model: String,
    /// Where it is not that of a scene file.
    pub(super) method: Option<String>,
    pub(super) step_s: f64,
    pub(super) threads: usize,
    pub(super) starts: usize,
    pub(super) simulated_s: Option<f64>,
    pub(super) cpu_s: Option<f64>,
    pub(super) cpu_s_per_simulated_s: Option<f64>,
    /// As a multiple of that of the fastest method that keeps lengths; made with the table.
    pub(super) times_fastest_exact: Option<f64>,
    pub(super) wall_s: Option<f64>,
    pub(super) wall_s_per_simulated_s: Option<f64>,
    pub(super) factorisations_per_step: Option<f64>,
    pub(super) iterations_per_step: Option<f64>,
    /// Factorisations: the most of a start as a multiple of the fewest.
    pub(super) largest_over_smallest: Option<f64>,
    /// Parts of steps, and rejected ones.
    pub(super) steps: Option<f64>,
    pub(super) rejected: Option<f64>,
    /// The largest.
    pub(super) strain: f64,
    /// The smallest.
    pub(super) smallest_gap_m: Option<f64>,
    /// At the end, and the largest on the way, as part of the potential energy released.
    pub(super) energy_balance: Option<f64>,
    pub(super) largest_energy_change: Option<f64>,
    /// The largest.
    pub(super) peak_bytes: Option<f64>,
    /// Starts whose runs came to their ends.
    pub(super) ended: usize,
    /// How far the last run came that did not come to its end, and why.
    pub(super) failure: Option<String>,
    /// Scene file and edits.
    pub(super) scene: Option<String>,
}

impl WorkRow {
    /// Whether all runs came to their ends.
    pub(super) fn is_good(&self) -> bool {
        self.failure.is_none()
    }

    /// CPU seconds for a simulated second, of runs that came to their ends.
    pub(super) fn rate(&self) -> Option<f64> {
        self.cpu_s_per_simulated_s.filter(|_| self.is_good())
    }

    /// Factorisations of a step, of runs that came to their ends.
    pub(super) fn factorisations(&self) -> Option<f64> {
        self.factorisations_per_step.filter(|_| self.is_good())
    }

    /// This row with what its runs gave.
    fn with(self, runs: &[TimedRun]) -> Self {
        // The median of a number that all runs have.
        let median = |of: &dyn Fn(&TimedRun) -> Option<f64>| {
            let all: Option<Vec<f64>> = runs.iter().map(of).collect();
            all.and_then(median)
        };
        let factorisations = runs.iter().map(|r| r.course.cost.factorisations as f64);
        let spread = extremes(factorisations).filter(|_| runs.len() > 1);
        let failed = runs.iter().rfind(|r| !r.course.is_good());
        let failure = failed.and_then(|r| Some((r.course.time, r.course.failure()?)));
        let gaps = runs.iter().filter_map(|r| r.course.gap);
        Self {
            starts: runs.len(),
            simulated_s: median(&|r| Some(r.course.time)),
            cpu_s: median(&|r| Some(r.course.cost.cpu)),
            cpu_s_per_simulated_s: median(&|r| r.course.cpu_rate()),
            wall_s: median(&|r| Some(r.course.cost.wall)),
            wall_s_per_simulated_s: median(&|r| r.course.rate()),
            factorisations_per_step: median(&|r| r.course.cost.factorisations_per_step()),
            iterations_per_step: median(&|r| r.course.cost.iterations_per_step()),
            largest_over_smallest: spread.map(|[low, high]| high / low),
            steps: median(&|r| Some(r.course.cost.substeps as f64)),
            rejected: median(&|r| Some(r.course.cost.rejected as f64)),
            strain: runs.iter().map(|r| r.course.strain).fold(0.0, f64::max),
            smallest_gap_m: gaps.reduce(f64::min),
            energy_balance: median(&|r| Some(r.part(0))),
            largest_energy_change: median(&|r| Some(r.part(1))),
            peak_bytes: runs.iter().filter_map(|r| r.peak).reduce(f64::max),
            ended: runs.iter().filter(|r| r.course.is_good()).count(),
            failure: failure.map(|(t, why)| format!("at {} s: {}", number(t), rounded(&why))),
            ..self
        }
    }
}

/// Runs a work from all starts. After a start that is refused, or a run that does not come to its end, no
/// other start is tried.
///
/// # Errors
/// A scene of which no simulation can be made; [`Interrupted`](crate::interrupt::Interrupted).
pub(super) fn measure(task: &Task, effort: Effort) -> Result<WorkRow> {
    // Starts, steps after which a run ends, and its longest time of the processor, seconds.
    let (starts, steps, patience) = effort.pick(
        (1, 4.0, 10.0),
        (3, f64::INFINITY, 300.0),
        (5, f64::INFINITY, 1800.0),
    );
    let work = task.work;
    let pool = ThreadPoolBuilder::new().num_threads(task.threads).build()?;
    let bar = Progress::start(&task.unit.title, starts as usize);
    let start = |number| {
        let start = work.start(task.size, task.method.as_ref(), number)?;
        start.context("the mesh is gone")
    };
    let first = start(1)?;
    let model = first.simulation.model();
    let is_elastic = model.elastic_sheet().is_some();
    let row = WorkRow {
        work: work.name.clone(),
        what_happens: work.title.clone(),
        size: work.size_name(task.size),
        vertices: model.topology().vertex_count(),
        model: if is_elastic { "elastic" } else { "rods" }.to_owned(),
        method: task
            .method
            .as_ref()
            .map(|((name, _), _)| (*name).to_owned()),
        step_s: first.plan.step,
        threads: task.threads,
        scene: work.command(task.size),
        ..WorkRow::default()
    };
    let (mut runs, mut refused) = (Vec::new(), None);
    for number in 1..=starts {
        // The first start was one.
        let mut start = match start(number) {
            Err(error) if number > 1 => {
                refused = Some(format!("start {number}: {}", in_short(&error)));
                break;
            }
            start => start?,
        };
        let Plan { step, duration, .. } = start.plan;
        start.plan = Plan::new(step, duration.min(steps * step)).within(patience);
        runs.push(pool.install(|| run(start))?);
        bar.step();
        if !runs.iter().all(|r| r.course.is_good()) {
            break;
        }
    }
    let row = row.with(&runs);
    let row = WorkRow {
        failure: row.failure.or(refused),
        ..row
    };
    let rate = row.cpu_s_per_simulated_s;
    bar.finish(&format!("{:.2} CPU s/s", rate.unwrap_or(f64::NAN)));
    Ok(row)
}

/// The first line of an error, without the place in a scene.
fn in_short(error: &anyhow::Error) -> String {
    let text = error.to_string();
    let line = text.lines().next().unwrap_or_default();
    line.strip_prefix("error: ").unwrap_or(line).to_owned()
}

fn run(start: PreparedRun) -> Result<TimedRun> {
    let PreparedRun {
        mut simulation,
        plan,
        is_over,
    } = start;
    let potential = |s: &Simulation| s.model().potential_energy(s.state().t, &s.state().x);
    let (energy, height) = (simulation.energy(), potential(&simulation));
    let (mut strain, mut looking, mut ends) = (0.0_f64, Duration::ZERO, false);
    let mut look = |simulation: &Simulation, report: &StepReport| {
        let begun = ThreadTime::now();
        strain = match simulation.elastic_deformation() {
            Some(faces) => faces.strain.into_iter().fold(strain, f64::max),
            None => strain.max(report.strain),
        };
        ends = is_over(simulation);
        looking += begun.elapsed();
        match ends {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    };
    reset_peak_memory();
    let clock = ProcessTime::now();
    let mut course = plan.run(&mut simulation, &mut look)?;
    course.cost.cpu = clock.elapsed().saturating_sub(looking).as_secs_f64();
    course.strain = strain;
    if ends {
        course.ending = Ending::Complete;
    }
    Ok(TimedRun {
        changes: [simulation.energy() - energy, course.drift],
        released: height - potential(&simulation),
        course,
        peak: peak_memory(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::{kinds::Work, named};
    use super::*;

    #[test]
    fn medians_are_those_of_all_starts() {
        let run = |cpu: f64, factorisations: usize, ending| {
            let mut course = Course {
                time: 2.0,
                strain: 1e-12 * cpu,
                ending,
                ..Course::default()
            };
            (course.cost.cpu, course.cost.factorisations) = (cpu, factorisations);
            TimedRun {
                course,
                ..TimedRun::default()
            }
        };
        let good = |cpu, factorisations| run(cpu, factorisations, Ending::Complete);
        let mut runs = vec![good(5.0, 10), good(1.0, 10), good(2.0, 15)];
        let row = WorkRow::default().with(&runs);
        let found = (row.rate(), row.largest_over_smallest, row.strain);
        assert_eq!(found, (Some(1.0), Some(1.5), 5e-12));
        assert!(row.smallest_gap_m.is_none());
        runs.push(run(4.0, 10, Ending::CpuTime(4.0)));
        let row = WorkRow::default().with(&runs);
        assert_eq!((row.cpu_s_per_simulated_s, row.rate()), (Some(1.5), None));
        assert_eq!((row.starts, row.ended), (4, 3));
        let failure = row.failure.unwrap();
        assert_eq!(failure, "at 2 s: 4 s of CPU time were over");
    }

    fn of(work: &Work) -> TimedRun {
        let size = work.sizes(Effort::Quick)[0];
        let method = work.methods().swap_remove(0);
        let start = work.start(size, method.as_ref(), 1).unwrap();
        run(start.expect("a mesh")).unwrap()
    }

    /// The strip is pushed until its support bears 3 mN.
    #[test]
    fn a_support_that_slips_ends_a_run_well() {
        let jam = "name = 'jam'\ntitle = ''\nscene = { file = 'fig16' }\n\
            edits = ['stop.time=0.05', 'stop.support_force=0.003']";
        let slips = of(&toml::from_str(jam).unwrap());
        let course = &slips.course;
        assert!(course.is_good() && course.time < 0.05, "{slips:?}");
        assert!(course.strain < 1e-11 && course.cost.cpu > 0.0);
    }

    #[test]
    fn the_sheets_of_other_programs_come_to_their_ends() {
        let work = |name| named().into_iter().find(|(n, _)| *n == name).unwrap().1;
        let hanging = of(work("hanging"));
        assert_eq!(hanging.course.cost.steps, 60);
        assert!((-0.9..0.01).contains(&hanging.part(0)), "{hanging:?}");
        let cloth = of(work("tablecloth-itself"));
        let course = &cloth.course;
        assert!(course.is_good() && (course.time - 1.5).abs() < 1e-9);
        assert!(course.strain < 1e-10 && course.gap.is_some_and(|gap| gap > 0.0));
    }
}
