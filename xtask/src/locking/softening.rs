//! How stiff the faces of an elastic sheet may be: a disk that must not stretch, strips that must not lock.

use super::model::{Model, PAPER};
use super::runs::{EVERY_RUN, Ran, Records};
use super::scene::until_rest;
use super::{cone, strips};
use crate::report::Table;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// The bounds that are compared.
const BOUNDS: [f64; 7] = [100.0, 500.0, 1000.0, 2000.0, 3000.0, 5000.0, 10_000.0];

/// A bound, or the stiffness of the material, with the sizes of both meshes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct SofteningJob {
    #[serde(rename = "C")]
    bound: Option<f64>,
    /// Radius of the disk over the spacing.
    #[serde(rename = "R/h")]
    rings: usize,
    #[serde(rename = "squares across the strips")]
    across: usize,
}

/// The errors of the strips.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Strips {
    #[serde(rename = "error of the energy of strips")]
    energy: Option<f64>,
    #[serde(rename = "error of the place of strips")]
    place: Option<f64>,
}

/// The runs of the yardstick.
pub(super) fn runs(records: &Records<'_>) -> Result<Table> {
    let effort = records.store.effort;
    let sizes: &[[usize; 2]] = effort.quick_or(&[[4, 2]], &[[8, 2], [16, 4]]);
    let bounds = effort.quick_or(vec![PAPER.bound], BOUNDS.to_vec());
    let mut jobs = Vec::new();
    for bound in bounds.into_iter().map(Some).chain([None]) {
        jobs.extend(sizes.iter().map(|&[rings, across]| SofteningJob {
            bound,
            rings,
            across,
        }));
    }
    let plan = until_rest(effort.quick_or(2.0, 30.0));
    let found = records.runs("bounds", &jobs, |&job| {
        let model = job.bound.map_or(Model::Material, |_| Model::Elastic);
        let bound = job.bound.unwrap_or(PAPER.bound);
        let (ran, cone) = cone::with_bound(model, bound, job.rings, &plan)?;
        let [energy, place] = strips::with_bound(model, bound, job.across, &plan)?;
        Ok((job, ran, cone, Strips { energy, place }))
    })?;
    Table::of_fields(
        EVERY_RUN,
        found.iter().map(
            |(job, ran, cone, strips): &(SofteningJob, Ran, cone::Cone, Strips)| {
                (job, ran, cone, strips)
            },
        ),
    )
}
