//! Lengths of the sub-steps of a step: halves of halves, on a binary grid that ends at the step exactly.

/// Sub-steps `h / 2^k` of a step of `h` seconds.
#[derive(Debug, Clone)]
pub(crate) struct Subdivision {
    start: f64,
    h: f64,
    /// Length of the next sub-step, as a fraction of the step.
    fraction: f64,
    /// Fraction of the step that is done.
    done: f64,
    patience: usize,
    /// Sub-steps accepted after a refusal before a longer one is tried.
    most_patience: usize,
    /// Largest sub-step, as a fraction of the step.
    largest: f64,
}

impl Subdivision {
    /// Of a step of `h` seconds from the time `start`.
    pub(crate) fn new(start: f64, h: f64, patience: usize) -> Self {
        Self {
            start,
            h,
            fraction: 1.0,
            done: 0.0,
            patience: 0,
            most_patience: patience,
            largest: 1.0,
        }
    }

    /// Makes no sub-step longer than `length` seconds from now on, if there is one as short as that on the
    /// grid.
    pub(crate) fn limit(&mut self, length: f64) {
        // Lengths that were sub-steps of another step differ by round-off.
        let mut largest = 1.0;
        while largest * self.h > length * (1.0 + 1e-9) && largest > f64::MIN_POSITIVE {
            largest *= 0.5;
        }
        self.largest = largest;
        self.fraction = self.fraction.min(largest);
    }

    pub(crate) fn is_finished(&self) -> bool {
        self.done >= 1.0
    }

    /// Length of the next sub-step, seconds.
    pub(crate) fn length(&self) -> f64 {
        self.fraction * self.h
    }

    /// Length of a fraction of the step, seconds.
    pub(crate) fn part(&self, fraction: f64) -> f64 {
        fraction * self.h
    }

    /// Time at the end of the step, seconds.
    pub(crate) fn end(&self) -> f64 {
        self.start + self.h
    }

    /// Whether the sub-step is the whole step.
    pub(crate) fn is_whole(&self) -> bool {
        self.fraction == 1.0
    }

    /// Whether halves of the sub-step are parts of the step of at least `smallest`.
    pub(crate) fn can_halve(&self, smallest: f64) -> bool {
        0.5 * self.fraction >= smallest
    }

    /// Halves the next sub-step and returns its length; nothing if it would be shorter than the fraction
    /// `smallest` of the step.
    pub(crate) fn halve(&mut self, smallest: f64) -> Option<f64> {
        if !self.can_halve(smallest) {
            return None;
        }
        self.fraction *= 0.5;
        self.patience = self.most_patience;
        Some(self.length())
    }

    /// Makes the next sub-step as long as the grid allows and returns its length.
    pub(crate) fn lengthen(&mut self) -> f64 {
        self.fraction = self.longest();
        self.length()
    }

    /// Takes the sub-step as done; returns the time reached, free of accumulated round-off.
    pub(crate) fn advance(&mut self) -> f64 {
        self.done += self.fraction;
        self.patience = self.patience.saturating_sub(1);
        let growth = if self.patience == 0 { 2.0 } else { 1.0 };
        self.fraction = self.longest().min(growth * self.fraction).min(self.largest);
        self.start + self.done * self.h
    }

    /// The largest sub-step `2^-k` that may start after the fraction that is done.
    fn longest(&self) -> f64 {
        let mut fraction = 1.0;
        while (self.done / fraction).fract() != 0.0 {
            fraction *= 0.5;
        }
        fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sub_steps_end_at_the_step() {
        let mut steps = Subdivision::new(1.0, 0.3, 4);
        let mut refusals = 0;
        let (mut t, mut count) = (1.0, 0_usize);
        while !steps.is_finished() {
            // The first sub-step is refused three times, the third one once.
            let refused = [3, 0, 1].get(count).copied().unwrap_or(0);
            for _ in 0..refused {
                assert!(steps.halve(1.0 / 64.0).is_some());
                refusals += 1;
            }
            let length = steps.length();
            let end = steps.advance();
            assert!((end - t - length).abs() < 1e-15, "{end} {t} {length}");
            t = end;
            count += 1;
        }
        assert_eq!((t, steps.end()), (1.3, 1.3));
        assert!(refusals == 4 && count > 5);
    }

    #[test]
    fn a_limit_holds_until_it_is_lifted() {
        let mut steps = Subdivision::new(0.0, 0.3, 4);
        // The length of a sub-step of another step, with its round-off.
        steps.limit(0.6 / 8.0);
        assert_eq!(steps.length(), 0.075);
        steps.advance();
        steps.limit(0.14);
        assert_eq!((steps.length(), steps.advance()), (0.075, 0.15));
        steps.limit(0.16);
        assert_eq!(steps.length(), 0.075);
        steps.advance();
        assert_eq!((steps.length(), steps.advance()), (0.075, 0.3));
        assert!(steps.is_finished());
    }

    #[test]
    fn halving_ends() {
        let mut steps = Subdivision::new(0.0, 1.0, 4);
        assert!(!steps.can_halve(1.0) && steps.can_halve(0.5) && steps.is_whole());
        assert_eq!(steps.halve(1.0), None);
        assert!(steps.is_whole());
        assert_eq!(steps.halve(0.25), Some(0.5));
        assert!(!steps.is_whole() && steps.can_halve(0.25));
        assert_eq!(steps.halve(0.25), Some(0.25));
        assert_eq!(steps.halve(0.25), None);
        assert_eq!(steps.advance(), 0.25);
        assert_eq!(steps.length(), 0.25);
    }
}
