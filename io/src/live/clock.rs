//! The time of a run beside that on the wall.

use std::collections::VecDeque;

/// Keeps a run from being faster than real time, and measures how fast it is. Times are seconds on the wall
/// from any beginning.
#[derive(Debug)]
pub(super) struct Clock {
    /// When the next step may begin.
    due: f64,
    /// The steps of the last second: when each ended, and by how much it moved the time of the run.
    steps: VecDeque<[f64; 2]>,
}

/// The span of time over which the pace is measured, seconds.
const SPAN: f64 = 1.0;

impl Clock {
    /// Begins to play.
    pub(super) fn start(now: f64) -> Self {
        Self {
            due: now,
            steps: VecDeque::from([[now, 0.0]]),
        }
    }

    /// How long the next step has to wait, seconds.
    pub(super) fn wait(&self, now: f64) -> f64 {
        (self.due - now).max(0.0)
    }

    /// A step of `h` seconds has ended that began at a time. What it was late is made up for by no more than
    /// one step: after a slow one the run does not hurry.
    pub(super) fn stepped(&mut self, h: f64, began: f64, now: f64) {
        self.due = (self.due + h).max(began);
        self.steps.push_back([now, h]);
        while self.steps.len() > 2 && self.steps[1][0] < now - SPAN {
            self.steps.pop_front();
        }
    }

    /// Seconds of the run in a second; nothing before a tenth of the span has passed.
    pub(super) fn pace(&self) -> Option<f64> {
        let (first, last) = (self.steps.front()?, self.steps.back()?);
        let wall = last[0] - first[0];
        let run: f64 = self.steps.iter().skip(1).map(|step| step[1]).sum();
        (wall >= 0.1 * SPAN).then(|| run / wall)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays `count` steps of 0.02 s that take the given times. The ends of all of them.
    fn play(cost: impl Fn(usize) -> f64, count: usize) -> (Clock, Vec<f64>) {
        let (mut clock, mut now, mut ends) = (Clock::start(5.0), 5.0, Vec::new());
        for k in 0..count {
            now += clock.wait(now);
            let began = now;
            now += cost(k);
            clock.stepped(0.02, began, now);
            ends.push(now);
        }
        (clock, ends)
    }

    #[test]
    fn a_fast_run_keeps_pace_with_the_wall() {
        let (clock, ends) = play(|_| 0.003, 500);
        assert!((ends[499] - (5.0 + 499.0 * 0.02 + 0.003)).abs() < 1e-9);
        assert!((clock.pace().unwrap() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_slow_run_is_as_fast_as_it_can_be() {
        let (clock, _) = play(|_| 0.08, 100);
        assert!((clock.pace().unwrap() - 0.25).abs() < 1e-9);
    }

    #[test]
    fn after_a_slow_step_nothing_hurries() {
        let (_, ends) = play(|k| if k == 10 { 3.0 } else { 0.001 }, 60);
        // The next step begins at once and one more is made up for, all others are at least 0.02 s apart.
        assert!(ends[12] - ends[10] < 0.003);
        for k in 14..60 {
            assert!(ends[k] - ends[k - 1] > 0.02 - 1e-9, "step {k}");
        }
    }

    #[test]
    fn steps_longer_than_the_span_have_a_pace() {
        let (clock, _) = play(|_| 4.0, 5);
        assert!((clock.pace().unwrap() - 0.005).abs() < 1e-9);
        assert_eq!(Clock::start(0.0).pace(), None);
    }
}
