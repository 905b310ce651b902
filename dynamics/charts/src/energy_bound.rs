//! The adaptive step of the paper (Sec. 4.2).

use super::ChartStepControl;

/// Part of the step that the bound would allow which is taken: the change of the Hamiltonian is known at one
/// step length only.
const SAFETY: f64 = 0.9;
/// Bounds of the factor by which a refused step is shortened.
const SHORTENING: (f64, f64) = (0.1, 0.9);
/// The factor where a step fails altogether, and its change is not known.
const SHORTENING_AFTER_FAILURE: f64 = 0.25;
/// Largest factor by which the next step is longer than one that was accepted.
const GROWTH: f64 = 2.0;

/// The step control of Sec. 4.2: the largest step that changes the Hamiltonian by less than a tolerance
/// `eps`.
///
/// The terms that the scheme (20) leaves out of the Taylor series (23) are bounded by a multiple of `h^2`
/// (24), so that a step is "inversely proportional to the square root of the change of Hamiltonian": a step
/// `h` that changes `H` by `dH` allows one of `h sqrt(eps / |dH|)`. With [`ChartStepControl::Fixed`] every
/// step is accepted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EnergyBound {
    control: ChartStepControl,
    planned: f64,
}

/// What the bound says of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Verdict {
    /// The step is within the bound.
    Accept,
    /// It is not: try one of this length, seconds.
    Shorten(f64),
    /// It is not, and may not be shorter.
    TooSmall,
}

impl EnergyBound {
    /// With the step that is planned next, seconds.
    pub(super) fn new(control: ChartStepControl, planned: f64) -> Self {
        Self { control, planned }
    }

    /// The step that is planned next, seconds.
    pub(super) fn planned(&self) -> f64 {
        self.planned
    }

    pub(super) fn control(&self) -> ChartStepControl {
        self.control
    }

    /// Judges a step of `h` seconds that changes the Hamiltonian by `change` (joules, absolute value); NaN if
    /// the step itself failed.
    pub(super) fn judge(&self, h: f64, change: f64) -> Verdict {
        match self.control {
            ChartStepControl::Fixed(_) if change.is_nan() => Verdict::TooSmall,
            ChartStepControl::Fixed(_) => Verdict::Accept,
            ChartStepControl::Adaptive { tolerance, .. } if change < tolerance => Verdict::Accept,
            ChartStepControl::Adaptive { min, .. } if h <= min => Verdict::TooSmall,
            ChartStepControl::Adaptive { tolerance, min, .. } => {
                let factor = SAFETY * (tolerance / change).sqrt();
                let factor = if factor.is_nan() {
                    SHORTENING_AFTER_FAILURE
                } else {
                    factor
                };
                let factor = factor.clamp(SHORTENING.0, SHORTENING.1);
                Verdict::Shorten((h * factor).max(min))
            }
        }
    }

    /// The step to plan after an accepted one of `h` seconds that changed the Hamiltonian by `change`.
    pub(super) fn next(&self, h: f64, change: f64) -> f64 {
        match self.control {
            ChartStepControl::Fixed(h) => h,
            ChartStepControl::Adaptive { tolerance, max, .. } => {
                let growth = SAFETY * (tolerance / change).sqrt();
                (h * growth.clamp(1.0, GROWTH)).min(max)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scheme whose change of the Hamiltonian is `h^2` joules: Eq. 24 with equality.
    #[test]
    fn steps_settle_at_the_root_of_the_tolerance() {
        let control = ChartStepControl::Adaptive {
            tolerance: 1e-6,
            min: 1e-9,
            max: 1.0,
        };
        let mut planned = 1.0;
        for _ in 0..40 {
            let bound = EnergyBound::new(control, planned);
            let mut h = bound.planned();
            let h = loop {
                match bound.judge(h, h * h) {
                    Verdict::Accept => break h,
                    Verdict::Shorten(shorter) => h = shorter,
                    Verdict::TooSmall => panic!("a step of {h} is not too small"),
                }
            };
            assert!(h * h < 1e-6);
            planned = bound.next(h, h * h);
        }
        // The goal of each step is nine tenths of the bound.
        assert!((0.9e-3..1e-3).contains(&planned), "{planned}");
    }

    #[test]
    fn failed_steps_are_quartered_down_to_the_smallest() {
        let control = ChartStepControl::Adaptive {
            tolerance: 1e-6,
            min: 0.1,
            max: 1.0,
        };
        let bound = EnergyBound::new(control, 1.0);
        assert_eq!(bound.judge(1.0, f64::NAN), Verdict::Shorten(0.25));
        assert_eq!(bound.judge(0.25, f64::NAN), Verdict::Shorten(0.1));
        assert_eq!(bound.judge(0.1, f64::NAN), Verdict::TooSmall);
        let fixed = EnergyBound::new(ChartStepControl::Fixed(0.5), 0.5);
        assert_eq!(fixed.judge(0.5, 1e9), Verdict::Accept);
        assert_eq!(fixed.judge(0.5, f64::NAN), Verdict::TooSmall);
        assert_eq!(fixed.next(0.2, 1.0), 0.5);
    }
}
