//! Bisection for the value from which on a scene behaves otherwise.

use crate::runs::Course;
use anyhow::Result;
use serde::{Deserialize, Serialize};

/// What a scene does at a value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Verdict {
    /// The value is below the critical one.
    Below,
    /// The value is above the critical one.
    Above,
    /// The run did not say: how it ended.
    Undecided(String),
}

/// Where the critical value lies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Bracket {
    /// The largest value known to be below.
    pub(super) below: Option<f64>,
    /// The smallest value known to be above.
    pub(super) above: Option<f64>,
    /// Why the bisection ended early; empty if it did not.
    pub(super) undecided: String,
}

impl Bracket {
    /// The critical value: the geometric mean of both bounds. Nothing where a bound is missing or the
    /// bisection ended early.
    pub(super) fn middle(&self) -> Option<f64> {
        let middle = (self.below? * self.above?).sqrt();
        self.undecided.is_empty().then_some(middle)
    }
}

/// Halves the interval of logarithms so many times, or until a scene is undecided. The ends of the interval
/// themselves are not tried. `probe` says what the scene does at a value, and how its run went; the worst of
/// all runs is returned as well.
pub(super) fn search(
    [mut low, mut high]: [f64; 2],
    halvings: usize,
    mut probe: impl FnMut(f64) -> Result<(Verdict, Course)>,
) -> Result<(Course, Bracket)> {
    let (mut worst, mut bracket) = (Course::default(), Bracket::default());
    for _ in 0..halvings {
        let middle = (low * high).sqrt();
        let (verdict, run) = probe(middle)?;
        worst.add_run(run);
        match verdict {
            Verdict::Below => {
                low = middle;
                bracket.below = Some(middle);
            }
            Verdict::Above => {
                high = middle;
                bracket.above = Some(middle);
            }
            Verdict::Undecided(why) => {
                bracket.undecided = format!("at {middle:.3}: {why}");
                break;
            }
        }
    }
    Ok((worst, bracket))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_critical_value_is_bracketed() {
        let find = |halvings, verdict: &dyn Fn(f64) -> Verdict| {
            let probe = |x| Ok((verdict(x), Course::default()));
            search([1.0, 16.0], halvings, probe).unwrap().1
        };
        let found = find(10, &|x| match x < 3.0 {
            true => Verdict::Below,
            false => Verdict::Above,
        });
        let (below, above) = (found.below.unwrap(), found.above.unwrap());
        assert!(below < 3.0 && above >= 3.0 && found.undecided.is_empty());
        // Ten halvings of a ratio of 16.
        assert!((above / below - 16.0_f64.powf(1.0 / 1024.0)).abs() < 1e-12);
        assert!((found.middle().unwrap() - (below * above).sqrt()).abs() < 1e-15);
        let never = find(4, &|_| Verdict::Below);
        assert_eq!((never.above, never.middle()), (None, None));
        let lost = find(4, &|_| Verdict::Undecided("lost".into()));
        assert_eq!(lost.undecided, "at 4.000: lost");
    }
}
