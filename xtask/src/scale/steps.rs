//! What a step of the hanging sheet costs at one mesh size.

use crate::runs::{Course, Plan, unseen};
use crate::timing::{BUMP, OrderRow, Work, bumped, order};
use anyhow::Result;
use isosheet_coords::linalg::Ordering;
use isosheet_dynamics::{Method, Simulation};
use serde::{Deserialize, Serialize};
use std::time::Instant;

/// Length of a step, seconds. The finer the mesh, the sooner a sheet that starts all but flat comes to states
/// that its length equations barely determine, where a step takes hundreds of factorisations: with 66 049
/// vertices after 3 ms, with 4225 after 15 ms. Steps this short stay before them at every size, so that what
/// is measured is the price of the size.
pub(super) const STEP: f64 = 2.5e-4;

/// A few steps of the hanging sheet at one mesh size.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Row {
    pub(super) level: u32,
    pub(super) vertices: usize,
    pub(super) faces: usize,
    /// Seconds to set the simulation up.
    pub(super) setup: f64,
    pub(super) course: Course,
    /// Energy gained or lost against the potential energy released.
    pub(super) balance: f64,
    /// Most memory the process has used so far, bytes, where the system tells.
    pub(super) peak: Option<f64>,
    /// Minimum degree and nested dissection.
    pub(super) orders: [OrderRow; 2],
}

impl Row {
    /// Wall seconds per step.
    pub(super) fn step(&self) -> f64 {
        self.course.cost.wall_per_step().unwrap_or(f64::NAN)
    }

    pub(super) fn factorisations(&self) -> f64 {
        let all = self.course.cost.factorisations_per_step();
        all.unwrap_or(f64::NAN)
    }

    /// Parts of a step's time, seconds: factorisations and solves, their numbers times what one of each takes
    /// alone, and the rest.
    pub(super) fn parts(&self) -> [f64; 3] {
        let (best, all) = (self.best(), self.factorisations());
        let iterations = self.course.cost.iterations_per_step();
        let solves = iterations.unwrap_or(f64::NAN).max(all);
        let [factorising, solving] = [all * best.numeric, solves * best.solve];
        [factorising, solving, self.step() - factorising - solving]
    }

    /// The order that a simulation uses: the one with fewer operations.
    pub(super) fn best(&self) -> &OrderRow {
        let [a, b] = &self.orders;
        if b.operations < a.operations { b } else { a }
    }
}

/// Measures one level: orders of elimination, and `steps` steps of the hanging sheet after a first one that
/// is not timed.
pub(super) fn measure(level: u32, steps: usize) -> Result<Row> {
    let sheet = bumped(level, BUMP)?;
    let clock = Instant::now();
    let mut run = Work::Hanging.start(level, BUMP, Method::default())?;
    let setup = clock.elapsed().as_secs_f64();
    let potential = |run: &Simulation| run.model().potential_energy(0.0, &run.state().x);
    let (before, energy) = (potential(&run), run.energy());
    run.step(STEP)?;
    let plan = Plan::new(STEP, steps as f64 * STEP);
    let mut course = plan.run(&mut run, &mut unseen)?;
    if let Some(error) = course.error.take() {
        return Err(error.into());
    }
    let balance = (run.energy() - energy) / (before - potential(&run));
    let peak = peak_memory();
    drop(run);
    Ok(Row {
        level,
        vertices: sheet.topology().vertex_count(),
        faces: sheet.topology().face_count(),
        setup,
        course,
        balance,
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
        assert_eq!(
            (row.vertices, row.faces, row.course.cost.steps),
            (25, 32, 3)
        );
        assert!(row.course.strain < 1e-12 && row.factorisations() >= 1.0 && row.step() > 0.0);
        for o in &row.orders {
            assert!(o.stored as f64 >= o.entries && o.entries >= 75.0);
        }
    }
}
