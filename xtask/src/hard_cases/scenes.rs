//! Sheets, methods and ways to run them that several cases share.

use crate::draw::Viewpoint;
use crate::interrupt::Interrupted;
use crate::runs::bumped;
use crate::runs::{Course, Plan};
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel, Simulation, State, StepReport};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use std::ops::ControlFlow;

/// The length of a step wherever a case does not say otherwise, seconds.
pub(super) const FRAME: f64 = 1.0 / 60.0;

/// How sheets are seen.
pub(super) const VIEWPOINT: Viewpoint = Viewpoint {
    azimuth: -62.0,
    elevation: 17.0,
    distance: 6.0,
    depth: f64::INFINITY,
};

/// Bound for the relative edge length error of accepted steps, unless the rounding of the coordinates is
/// larger.
pub(super) const STRAIN: f64 = 1e-12;

/// Bound for the relative edge length error at positions of the given sheet: [`STRAIN`], or four units in
/// the last place of the largest coordinate over the shortest rod where that is larger.
pub(super) fn strain_bound(sheet: &Sheet) -> f64 {
    let size = sheet
        .positions()
        .iter()
        .fold(0.0_f64, |m, x| m.max(x.abs()));
    let shortest = sheet.lengths().iter().fold(f64::INFINITY, |m, l| m.min(*l));
    // Sheets that move about reach twice the size of their rest positions.
    STRAIN.max(4.0 * f64::EPSILON * (2.0 * size / shortest + 1.0))
}

/// A sheet of 0.1 kg under gravity, pinned at the given vertices.
pub(super) fn pinned(sheet: &Sheet, pins: &[VertexId]) -> Result<SheetModel> {
    Ok(SheetModel::new(sheet, 0.1, MassKind::Lumped)?
        .with_gravity()
        .with_pins(pins)?)
}

/// `M^1` with a bump (metres), flying and tumbling, with velocities that keep the lengths.
pub(super) fn tumbling(bump: f64) -> Result<(SheetModel, State)> {
    Ok(isosheet_tests::tumbling(&bumped(1, bump)))
}

/// A simulation from rest.
pub(super) fn at_rest(model: SheetModel, x: &[f64], method: Method) -> Result<Simulation> {
    Ok(Simulation::new(model, State::at_rest(x.to_vec()), method)?)
}

/// A sheet of 0.1 kg under gravity, pinned at the given vertices, released at rest in its own positions.
pub(super) fn released(sheet: &Sheet, pins: &[VertexId], method: Method) -> Result<Simulation> {
    at_rest(pinned(sheet, pins)?, sheet.positions(), method)
}

/// The top row of `M^1`.
pub(super) fn top_row() -> Vec<VertexId> {
    (20..25).map(VertexId).collect()
}

/// Takes `steps` steps or as many as are accepted.
pub(super) fn course(
    run: &mut Simulation,
    h: f64,
    steps: usize,
    mut watch: impl FnMut(&StepReport, &State),
) -> Result<Course, Interrupted> {
    let mut look = |run: &Simulation, report: &StepReport| {
        watch(report, run.state());
        ControlFlow::Continue(())
    };
    Plan::new(h, steps as f64 * h).run(run, &mut look)
}

/// Takes steps as [`course`] does, unwatched; returns the positions at the end as well.
pub(super) fn go(
    mut run: Simulation,
    h: f64,
    steps: usize,
) -> Result<(Course, Vec<f64>), Interrupted> {
    let course = course(&mut run, h, steps, |_, _| {})?;
    Ok((course, run.state().x.clone()))
}

/// Largest distance of corresponding vertices, metres.
pub(super) fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.chunks(3)
        .zip(b.chunks(3))
        .map(|(p, q)| (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt())
        .fold(0.0, f64::max)
}

/// The sheet turned upright: y becomes z.
pub(super) fn upright(sheet: &Sheet) -> Result<Sheet> {
    Ok(sheet.map_positions(|[x, y, _]| [x, 0.0, y])?)
}
