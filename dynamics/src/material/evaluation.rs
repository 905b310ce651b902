//! What a potential computes of each of its parts where it is evaluated.

use crate::potential::At;
use isosheet_coords::linalg::parallel::{Work, fill};
use std::sync::Mutex;

/// Working memory that one caller at a time reuses; another one gets memory of its own, and so does a thread that
/// takes up other work while it waits for the rest of its own.
#[derive(Debug, Default)]
pub(super) struct Room<T>(Mutex<T>);

impl<T: Default> Room<T> {
    pub(super) fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        match self.0.try_lock() {
            Ok(mut room) => work(&mut room),
            Err(_) => work(&mut T::default()),
        }
    }
}

/// A clone has memory of its own.
impl<T: Default> Clone for Room<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The parts of a potential, such as faces, where it was evaluated last: its energy, gradient and Hessian at one place
/// have most of what they compute in common. What changes the potential itself has to begin with a new one.
#[derive(Debug)]
pub(super) struct Evaluation<T>(Room<Last<T>>);

impl<T> Default for Evaluation<T> {
    fn default() -> Self {
        Self(Room::default())
    }
}

/// A clone has not been evaluated.
impl<T> Clone for Evaluation<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The parts at the last place.
#[derive(Debug)]
struct Last<T> {
    t: f64,
    x: Vec<f64>,
    memory: Vec<f64>,
    parts: Vec<T>,
}

impl<T> Default for Last<T> {
    /// Nowhere.
    fn default() -> Self {
        Self {
            t: f64::NAN,
            x: Vec::new(),
            memory: Vec::new(),
            parts: Vec::new(),
        }
    }
}

impl<T> Last<T> {
    fn is_at(&self, at: At<'_>) -> bool {
        self.t == at.t && self.x == at.x && self.memory == at.memory
    }

    fn go_to(&mut self, At { t, x, memory }: At<'_>) {
        self.t = t;
        self.x.clear();
        self.x.extend_from_slice(x);
        self.memory.clear();
        self.memory.extend_from_slice(memory);
    }
}

impl<T: Send> Evaluation<T> {
    /// Hands all parts at a place to `take`; `part` computes one by its number.
    pub(super) fn at<R>(
        &self,
        at: At<'_>,
        work: Work,
        part: impl Fn(usize) -> T + Sync,
        take: impl FnOnce(&[T]) -> R,
    ) -> R {
        self.0.with(|last| {
            if !last.is_at(at) {
                last.go_to(at);
                fill(&mut last.parts, work, part);
            }
            take(&last.parts)
        })
    }
}
