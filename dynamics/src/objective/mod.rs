//! The objective of a damped step, a sum of terms.

mod acting;
mod inertia;
#[cfg(test)]
mod spring_tests;

use crate::contact::ContactTerm;
use crate::linear::primal::PrimalMatrix;
use crate::{SheetModel, StepError};
use acting::Acting;
use inertia::Inertia;
use isosheet_linalg::LinalgError;
use isosheet_linalg::parallel::both;
use isosheet_materials::hessian::{BlockSink, HessianProduct};
use isosheet_materials::potential::{At, Difference};
use isosheet_model::PINNED;
use isosheet_model::term::{Barrier, Exchange, Iterate, Lagging, StepStart, Term, Value};
use std::any::Any;
use std::sync::Arc;

pub(crate) use isosheet_materials::hessian::HessianPart;

/// What the damped methods minimise in a step of the effective length `h`,
///
/// ```text
/// Phi(x) = |x - x^|_M^2 / 2 + h^2 sum_k T_k(x),
/// ```
///
/// the inertia, the potentials with the explicit forces, and further terms: implicit forces of the model, and
/// contact where a scene names it.
pub(crate) struct Objective {
    inertia: Inertia,
    /// Potentials and explicit forces.
    acting: Acting,
    /// Further terms, of which it knows nothing else.
    others: Vec<Box<dyn Term>>,
    model: Arc<SheetModel>,
    couplings: Vec<[u32; 2]>,
}

/// The incremental potential `Phi` at an iterate, joules times squared seconds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IncrementalPotential {
    pub(crate) value: f64,
    /// Its inertia term in the frames of the parts that fall, where that is less: what a decrease is compared
    /// with, so that a sheet that falls freely is as exact as one at rest.
    pub(crate) relative_inertia: f64,
    /// Size of what was summed.
    pub(crate) size: f64,
    /// What the round-off of positions makes besides.
    pub(crate) round_off: f64,
}

impl Objective {
    /// Of a model, without contact.
    pub(crate) fn new(model: &Arc<SheetModel>) -> Self {
        let free = model.free_index().iter().map(|i| *i != PINNED);
        let free: Arc<[bool]> = free.collect();
        let others = model.implicit_forces();
        Self {
            inertia: Inertia::new(model),
            acting: Acting::new(model),
            others: others.map(|f| f.term(Arc::clone(&free))).collect(),
            model: Arc::clone(model),
            couplings: Vec::new(),
        }
    }

    /// Of a model at rest, without contact: without the terms of forces that depend on velocities.
    pub(crate) fn at_rest(model: &Arc<SheetModel>) -> Self {
        Self {
            others: Vec::new(),
            ..Self::new(model)
        }
    }

    /// Adds a term before the implicit forces, or puts it in the place of the one of its type.
    pub(crate) fn set<T: Term>(&mut self, term: T) {
        self.others.retain(|other| !is::<T>(&**other));
        self.others.insert(0, Box::new(term));
    }

    /// The term of a type, if there is one.
    pub(crate) fn get<T: Term>(&self) -> Option<&T> {
        self.others
            .iter()
            .find_map(|term| (&**term as &dyn Any).downcast_ref())
    }

    /// The term of a type, if there is one.
    pub(crate) fn get_mut<T: Term>(&mut self) -> Option<&mut T> {
        let mut others = self.others.iter_mut();
        others.find_map(|term| (&mut **term as &mut dyn Any).downcast_mut())
    }

    /// All terms, each with its factor.
    fn weighted(&mut self, h: f64) -> impl Iterator<Item = (&mut dyn Term, f64)> {
        let others = self.others.iter_mut().map(|term| &mut **term as _);
        let acting = std::iter::once(&mut self.acting as &mut dyn Term);
        let terms = acting.chain(others);
        let inertia = std::iter::once((&mut self.inertia as &mut dyn Term, 1.0));
        inertia.chain(terms.map(move |term| (term, h * h)))
    }

    /// All terms but the inertia.
    fn terms(&mut self) -> impl Iterator<Item = &mut dyn Term> {
        self.weighted(1.0).skip(1).map(|(term, _)| term)
    }

    /// The terms that cut displacements.
    fn barriers(&mut self) -> impl Iterator<Item = &mut dyn Term> {
        self.terms().filter(|term| term.barrier().is_some())
    }

    /// What may cut displacements.
    fn barrier_kinds(&self) -> impl Iterator<Item = Barrier> {
        let others = self.others.iter().filter_map(|term| term.barrier());
        self.acting.barrier().into_iter().chain(others)
    }

    /// Whether displacements are bounded.
    pub(crate) fn has_barrier(&self) -> bool {
        self.barrier_kinds().next().is_some()
    }

    /// Whether there is a barrier that holds on the whole way of a displacement, such as contact.
    pub(crate) fn has_barrier_on_the_way(&self) -> bool {
        self.barrier_kinds().any(Barrier::holds_on_the_way)
    }

    /// Whether nothing that a term prescribes moves in a span of time.
    pub(crate) fn rests(&mut self, span: [f64; 2]) -> bool {
        self.terms().all(|term| term.rests(span))
    }

    /// Refuses a span of time that cannot be stepped over from positions `x`.
    ///
    /// # Errors
    /// As [`Term::check`].
    pub(crate) fn check(&mut self, span: [f64; 2], x: &[f64]) -> Result<(), StepError> {
        self.terms().try_for_each(|term| term.check(span, x))
    }

    /// Refuses positions at the end of a step where the limits of the potentials leave no place at the time
    /// of its start: the work of what is prescribed is measured there, too.
    ///
    /// # Errors
    /// As [`Limited::check`](crate::Limited::check).
    pub(crate) fn check_end(&self, start: f64, x: &[f64]) -> Result<(), StepError> {
        self.acting.check_at(At::new(start, x))
    }

    /// Begins a step, or begins it anew.
    ///
    /// # Errors
    /// [`StepError`].
    pub(crate) fn begin(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        self.inertia.begin(step)?;
        self.terms().try_for_each(|term| term.begin(step))
    }

    /// As [`Objective::begin`], but for contact.
    ///
    /// # Errors
    /// [`StepError`].
    pub(crate) fn begin_without_contact(&mut self, step: &StepStart<'_>) -> Result<(), StepError> {
        self.inertia.begin(step)?;
        self.without_contact().try_for_each(|term| term.begin(step))
    }

    /// The incremental potential in a step of the effective length `h`, seconds.
    pub(crate) fn value(&mut self, at: Iterate<'_>, h: f64) -> IncrementalPotential {
        let inertia = self.inertia.value(at).energy;
        let mut sum = Value::default();
        for term in self.terms() {
            let Value {
                energy,
                size,
                round_off,
            } = term.value(at);
            sum.energy += energy;
            sum.size += size;
            sum.round_off += round_off;
        }
        IncrementalPotential {
            value: inertia + h * h * sum.energy,
            relative_inertia: (inertia - self.inertia.of_fall()).max(0.0),
            size: inertia + h * h * sum.size,
            round_off: h * h * sum.round_off,
        }
    }

    /// Restricts gradients to parts of the potentials from now on; to none where there is no list.
    pub(crate) fn restrict(&mut self, to: &[Difference]) {
        self.acting.restrict(to);
    }

    /// All terms but the inertia and contact.
    pub(crate) fn without_contact(&mut self) -> impl Iterator<Item = &mut dyn Term> {
        self.terms().filter(|term| !is::<ContactTerm>(&**term))
    }

    /// The terms that are neither inertia, potentials and explicit forces, nor contact.
    pub(crate) fn others_without_contact(&mut self) -> impl Iterator<Item = &mut dyn Term> {
        self.without_contact().skip(1)
    }

    /// Whether there are such terms.
    pub(crate) fn has_others(&mut self) -> bool {
        self.others_without_contact().next().is_some()
    }

    /// Adds the Hessian of the inertia.
    pub(crate) fn add_inertia_hessian(&mut self, at: Iterate<'_>, sink: &mut dyn BlockSink) {
        self.inertia.add_hessian(at, HessianPart::Full, sink);
    }

    /// Sets the gradient of the incremental potential.
    pub(crate) fn set_gradient(&mut self, at: Iterate<'_>, h: f64, out: &mut [f64]) {
        out.fill(0.0);
        for (term, scale) in self.weighted(h) {
            term.add_gradient(at, scale, out);
        }
    }

    /// Adds the forces that the terms leave to be balanced, `dPhi/dx / h^2`, newtons.
    pub(crate) fn add_unbalanced(&mut self, at: Iterate<'_>, h: f64, out: &mut [f64]) {
        self.inertia.add_gradient(at, 1.0 / (h * h), out);
        for term in self.terms() {
            term.add_gradient(at, 1.0, out);
        }
    }

    /// Adds the change of the gradient by the rest of the prescribed motions, `rest` being that of the pins
    /// (`3V`, metres), to first order.
    pub(crate) fn add_drive(&mut self, at: Iterate<'_>, h: f64, rest: &[f64], out: &mut [f64]) {
        let model = Arc::clone(&self.model);
        for (term, scale) in self.weighted(h) {
            let mut product = HessianProduct {
                edges: model.edges().edges(),
                scale,
                vector: rest,
                product: out,
            };
            term.add_drive(at, &mut product);
        }
    }

    /// Makes room for what the terms couple.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] if memory runs out.
    pub(crate) fn make_room(
        &mut self,
        at: Iterate<'_>,
        matrix: &mut PrimalMatrix,
    ) -> Result<(), LinalgError> {
        let mut pairs = std::mem::take(&mut self.couplings);
        pairs.clear();
        for term in self.terms() {
            term.append_couplings(at, &mut pairs);
        }
        let done = matrix.make_room(&self.model, &mut pairs);
        self.couplings = pairs;
        done
    }

    /// Adds the Hessian of the incremental potential; call [`Objective::make_room`] before.
    pub(crate) fn add_hessian(
        &mut self,
        at: Iterate<'_>,
        h: f64,
        part: HessianPart,
        matrix: &mut PrimalMatrix,
    ) {
        let model = Arc::clone(&self.model);
        for (term, scale) in self.weighted(h) {
            term.add_hessian(at, part, &mut matrix.scaled_sink(&model, scale));
        }
    }

    /// Adds `scale` times the gradient of the barriers.
    pub(crate) fn add_barrier_gradient(&mut self, at: Iterate<'_>, scale: f64, out: &mut [f64]) {
        for term in self.barriers() {
            term.add_gradient(at, scale, out);
        }
    }

    /// Adds `scale` times a part of the Hessian of the barriers.
    pub(crate) fn add_barrier_hessian(
        &mut self,
        at: Iterate<'_>,
        scale: f64,
        part: HessianPart,
        matrix: &mut PrimalMatrix,
    ) {
        let model = Arc::clone(&self.model);
        for term in self.barriers() {
            term.add_hessian(at, part, &mut matrix.scaled_sink(&model, scale));
        }
    }

    /// Largest part of a displacement that all terms allow, and what cut it; see [`Term::safe_part`].
    pub(crate) fn safe_part(&mut self, at: Iterate<'_>, dx: &[f64]) -> (f64, Option<Barrier>) {
        let Self { acting, others, .. } = self;
        let part = |term: &mut dyn Term| {
            let barrier = term.barrier();
            (barrier.map_or(1.0, |_| term.safe_part(at, dx)), barrier)
        };
        let whole = (1.0, None);
        let of_others = |others: &mut Vec<Box<dyn Term>>| {
            let parts = others.iter_mut().map(|term| part(&mut **term));
            parts.fold(whole, shorter)
        };
        let (further, own) = match others.iter().any(|term| term.barrier().is_some()) {
            false => (whole, part(acting)),
            true => both(|| of_others(others), || part(acting)),
        };
        shorter(shorter(whole, own), further)
    }

    /// Largest part of the chord of a curved way that is allowed but for limits of the strain, which are
    /// checked at its end, see [`Objective::stays_within`].
    pub(crate) fn safe_chord(&mut self, at: Iterate<'_>, dx: &[f64]) -> f64 {
        self.barriers()
            .filter(|term| term.barrier().is_some_and(Barrier::holds_on_the_way))
            .map(|term| term.safe_part(at, dx))
            .fold(1.0, f64::min)
    }

    /// Whether positions `end` are within all limits.
    pub(crate) fn stays_within(&mut self, at: Iterate<'_>, end: &[f64]) -> bool {
        self.terms().all(|term| term.stays_within(at, end))
    }

    /// Adds the forces of all corrections of second order; whether there are any.
    pub(crate) fn add_correction(
        &mut self,
        at: Iterate<'_>,
        dx: &[f64],
        scale: f64,
        out: &mut [f64],
    ) -> bool {
        self.barriers().fold(false, |any, term| {
            any | term.add_correction(at, dx, scale, out)
        })
    }

    /// Adds what displacements of second order take back; whether there is any.
    pub(crate) fn add_second_order(
        &mut self,
        at: Iterate<'_>,
        dx: &[f64],
        scale: f64,
        out: &mut [f64],
    ) -> bool {
        self.terms().fold(false, |any, term| {
            any | term.add_second_order(at, dx, scale, out)
        })
    }

    /// How far prescribed motions of terms have gone on, from 0 to 1.
    pub(crate) fn progress(&mut self) -> f64 {
        self.terms().map(|term| term.progress()).fold(1.0, f64::min)
    }

    /// Goes on by a part of the rest of these motions.
    pub(crate) fn advance(&mut self, part: f64) {
        self.terms().for_each(|term| term.advance(part));
    }

    /// Brings what lags to the iterate; whether it had not settled.
    pub(crate) fn renew(&mut self, at: Iterate<'_>, settled: Lagging) -> bool {
        self.terms()
            .fold(false, |any, term| any | term.renew(at, settled))
    }

    /// Number of contacts that are active.
    pub(crate) fn contact_count(&mut self) -> usize {
        self.terms().map(|term| term.contact_count()).sum()
    }

    /// Sum of the magnitudes of the components of the conservative forces of potentials at the last gradient,
    /// newtons.
    pub(crate) fn force_sum(&self) -> f64 {
        self.acting.force_sum()
    }

    /// What all terms did in a step that ends at an iterate.
    ///
    /// # Errors
    /// [`StepError`].
    pub(crate) fn finish(
        &mut self,
        step: &StepStart<'_>,
        at: Iterate<'_>,
    ) -> Result<Exchange, StepError> {
        let mut sum = Exchange::default();
        for term in self.terms() {
            sum.add(term.finish(step, at)?);
        }
        Ok(sum)
    }
}

/// Whether a term is of a type.
fn is<T: Term>(term: &dyn Term) -> bool {
    (term as &dyn Any).is::<T>()
}

/// The shorter of two parts of a displacement, with what cut it, the second one of equal ones.
fn shorter(a: (f64, Option<Barrier>), b: (f64, Option<Barrier>)) -> (f64, Option<Barrier>) {
    match b.0 < 1.0 && b.0 <= a.0 {
        true => b,
        false => a,
    }
}
