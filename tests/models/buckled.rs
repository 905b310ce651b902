//! Strips that are clamped flat at both ends and pushed together.

use crate::elliptic::{complete_e, complete_k};

/// An inextensible strip of unit length, rigidity and width that is clamped flat at both ends, at a distance
/// `distance`: its energy and the height of its middle.
///
/// A quarter of the strip is an elastica from a clamp to a point of inflection. With the modulus `k` and the
/// complete elliptic integrals `K` and `E` its span is `2 E / K - 1` of its length, the middle is `k / K`
/// lengths of the strip high, and the energy is `32 K^2 (k^2 - (1 - s) / 2)` with the span `s`.
pub fn buckled(distance: f64) -> [f64; 2] {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for _ in 0..BISECTIONS {
        let k = 0.5 * (low + high);
        if 2.0 * complete_e(k * k) / complete_k(k * k) - 1.0 > distance {
            low = k;
        } else {
            high = k;
        }
    }
    let k = 0.5 * (low + high);
    let first = complete_k(k * k);
    [
        32.0 * first * first * (k * k - 0.5 * (1.0 - distance)),
        k / first,
    ]
}

/// Halvings of an interval to round-off.
const BISECTIONS: usize = 60;

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A strip of 4 x 1 at a distance of 1.2 (Bartels, Numer. Math. 124, 2013, ex. 6.3, recomputed); and
    /// small deflections, whose energy is `4 pi^2` times the shortening.
    #[test]
    fn buckled_strips_are_known() {
        let [energy, height] = buckled(0.3);
        assert!((energy / 4.0 - 8.582).abs() < 1e-3, "{energy}");
        assert!((4.0 * height - 1.599).abs() < 1e-3, "{height}");
        let [energy, _] = buckled(1.0 - 1e-4);
        let small = 4.0 * PI.powi(2) * 1e-4;
        assert!((energy / small - 1.0).abs() < 1e-3, "{energy} {small}");
    }
}
