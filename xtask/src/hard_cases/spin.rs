//! Free spin of a rigid body by Euler's equations: the reference for meshes that cannot bend.

use isosheet_dynamics::State;
use isosheet_mesh::Sheet;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Inertia tensor about the centre of mass, and the centre, of given masses.
pub(super) fn inertia(points: &[(f64, Vector3<f64>)]) -> (Matrix3<f64>, Vector3<f64>, f64) {
    let mass: f64 = points.iter().map(|p| p.0).sum();
    let centre = points.iter().map(|(m, r)| *m * r).sum::<Vector3<f64>>() / mass;
    let tensor = points
        .iter()
        .map(|(m, r)| {
            let d = r - centre;
            *m * (Matrix3::identity() * d.norm_squared() - d * d.transpose())
        })
        .sum();
    (tensor, centre, mass)
}

/// A rigid body that turns freely, by Euler's equations and the quaternion of its attitude. They are
/// integrated by the classical Runge-Kutta method with a step whose halving changes nothing (checked by the
/// caller).
pub(super) fn turned(
    tensor: Matrix3<f64>,
    spin: Vector3<f64>,
    t: f64,
    steps: usize,
) -> UnitQuaternion<f64> {
    // In the frame of the start, which is the body frame.
    let inverse = tensor.try_inverse().unwrap_or_else(Matrix3::zeros);
    let h = t / steps as f64;
    let (mut w, mut q) = (spin, Quaternion::identity());
    let rate = |w: Vector3<f64>, q: Quaternion<f64>| {
        let dq = q * Quaternion::from_imag(w) * 0.5;
        (inverse * (tensor * w).cross(&w), dq)
    };
    for _ in 0..steps {
        let (a1, b1) = rate(w, q);
        let (a2, b2) = rate(w + 0.5 * h * a1, q + b1 * (0.5 * h));
        let (a3, b3) = rate(w + 0.5 * h * a2, q + b2 * (0.5 * h));
        let (a4, b4) = rate(w + h * a3, q + b3 * h);
        w += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        q += (b1 + b2 * 2.0 + b3 * 2.0 + b4) * (h / 6.0);
    }
    UnitQuaternion::from_quaternion(q)
}

/// Angular velocity at the start, radians per second.
pub(super) const SPIN: [f64; 3] = [1.0, 3.0, 0.5];

/// Positions turning with the spin about the centre of mass.
pub(super) fn spinning(sheet: &Sheet, centre: Vector3<f64>) -> State {
    let x = sheet.positions().to_vec();
    let v = x
        .chunks(3)
        .flat_map(|p| {
            let v = Vector3::from(SPIN).cross(&(Vector3::from_column_slice(p) - centre));
            [v.x, v.y, v.z]
        })
        .collect();
    State::moving(x, v)
}

/// Where the vertices are after the rotation.
pub(super) fn carried(sheet: &Sheet, centre: Vector3<f64>, q: &UnitQuaternion<f64>) -> Vec<f64> {
    sheet
        .positions()
        .chunks(3)
        .flat_map(|p| {
            let r = centre + q * (Vector3::from_column_slice(p) - centre);
            [r.x, r.y, r.z]
        })
        .collect()
}
