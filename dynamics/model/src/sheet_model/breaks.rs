//! Times at which what is prescribed changes abruptly.

/// Part of a step within which a break counts as one of its ends: the force that comes so much too early or
/// too late gives a momentum far below the error of the step.
const AT_AN_END: f64 = 1e-6;

/// When what is prescribed changes abruptly.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Breaks {
    /// Seconds, in order.
    times: Vec<f64>,
}

impl Breaks {
    /// At these times too, in any order.
    pub fn and(self, times: impl IntoIterator<Item = f64>) -> Self {
        Self::at(self.times.into_iter().chain(times))
    }

    /// At these times, in any order.
    pub fn at(times: impl IntoIterator<Item = f64>) -> Self {
        let mut times: Vec<f64> = times.into_iter().filter(|t| t.is_finite()).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        Self { times }
    }

    /// Where what is left of a step of `h` seconds begins, from its first time to its last one, and the break
    /// within it at which its first part ends.
    pub fn within(&self, [t, end]: [f64; 2], h: f64) -> (Start, Option<f64>) {
        let near = AT_AN_END * h;
        let first = self.times.partition_point(|b| *b < t - near);
        let counts = |k: &usize| *k == 0 || self.times[*k] - self.times[*k - 1] > h;
        let mut those = (first..self.times.len())
            .take_while(|k| self.times[*k] < end - near)
            .filter(counts)
            .map(|k| self.times[k])
            .peekable();
        let start = match those.next_if(|b| *b <= t + near) {
            Some(_) => Start::AtBreak,
            None => Start::Between,
        };
        (start, those.next())
    }
}

/// Where a step begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// Where something changes abruptly.
    AtBreak,
    /// Where nothing does.
    Between,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_ends_at_breaks_that_it_resolves() {
        let breaks = Breaks::at([f64::NAN, 0.75, 0.25, 0.25, 0.3, 0.35, 0.5]);
        for (t, h, expected) in [
            (0.0, 0.2, (Start::Between, None)),
            (0.2, 0.2, (Start::Between, Some(0.25))),
            // Within 0.2 s of the one before.
            (0.25, 0.2, (Start::AtBreak, None)),
            (0.28, 0.04, (Start::Between, Some(0.3))),
            (0.45, 0.1, (Start::Between, Some(0.5))),
            (0.65, 0.1, (Start::Between, None)),
            (0.75 - 1e-9, 0.1, (Start::AtBreak, None)),
            (0.75 + 1e-9, 0.1, (Start::AtBreak, None)),
            (0.8, 0.1, (Start::Between, None)),
        ] {
            assert_eq!(breaks.within([t, t + h], h), expected, "{t} {h}");
        }
    }
}
