//! Runs of one motion and what is kept of them.

use crate::report::rounded;
use crate::runs::Course;
use anyhow::Result;
use serde::Serialize;
use std::time::Instant;

/// How a run went. The fields are columns of tables, by their names.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Ran {
    pub(super) cpu_s_per_simulated_s: Option<f64>,
    pub(super) wall_s_per_simulated_s: Option<f64>,
    /// Largest relative edge length error.
    pub(super) strain: Option<f64>,
    pub(super) smallest_gap_m: Option<f64>,
    /// Parts of steps, where steps were divided.
    pub(super) steps: usize,
    pub(super) rejected: usize,
    pub(super) iterations: usize,
    pub(super) factorisations: usize,
    /// Runs from the same start, of which the times are those of the fastest.
    pub(super) repetitions: usize,
    /// Simulated time, seconds.
    pub(super) reached_s: f64,
    /// Why the run did not come to its end.
    pub(super) failure: Option<String>,
}

impl Ran {
    /// What a course says of its run.
    pub(super) fn of(course: &Course, repetitions: usize) -> Self {
        let cost = &course.cost;
        Self {
            cpu_s_per_simulated_s: course.cpu_rate(),
            wall_s_per_simulated_s: course.rate(),
            strain: Some(course.strain),
            smallest_gap_m: course.gap,
            steps: cost.substeps,
            rejected: cost.rejected,
            iterations: cost.iterations,
            factorisations: cost.factorisations,
            repetitions,
            reached_s: course.time,
            failure: course.failure().as_deref().map(rounded),
        }
    }

    /// CPU seconds for a simulated second, of a run that came to its end.
    pub(super) fn cpu(&self) -> Option<f64> {
        let finished = self.failure.is_none();
        self.cpu_s_per_simulated_s.filter(|_| finished)
    }
}

/// Makes a run that comes to its end `most` times, or until all together have taken some seconds. Returns the
/// fastest, with what was seen of it, and the number of runs.
///
/// # Errors
/// Those of the run.
pub(super) fn fastest<T>(
    most: usize,
    seconds: f64,
    mut run: impl FnMut() -> Result<(Course, T)>,
) -> Result<(Course, T, usize)> {
    let clock = Instant::now();
    let (mut course, mut seen) = run()?;
    let mut count = 1;
    while course.is_good() && count < most && clock.elapsed().as_secs_f64() < seconds {
        let (again, seen_again) = run()?;
        count += 1;
        if again.is_good() && again.cost.cpu < course.cost.cpu {
            (course, seen) = (again, seen_again);
        }
    }
    Ok((course, seen, count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::Ending;

    #[test]
    fn the_fastest_run_counts() {
        let runs = |most, seconds, times: &[(f64, Ending)]| {
            let mut times = times.iter();
            let course = move || {
                let (cpu, ending) = times.next().expect("no more runs").clone();
                let mut course = Course {
                    ending,
                    time: 1.0,
                    ..Course::default()
                };
                course.cost.cpu = cpu;
                Ok((course, cpu))
            };
            let (course, seen, count) = fastest(most, seconds, course).unwrap();
            assert_eq!(course.cost.cpu, seen);
            (seen, count, Ran::of(&course, count).cpu())
        };
        let good = |cpu| (cpu, Ending::Complete);
        let three = [good(2.0), good(1.0), good(3.0)];
        assert_eq!(runs(3, f64::INFINITY, &three), (1.0, 3, Some(1.0)));
        assert_eq!(runs(2, f64::INFINITY, &three), (1.0, 2, Some(1.0)));
        assert_eq!(runs(3, 0.0, &three), (2.0, 1, Some(2.0)));
        let lost = [(4.0, Ending::WallTime(4.0)), good(1.0)];
        assert_eq!(runs(3, f64::INFINITY, &lost), (4.0, 1, None));
    }
}
