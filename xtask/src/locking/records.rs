//! Runs that are computed on all cores and kept in the output folder, so that an interrupted report
//! continues where it stopped.

use super::isometry::Isometry;
use super::sample::Sample;
use crate::progress::Progress;
use crate::report::Effort;
use crate::store::{Store, Unit};
use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use std::sync::atomic::{AtomicBool, Ordering};

/// The runs of one yardstick.
pub(super) struct Records<'a> {
    pub(super) store: &'a Store,
    /// Its name.
    pub(super) part: String,
    pub(super) effort: Effort,
}

impl Records<'_> {
    /// The samples of all models, model by model in the order of [`Isometry::ALL`], each in the order of its
    /// jobs. Those of a model are kept as soon as they are complete. `run` gives the number of vertices, the
    /// run and what was measured.
    ///
    /// # Errors
    /// Those of [`Records::runs`].
    pub(super) fn of_models<J, R, M>(
        &self,
        jobs: impl Fn(Isometry) -> Vec<J>,
        run: impl Fn(Isometry, &J) -> Result<(usize, R, M)> + Sync,
    ) -> Result<Vec<Sample<J, R, M>>>
    where
        J: Clone + Serialize + DeserializeOwned + Send + Sync,
        R: Serialize + DeserializeOwned + Send,
        M: Serialize + DeserializeOwned + Send,
    {
        let mut all = Vec::new();
        for isometry in Isometry::ALL {
            let sample = |job: &J| {
                let (vertices, run, measured) = run(isometry, job)?;
                Ok(Sample {
                    isometry,
                    job: job.clone(),
                    vertices,
                    run,
                    measured,
                })
            };
            all.extend(self.runs(&isometry.to_string(), &jobs(isometry), sample)?);
        }
        Ok(all)
    }

    /// Named runs in the order of their jobs: those kept by an earlier report, or new ones, which are kept.
    ///
    /// # Errors
    /// The first error of a run, in the order of the jobs; those of the output folder.
    pub(super) fn runs<J: Sync, T: Serialize + DeserializeOwned + Send>(
        &self,
        name: &str,
        jobs: &[J],
        run: impl Fn(&J) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let title = format!("{}, {name}", self.part);
        let word = name.replace(|c: char| !c.is_alphanumeric(), "");
        let unit = Unit {
            name: format!("locking-{}-{word}", self.part),
            title: title.clone(),
            options: json!({ "effort": self.effort }),
        };
        self.store.keep(&unit, |_| {
            let bar = Progress::start(title, jobs.len());
            let runs = each(jobs, |job| {
                let result = run(job);
                bar.step();
                result
            })?;
            bar.finish("measured");
            Ok(runs)
        })
    }
}

/// The results of all jobs in their order, computed on the threads that rayon has, which begin with the first
/// jobs. After an error no further job begins.
fn each<J: Sync, T: Send>(jobs: &[J], work: impl Fn(&J) -> Result<T> + Sync) -> Result<Vec<T>> {
    let has_failed = AtomicBool::new(false);
    let begin = |(k, job)| {
        let result = (!has_failed.load(Ordering::Relaxed)).then(|| work(job))?;
        has_failed.fetch_or(result.is_err(), Ordering::Relaxed);
        Some((k, result))
    };
    let numbered = jobs.iter().enumerate().par_bridge();
    let mut results: Vec<(usize, Result<T>)> = numbered.filter_map(begin).collect();
    results.sort_unstable_by_key(|(k, _)| *k);
    results.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;
    use std::thread;

    #[test]
    fn results_are_in_the_order_of_the_jobs() {
        let jobs: Vec<u64> = (0..100).collect();
        let squares = each(&jobs, |k| {
            thread::sleep(std::time::Duration::from_micros(50 * (k % 7)));
            Ok(k * k)
        });
        let known: Vec<u64> = (0..100).map(|k| k * k).collect();
        assert_eq!(squares.unwrap(), known);
        assert!(each(&[0_u64; 0], |k| Ok(*k)).unwrap().is_empty());
    }

    /// What an earlier report has computed is not computed again.
    #[test]
    fn runs_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open(&folder.path().join("out")).unwrap();
        let records = Records {
            store: &store,
            part: "sliding".into(),
            effort: Effort::Quick,
        };
        let count = AtomicUsize::new(0);
        let run = || {
            records.runs("a name", &[0.1, 0.2], |k| {
                count.fetch_add(1, Ordering::Relaxed);
                Ok(k / 3.0)
            })
        };
        let (first, second) = (run().unwrap(), run().unwrap());
        assert_eq!((&first, first.len()), (&second, 2));
        assert_eq!(count.into_inner(), 2);
        let other = records.runs("another", &[0.0], |_| Ok(7.0));
        assert_eq!(other.unwrap(), [7.0]);
    }

    #[test]
    fn the_first_error_is_returned_and_no_further_job_begins() {
        let begun = AtomicUsize::new(0);
        let jobs: Vec<usize> = (0..10_000).collect();
        let result = each(&jobs, |k| {
            begun.fetch_add(1, Ordering::Relaxed);
            anyhow::ensure!(*k < 10, "job {k}");
            Ok(*k)
        });
        assert!(result.unwrap_err().to_string().starts_with("job 1"));
        assert!(begun.into_inner() < 10_000);
    }
}
