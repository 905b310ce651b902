//! Vertices of sheets that are glued to rigid bodies.

use crate::rigid_body::CarriedPoint;
use isosheet_materials::GlueError;
use isosheet_materials::hessian::HessianSink;
use isosheet_materials::potential::{At, CouplingKind, Potential};
use isosheet_materials::vectors::{add, point};
use isosheet_mesh::VertexId;
use nalgebra::{Matrix3, Vector3};

/// Springs that hold vertices at points that [rigid bodies](crate::RigidBody::carried) carry,
///
/// ```text
/// V(x) = k/2 sum_p |x_p - sum_k b_pk a_k|^2,
/// ```
///
/// with the stiffness `k` of each pair (newtons per metre), the corners `a_k` that carry the point, and its
/// weights.
#[derive(Debug, Clone)]
pub struct Attachment {
    pairs: Vec<(VertexId, CarriedPoint)>,
    stiffness: f64,
}

impl Attachment {
    /// Springs of the `stiffness` of each pair, newtons per metre.
    ///
    /// # Errors
    /// [`GlueError::Stiffness`].
    pub fn new(pairs: Vec<(VertexId, CarriedPoint)>, stiffness: f64) -> Result<Self, GlueError> {
        match stiffness.is_finite() && stiffness > 0.0 {
            true => Ok(Self { pairs, stiffness }),
            false => Err(GlueError::Stiffness { stiffness }),
        }
    }

    /// The force that each pair carries at positions `x` (`3V`, metres), newtons.
    pub fn pair_forces(&self, x: &[f64]) -> Vec<f64> {
        let pairs = self.pairs.iter();
        pairs
            .map(|pair| self.stiffness * Self::gap(pair, x).norm())
            .collect()
    }

    /// The vertices of a pair with their weights in what is between them.
    fn weights((vertex, carriers): &(VertexId, CarriedPoint)) -> [(VertexId, f64); 5] {
        let [a, b, c, d] = carriers.map(|(v, b)| (v, -b));
        [(*vertex, 1.0), a, b, c, d]
    }

    fn gap(pair: &(VertexId, CarriedPoint), x: &[f64]) -> Vector3<f64> {
        let parts = Self::weights(pair).into_iter();
        parts.map(|(v, w)| w * point(x, v)).sum()
    }
}

impl Potential for Attachment {
    fn energy(&self, at: At<'_>) -> f64 {
        let squares = self
            .pairs
            .iter()
            .map(|pair| Self::gap(pair, at.x).norm_squared());
        0.5 * self.stiffness * squares.sum::<f64>()
    }

    fn add_gradient(&self, at: At<'_>, gradient: &mut [f64]) {
        for pair in &self.pairs {
            let force = self.stiffness * Self::gap(pair, at.x);
            for (v, w) in Self::weights(pair) {
                add(gradient, v, &(w * force));
            }
        }
    }

    fn add_hessian(&self, _at: At<'_>, hessian: &mut dyn HessianSink) {
        for pair in &self.pairs {
            let weights = Self::weights(pair);
            for (i, (v, a)) in weights.iter().enumerate() {
                let block = |b: f64| Matrix3::from_diagonal_element(self.stiffness * a * b);
                hessian.add_vertex(*v, &block(*a));
                for (w, b) in &weights[i + 1..] {
                    hessian.add_pair(*v, *w, &block(*b));
                }
            }
        }
    }

    fn couplings(&self) -> Vec<[VertexId; 2]> {
        let pairs = self.pairs.iter().flat_map(|pair| {
            let vertices = Self::weights(pair).map(|(v, _)| v);
            (0..5).flat_map(move |i| (i + 1..5).map(move |j| [vertices[i], vertices[j]]))
        });
        pairs.collect()
    }

    fn coupling_kind(&self) -> CouplingKind {
        CouplingKind::Stiff
    }
}
