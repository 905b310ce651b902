//! Runs that are computed on all cores and kept in the output folder, so that an interrupted report
//! continues where it stopped.

use super::isometry::Isometry;
use super::sample::Sample;
use crate::progress::Progress;
use crate::runs::Course;
use crate::store::Store;
use anyhow::Result;
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The runs of one yardstick.
pub(super) struct Records<'a> {
    pub(super) store: &'a Store,
    /// Its name.
    pub(super) part: &'a str,
}

impl Records<'_> {
    /// The samples of all models, model by model in the order of [`Isometry::ALL`], each in the order of its
    /// jobs. Those of a model are kept as soon as they are complete. `run` gives the number of vertices, the
    /// course and what was measured.
    ///
    /// # Errors
    /// Those of [`Records::runs`].
    pub(super) fn of_models<J, M>(
        &self,
        jobs: impl Fn(Isometry) -> Vec<J>,
        run: impl Fn(Isometry, &J) -> Result<(usize, Course, M)> + Sync,
    ) -> Result<Vec<Sample<J, M>>>
    where
        J: Clone + Serialize + DeserializeOwned + Send + Sync,
        M: Serialize + DeserializeOwned + Send,
    {
        let mut all = Vec::new();
        for isometry in Isometry::ALL {
            let sample = |job: &J| {
                let (vertices, course, measured) = run(isometry, job)?;
                Ok(Sample {
                    isometry,
                    job: job.clone(),
                    vertices,
                    course,
                    measured,
                })
            };
            all.extend(self.runs(&isometry.to_string(), &jobs(isometry), sample)?);
        }
        Ok(all)
    }

    /// Named runs in the order of their jobs: those kept by an earlier report, or new ones on the threads
    /// that rayon has, which are kept.
    ///
    /// # Errors
    /// An error of a run, after which no further job begins; those of the output folder.
    pub(super) fn runs<J: Sync, T: Serialize + DeserializeOwned + Send>(
        &self,
        name: &str,
        jobs: &[J],
        run: impl Fn(&J) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let title = format!("{}, {name}", self.part);
        let word = name.replace(|c: char| !c.is_alphanumeric(), "");
        let unit = self
            .store
            .unit(format!("locking-{}-{word}", self.part), title);
        self.store.keep(&unit, |_| {
            let bar = Progress::start(&unit.title, jobs.len());
            let one = |job| {
                let result = run(job);
                bar.step();
                result
            };
            let runs = jobs
                .par_iter()
                .with_max_len(1)
                .map(one)
                .collect::<Result<_>>()?;
            bar.finish("measured");
            Ok(runs)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Effort;
    use crate::store::Remake;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// What an earlier report has computed is not computed again.
    #[test]
    fn runs_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let store = Store::open(&out, "a", Effort::Quick, Remake::Never).unwrap();
        let records = Records {
            store: &store,
            part: "sliding",
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
}
