//! Sheets, methods and ways to run them that several cases share.

use crate::interrupt::{self, Interrupted};
use crate::timing::bumped;
use anyhow::Result;
use isosheet_dynamics::{Method, SheetModel, Simulation, State, StepError, StepReport};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use std::ops::ControlFlow;

/// The length of a step wherever a case does not say otherwise, seconds.
pub(super) const FRAME: f64 = 1.0 / 60.0;

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
    Ok(isosheet_tests::tumbling(&bumped(1, bump)?))
}

/// A simulation from rest.
pub(super) fn at_rest(model: SheetModel, x: &[f64], method: Method) -> Result<Simulation> {
    Ok(Simulation::new(model, State::at_rest(x.to_vec()), method)?)
}

/// A sheet of 0.1 kg under gravity, pinned at the given vertices, released at rest in its own positions.
pub(super) fn released(sheet: &Sheet, pins: &[VertexId], method: Method) -> Result<Simulation> {
    at_rest(pinned(sheet, pins)?, sheet.positions(), method)
}

/// How many of some simulations that differ a little stop before the end of their steps of [`FRAME`], and the
/// largest edge strain of all steps. Whether a chaotic run gets through is a matter of chance; how many of
/// them do is not.
pub(super) fn stopped(
    runs: u32,
    steps: usize,
    build: impl Fn(u32) -> Result<Simulation>,
) -> Result<(u32, f64)> {
    let (mut stopped, mut strain) = (0, 0.0_f64);
    for k in 0..runs {
        let course = go(&mut build(k)?, FRAME, steps)?;
        stopped += u32::from(course.steps < steps);
        strain = strain.max(course.strain);
    }
    Ok((stopped, strain))
}

/// The top row of `M^1`.
pub(super) fn top_row() -> Vec<VertexId> {
    (20..25).map(VertexId).collect()
}

/// What happened in a number of steps.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    /// Steps taken.
    pub(super) steps: usize,
    pub(super) rejected: usize,
    /// Largest relative edge length error.
    pub(super) strain: f64,
    /// Largest absolute energy error, joules.
    pub(super) drift: f64,
    /// Largest energy error of the sign of a gain, joules.
    pub(super) gain: f64,
    /// Largest kinetic energy, joules.
    pub(super) kinetic: f64,
    /// Time at its end, seconds.
    pub(super) end: f64,
    /// Why it ended early.
    pub(super) refusal: Option<StepError>,
}

impl Course {
    /// The error message of an early end, shortened to its first reason.
    pub(super) fn said(&self) -> Option<String> {
        self.refusal.as_ref().map(ToString::to_string)
    }

    /// Takes another run into account: the worst of both, and the first error.
    pub(super) fn add(&mut self, other: Self) {
        self.steps += other.steps;
        self.rejected += other.rejected;
        self.strain = self.strain.max(other.strain);
        self.drift = self.drift.max(other.drift);
        self.gain = self.gain.max(other.gain);
        self.kinetic = self.kinetic.max(other.kinetic);
        if self.refusal.is_none() {
            (self.end, self.refusal) = (other.end, other.refusal);
        }
    }

    /// NaN if the run ended early: no number of it is what was asked for.
    pub(super) fn if_finished(&self, value: f64) -> f64 {
        if self.refusal.is_none() {
            value
        } else {
            f64::NAN
        }
    }
}

/// Takes `steps` steps or as many as are accepted.
pub(super) fn course(
    run: &mut Simulation,
    h: f64,
    steps: usize,
    mut watch: impl FnMut(&StepReport, &State),
) -> Result<Course, Interrupted> {
    let mut course = Course::default();
    let mut observe = |run: &Simulation, report: &StepReport| {
        course.steps += 1;
        course.rejected += report.rejected;
        course.strain = course.strain.max(report.strain);
        course.drift = course.drift.max(report.energy_drift.abs());
        course.gain = course.gain.max(report.energy_drift);
        course.kinetic = course.kinetic.max(report.kinetic);
        watch(report, run.state());
        ControlFlow::Continue(())
    };
    let duration = steps as f64 * h;
    let end = run.run(duration, h, &mut [&mut observe, &mut interrupt::observe]);
    interrupt::check()?;
    course.refusal = end.err();
    course.end = run.state().t;
    Ok(course)
}

/// Takes steps as [`course`] does, unwatched.
pub(super) fn go(run: &mut Simulation, h: f64, steps: usize) -> Result<Course, Interrupted> {
    course(run, h, steps, |_, _| {})
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
