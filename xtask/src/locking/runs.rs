//! The runs of a yardstick: computed on all cores and kept in the output folder, so that an interrupted
//! report continues where it stopped; and the table of all of them.

use super::model::Model;
use crate::progress::Progress;
use crate::report::Table;
use crate::runs::Course;
use crate::store::Store;
use anyhow::Result;
use isosheet_mesh::Sheet;
use rayon::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The runs of one yardstick.
pub(super) struct Records<'a> {
    pub(super) store: &'a Store,
    /// Its name.
    pub(super) part: &'a str,
}

/// A job done with a model, and what was measured. Their fields are columns of the table of all runs, by the
/// names that serde gives them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Sample<J, M> {
    pub(super) job: J,
    pub(super) ran: Ran,
    pub(super) measured: M,
}

/// How a run went.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Ran {
    pub(super) model: Model,
    /// Number of vertices of the mesh.
    #[serde(rename = "V")]
    vertices: usize,
    ending: String,
    /// 1 of a run that reached its end, 0 of others, so that the mean is the part that does.
    #[serde(rename = "reaches the end")]
    pub(super) is_good: u8,
    #[serde(rename = "t at the end, s")]
    pub(super) time: f64,
    factorisations: usize,
    #[serde(rename = "factorisations per step")]
    per_step: Option<f64>,
    #[serde(rename = "most in a step")]
    worst: usize,
    #[serde(rename = "CPU s per simulated s")]
    cpu_rate: Option<f64>,
    #[serde(rename = "strain of an edge")]
    strain: f64,
    /// Of rods alone: no other model has equations of isometry.
    #[serde(rename = "violation of the equations of isometry")]
    violation: Option<f64>,
    #[serde(rename = "gap, m")]
    gap: Option<f64>,
    #[serde(rename = "speed left, m/s")]
    speed: f64,
    message: String,
}

impl Ran {
    pub(super) fn of(model: Model, sheet: &Sheet, course: &Course) -> Self {
        Self {
            model,
            vertices: sheet.topology().vertex_count(),
            ending: course.ending.name().to_owned(),
            is_good: course.is_good().into(),
            time: course.time,
            factorisations: course.cost.factorisations,
            per_step: course.cost.factorisations_per_step(),
            worst: course.worst,
            cpu_rate: course.cpu_rate(),
            strain: course.strain,
            violation: (model == Model::Rods).then_some(course.violation),
            gap: course.gap,
            speed: course.speed,
            message: course.ending.message().to_owned(),
        }
    }

    /// A value of a run that reached its end.
    pub(super) fn if_good(&self, value: f64) -> Option<f64> {
        (self.is_good == 1).then_some(value)
    }
}

impl Records<'_> {
    /// The samples of all models, model by model, each in the order of the jobs. The samples of a model are
    /// kept as soon as they are complete.
    ///
    /// # Errors
    /// Errors of [`Records::runs`].
    pub(super) fn of_models<J, M>(
        &self,
        jobs: &[J],
        run: impl Fn(Model, &J) -> Result<(Ran, M)> + Sync,
    ) -> Result<Vec<Sample<J, M>>>
    where
        J: Clone + Serialize + DeserializeOwned + Send + Sync,
        M: Serialize + DeserializeOwned + Send,
    {
        let mut all = Vec::new();
        for model in Model::ALL {
            all.extend(self.runs(&model.to_string(), jobs, |job| {
                let (ran, measured) = run(model, job)?;
                let job = job.clone();
                Ok(Sample { job, ran, measured })
            })?);
        }
        Ok(all)
    }

    /// Named runs in the order of their jobs: those kept by an earlier report, or new ones on the threads
    /// that rayon has, which are kept.
    ///
    /// # Errors
    /// An error of a run, after which no further job begins; errors of the output folder.
    pub(super) fn runs<J: Sync, T: Serialize + DeserializeOwned + Send>(
        &self,
        name: &str,
        jobs: &[J],
        run: impl Fn(&J) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let title = format!("{}, {name}", self.part);
        let word = name.replace(|c: char| !c.is_alphanumeric(), "");
        let unit = format!("locking-{}-{word}", self.part);
        let unit = self.store.unit(unit, title);
        self.store.keep(&unit, |_| {
            let bar = Progress::start(&unit.title, jobs.len());
            let one = |job| run(job).inspect(|_| bar.step());
            let runs = jobs.par_iter().with_max_len(1).map(one);
            let runs = runs.collect::<Result<_>>()?;
            bar.finish("measured");
            Ok(runs)
        })
    }
}

/// The caption of the table of all runs.
pub(super) const EVERY_RUN: &str = "Every run";

/// The table of some samples.
///
/// # Errors
/// As [`Table::of_fields`].
pub(super) fn samples<J: Serialize, M: Serialize>(all: &[Sample<J, M>]) -> Result<Table> {
    Table::of_fields(EVERY_RUN, all.iter().map(|s| (&s.job, &s.ran, &s.measured)))
}
