//! A free triangle: Euler's rigid body, solved by Jacobi functions.

use crate::{complete_k, jacobi};
use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassMatrix, Sheet};
use nalgebra::{Matrix3, Vector3};

/// An isosceles triangle with equal vertex masses tumbling freely.
///
/// Body axes: 1 along the base, 2 along the altitude, 3 the normal; `I3 = I1 + I2`. The start
/// satisfies `M^2 > 2 E I2` with `I1 < I2 < I3`, so that
///
/// ```text
/// w1 = -a1 cn(s), w2 = a2 sn(s), w3 = a3 dn(s)
/// ```
///
/// with `s = rate * t + s0` (Landau and Lifshitz, Mechanics, Sec. 37).
#[derive(Debug, Clone, Copy)]
pub struct FreeTriangle {
    /// Base, metres.
    pub base: f64,
    /// Altitude, metres.
    pub altitude: f64,
    /// Mass of each vertex, kilograms.
    pub vertex_mass: f64,
    /// Angular velocity at the start in body axes (its second component zero), rad/s.
    pub spin: [f64; 2],
}

impl Default for FreeTriangle {
    fn default() -> Self {
        Self {
            base: 1.0,
            altitude: 0.6,
            vertex_mass: 0.1,
            spin: [1.1, 2.0],
        }
    }
}

impl FreeTriangle {
    /// Principal moments of inertia, kg m2: `I1` about the base direction.
    pub fn moments(&self) -> [f64; 3] {
        let about_base = self.vertex_mass * self.altitude.powi(2) * 2.0 / 3.0;
        let about_altitude = self.vertex_mass * self.base.powi(2) / 2.0;
        [about_base, about_altitude, about_base + about_altitude]
    }

    fn corners(&self) -> [Vector3<f64>; 3] {
        let (b, h) = (0.5 * self.base, self.altitude / 3.0);
        [
            Vector3::new(-b, -h, 0.0),
            Vector3::new(b, -h, 0.0),
            Vector3::new(0.0, 2.0 * h, 0.0),
        ]
    }

    /// The sheet, free of gravity and pins.
    pub fn model(&self) -> SheetModel {
        let positions = self
            .corners()
            .iter()
            .flat_map(|c| [c.x, c.y, c.z])
            .collect();
        let sheet = Sheet::new(positions, &[[0, 1, 2]]).expect("a triangle");
        let mass = MassMatrix::from_vertex_masses(vec![self.vertex_mass; 3]).expect("positive");
        SheetModel::with_mass(&sheet, mass).expect("positive masses")
    }

    /// Centred at the origin, spinning.
    pub fn start(&self) -> State {
        let spin = Vector3::new(self.spin[0], 0.0, self.spin[1]);
        let corners = self.corners();
        State::moving(
            corners.iter().flat_map(|c| [c.x, c.y, c.z]).collect(),
            corners
                .iter()
                .flat_map(|c| {
                    let v = spin.cross(c);
                    [v.x, v.y, v.z]
                })
                .collect(),
        )
    }

    /// Exact angular velocity in body axes at time `t`.
    pub fn spin_at(&self, t: f64) -> [f64; 3] {
        let [i1, i2, i3] = self.moments();
        let [w1, w3] = self.spin;
        let twice_energy = i1 * w1 * w1 + i3 * w3 * w3;
        let squared = (i1 * w1).powi(2) + (i3 * w3).powi(2);
        assert!(
            i1 < i2 && squared > twice_energy * i2,
            "the case solved here"
        );
        let a1 = ((twice_energy * i3 - squared) / (i1 * (i3 - i1))).sqrt();
        let a2 = ((twice_energy * i3 - squared) / (i2 * (i3 - i2))).sqrt();
        let a3 = ((squared - twice_energy * i1) / (i3 * (i3 - i1))).sqrt();
        let m =
            (i2 - i1) * (twice_energy * i3 - squared) / ((i3 - i2) * (squared - twice_energy * i1));
        let rate = ((i3 - i2) * (squared - twice_energy * i1) / (i1 * i2 * i3)).sqrt();
        // w1 > 0 and w2 = 0 at t = 0, where Euler's equation I2 w2' = (I3 - I1) w3 w1 makes w2 grow.
        let (sn, cn, dn) = jacobi(rate * t, m);
        [a1 * cn, a2 * sn, a3 * dn]
    }

    /// Period of the angular velocity in body axes, seconds.
    pub fn period(&self) -> f64 {
        let [i1, i2, i3] = self.moments();
        let [w1, w3] = self.spin;
        let twice_energy = i1 * w1 * w1 + i3 * w3 * w3;
        let squared = (i1 * w1).powi(2) + (i3 * w3).powi(2);
        let m =
            (i2 - i1) * (twice_energy * i3 - squared) / ((i3 - i2) * (squared - twice_energy * i1));
        let rate = ((i3 - i2) * (squared - twice_energy * i1) / (i1 * i2 * i3)).sqrt();
        4.0 * complete_k(m) / rate
    }

    /// Positions (9 coordinates, metres) at increasing times (seconds): the attitude R follows from the
    /// exact spin w in body axes by `R' = R [w]`, integrated by the classical Runge-Kutta method to
    /// round-off.
    pub fn positions(&self, times: &[f64]) -> Vec<Vec<f64>> {
        // At 2e-4 of a period the error of the method is about (2 pi 2e-4)^4 / 120, below 1e-13.
        let longest = 2e-4 * self.period();
        let rate = |r: &Matrix3<f64>, t: f64| r * Vector3::from(self.spin_at(t)).cross_matrix();
        let mut attitude = Matrix3::identity();
        let mut now = 0.0;
        let mut states = Vec::new();
        for &t in times {
            let steps = ((t - now) / longest).ceil().max(1.0);
            let h = (t - now) / steps;
            for k in 0..steps as usize {
                let at = now + k as f64 * h;
                let k1 = rate(&attitude, at);
                let k2 = rate(&(attitude + 0.5 * h * k1), at + 0.5 * h);
                let k3 = rate(&(attitude + 0.5 * h * k2), at + 0.5 * h);
                let k4 = rate(&(attitude + h * k3), at + h);
                attitude += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
            }
            now = t;
            let corners = self.corners().map(|c| attitude * c);
            states.push(corners.iter().flat_map(|p| [p.x, p.y, p.z]).collect());
        }
        states
    }

    /// Angular velocity in body axes of a state, from its angular momentum and body frame.
    pub fn spin_of(&self, model: &SheetModel, state: &State) -> [f64; 3] {
        let p = |v: usize| Vector3::from_column_slice(&state.x[3 * v..3 * v + 3]);
        let e1 = (p(1) - p(0)).normalize();
        let e3 = (p(1) - p(0)).cross(&(p(2) - p(0))).normalize();
        let frame = Matrix3::from_columns(&[e1, e3.cross(&e1), e3]);
        let body = frame.transpose() * Vector3::from(model.angular_momentum(&state.x, &state.v));
        let moments = self.moments();
        [0, 1, 2].map(|k| body[k] / moments[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_spin_satisfies_eulers_equations() {
        let model = FreeTriangle::default();
        let [i1, i2, i3] = model.moments();
        let (t, h) = (0.37, 1e-5);
        let w = model.spin_at(t);
        let rate: Vec<f64> = (0..3)
            .map(|k| (model.spin_at(t + h)[k] - model.spin_at(t - h)[k]) / (2.0 * h))
            .collect();
        assert!((i1 * rate[0] - (i2 - i3) * w[1] * w[2]).abs() < 1e-9);
        assert!((i2 * rate[1] - (i3 - i1) * w[2] * w[0]).abs() < 1e-9);
        assert!((i3 * rate[2] - (i1 - i2) * w[0] * w[1]).abs() < 1e-9);
        let start = model.spin_at(0.0);
        assert!((start[0] - 1.1).abs() < 1e-14 && start[1].abs() < 1e-14);
        assert!((start[2] - 2.0).abs() < 1e-14);
    }
}
