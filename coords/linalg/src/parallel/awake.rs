//! Threads that wait for work without falling asleep.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Keeps the other threads of rayon's current pool awake for as long as it lives, if this one belongs to a
/// pool.
///
/// A thread without work falls asleep within some 20 microseconds, and to wake it takes 0.1 ms: much of the
/// time that the pieces of an iteration take. Threads that stay awake look for work, and let other programs
/// run where there is none for longer; they use processor time. A thread that keeps others awake itself, as
/// in ensembles of runs, does not stay awake for anyone else.
#[derive(Debug)]
pub struct Awake {
    /// Nothing where the thread has kept others awake before.
    held: Option<Arc<Watch>>,
}

/// How often a thread looks for work before it lets other programs run: for about the 0.1 ms that it takes to
/// wake a thread, as most pauses between the pieces of an iteration are not longer. (A program that is let
/// run may keep the core for milliseconds.)
const PATIENCE: usize = 1000;

/// What a thread asks of others.
#[derive(Debug, Default)]
struct Watch {
    is_held: AtomicBool,
    /// Threads that stay awake, and jobs that will have one stay.
    staying: AtomicUsize,
}

thread_local! {
    static OWN: Arc<Watch> = Arc::default();
}

impl Awake {
    /// From now on.
    pub fn new() -> Self {
        let Some(_) = rayon::current_thread_index() else {
            return Self { held: None };
        };
        let own = OWN.with(Arc::clone);
        if own.is_held.swap(true, Ordering::Relaxed) {
            return Self { held: None };
        }
        // (Jobs that no other thread had time for wait for the next time.)
        for _ in own.staying.load(Ordering::Relaxed)..rayon::current_num_threads() - 1 {
            own.staying.fetch_add(1, Ordering::Relaxed);
            let watch = Arc::clone(&own);
            rayon::spawn(move || watch.stay());
        }
        Self { held: Some(own) }
    }

    /// Whether this thread keeps others awake.
    pub fn is_held() -> bool {
        OWN.with(|own| own.is_held.load(Ordering::Relaxed))
    }
}

impl Default for Awake {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Awake {
    fn drop(&mut self) {
        if let Some(own) = &self.held {
            own.is_held.store(false, Ordering::Relaxed);
        }
    }
}

impl Watch {
    /// Does work of the pool for as long as others are to be awake.
    fn stay(&self) {
        let mut idle = 0;
        while self.is_held.load(Ordering::Relaxed) && !Awake::is_held() {
            idle = match rayon::yield_now() {
                Some(rayon::Yield::Executed) => 0,
                _ => idle + 1,
            };
            match idle < PATIENCE {
                true => std::hint::spin_loop(),
                false => std::thread::yield_now(),
            }
        }
        self.staying.fetch_sub(1, Ordering::Relaxed);
    }
}
