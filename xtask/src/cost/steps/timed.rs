//! A stop-watch around contact.

use cpu_time::ThreadTime;
use isosheet_dynamics::contact::{
    ActiveContact, BodyMotion, BodyPlace, Contact, ContactError, ContactKey, ContactLaws,
    JointMotion, StepSpan,
};
use isosheet_dynamics::{SheetModel, State};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// CPU seconds spent in contact, in simulations on one thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Spent {
    /// Looking for pairs within reach and for the safe part of motions: broad phase and continuous collision
    /// detection.
    pub(super) detection: f64,
    /// Distances, normals and weights of the pairs within reach.
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
    let clock = ThreadTime::now();
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
}

impl<C: Contact> Contact for Timed<C> {
    fn laws(&self) -> &ContactLaws {
        self.inner.laws()
    }

    fn body_motions(&self, span: StepSpan, out: &mut Vec<BodyMotion>) {
        self.inner.body_motions(span, out);
    }

    fn body_velocity(&self, body: u32, t: f64, place: &Vector3<f64>) -> Vector3<f64> {
        self.inner.body_velocity(body, t, place)
    }

    fn query(&mut self, motion: JointMotion<'_>, pairs: &mut Vec<ContactKey>) -> f64 {
        book(&self.watch.detection, || self.inner.query(motion, pairs))
    }

    fn evaluate(
        &self,
        pairs: &[ContactKey],
        x: &[f64],
        bodies: &[BodyPlace],
        out: &mut Vec<ActiveContact>,
    ) {
        book(&self.watch.evaluation, || {
            self.inner.evaluate(pairs, x, bodies, out);
        });
    }

    fn check_start(&mut self, model: &SheetModel, state: &State) -> Result<(), ContactError> {
        book(&self.watch.detection, || {
            self.inner.check_start(model, state)
        })
    }
}
