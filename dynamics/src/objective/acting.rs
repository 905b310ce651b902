//! Potentials and constant forces in a step.

use crate::SheetModel;
use crate::hessian::{BlockSink, HessianPart};
use crate::model::PINNED;
use crate::term::{Barrier, Exchange, Iterate, Refusal, StepStart, Term, Value};
use isosheet_coords::linalg::norm_inf;
use std::sync::Arc;

/// `V(x, t) - f . (x - x^)`: the potentials of a model at the end of a step, and its non-conservative forces
/// `f`, constant over the step as they are at its start; `x^` is the prediction.
pub(super) struct Acting {
    model: Arc<SheetModel>,
    has_limit: bool,
    prediction: Vec<f64>,
    /// `f`, `3V`, newtons.
    applied: Vec<f64>,
    /// The same, zero at pinned vertices.
    applied_free: Vec<f64>,
    /// Energy of the potentials where it was evaluated last, and its round-off, joules.
    energy: f64,
    round_off: f64,
    energy_at: Evaluated,
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
        Self {
            has_limit: model.potentials().any(|p| p.has_limit()),
            model: Arc::clone(model),
            prediction: vec![0.0; n],
            applied: vec![0.0; n],
            applied_free: vec![0.0; n],
            energy: 0.0,
            round_off: 0.0,
            energy_at: Evaluated::new(n),
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

    /// Work of the constant forces at the free vertices over displacements, joules.
    fn work(&self, moved: impl Iterator<Item = f64>) -> f64 {
        self.applied_free
            .iter()
            .zip(moved)
            .map(|(f, d)| f * d)
            .sum()
    }
}

impl Term for Acting {
    fn begin(&mut self, step: &StepStart<'_>) -> Result<(), Refusal> {
        let (model, state) = (&self.model, step.state);
        self.prediction.copy_from_slice(step.prediction);
        self.applied.fill(0.0);
        model.add_explicit_force(state.t, &state.x, &state.v, &mut self.applied);
        self.applied_free.copy_from_slice(&self.applied);
        model.clear_pinned(&mut self.applied_free);
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
            self.model
                .force_with(at.memories, at.t, at.x, &mut self.force);
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
        let potentials = self.model.potentials_at(at.t, at.x, at.memories);
        potentials.fold(1.0, |part, (p, here)| p.safe_part(here, dx).min(part))
    }

    fn stays_within(&mut self, at: Iterate<'_>, end: &[f64]) -> bool {
        let mut potentials = self.model.potentials_at(at.t, at.x, at.memories);
        potentials.all(|(p, here)| p.stays_within(here, end))
    }

    fn add_second_order(
        &mut self,
        at: Iterate<'_>,
        dx: &[f64],
        scale: f64,
        out: &mut [f64],
    ) -> bool {
        let potentials = self.model.potentials_at(at.t, at.x, at.memories);
        let mut any = false;
        for (p, here) in potentials {
            any |= p.add_second_order(here, dx, scale, out);
        }
        any
    }

    fn finish(&mut self, step: &StepStart<'_>, at: Iterate<'_>) -> Result<Exchange, Refusal> {
        let moved = at.x.iter().zip(&step.state.x).map(|(x, x0)| x - x0);
        let work = self.work(moved);
        Ok(Exchange {
            work,
            ..Exchange::default()
        })
    }
}
