//! What a step with contact costs at one mesh size.

use super::measure::{STEP, peak_memory};
use super::timed::{Spent, Timed};
use crate::interrupt;
use crate::report::Cost;
use crate::timing::{Pairs, bumped, on_table};
use anyhow::Result;
use isosheet_collide::ContactOptions;
use isosheet_dynamics::{Method, RunEnd, SheetModel, Simulation, State, StepReport};
use isosheet_mesh::{MassKind, VertexId};
use std::ops::ControlFlow;
use std::time::Instant;

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
#[derive(Clone, Debug, Default)]
pub(crate) struct DrapeRow {
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    /// What the steps that were timed cost.
    pub(crate) cost: Cost,
    /// Parts of the wall time, seconds: finding pairs and safe motions; distances and normals of contacts.
    pub(crate) contact: Spent,
    /// Contacts within reach at the end.
    pub(crate) contacts: usize,
    /// Pairs of vertices that contact couples at the end and the mesh does not: they would cost fill.
    pub(crate) couplings: usize,
    /// Largest relative edge length error.
    pub(crate) strain: f64,
    /// Smallest gap, metres.
    pub(crate) gap: f64,
    /// Most memory the process has used so far, bytes, where the system tells.
    pub(crate) peak: Option<f64>,
    /// Why there are no more steps.
    pub(crate) stopped: Option<String>,
}

impl DrapeRow {
    /// A number as a mean over the steps that were timed.
    fn per_step(&self, all: f64) -> f64 {
        all / self.cost.steps.max(1) as f64
    }

    /// Wall seconds of a step.
    pub(crate) fn step(&self) -> f64 {
        self.per_step(self.cost.wall)
    }

    /// Parts of it, seconds, see [`Spent`].
    pub(crate) fn detection(&self) -> f64 {
        self.per_step(self.contact.detection)
    }

    /// See [`DrapeRow::detection`].
    pub(crate) fn evaluation(&self) -> f64 {
        self.per_step(self.contact.evaluation)
    }

    pub(crate) fn iterations(&self) -> f64 {
        self.per_step(self.cost.iterations as f64)
    }

    pub(crate) fn factorisations(&self) -> f64 {
        self.per_step(self.cost.factorisations as f64)
    }
}

/// Measures up to `steps` steps after a first one that is not timed, or as many as begin within `patience`
/// seconds.
pub(crate) fn measure(level: u32, steps: usize, patience: f64) -> Result<DrapeRow> {
    let sheet = bumped(level, BUMP)?;
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?.with_gravity();
    let options = ContactOptions::for_sheet(&model);
    // The bump is at half its height above the corners of the table, where the cloth is lowest.
    let top = 0.5 * BUMP - START * options.activation;
    let contacts = on_table(&model, options, (TABLE, top), Pairs::TableAndItself)?;
    let (contacts, watch) = Timed::new(contacts);
    let start = State::at_rest(sheet.positions().to_vec());
    let mut run = Simulation::new(model, start, Method::default())?.with_contact(contacts)?;
    let mut row = DrapeRow {
        level,
        vertices: sheet.topology().vertex_count(),
        gap: f64::INFINITY,
        ..DrapeRow::default()
    };
    let first = run.step(STEP);
    let (clock, before) = (Instant::now(), watch.read());
    let mut observe = |_: &Simulation, report: &StepReport| {
        row.cost.add(report);
        row.strain = row.strain.max(report.strain);
        row.gap = row.gap.min(report.gap.unwrap_or(f64::INFINITY));
        if clock.elapsed().as_secs_f64() > patience {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    };
    let duration = steps as f64 * STEP;
    let end =
        first.and_then(|_| run.run(duration, STEP, &mut [&mut observe, &mut interrupt::observe]));
    interrupt::check()?;
    row.stopped = match end {
        Ok(RunEnd::Stopped) => Some(format!("{patience} s of wall time were over")),
        // No support of this scene moves, so that no run ends taut.
        Ok(RunEnd::Complete | RunEnd::Taut) => None,
        Err(error) => Some(error.to_string()),
    };
    row.cost.wall = clock.elapsed().as_secs_f64();
    row.contact = watch.read().since(before);
    row.peak = peak_memory();
    if let Some(active) = run.contacts() {
        row.contacts = active.list().len();
        let mut pairs = Vec::new();
        active.couplings(&mut pairs);
        pairs.sort_unstable();
        pairs.dedup();
        let edge = |[a, b]: &[u32; 2]| sheet.topology().find_edge(VertexId(*a), VertexId(*b));
        row.couplings = pairs.iter().filter(|p| edge(p).is_none()).count();
    }
    Ok(row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_cloth_is_measured() {
        let row = measure(1, 3, 10.0).expect("a small cloth moves");
        assert_eq!((row.vertices, row.cost.steps, row.couplings), (25, 3, 0));
        assert!(
            row.contacts >= 4 && row.gap > 0.0 && row.strain < 1e-12,
            "{row:?}"
        );
        let contact = row.detection() + row.evaluation();
        assert!(
            row.detection() > 0.0 && row.evaluation() > 0.0 && contact < row.step(),
            "{row:?}"
        );
        assert!(measure(1, 3, 0.0).expect("stopped").stopped.is_some());
    }
}
