//! The error that a step of a damped method adds, estimated from velocities that are there anyway.

use crate::{SheetModel, State};
use isosheet_model::PINNED;
use isosheet_model::term::Formula;

/// An estimate of the error that a step adds to the positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LocalError {
    /// Root of the mean square over the free vertices, metres.
    pub(crate) size: f64,
    /// The formula of the step.
    pub(crate) formula: Formula,
}

impl LocalError {
    /// Of a step from `start` to `end`, where `before` is the state before `start` that the formula of two
    /// steps used.
    ///
    /// With the lengths `h` of the step and `h / w` of the one before, BDF2 leaves
    ///
    /// ```text
    /// x(t1) - x1 = -h^3 (1 + w)^2 / (6 w (1 + 2 w)) x''' + O(h^4),
    /// x''' = 2 w (v1 - v0 - w (v0 - v_)) / (h^2 (1 + w)) + O(h),
    /// ```
    ///
    /// if it begins with exact values, which makes `h (1 + w) / (3 (1 + 2 w)) |v1 - v0 - w (v0 - v_)|`, and
    /// implicit Euler `h / 2 |v1 - v0|` (E. Hairer, S. P. Noersett and G. Wanner, "Solving Ordinary
    /// Differential Equations I", Sec. III.5). Where contact changes a velocity within a step both are of
    /// first order in `h`, as the error is.
    pub(crate) fn of(
        model: &SheetModel,
        before: Option<&State>,
        start: &State,
        end: &State,
    ) -> Self {
        let h = end.t - start.t;
        let (formula, w, factor) = match before {
            None => (Formula::OneStep, 0.0, 0.5 * h),
            Some(before) => {
                let w = h / (start.t - before.t);
                let factor = h * (1.0 + w) / (3.0 * (1.0 + 2.0 * w));
                (Formula::TwoStep, w, factor)
            }
        };
        let before = before.unwrap_or(start);
        let (mut sum, mut count) = (0.0, 0_usize);
        let free = model.free_index().iter().enumerate();
        for (vertex, _) in free.filter(|(_, place)| **place != PINNED) {
            for i in 3 * vertex..3 * vertex + 3 {
                let now = start.v[i];
                let change = end.v[i] - now - w * (now - before.v[i]);
                sum += change * change;
            }
            count += 1;
        }
        Self {
            size: factor * (sum / count.max(1) as f64).sqrt(),
            formula,
        }
    }

    /// The estimate for a step of twice the length.
    pub(crate) fn of_twice(&self) -> f64 {
        match self.formula {
            Formula::OneStep => 4.0 * self.size,
            Formula::TwoStep => 8.0 * self.size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, generate};

    /// The error of one step of the motion `x = t^p`, `v = p t^(p-1)`, for all coordinates, from exact
    /// values; the velocity at the end follows from the formula.
    fn step(power: i32, steps: [f64; 2], formula: Formula) -> (f64, f64) {
        let sheet = generate::isotropic_square(1, 0.21).unwrap();
        let model = SheetModel::new(&sheet, 1.0, MassKind::Lumped).unwrap();
        let n = model.coordinate_count();
        let at = |t: f64| State {
            t,
            x: vec![t.powi(power); n],
            v: vec![f64::from(power) * t.powi(power - 1); n],
        };
        let [last, h] = steps;
        let (before, start, end) = (at(1.0 - last), at(1.0), at(1.0 + h));
        let error = LocalError::of(
            &model,
            (formula == Formula::TwoStep).then_some(&before),
            &start,
            &end,
        );
        let x = |state: &State| state.x[0];
        let made = match formula {
            Formula::OneStep => x(&start) + h * end.v[0],
            Formula::TwoStep => {
                let w = h / last;
                let [b, k] = [w * w, 1.0 + w].map(|c| c / (1.0 + 2.0 * w));
                x(&start) + b * (x(&start) - x(&before)) + k * h * end.v[0]
            }
        };
        // Each vertex has three equal coordinates.
        (error.size, 3.0_f64.sqrt() * (x(&end) - made).abs())
    }

    #[test]
    fn the_estimate_is_exact_for_the_first_power_that_the_formula_misses() {
        for steps in [[0.1, 0.1], [0.2, 0.1], [0.05, 0.1], [0.1, 0.03]] {
            for (formula, power) in [(Formula::OneStep, 2), (Formula::TwoStep, 3)] {
                let (estimate, error) = step(power, steps, formula);
                assert!(
                    (estimate - error).abs() < 1e-13 + 1e-12 * error,
                    "{estimate} {error}"
                );
                assert!(error > 1e-5);
                let (estimate, error) = step(power - 1, steps, formula);
                assert!(estimate < 1e-14 && error < 1e-14, "{estimate} {error}");
            }
        }
    }

    #[test]
    fn twice_the_length_is_foreseen_to_leading_order() {
        for formula in [Formula::OneStep, Formula::TwoStep] {
            for h in [0.01, 0.005] {
                let [single, twice] = [h, 2.0 * h].map(|h| step(5, [h, h], formula).0);
                let foreseen = match formula {
                    Formula::OneStep => 4.0 * single,
                    Formula::TwoStep => 8.0 * single,
                };
                assert!(
                    (foreseen / twice - 1.0).abs() < 6.0 * h,
                    "{foreseen} {twice}"
                );
            }
        }
    }
}
