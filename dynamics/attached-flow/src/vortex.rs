//! The velocity that vortices induce.

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Velocity at a point by a straight vortex segment of unit circulation from `a` to `b`, 1/m: the law of Biot
/// and Savart (Katz and Plotkin, "Low-speed aerodynamics", 2001, Sec. 2.12),
///
/// ```text
/// q = r_a x r_b (|r_a| + |r_b|) / (4 pi (|r_a| |r_b| (|r_a| |r_b| + r_a . r_b) + core^2 l^2 / 2)),
/// ```
///
/// which is finite everywhere for a radius of the core above zero (metres); on a segment without a core it is
/// zero.
pub(super) fn segment(at: &Vector3<f64>, [a, b]: [&Vector3<f64>; 2], core: f64) -> Vector3<f64> {
    let (to_a, to_b) = (at - a, at - b);
    let (far_a, far_b) = (to_a.norm(), to_b.norm());
    let product = far_a * far_b;
    let softened = 0.5 * core * core * (b - a).norm_squared();
    let (cos, across) = (to_a.dot(&to_b), to_a.cross(&to_b));
    // Both are the same but for cancellation.
    let sum = match cos < 0.0 {
        true => across.norm_squared() / (product - cos),
        false => product + cos,
    };
    let below = product * sum + softened;
    if below > 0.0 {
        across * ((far_a + far_b) / (4.0 * PI * below))
    } else {
        Vector3::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `1 / (2 pi d)` beside a straight line, `1 / (2 r)` in the centre of a circle.
    #[test]
    fn a_line_and_a_circle_induce_what_the_law_of_biot_and_savart_says() {
        let [a, b] = [-1e6, 1e6].map(|x| Vector3::new(x, 0.0, 0.0));
        let found = segment(&Vector3::new(3.0, 0.2, 0.0), [&a, &b], 0.0);
        let exact = Vector3::new(0.0, 0.0, 1.0 / (2.0 * PI * 0.2));
        assert!((found - exact).norm() < 1e-9, "{found}");
        let corner = |k: usize| {
            let (sin, cos) = (2.0 * PI * k as f64 / 1000.0).sin_cos();
            Vector3::new(0.4 * cos, 0.4 * sin, 0.0)
        };
        let sides =
            (0..1000).map(|k| segment(&Vector3::zeros(), [&corner(k), &corner(k + 1)], 0.0));
        let found: Vector3<f64> = sides.sum();
        let exact = Vector3::new(0.0, 0.0, 1.0 / 0.8);
        assert!((found - exact).norm() < 1e-4, "{found}");
    }

    #[test]
    fn velocities_are_finite_everywhere() {
        let [a, b] = [[0.0; 3], [1.0, 0.0, 0.0]].map(Vector3::from);
        for core in [0.0, 0.1] {
            for at in [a, b, 0.5 * (a + b), 2.0 * b, -b] {
                assert_eq!(segment(&at, [&a, &b], core), Vector3::zeros());
            }
            let nothing = segment(&Vector3::new(0.3, 0.2, 0.1), [&a, &a], core);
            assert_eq!(nothing, Vector3::zeros());
        }
        let near = segment(&Vector3::new(0.5, 1e-9, 0.0), [&a, &b], 0.1);
        assert!(near.norm() < 1e-6, "{near}");
    }
}
