//! What is measured at one mesh size.

use crate::interrupt;
use crate::timing::{OrderRow, bumped, corner, order};
use anyhow::{Context, Result};
use isosheet_coords::linalg::Ordering;
use isosheet_dynamics::{History, Method, SheetModel, Simulation, State, StepReport};
use isosheet_mesh::MassKind;
use std::time::Instant;

/// Length of a step, seconds. The finer the mesh, the sooner a sheet that starts all but flat comes to states
/// that its length equations barely determine, where a step takes hundreds of factorisations: with 66 049
/// vertices after 3 ms, with 4225 after 15 ms. Steps this short stay before them at every size, so that what
/// is measured is the price of the size.
pub(crate) const STEP: f64 = 2.5e-4;

/// A few steps of the hanging sheet at one mesh size.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) level: u32,
    pub(crate) vertices: usize,
    pub(crate) faces: usize,
    /// Seconds to set the simulation up.
    pub(crate) setup: f64,
    pub(crate) steps: usize,
    /// Wall seconds per step.
    pub(crate) per_step: f64,
    pub(crate) iterations: f64,
    pub(crate) factorisations: f64,
    /// Largest relative edge length error.
    pub(crate) strain: f64,
    /// Energy gained or lost against the potential energy released.
    pub(crate) balance: f64,
    /// Most memory the process has used so far, bytes, where the system tells.
    pub(crate) peak: Option<f64>,
    /// Minimum degree and nested dissection.
    pub(crate) orders: [OrderRow; 2],
}

impl Row {
    /// Parts of a step's time, seconds: factorisations and solves, their numbers times what one of each takes
    /// alone.
    pub(super) fn linear(&self) -> [f64; 2] {
        let best = self.best();
        let solves = self.iterations.max(self.factorisations);
        [self.factorisations * best.numeric, solves * best.solve]
    }

    /// The order that a simulation uses: the one with fewer operations.
    pub(crate) fn best(&self) -> &OrderRow {
        let [a, b] = &self.orders;
        if b.fill.operations < a.fill.operations {
            b
        } else {
            a
        }
    }
}

/// Height of the bump of the hanging sheet, metres: all but flat.
const BUMP: f64 = 1e-3;

/// Measures one level: orders of elimination, and `steps` steps of the hanging sheet after a first one that
/// is not timed.
pub(crate) fn measure(level: u32, steps: usize) -> Result<Row> {
    let sheet = bumped(level, BUMP)?;
    let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped)?
        .with_gravity()
        .with_pins(&[corner(level)])?;
    let start = sheet.positions().to_vec();
    let before = model.potential_energy(0.0, &start);
    let clock = Instant::now();
    let mut run = Simulation::new(model, State::at_rest(start), Method::default())?;
    let setup = clock.elapsed().as_secs_f64();
    let context = |k| format!("step {k} of the sheet of level {level}");
    run.step(STEP).with_context(|| context(0))?;
    let clock = Instant::now();
    let mut history = History::default();
    let end = run.run(
        steps as f64 * STEP,
        STEP,
        &mut [&mut history, &mut interrupt::observe],
    );
    let per_step = clock.elapsed().as_secs_f64() / steps as f64;
    interrupt::check()?;
    let reports = history.reports();
    end.with_context(|| context(reports.len() + 1))?;
    let mean = |count: fn(&StepReport) -> usize| {
        reports.iter().map(count).sum::<usize>() as f64 / steps as f64
    };
    let released = before - run.model().potential_energy(0.0, &run.state().x);
    let peak = peak_memory();
    drop(run);
    Ok(Row {
        level,
        vertices: sheet.topology().vertex_count(),
        faces: sheet.topology().face_count(),
        setup,
        steps,
        per_step,
        iterations: mean(|r| r.iterations),
        factorisations: mean(|r| r.factorisations),
        strain: reports.iter().map(|r| r.strain).fold(0.0, f64::max),
        balance: reports.last().map_or(0.0, |r| r.energy_drift) / released,
        peak,
        orders: [
            order(&sheet, Ordering::MinimumDegree)?,
            order(&sheet, Ordering::NestedDissection)?,
        ],
    })
}

/// Most resident memory of this process so far, bytes; `None` where the system does not tell.
pub(super) fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024.0 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_sheet_is_measured() {
        let row = measure(1, 3).expect("a small sheet moves");
        assert_eq!((row.vertices, row.faces, row.steps), (25, 32, 3));
        assert!(row.strain < 1e-12 && row.factorisations >= 1.0 && row.per_step > 0.0);
        for o in &row.orders {
            assert!(o.stored as f64 >= o.fill.entries && o.fill.entries >= 75.0);
        }
    }
}
