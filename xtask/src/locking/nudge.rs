//! Forces that choose among states of rest, and supports that hold from one side.
use isosheet_dynamics::At;

use isosheet_dynamics::{HessianSink, Potential};
use isosheet_mesh::VertexId;
use nalgebra::Matrix3;

/// Vertical forces on some vertices that become smaller and are zero from some time on: they choose one of
/// several equivalent states of rest, and have no part in it.
#[derive(Debug)]
pub(super) struct Nudge {
    /// Vertices with their upward forces at first, newtons.
    pub(super) forces: Vec<(VertexId, f64)>,
    /// When the forces are gone, seconds.
    pub(super) end: f64,
}

impl Nudge {
    fn factor(&self, t: f64) -> f64 {
        (1.0 - t / self.end).max(0.0)
    }
}

impl Potential for Nudge {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { t, x, .. } = at;
        let work = self.forces.iter().map(|(v, f)| f * x[3 * v.index() + 2]);
        -self.factor(t) * work.sum::<f64>()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { t, .. } = at;
        for (v, f) in &self.forces {
            gradient[3 * v.index() + 2] -= self.factor(t) * f;
        }
    }

    fn is_driven(&self) -> bool {
        true
    }
}

/// Springs without friction that push vertices up from below the plane z = 0, and do nothing above.
#[derive(Debug)]
pub(super) struct Ring {
    pub(super) rim: Vec<VertexId>,
    /// Stiffness at each vertex, newtons per metre.
    pub(super) stiffness: f64,
}

impl Ring {
    /// How far each vertex of the rim is below the plane, metres.
    fn depths<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = (VertexId, f64)> + 'a {
        let depth = |v: &VertexId| (*v, -x[3 * v.index() + 2]);
        self.rim.iter().map(depth).filter(|(_, depth)| *depth > 0.0)
    }
}

impl Potential for Ring {
    fn energy(&self, at: At<'_>) -> f64 {
        let At { x, .. } = at;
        let squares = self.depths(x).map(|(_, depth)| depth * depth);
        0.5 * self.stiffness * squares.sum::<f64>()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        let At { x, .. } = at;
        for (v, depth) in self.depths(x) {
            gradient[3 * v.index() + 2] -= self.stiffness * depth;
        }
    }

    fn add_hessian(&self, at: At<'_>, hessian: &mut dyn HessianSink) {
        let At { x, .. } = at;
        let mut block = Matrix3::zeros();
        block[(2, 2)] = self.stiffness;
        for (v, _) in self.depths(x) {
            hessian.add_vertex(v, &block);
        }
    }
}
