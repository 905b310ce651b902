//! How a sheet is curved, face by face.

use super::stencil::Stencils;
use super::stiffness::PlateStiffness;
use nalgebra::Matrix3;
use std::sync::Arc;

/// The second derivatives of the positions of a plate by its material coordinates.
#[derive(Debug, Clone)]
pub(crate) struct SecondDerivatives {
    stencils: Arc<Stencils>,
    /// The inverse of the root of the law of the plate.
    inverse: Matrix3<f64>,
    /// Of each face, `1 / sqrt(D A)`.
    scales: Vec<f64>,
}

impl SecondDerivatives {
    /// Of a plate with rigidity.
    pub(super) fn new(stencils: &Arc<Stencils>, stiffness: PlateStiffness, areas: &[f64]) -> Self {
        let scale = |area: &f64| 1.0 / (stiffness.rigidity * area).sqrt();
        Self {
            stencils: Arc::clone(stencils),
            inverse: stiffness.inverse_root(),
            scales: areas.iter().map(scale).collect(),
        }
    }

    /// Of each face at positions: a row for each component of the positions, with the components `(11,
    /// sqrt(2) 12, 22)`, the first axis along the first edge of the face; 1/m.
    pub(crate) fn at<'a>(&'a self, x: &'a [f64]) -> impl Iterator<Item = Matrix3<f64>> + 'a {
        let faces = self.stencils.iter().zip(&self.scales);
        faces.map(|(stencil, scale)| stencil.apply(x) * self.inverse * *scale)
    }
}
