//! What the ways of solving with the whole matrix cost, in multiplications of a factorisation.

use isosheet_linalg::SparseLlt;
use std::ops::{Add, Sub};

/// A multiplication of a solve takes as long as so many of a factorisation, whose dense kernels use each
/// number that they read several times: 4 to 5 for sheets of 289 and 1089 vertices, with and without the
/// couplings of a plate.
const SOLVE_WEIGHT: f64 = 4.0;

/// Costs of a factorisation and of a solve with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Direct {
    pub(super) factorisation: f64,
    pub(super) solve: f64,
}

impl Direct {
    pub(super) fn of(matrix: &SparseLlt) -> Self {
        Self {
            factorisation: matrix.operations(),
            // Once forwards and once backwards.
            solve: SOLVE_WEIGHT * 2.0 * matrix.factor_len() as f64,
        }
    }

    /// The number of iterations with this factorisation, beside a product of `product` multiplications each,
    /// from which the factorisation and the solve of `whole` are cheaper.
    pub(super) fn iterations_worth(self, product: f64, whole: Self) -> usize {
        let saved = whole.factorisation + whole.solve - self.factorisation - self.solve;
        (saved / (self.solve + SOLVE_WEIGHT * product)).max(0.0) as usize
    }
}

impl Add for Direct {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            factorisation: self.factorisation + other.factorisation,
            solve: self.solve + other.solve,
        }
    }
}

impl Sub for Direct {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            factorisation: self.factorisation - other.factorisation,
            solve: self.solve - other.solve,
        }
    }
}

/// The number of iterations that conjugate gradients are expected to take until the error is `relative` times
/// the one at the start, for a matrix whose far couplings have substitutes of the norm `substitutes` beside
/// masses of the norm `masses`.
///
/// In units of the masses the bending stiffness reaches from 0 to a largest value `s`, and grows as the
/// fourth power of the wave number `k`; with substitutes it grows as the square, to the same `s` at the
/// largest `k`. The ratio `(1 + s t^2) / (1 + s t)`, `t` from 0 to 1, lies between `2 / (1 + s^(1/2))` and 1,
/// and its bounds give the convergence of conjugate gradients. On a lattice `x_{i-1} - 2 x_i + x_{i+1}` the
/// largest stiffness is eight times the substitutes of a vertex.
pub(super) fn expected_iterations(substitutes: f64, masses: f64, relative: f64) -> f64 {
    let condition = 0.5 * (1.0 + (8.0 * substitutes / masses).sqrt());
    let root = condition.max(1.0).sqrt();
    let rate = (root - 1.0) / (root + 1.0);
    // One iteration more shows that the error is small.
    1.0 + (0.5 * relative).ln() / rate.max(f64::MIN_POSITIVE).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffer_sheets_take_more_iterations() {
        let expected = [0.0, 1.0, 10.0, 1e3].map(|s| expected_iterations(s, 1.0, 0.1));
        assert!(expected.is_sorted(), "{expected:?}");
        assert!(expected[0] < 1.1 && expected[3] > 8.0, "{expected:?}");
    }

    #[test]
    fn iterations_are_worth_what_they_save() {
        let near = Direct {
            factorisation: 10.0,
            solve: 1.0,
        };
        let whole = Direct {
            factorisation: 100.0,
            solve: 11.0,
        };
        assert_eq!(near.iterations_worth(1.0, whole), 20);
        assert_eq!(whole.iterations_worth(1.0, near), 0);
    }
}
