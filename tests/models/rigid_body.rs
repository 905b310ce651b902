//! A rigid body that spins freely.

use isosheet_dynamics::State;
use isosheet_mesh::Sheet;
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// A rigid body without gravity and supports: the reference for meshes that cannot bend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidBody {
    /// Inertia tensor about the centre of mass at the start, kg m2.
    pub inertia: Matrix3<f64>,
    /// Centre of mass, metres.
    pub centre: Vector3<f64>,
}

impl RigidBody {
    /// Of masses (kilograms) at places (metres).
    pub fn of_masses(masses: &[(f64, Vector3<f64>)]) -> Self {
        let total: f64 = masses.iter().map(|p| p.0).sum();
        let centre = masses.iter().map(|(m, r)| *m * r).sum::<Vector3<f64>>() / total;
        let of_one = |(m, r): &(f64, Vector3<f64>)| {
            let d = r - centre;
            *m * (Matrix3::identity() * d.norm_squared() - d * d.transpose())
        };
        Self {
            inertia: masses.iter().map(of_one).sum(),
            centre,
        }
    }

    /// The vertices of a sheet turning about the centre of mass with the angular velocity `spin`, rad/s.
    pub fn start(&self, sheet: &Sheet, spin: [f64; 3]) -> State {
        let velocity = |p: &[f64]| {
            let v = Vector3::from(spin).cross(&(Vector3::from_column_slice(p) - self.centre));
            [v.x, v.y, v.z]
        };
        let x = sheet.positions().to_vec();
        let v = x.chunks(3).flat_map(velocity).collect();
        State::moving(x, v)
    }

    /// Where the vertices of a sheet are after `t` seconds of free spin, metres (3V).
    ///
    /// Euler's equations `I w' = I w x w` in the frame of the body and `q' = q w / 2` for the quaternion
    /// of its attitude are integrated by the classical Runge-Kutta method in so many steps.
    pub fn positions(&self, sheet: &Sheet, spin: [f64; 3], t: f64, steps: usize) -> Vec<f64> {
        let turn = self.attitude(spin, t, steps);
        let place = |p: &[f64]| {
            let r = self.centre + turn * (Vector3::from_column_slice(p) - self.centre);
            [r.x, r.y, r.z]
        };
        sheet.positions().chunks(3).flat_map(place).collect()
    }

    fn attitude(&self, spin: [f64; 3], t: f64, steps: usize) -> UnitQuaternion<f64> {
        // In the frame of the start, which is the body frame.
        let tensor = self.inertia;
        let inverse = tensor.try_inverse().unwrap_or_else(Matrix3::zeros);
        let h = t / steps as f64;
        let (mut w, mut q) = (Vector3::from(spin), Quaternion::identity());
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FreeTriangle, max_difference};

    /// The free triangle, whose spin is known by Jacobi functions.
    #[test]
    fn a_triangle_spins_as_its_exact_solution() {
        let triangle = FreeTriangle::default();
        let State { x, v, .. } = triangle.start();
        let corners = x.chunks(3).map(Vector3::from_column_slice);
        let body = RigidBody::of_masses(&corners.map(|r| (0.1, r)).collect::<Vec<_>>());
        for (k, moment) in triangle.moments().into_iter().enumerate() {
            assert!((body.inertia[(k, k)] - moment).abs() < 1e-15);
        }
        let sheet = Sheet::new(x, &[[0, 1, 2]]).unwrap();
        let spin = [triangle.spin[0], 0.0, triangle.spin[1]];
        assert!(max_difference(&body.start(&sheet, spin).v, &v) < 1e-15);
        let t = 0.4 * triangle.period();
        let exact = &triangle.positions(&[t])[0];
        let found = body.positions(&sheet, spin, t, 2000);
        assert!(max_difference(&found, exact) < 1e-10);
    }
}
