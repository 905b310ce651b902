//! What a potential computes of each of its parts where it is evaluated.

use crate::potential::At;
use isosheet_linalg::parallel::{Work, fill};
use std::sync::Mutex;

/// Working memory that one caller at a time reuses; another one gets memory of its own, and so does a thread
/// that takes up other work while it waits for the rest of its own.
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

/// The parts of a potential, such as faces, where it was evaluated last: its energy, gradient and Hessian at
/// one place have most of what they compute in common. What changes the potential itself has to begin with a
/// new one.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What is kept belongs to time, positions and memory, and a caller within another one gets memory of its
    /// own.
    #[test]
    fn parts_are_those_of_the_place() {
        let evaluation = Evaluation::default();
        let work = Work {
            count: 3,
            each: 1.0,
        };
        let ask = |at: At<'_>| {
            let part = |k: usize| at.t + at.x[k] + at.memory.iter().sum::<f64>();
            evaluation.at(at, work, part, <[f64]>::to_vec)
        };
        let (x, y) = ([0.0, 1.0, 2.0], [5.0; 3]);
        for _ in 0..2 {
            assert_eq!(ask(At::new(0.0, &x)), [0.0, 1.0, 2.0]);
            assert_eq!(ask(At::new(10.0, &x)), [10.0, 11.0, 12.0]);
            assert_eq!(ask(At::new(10.0, &y)), [15.0; 3]);
            let with_memory = At::new(10.0, &y).with_memory(&[100.0]);
            assert_eq!(ask(with_memory), [115.0; 3]);
        }
        let at = At::new(0.0, &x);
        let inner = evaluation.at(at, work, |k| k as f64, |_| ask(At::new(0.0, &y)));
        assert_eq!(inner, [5.0; 3]);
        assert_eq!(ask(at), [0.0, 1.0, 2.0]);
    }

    #[test]
    fn parts_are_computed_once() {
        let evaluation = Evaluation::default();
        let work = Work {
            count: 1,
            each: 1.0,
        };
        let at = At::new(0.0, &[1.0]);
        let first = evaluation.at(at, work, |_| 1.0, |parts| parts[0]);
        let again = evaluation.at(at, work, |_| 2.0, |parts| parts[0]);
        let of_clone = evaluation.clone().at(at, work, |_| 3.0, |parts| parts[0]);
        assert_eq!([first, again, of_clone], [1.0, 1.0, 3.0]);
    }
}
