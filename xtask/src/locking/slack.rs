//! How much force the slack of faces may have: a disk that must not stretch, strips that must not lock.

use super::model::{Model, PAPER};
use super::runs::{EVERY_RUN, Ran, Records};
use super::scene::until_rest;
use super::{cone, strips};
use crate::report::Table;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// The forces that are compared, in parts of that of the library.
const FORCES: [f64; 5] = [0.05, 0.25, 1.0, 4.0, 20.0];

/// A force, or nothing for faces without slack, with the sizes of both meshes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct SlackJob {
    #[serde(rename = "force")]
    force: Option<f64>,
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
    let forces = effort.quick_or(vec![PAPER.force], FORCES.to_vec());
    let mut jobs = Vec::new();
    for force in forces.into_iter().map(Some).chain([None]) {
        jobs.extend(sizes.iter().map(|&[rings, across]| SlackJob {
            force,
            rings,
            across,
        }));
    }
    let plan = until_rest(effort.quick_or(2.0, 30.0));
    let found = records.runs("forces", &jobs, |&job| {
        let model = job.force.map_or(Model::Material, |_| Model::Elastic);
        let force = job.force.unwrap_or(PAPER.force);
        let (ran, cone) = cone::with_force(model, force, job.rings, &plan)?;
        let [energy, place] = strips::with_force(model, force, job.across, &plan)?;
        Ok((job, ran, cone, Strips { energy, place }))
    })?;
    Table::of_fields(
        EVERY_RUN,
        found.iter().map(
            |(job, ran, cone, strips): &(SlackJob, Ran, cone::Cone, Strips)| {
                (job, ran, cone, strips)
            },
        ),
    )
}
