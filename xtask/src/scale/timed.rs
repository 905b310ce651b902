//! A stop-watch around contact.

use isosheet_dynamics::contact::{
    BodyLoad, Contact, ContactError, ContactPoint, ContactWork, CouplingSink,
};
use isosheet_dynamics::{SheetModel, State};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Seconds spent in contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spent {
    /// Looking for pairs within reach and for the safe part of motions: broad phase and continuous collision detection.
    pub(super) detection: f64,
    /// Energies, gradients and Hessians, distances and assembly included.
    pub(super) evaluation: f64,
}

impl Spent {
    pub(super) fn since(&self, before: Self) -> Self {
        Self {
            detection: self.detection - before.detection,
            evaluation: self.evaluation - before.evaluation,
        }
    }
}

/// Nanoseconds, read while the simulation owns the contact.
#[derive(Debug, Default)]
pub(super) struct Watch {
    detection: AtomicU64,
    evaluation: AtomicU64,
}

impl Watch {
    pub(super) fn read(&self) -> Spent {
        let seconds = |n: &AtomicU64| 1e-9 * n.load(Ordering::Relaxed) as f64;
        Spent {
            detection: seconds(&self.detection),
            evaluation: seconds(&self.evaluation),
        }
    }
}

fn book<T>(on: &AtomicU64, work: impl FnOnce() -> T) -> T {
    let clock = Instant::now();
    let result = work();
    // A run of 500 years would not fit.
    on.fetch_add(clock.elapsed().as_nanos() as u64, Ordering::Relaxed);
    result
}

/// Contact that books the time it takes.
#[derive(Debug)]
pub(super) struct Timed<C> {
    inner: C,
    watch: Arc<Watch>,
}

impl<C> Timed<C> {
    pub(super) fn new(inner: C) -> (Self, Arc<Watch>) {
        let watch = Arc::<Watch>::default();
        let timed = Self {
            inner,
            watch: Arc::clone(&watch),
        };
        (timed, watch)
    }

    fn evaluate<T>(&self, work: impl FnOnce(&C) -> T) -> T {
        book(&self.watch.evaluation, || work(&self.inner))
    }
}

impl<C: Contact> Contact for Timed<C> {
    fn begin(&mut self, t0: f64, h: f64, x0: &[f64]) {
        book(&self.watch.detection, || self.inner.begin(t0, h, x0));
    }

    fn progress(&self) -> f64 {
        self.inner.progress()
    }

    fn safe_fraction(&mut self, x: &[f64], dx: &[f64]) -> f64 {
        book(&self.watch.detection, || self.inner.safe_fraction(x, dx))
    }

    fn advance(&mut self, fraction: f64) {
        self.inner.advance(fraction);
    }

    fn energy(&self, x: &[f64]) -> f64 {
        self.evaluate(|c| c.energy(x))
    }

    fn add_gradient(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        self.evaluate(|c| c.add_gradient(x, scale, out));
    }

    fn add_drive(&self, x: &[f64], scale: f64, out: &mut [f64]) {
        self.evaluate(|c| c.add_drive(x, scale, out));
    }

    fn add_hessian(&self, x: &[f64], sink: &mut dyn CouplingSink) {
        self.evaluate(|c| c.add_hessian(x, sink));
    }

    fn couplings(&self, x: &[f64], out: &mut Vec<[u32; 2]>) {
        self.evaluate(|c| c.couplings(x, out));
    }

    fn relag(&mut self, x: &[f64]) -> f64 {
        book(&self.watch.evaluation, || self.inner.relag(x))
    }

    fn finish(&mut self, x1: &[f64]) -> ContactWork {
        book(&self.watch.evaluation, || self.inner.finish(x1))
    }

    fn potential(&self, x: &[f64]) -> f64 {
        self.evaluate(|c| c.potential(x))
    }

    fn gap(&self, x: &[f64]) -> f64 {
        self.evaluate(|c| c.gap(x))
    }

    fn loads(&self, x: &[f64]) -> Vec<BodyLoad> {
        self.evaluate(|c| c.loads(x))
    }

    fn activation(&self) -> f64 {
        self.inner.activation()
    }

    fn contact_points(&self, x: &[f64], out: &mut Vec<ContactPoint>) {
        self.evaluate(|c| c.contact_points(x, out));
    }

    fn check_start(&mut self, model: &SheetModel, state: &State) -> Result<(), ContactError> {
        book(&self.watch.detection, || {
            self.inner.check_start(model, state)
        })
    }
}
