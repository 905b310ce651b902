//! Three rigid panels in a row, hung at both ends: a four-bar linkage.

use crate::Pendulum;
use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassMatrix, Sheet, VertexId};

/// Three panels with parallel hinges between two pinned ends at the same height, with equal vertex masses.
///
/// The panels are pairs of triangles, and nothing but the pins keeps them plane: 12 unknowns and 11 rods
/// leave one degree of freedom, that of the linkage.
#[derive(Debug, Clone, Copy)]
pub struct Linkage {
    /// Length of the outer panels, metres.
    pub length: f64,
    /// Length of the middle panel, metres.
    pub middle: f64,
    /// Mass of each vertex, kilograms.
    pub mass: f64,
    /// Acceleration of gravity along -z, m/s2.
    pub gravity: f64,
}

impl Default for Linkage {
    fn default() -> Self {
        Self {
            length: 0.7,
            middle: 0.4,
            mass: 0.02,
            gravity: 9.81,
        }
    }
}

impl Linkage {
    /// The four pinned vertices, the first end first.
    pub const PINS: [VertexId; 4] = [VertexId(0), VertexId(1), VertexId(6), VertexId(7)];

    /// Positions with the outer panels at the angles `left` and `right` to the vertical (radians, positive
    /// towards +x) and the middle panel horizontal. The middle panel has its length if the angles are equal
    /// or opposite.
    fn place(&self, left: f64, right: f64) -> Vec<f64> {
        let (x, z) = (self.length * left.sin(), -self.length * left.cos());
        let end = x + self.middle - self.length * right.sin();
        [[0.0, 0.0], [x, z], [x + self.middle, z], [end, 0.0]]
            .iter()
            .flat_map(|[x, z]| [*x, 0.0, *z, *x, 0.3, *z])
            .collect()
    }

    fn model_at(&self, x: Vec<f64>) -> SheetModel {
        let faces: Vec<[u32; 3]> = (0..3)
            .flat_map(|row| {
                let i = 2 * row;
                [[i, i + 2, i + 3], [i, i + 3, i + 1]]
            })
            .collect();
        let sheet = Sheet::new(x, &faces).expect("a strip");
        let mass = MassMatrix::from_vertex_masses(vec![self.mass; 8]).expect("positive");
        SheetModel::with_mass(&sheet, mass)
            .expect("positive masses")
            .with_acceleration([0.0, 0.0, -self.gravity])
            .with_pins(&Self::PINS)
            .expect("vertices exist")
    }

    /// The parallel linkage, whose ends are as far apart as the middle panel is long, displaced by an angle
    /// (radians), at rest.
    pub fn parallel(&self, angle: f64) -> (SheetModel, State) {
        let x = self.place(angle, angle);
        (self.model_at(x.clone()), State::at_rest(x))
    }

    /// The exact positions of the parallel linkage at time `t`: the middle panel translates, as a pendulum
    /// of the length of the outer panels does.
    pub fn exact(&self, amplitude: f64, t: f64) -> Vec<f64> {
        let pendulum = Pendulum {
            length: self.length,
            amplitude,
            gravity: self.gravity,
        };
        let x = pendulum.exact(t);
        let angle = x[6].atan2(-x[8]);
        self.place(angle, angle)
    }

    /// The trapezoid, whose outer panels are at opposite angles to the vertical. It is in equilibrium if
    /// each end is pulled inwards with the force [`Linkage::pull`].
    pub fn trapezoid(&self, angle: f64) -> (SheetModel, State) {
        let x = self.place(angle, -angle);
        (self.model_at(x.clone()), State::at_rest(x))
    }

    /// Horizontal force on each end of the trapezoid, newtons. Each outer panel carries the weight of the
    /// hinge below it, which gives `tan(angle) 2 m g`.
    pub fn pull(&self, angle: f64) -> f64 {
        2.0 * self.mass * self.gravity * angle.tan()
    }
}
