//! How closest points wander along faces and edges that tilt.

use nalgebra::Vector3;

/// Gradients along a face of the weights of its point closest to another point, given these weights: along an
/// edge, if the closest point is on one, and zero if it is a corner.
pub(super) fn face_gradients(corners: [Vector3<f64>; 3], weights: [f64; 3]) -> [Vector3<f64>; 3] {
    let mut gradients = [Vector3::zeros(); 3];
    let on = weights.map(|w| w > 0.0);
    if on == [true; 3] {
        let area = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        for (i, gradient) in gradients.iter_mut().enumerate() {
            let opposite = corners[(i + 2) % 3] - corners[(i + 1) % 3];
            *gradient = area.cross(&opposite) / area.norm_squared();
        }
        return gradients;
    }
    for i in 0..3 {
        let j = (i + 1) % 3;
        if on[i] && on[j] {
            let edge = corners[j] - corners[i];
            gradients[j] = edge / edge.norm_squared();
            gradients[i] = -gradients[j];
        }
    }
    gradients
}

/// Gradient of the weight of the second end of the edge `first` at its point closest to the edge `second`,
/// given the weights of the four ends (the weights of the second edge are not positive): the closest point of
/// the second edge moves too, unless it is an end. Zero if the closest point of the first edge is an end.
pub(super) fn edge_gradient(
    first: [Vector3<f64>; 2],
    second: [Vector3<f64>; 2],
    weights: [f64; 4],
) -> Vector3<f64> {
    let [wp, wq, wc, wd] = weights;
    if !(wp > 0.0 && wq > 0.0) {
        return Vector3::zeros();
    }
    let edge = first[1] - first[0];
    let across = if wc < 0.0 && wd < 0.0 {
        let other = second[1] - second[0];
        edge - edge.dot(&other) / other.norm_squared() * other
    } else {
        edge
    };
    across / across.dot(&edge)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_geometry::distance::{edge_edge, point_triangle};
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vector3<f64>> {
        (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(x, y, z)| Vector3::new(x, y, z))
    }

    /// Displacements along a direction that leave the closest point where it is.
    fn tilts<const N: usize>(
        raw: [f64; N],
        weights: [f64; N],
        normal: &Vector3<f64>,
    ) -> [Vector3<f64>; N] {
        let mean: f64 = raw.iter().zip(&weights).map(|(r, w)| r * w).sum();
        raw.map(|r| (r - mean) * normal)
    }

    /// Second derivative at 0, by differences of fourth order.
    fn second_derivative(f: impl Fn(f64) -> f64) -> f64 {
        let h = 2e-3;
        (16.0 * (f(h) + f(-h)) - f(2.0 * h) - f(-2.0 * h) - 30.0 * f(0.0)) / (12.0 * h * h)
    }

    proptest! {
        #![proptest_config(isosheet_random::cases(256))]

        /// `d'' = -d |t|^2` where the closest point does not slide.
        #[test]
        fn faces_that_tilt_come_closer(
            corners in [point(), point(), point()],
            inside in [0.2..1.0_f64, 0.2..1.0, 0.2..1.0],
            height in 0.5..2.0_f64,
            raw in [-0.3..0.3_f64, -0.3..0.3, -0.3..0.3],
            on_edge in any::<bool>(),
        ) {
            let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            prop_assume!(normal.norm() > 0.3);
            let sum = inside[0] + inside[1] + if on_edge { 0.0 } else { inside[2] };
            let [a, b, c] = inside.map(|w| w / sum);
            let c = if on_edge { 0.0 } else { c };
            let place = a * corners[0] + b * corners[1] + c * corners[2];
            let mut direction = normal.normalize();
            if on_edge {
                // Out over the edge.
                let edge = (corners[1] - corners[0]).normalize();
                let outwards = edge.cross(&direction);
                let outwards = outwards * -outwards.dot(&(corners[2] - place)).signum();
                direction = (direction + outwards).normalize();
            }
            let p = place + height * direction;
            let closest = point_triangle(&[p, corners[0], corners[1], corners[2]]);
            let [_, wa, wb, wc] = closest.weights;
            let weights = [-wa, -wb, -wc];
            prop_assert!((closest.distance() - height).abs() < 1e-9);
            let u = tilts(raw, weights, &direction);
            let distance = |s: f64| {
                let at: [Vector3<f64>; 3] = std::array::from_fn(|i| corners[i] + s * u[i]);
                point_triangle(&[p, at[0], at[1], at[2]]).distance()
            };
            let gradients = face_gradients(corners, weights);
            let tilt: Vector3<f64> = (0..3).map(|i| gradients[i] * direction.dot(&u[i])).sum();
            let want = -height * tilt.norm_squared();
            let found = second_derivative(distance);
            prop_assert!((found - want).abs() < 1e-3 * (1.0 + want.abs()), "{} {}", found, want);
        }

        #[test]
        fn edges_that_tilt_come_closer(
            axis in point(),
            angle in 0.4..2.7_f64,
            place in [0.3..0.7_f64, 0.2..0.8],
            height in 0.5..2.0_f64,
            raw in [-0.3..0.3_f64, -0.3..0.3],
        ) {
            prop_assume!(axis.norm() > 0.3);
            let n = axis.normalize();
            let u1 = n.cross(&Vector3::new(0.3, -0.7, 0.5)).normalize();
            let u2 = angle.cos() * u1 + angle.sin() * n.cross(&u1);
            let foot = place[1] * u2;
            let second = [Vector3::zeros(), u2];
            let first = [
                foot + height * n - place[0] * u1,
                foot + height * n + (1.0 - place[0]) * u1,
            ];
            let closest = edge_edge(&[first[0], first[1], second[0], second[1]]);
            prop_assert!((closest.distance() - height).abs() < 1e-9);
            let [wp, wq, _, _] = closest.weights;
            let u = tilts(raw, [wp, wq], &n);
            let distance = |s: f64| {
                edge_edge(&[first[0] + s * u[0], first[1] + s * u[1], second[0], second[1]])
                    .distance()
            };
            let gradient = edge_gradient(first, second, closest.weights);
            let tilt = gradient * n.dot(&(u[1] - u[0]));
            let want = -height * tilt.norm_squared();
            let found = second_derivative(distance);
            prop_assert!((found - want).abs() < 2e-3 * (1.0 + want.abs()), "{} {}", found, want);
        }
    }
}
