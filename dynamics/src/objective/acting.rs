//! Potentials and explicit forces in a step.

use crate::{SheetModel, StepError};
use isosheet_linalg::norm_inf;
use isosheet_materials::hessian::{BlockSink, HessianPart};
use isosheet_materials::potential::{At, Difference, Limited};
use isosheet_mesh::VertexId;
use isosheet_model::PINNED;
use isosheet_model::term::{Barrier, Exchange, Formula, Iterate, StepStart, Term, Value};
use std::sync::Arc;

/// `V(x, t) - f . (x - x^)`: the potentials of a model at the end of a step, and its explicit forces `f`;
/// `x^` is the prediction.
///
/// The explicit forces are those at the time of the end, which is exact where they depend on time alone, and
/// at the positions and velocities that the step is expected to end with ([`StepStart::ahead`],
/// [`StepStart::add_velocity_ahead`]): a two-step formula keeps its order (U. M. Ascher, S. J. Ruuth and B.
/// T. R. Wetton, SIAM J. Numer. Anal. 32, 1995).
pub(super) struct Acting {
    model: Arc<SheetModel>,
    has_limit: bool,
    prediction: Vec<f64>,
    /// `f`, `3V`, newtons.
    applied: Vec<f64>,
    /// `f` at free vertices and zero at pinned ones.
    applied_free: Vec<f64>,
    /// Work arrays, `3V`; empty without explicit forces.
    scratch: Vec<f64>,
    /// Masses of the vertices, kilograms; empty without explicit forces.
    masses: Vec<f64>,
    /// Energy of the potentials where it was evaluated last, and its round-off, joules.
    energy: f64,
    round_off: f64,
    energy_at: Evaluated,
    /// The potentials that are left out of gradients, by their numbers; nothing in steps.
    restricted: Vec<Difference>,
    /// Conservative forces where they were evaluated last, newtons; zero at pinned vertices.
    force: Vec<f64>,
    force_at: Evaluated,
}

/// Time and positions at which potentials were evaluated. Multipliers change more often than positions.
struct Evaluated {
    t: f64,
    x: Vec<f64>,
}

impl Evaluated {
    /// Nowhere.
    fn new(n: usize) -> Self {
        let (t, x) = (f64::NAN, vec![0.0; n]);
        Self { t, x }
    }

    /// Whether that was somewhere else; from now on it is here.
    fn moves_to(&mut self, at: Iterate<'_>) -> bool {
        if self.t == at.t && self.x == at.x {
            return false;
        }
        self.t = at.t;
        self.x.copy_from_slice(at.x);
        true
    }

    fn forget(&mut self) {
        self.t = f64::NAN;
    }
}

impl Acting {
    pub(super) fn new(model: &Arc<SheetModel>) -> Self {
        let n = model.coordinate_count();
        let (scratch, masses) = match model.forces().is_empty() {
            true => (0, Vec::new()),
            false => (n, model.mass().row_sums(model.topology())),
        };
        Self {
            scratch: vec![0.0; scratch],
            masses,
            has_limit: model.has_limit(),
            model: Arc::clone(model),
            prediction: vec![0.0; n],
            applied: vec![0.0; n],
            applied_free: vec![0.0; n],
            energy: 0.0,
            round_off: 0.0,
            energy_at: Evaluated::new(n),
            restricted: Vec::new(),
            force: vec![0.0; n],
            force_at: Evaluated::new(n),
        }
    }

    /// Sum of the magnitudes of the components of the conservative forces at the last gradient, newtons.
    pub(super) fn force_sum(&self) -> f64 {
        let rows = self.force.as_chunks::<3>().0.iter();
        let free = rows
            .zip(self.model.free_index())
            .filter(|(_, i)| **i != PINNED);
        free.flat_map(|(row, _)| row).map(|f| f.abs()).sum()
    }

    /// Restricts gradients to parts of the potentials from now on; to none where there is no list.
    pub(super) fn restrict(&mut self, to: &[Difference]) {
        self.restricted.clear();
        self.restricted.extend_from_slice(to);
        self.force_at.forget();
    }

    /// Sets the conservative force of the parts of the potentials that it is restricted to.
    fn set_restricted_force(&mut self, at: Iterate<'_>) {
        self.force.fill(0.0);
        let potentials = self.model.potentials_at(at.t, at.x, at.memories);
        for ((potential, place), parts) in potentials.zip(&self.restricted) {
            match parts {
                Difference::Nothing => {}
                Difference::Parts(parts) => {
                    potential.add_gradient_of(parts, place, &mut self.force);
                }
                Difference::Everything => potential.add_gradient(place, &mut self.force),
            }
        }
        self.force.iter_mut().for_each(|f| *f = -*f);
    }

    /// The potentials with limits, each with where it is evaluated.
    fn limits<'a>(&'a self, at: Iterate<'a>) -> impl Iterator<Item = (&'a dyn Limited, At<'a>)> {
        let all = self.model.potentials_at(at.t, at.x, at.memories);
        all.filter_map(|(p, here)| Some((p.limit()?, here)))
    }

    /// Whether the limits leave a place at a time and positions.
    ///
    /// # Errors
    /// As [`Limited::check`].
    pub(super) fn check_at(&self, at: At<'_>) -> Result<(), StepError> {
        let mut limits = self.model.potentials().filter_map(|p| p.limit());
        limits.try_for_each(|limit| limit.check(at))?;
        Ok(())
    }

    /// By how much the work of the explicit forces, as they were expected of the end of a step, differs from
    /// that of the forces there, at the vertices for which they are too stiff to be expected.
    ///
    /// A force `-c v` on a mass `m` whose velocity is extrapolated over a step of the span `s` from one
    /// before it, `w` times shorter, is stable to `c s / m = 2 (1 + w) / (1 + 2 w)`, 4/3 for equal steps:
    /// there the root of the recursion is -1. With the effective step `h = s (1 + w) / (1 + 2 w)`, the motion
    /// `z` at the end and the expected one `y` this is `|h^2 (f(z) - f(y)) / m| = 2 (h / s)^2 |z - y|`. Of
    /// implicit Euler, where it would be twice `|z - y|`, the bound is `|z - y|`, from which on velocities
    /// change their sign.
    fn misjudged(&mut self, step: &StepStart<'_>, x: &[f64]) -> f64 {
        let h = step.h;
        let limit = (2.0 * (h / step.span).powi(2)).min(1.0);
        let v = x.iter().zip(step.rest).map(|(x, y)| (x - y) / h);
        let v: Vec<f64> = v.collect();
        let mut expected = vec![0.0; x.len()];
        step.add_velocity_ahead(&mut expected);
        self.scratch.fill(0.0);
        self.model
            .add_explicit_force(step.t(), x, &v, &mut self.scratch);
        self.model.clear_pinned(&mut self.scratch);
        let mut misjudged = 0.0;
        let rows = self.masses.iter().zip(self.model.free_index());
        let free = rows
            .enumerate()
            .filter(|(_, (mass, free))| **free != PINNED && **mass > 0.0);
        for (vertex, (mass, _)) in free {
            let (mut work, mut response, mut error) = (0.0_f64, 0.0, 0.0);
            for i in 3 * vertex..3 * vertex + 3 {
                let change = self.scratch[i] - self.applied_free[i];
                work += change * (x[i] - step.state.x[i]);
                response += (h * h * change).powi(2) / mass;
                let off = (x[i] - step.ahead[i])
                    .abs()
                    .max(h * (v[i] - expected[i]).abs());
                error += mass * off * off;
            }
            if response > limit * limit * error {
                misjudged += work.abs();
            }
        }
        misjudged
    }

    /// Work of the explicit forces at the free vertices over displacements, joules.
    fn work(&self, moved: impl Iterator<Item = f64>) -> f64 {
        self.applied_free
            .iter()
            .zip(moved)
            .map(|(f, d)| f * d)
            .sum()
    }
}

impl Term for Acting {
    fn check(&mut self, [_, end]: [f64; 2], x: &[f64]) -> Result<(), StepError> {
        self.check_at(At::new(end, x))
    }

    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        let model = &self.model;
        self.prediction.copy_from_slice(step.prediction);
        if !model.forces().is_empty() {
            self.scratch.fill(0.0);
            step.add_velocity_ahead(&mut self.scratch);
            self.applied.fill(0.0);
            model.add_explicit_force(step.t(), step.ahead, &self.scratch, &mut self.applied);
            if let Some(i) = self.applied.iter().position(|f| !f.is_finite()) {
                let (vertex, value) = (VertexId::from_index(i / 3), self.applied[i]);
                let t = step.t();
                return Err(StepError::NonFiniteForce { vertex, value, t });
            }
            self.applied_free.copy_from_slice(&self.applied);
            model.clear_pinned(&mut self.applied_free);
        }
        self.energy_at.forget();
        self.force_at.forget();
        Ok(())
    }

    fn value(&mut self, at: Iterate<'_>) -> Value {
        let model = &self.model;
        if self.energy_at.moves_to(at) {
            let size = norm_inf(at.x);
            (self.energy, self.round_off) = (0.0, 0.0);
            for (potential, place) in model.potentials_at(at.t, at.x, at.memories) {
                let energy = potential.energy(place);
                self.energy += energy;
                self.round_off += potential.round_off(size, energy);
            }
        }
        let moved = at.x.iter().zip(&self.prediction).map(|(x, p)| x - p);
        let work: f64 = self.work(moved);
        Value {
            energy: self.energy - work,
            size: self.energy.abs() + work.abs(),
            round_off: self.round_off,
        }
    }

    fn add_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        if self.force_at.moves_to(at) {
            match self.restricted.is_empty() {
                true => self
                    .model
                    .force_with(at.memories, at.t, at.x, &mut self.force),
                false => self.set_restricted_force(at),
            }
        }
        let acting = self.force.iter().zip(&self.applied);
        for (o, (f, a)) in out.iter_mut().zip(acting) {
            *o -= scale * (f + a);
        }
    }

    fn add_hessian(&mut self, at: Iterate<'_>, part: HessianPart, sink: &mut dyn BlockSink) {
        for (p, here) in self.model.potentials_at(at.t, at.x, at.memories) {
            match part {
                HessianPart::Full => p.add_hessian(here, sink),
                HessianPart::PositiveSemidefinite => p.add_semidefinite_hessian(here, sink),
                HessianPart::Certain => {}
            }
        }
    }

    fn barrier(&self) -> Option<Barrier> {
        self.has_limit.then_some(Barrier::StrainLimit)
    }

    fn safe_part(&mut self, at: Iterate<'_>, dx: &[f64]) -> f64 {
        let limits = self.limits(at);
        limits.fold(1.0, |part, (p, here)| p.safe_part(here, dx).min(part))
    }

    fn stays_within(&mut self, at: Iterate<'_>, end: &[f64]) -> bool {
        let mut limits = self.limits(at);
        limits.all(|(p, here)| p.stays_within(here, end))
    }

    fn add_second_order(
        &mut self,
        at: Iterate<'_>,
        dx: &[f64],
        scale: f64,
        out: &mut [f64],
    ) -> bool {
        let mut any = false;
        for (p, here) in self.limits(at) {
            any |= p.add_second_order(here, dx, scale, out);
        }
        any
    }

    /// The work of the explicit forces: of implicit Euler that of the forces at the end, and of a two-step
    /// formula that of their mean at both ends, which may err by the difference of the two.
    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, StepError> {
        let start = step.state;
        if self.model.forces().is_empty() {
            return Ok(Exchange::default());
        }
        let misjudged = self.misjudged(step, at.x);
        let moved = || at.x.iter().zip(&start.x).map(|(x, x0)| x - x0);
        let end = self.work(moved());
        let mut difference = 0.0;
        if step.formula == Formula::TwoStep {
            self.scratch.fill(0.0);
            self.model
                .add_explicit_force(start.t, &start.x, &start.v, &mut self.scratch);
            self.model.clear_pinned(&mut self.scratch);
            let changes = self.applied_free.iter().zip(&self.scratch);
            let parts = changes
                .zip(moved())
                .map(|((end, begin), d)| (end - begin) * d);
            difference = parts.sum();
        }
        Ok(Exchange {
            work: end - 0.5 * difference,
            driven_size: difference.abs(),
            misjudged,
            ..Exchange::default()
        })
    }
}
