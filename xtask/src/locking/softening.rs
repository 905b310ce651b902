//! How stiff the faces of an elastic sheet may be: a disk that must not stretch, strips that must not lock.

use super::Findings;
use super::cone::{self, Bounded};
use super::model::Model;
use super::records::Records;
use super::strips;
use crate::draw::Charts;
use crate::report::{Effort, Table};
use anyhow::Result;
use isosheet_dynamics::ElasticSheet;
use serde::{Deserialize, Serialize};

pub(super) const ABOUT: &str = "The membrane stiffness of a face of an elastic sheet is that of the material, but at most C D / h² (h²: the mean square of the lengths of its edges). Two scenes \
    pull in opposite directions: a disk pushed into a ring (see above; an irregular mesh) becomes a cone without a fold where C is small, and strips that bend much (see above: heavy with Γ = 100, and pushed together; on the union jack and the one-way mesh, turned, and \
    on three irregular ones) are too stiff where C is large. Both with several values of C and with the stiffness of the material.";

/// The bounds that are compared; the stiffness of the material comes last.
const BOUNDS: [f64; 7] = [100.0, 500.0, 1000.0, 2000.0, 3000.0, 5000.0, 10_000.0];

/// A bound with the size of both meshes.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Job {
    model: Model,
    /// Radius of the disk over the spacing.
    rings: usize,
    /// Squares across the strips.
    across: usize,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
struct Found {
    job: Job,
    cone: Bounded,
    /// The largest errors of energy and place of the strips.
    strips: [Option<f64>; 2],
}

fn jobs(effort: Effort) -> Vec<Job> {
    let sizes: &[[usize; 2]] = effort.quick_or(&[[4, 2]], &[[8, 2], [16, 4]]);
    let bounds = effort.quick_or(vec![ElasticSheet::SOFTENING], BOUNDS.to_vec());
    let models = bounds
        .into_iter()
        .map(Model::Bound)
        .chain([Model::Material]);
    let of = |model: Model| {
        sizes.iter().map(move |&[rings, across]| Job {
            model,
            rings,
            across,
        })
    };
    models.flat_map(of).collect()
}

/// Runs the yardstick.
pub(super) fn make(records: &Records<'_>) -> Result<(Findings, Option<Charts>)> {
    let effort = records.store.effort;
    let patience = effort.quick_or(1.0, 120.0);
    let found = records.runs("bounds", &jobs(effort), |&job| {
        Ok(Found {
            job,
            cone: cone::with_bound(job.model, job.rings, patience)?,
            strips: strips::with_bound(job.model, job.across, patience)?,
        })
    })?;
    let table = Table::of(
        "The bound C of the stiffness of faces: the developable cone (R / h: radius over spacing) and strips that bend much",
        &found,
        &[
            ("model", &|f| f.job.model.to_string().into()),
            ("R/h", &|f| f.job.rings.into()),
            ("V", &|f| f.cone.vertices.into()),
            ("folds", &|f| f.cone.folds.into()),
            ("sector, degrees", &|f| f.cone.sector.into()),
            ("energy / (D (d/R)²)", &|f| f.cone.energy.into()),
            ("in the plane", &|f| f.cone.membrane.into()),
            ("factorisations", &|f| f.cone.factorisations.into()),
            ("squares across the strips", &|f| f.job.across.into()),
            ("largest error of the energy", &|f| f.strips[0].into()),
            ("largest error of the place", &|f| f.strips[1].into()),
        ],
    );
    let findings = Findings {
        tables: vec![table.named("softening")],
        ..Findings::default()
    };
    Ok((findings, None))
}
