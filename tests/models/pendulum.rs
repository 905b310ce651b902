//! A triangle pinned along an edge: the mathematical pendulum at large amplitude.

use crate::{complete_k, jacobi};
use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassKind, Sheet, VertexId};

/// A triangle that swings about its pinned edge, released at rest.
#[derive(Debug, Clone, Copy)]
pub struct Pendulum {
    /// Altitude over the pinned edge: the length of the pendulum, metres.
    pub length: f64,
    /// Release angle from the hanging position, radians.
    pub amplitude: f64,
    /// Acceleration of gravity along -z, m/s2.
    pub gravity: f64,
}

impl Default for Pendulum {
    fn default() -> Self {
        Self {
            length: 0.7,
            amplitude: 2.0,
            gravity: 9.81,
        }
    }
}

impl Pendulum {
    fn place(&self, angle: f64) -> Vec<f64> {
        let (s, c) = angle.sin_cos();
        vec![
            0.0,
            -0.3,
            0.0,
            0.0,
            0.5,
            0.0,
            self.length * s,
            0.1,
            -self.length * c,
        ]
    }

    /// The sheet: vertices 0 and 1 are pinned.
    pub fn model(&self) -> SheetModel {
        let sheet = Sheet::new(self.place(self.amplitude), &[[0, 1, 2]]).expect("a triangle");
        SheetModel::new(&sheet, 0.3, MassKind::Lumped)
            .expect("positive mass")
            .with_acceleration([0.0, 0.0, -self.gravity])
            .with_pins(&[VertexId(0), VertexId(1)])
            .expect("vertices exist")
    }

    /// At rest at the release angle.
    pub fn start(&self) -> State {
        State::at_rest(self.place(self.amplitude))
    }

    /// Period `4 sqrt(l/g) K(sin^2(amplitude/2))`, seconds.
    pub fn period(&self) -> f64 {
        4.0 * (self.length / self.gravity).sqrt() * complete_k((0.5 * self.amplitude).sin().powi(2))
    }

    /// Exact positions at time `t`: `sin(angle/2) = k sn(K - t sqrt(g/l))`.
    pub fn exact(&self, t: f64) -> Vec<f64> {
        let k = (0.5 * self.amplitude).sin();
        let m = k * k;
        let (sn, _, _) = jacobi(complete_k(m) - t * (self.gravity / self.length).sqrt(), m);
        self.place(2.0 * (k * sn).asin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_period() {
        assert!((Pendulum::default().period() - 2.230_427_653_768_689).abs() < 1e-14);
    }
}
