//! Lists whose entries are computed on the threads of rayon's current pool.
//!
//! Every entry is computed on its own, so that results are the same for any number of threads.

mod awake;

pub use awake::Awake;
use rayon::prelude::*;

/// Time of one thread, in nanoseconds, from which work is shared. To wake a thread that sleeps takes 0.1 ms:
/// two threads need as long as one for what takes one thread 0.2 ms, and three quarters of the time for 0.4
/// ms.
const WORTH_SHARING: f64 = 3e5;

/// Time of one thread, in nanoseconds, from which work is shared where the other threads are awake, and take
/// up work within some microseconds.
const WORTH_SHARING_AWAKE: f64 = 3e4;

/// Time of the smallest pieces that threads take from each other, nanoseconds. Each costs some hundred
/// nanoseconds.
const PIECE: f64 = 1e4;

/// How many entries are computed, and how long each takes.
#[derive(Debug, Clone, Copy)]
pub struct Work {
    /// Number of entries.
    pub count: usize,
    /// Time of one thread for an entry, nanoseconds, from measurements.
    pub each: f64,
}

impl Work {
    /// Whether it takes less time on several threads than on one, and this is one of the threads of a pool.
    /// (Any other thread would sleep until the threads of the pool are done, and have to be woken, too.)
    pub fn is_shared(self) -> bool {
        let time = self.count as f64 * self.each;
        time >= WORTH_SHARING_AWAKE
            && (time >= WORTH_SHARING || Awake::is_held())
            && rayon::current_thread_index().is_some()
            && rayon::current_num_threads() > 1
    }

    /// Entries of a piece.
    fn piece(self) -> usize {
        (PIECE / self.each).ceil() as usize
    }
}

/// Makes `list` that of the entries `entry(0)`, `entry(1)` and so on. Allocates no memory where the list has
/// had as many entries before.
pub fn fill<T: Send>(list: &mut Vec<T>, work: Work, entry: impl Fn(usize) -> T + Sync) {
    if work.is_shared() {
        let entries = (0..work.count).into_par_iter().with_min_len(work.piece());
        entries.map(&entry).collect_into_vec(list);
    } else {
        list.clear();
        list.extend((0..work.count).map(entry));
    }
}

/// Hands the entries `entry(0)`, `entry(1)` and so on to `take` in this order; `room` holds them where they
/// are computed on several threads.
pub fn in_order<T: Send>(
    room: &mut Vec<T>,
    work: Work,
    entry: impl Fn(usize) -> T + Sync,
    mut take: impl FnMut(usize, &T),
) {
    if work.is_shared() {
        fill(room, work, entry);
        room.iter()
            .enumerate()
            .for_each(|(k, value)| take(k, value));
    } else {
        (0..work.count).for_each(|k| take(k, &entry(k)));
    }
}

/// Cuts a list into a piece for each thread, and hands each to `change` with the number of its first entry.
/// Where pieces begin and end must not matter to what becomes of the entries.
pub fn pieces<T: Send>(list: &mut [T], each: f64, change: impl Fn(usize, &mut [T]) + Sync) {
    let count = list.len();
    if !(Work { count, each }).is_shared() {
        return change(0, list);
    }
    let size = count.div_ceil(rayon::current_num_threads());
    let pieces = list.par_chunks_mut(size).enumerate();
    pieces.for_each(|(k, piece)| change(k * size, piece));
}

/// Does two things, side by side where the other threads are [awake](Awake).
pub fn both<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    match Awake::is_held() {
        true => rayon::join(first, second),
        false => (first(), second()),
    }
}

#[cfg(test)]
mod tests;
