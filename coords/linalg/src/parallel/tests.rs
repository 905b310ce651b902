use super::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// As much as is shared, and as little as is not.
const WORKS: [Work; 3] = [
    Work {
        count: 10_001,
        each: 100.0,
    },
    Work {
        count: 1001,
        each: 100.0,
    },
    Work {
        count: 0,
        each: 1.0,
    },
];

#[test]
fn lists_are_the_same_on_any_number_of_threads() {
    for Work { count, each } in WORKS {
        let expected: Vec<f64> = (0..count).map(|k| (k as f64).sin()).collect();
        for threads in [1, 2, 3, 5] {
            let (filled, ordered, cut) = on_threads(threads, || {
                let _awake = Awake::new();
                let entry = |k: usize| (k as f64).sin();
                let work = Work { count, each };
                let mut filled = vec![7.0; 3];
                fill(&mut filled, work, entry);
                let (mut room, mut ordered) = (Vec::new(), Vec::new());
                in_order(&mut room, work, entry, |k, value| {
                    assert_eq!(k, ordered.len());
                    ordered.push(*value);
                });
                let mut cut = vec![0.0; count];
                pieces(&mut cut, each, |first, piece| {
                    for (k, value) in piece.iter_mut().enumerate() {
                        *value += entry(first + k);
                    }
                });
                (filled, ordered, cut)
            });
            for list in [filled, ordered, cut] {
                assert!(list == expected, "{count} on {threads}");
            }
        }
    }
}

#[test]
fn work_is_shared_where_it_is_long_and_the_thread_belongs_to_a_pool() {
    let [long, short, _] = WORKS;
    assert!(!long.is_shared(), "no pool");
    assert!(!on_threads(1, || long.is_shared()));
    assert!(on_threads(2, || long.is_shared() && !short.is_shared()));
    let awake = |work: Work| {
        let _awake = Awake::new();
        work.is_shared()
    };
    assert!(on_threads(2, || awake(short) && !short.is_shared()));
}

/// Waits up to ten seconds.
fn wait_for(flag: &AtomicBool) -> bool {
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(10) {
        if flag.load(Ordering::Relaxed) {
            return true;
        }
        std::thread::yield_now();
    }
    false
}

/// Each of two things waits for the other one.
#[test]
fn two_things_are_done_side_by_side() {
    let met = on_threads(2, || {
        let flags = [AtomicBool::new(false), AtomicBool::new(false)];
        let meet = |own: usize| {
            flags[own].store(true, Ordering::Relaxed);
            wait_for(&flags[1 - own])
        };
        let _awake = Awake::new();
        both(|| meet(0), || meet(1))
    });
    assert_eq!(met, (true, true));
}

/// Threads that stay awake for one that has many steps, and for one within another, take up other work and go
/// to sleep at the end; jobs to stay do not pile up.
#[test]
fn threads_stay_awake_only_as_long_as_they_are_asked_to() {
    let done = on_threads(2, || {
        for _ in 0..1000 {
            let outer = Awake::new();
            drop(Awake::new());
            assert!(Awake::is_held());
            drop(outer);
            assert!(!Awake::is_held());
        }
        let flag = AtomicBool::new(false);
        let set = || flag.store(true, Ordering::Relaxed);
        rayon::join(|| wait_for(&flag), set).0
    });
    assert!(done);
}
