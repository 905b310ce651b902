//! Folds of a draped disk, counted on its rim.

use crate::report::extremes;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A rim: heights over the angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Rim {
    /// Number of folds: how often the height rises from its lower to its upper part once around.
    pub(super) folds: usize,
    /// Wave number of the largest component of the height, of at least two waves: one wave is a tilt.
    pub(super) wave: usize,
    /// Part of the mean square of the height about its mean that this component has.
    pub(super) share: f64,
    /// Mean height, metres.
    pub(super) mean: f64,
}

/// Part of the range of heights from the mean level to each of the two levels between which a rise counts as
/// a fold: ripples that are smaller are none.
const HYSTERESIS: f64 = 0.15;

/// Analyses a rim: angles (radians) in increasing order within one turn, and heights (metres).
///
/// The Fourier coefficients are integrals of the piecewise constant height, each value from half-way to its
/// neighbours, which for equal angles are those of the discrete transform. Nothing for fewer than eight
/// vertices, or a rim that is level.
pub(super) fn analyse(angles: &[f64], heights: &[f64]) -> Option<Rim> {
    let n = angles.len().min(heights.len());
    if n < 8 {
        return None;
    }
    let width = |i: usize| {
        let before = if i == 0 {
            angles[n - 1] - TAU
        } else {
            angles[i - 1]
        };
        let after = if i + 1 == n {
            angles[0] + TAU
        } else {
            angles[i + 1]
        };
        0.5 * (after - before)
    };
    let mean = (0..n).map(|i| width(i) * heights[i]).sum::<f64>() / TAU;
    let square = (0..n).map(|i| width(i) * (heights[i] - mean).powi(2));
    let variance = square.sum::<f64>() / TAU;
    let range = extremes(heights.iter().copied())?;
    if range[1] - range[0] <= 1e-9 {
        return None;
    }
    let power = |k: usize| {
        let (mut c, mut s) = (0.0, 0.0);
        for i in 0..n {
            let (sin, cos) = (k as f64 * angles[i]).sin_cos();
            c += width(i) * (heights[i] - mean) * cos;
            s += width(i) * (heights[i] - mean) * sin;
        }
        // The mean square of a cos + b sin is (a^2 + b^2) / 2, and a = c / pi.
        2.0 * (c * c + s * s) / (TAU * TAU)
    };
    let largest = (2..n / 2)
        .map(|k| (k, power(k)))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Rim {
        folds: rises(
            heights,
            0.5 * (range[0] + range[1]),
            HYSTERESIS * (range[1] - range[0]),
        ),
        wave: largest.0,
        share: largest.1 / variance,
        mean,
    })
}

/// How often a closed sequence rises from below `level - band` to above `level + band`.
fn rises(heights: &[f64], level: f64, band: f64) -> usize {
    let Some(start) = heights.iter().position(|z| *z < level - band) else {
        return 0;
    };
    let (mut count, mut is_low) = (0, true);
    for i in 0..heights.len() {
        let z = heights[(start + i) % heights.len()];
        if is_low && z > level + band {
            (count, is_low) = (count + 1, false);
        } else if z < level - band {
            is_low = true;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rim with folds of a known number, uneven angles and ripples.
    #[test]
    fn the_folds_of_a_synthetic_rim_are_counted() {
        for folds in [2, 3, 5, 8] {
            let angles: Vec<f64> = (0..60)
                .map(|i| TAU * (f64::from(i) + 0.3 * f64::from(i * i % 7) / 7.0) / 60.0)
                .collect();
            let height = |a: &f64| {
                -0.2 + 0.05 * (f64::from(folds) * a + 0.4).cos() + 0.004 * (17.0 * a).sin()
            };
            let heights: Vec<f64> = angles.iter().map(height).collect();
            let rim = analyse(&angles, &heights).unwrap();
            assert_eq!((rim.folds, rim.wave), (folds as usize, folds as usize));
            assert!((rim.mean + 0.2).abs() < 2e-3, "{rim:?}");
            assert!((0.9..1.02).contains(&rim.share), "{rim:?}");
        }
    }

    /// Of equal angles the coefficients are exact: the whole variance is in the one wave.
    #[test]
    fn a_pure_wave_has_the_whole_variance() {
        let angles: Vec<f64> = (0..32).map(|i| TAU * f64::from(i) / 32.0).collect();
        let heights: Vec<f64> = angles.iter().map(|a| 0.1 + (4.0 * a).sin()).collect();
        let rim = analyse(&angles, &heights).unwrap();
        assert!((rim.share - 1.0).abs() < 1e-12 && (rim.mean - 0.1).abs() < 1e-12);
        assert_eq!(analyse(&angles, &[0.5; 32]), None);
        assert_eq!(analyse(&angles[..4], &heights[..4]), None);
    }
}
