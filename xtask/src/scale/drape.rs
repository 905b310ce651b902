//! What a step with contact costs at one mesh size.

use super::steps::{STEP, peak_memory};
use super::timed::{Spent, Timed};
use crate::runs::{Course, Plan, unseen};
use crate::timing::{Pairs, bumped, on_table};
use anyhow::Result;
use isosheet_collide::ContactOptions;
use isosheet_dynamics::{Method, SheetModel, Simulation, State};
use isosheet_mesh::{MassKind, VertexId};
use serde::{Deserialize, Serialize};

/// Height of the bump of the cloth, metres. Ten centimetres keep the length equations independent; of a
/// nearly flat cloth on a table they are not, and from 16 641 vertices on the number of iterations would hide
/// the price of the size.
pub(super) const BUMP: f64 = 0.1;

/// Half of the table's side, half of its thickness, metres.
const TABLE: [f64; 3] = [0.25, 0.25, 0.1];

/// Part of the activation distance between the table and the lowest part of the cloth above it at the start:
/// the gap at which a contact carries its own vertex.
const START: f64 = 0.95;

/// A few steps of the draping sheet at one mesh size.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct DrapeRow {
    pub(super) level: u32,
    pub(super) vertices: usize,
    /// The steps that were timed.
    pub(super) course: Course,
    /// Parts of the wall time, seconds: finding pairs and safe motions; distances and normals of contacts.
    pub(super) contact: Spent,
    /// Contacts within reach at the end.
    pub(super) contacts: usize,
    /// Pairs of vertices that contact couples at the end and the mesh does not: they would cost fill.
    pub(super) couplings: usize,
    /// Most memory the process has used so far, bytes, where the system tells.
    pub(super) peak: Option<f64>,
}

impl DrapeRow {
    /// A number as a mean over the steps that were timed.
    fn per_step(&self, all: f64) -> f64 {
        all / self.course.cost.steps.max(1) as f64
    }

    /// Wall seconds of a step.
    pub(super) fn step(&self) -> f64 {
        self.per_step(self.course.cost.wall)
    }

    /// Parts of it, seconds, see [`Spent`].
    pub(super) fn detection(&self) -> f64 {
        self.per_step(self.contact.detection)
    }

    /// See [`DrapeRow::detection`].
    pub(super) fn evaluation(&self) -> f64 {
        self.per_step(self.contact.evaluation)
    }

    pub(super) fn factorisations(&self) -> f64 {
        self.per_step(self.course.cost.factorisations as f64)
    }
}

/// Measures up to `steps` steps after a first one that is not timed, or as many as begin within `patience`
/// seconds.
pub(super) fn measure(level: u32, steps: usize, patience: f64) -> Result<DrapeRow> {
    let sheet = bumped(level, BUMP)?;
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?.with_gravity();
    let options = ContactOptions::for_sheet(&model);
    // The bump is at half its height above the corners of the table, where the cloth is lowest.
    let top = 0.5 * BUMP - START * options.activation;
    let contacts = on_table(&model, options, (TABLE, top), Pairs::TableAndItself)?;
    let (contacts, watch) = Timed::new(contacts);
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default())?.with_contact(contacts)?;
    run.step(STEP)?;
    let before = watch.read();
    let plan = Plan::new(STEP, steps as f64 * STEP).within(patience);
    let course = plan.run(&mut run, &mut unseen)?;
    let mut pairs = Vec::new();
    let active = run.contacts();
    if let Some(active) = active {
        active.couplings(&mut pairs);
    }
    pairs.sort_unstable();
    pairs.dedup();
    let edge = |[a, b]: &[u32; 2]| sheet.topology().find_edge(VertexId(*a), VertexId(*b));
    Ok(DrapeRow {
        level,
        vertices: sheet.topology().vertex_count(),
        contact: watch.read().since(before),
        contacts: active.map_or(0, |active| active.list().len()),
        couplings: pairs.iter().filter(|p| edge(p).is_none()).count(),
        peak: peak_memory(),
        course,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_cloth_is_measured() {
        let row = measure(1, 3, 10.0).expect("a small cloth moves");
        assert_eq!(
            (row.vertices, row.course.cost.steps, row.couplings),
            (25, 3, 0)
        );
        assert!(
            row.contacts >= 4 && row.course.gap > Some(0.0) && row.course.strain < 1e-12,
            "{row:?}"
        );
        let contact = row.detection() + row.evaluation();
        assert!(
            row.detection() > 0.0 && row.evaluation() > 0.0 && contact < row.step(),
            "{row:?}"
        );
        assert!(!measure(1, 3, 0.0).expect("stopped").course.is_good());
    }
}
