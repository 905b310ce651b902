//! How far a motion is safe, as pairs are looked at side by side.

use isosheet_linalg::parallel::{Work, in_order};
use std::sync::atomic::{AtomicU64, Ordering};

/// Nanoseconds for a pair that may come near, estimated: it decides what is shared among threads, and no
/// result.
const PAIR_TIME: f64 = 40.0;

/// The part of a motion, from 0 to 1, that all pairs looked at so far allow: the smallest of what each of
/// them allows, in whatever order they are.
#[derive(Debug)]
pub(super) struct Limit(AtomicU64);

impl Limit {
    pub(super) fn new(part: f64) -> Self {
        Self(AtomicU64::new(part.to_bits()))
    }

    pub(super) fn part(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    /// Shortens it to a part that `of_pair` finds, up to the one that is given.
    pub(super) fn shorten(&self, of_pair: impl FnOnce(f64) -> f64) {
        // Numbers that are not negative are in the order of their bits.
        let part = of_pair(self.part()).max(0.0);
        self.0.fetch_min(part.to_bits(), Ordering::Relaxed);
    }
}

/// Hands the candidates that are near to `take`, in their order; `near` is room for what is found.
pub(super) fn for_each_near<T: Copy + Sync>(
    candidates: &[T],
    near: &mut Vec<bool>,
    is_near: impl Fn(T) -> bool + Sync,
    mut take: impl FnMut(T),
) {
    let (count, each) = (candidates.len(), PAIR_TIME);
    let is_near = |k: usize| is_near(candidates[k]);
    in_order(near, Work { count, each }, is_near, |k, is_near| {
        if *is_near {
            take(candidates[k]);
        }
    });
}
