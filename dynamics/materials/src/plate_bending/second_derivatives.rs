//! How a sheet is curved, face by face.

use super::law::Roots;
use super::stencil::{POINTS, Stencils};
use crate::potential::At;
use crate::vectors::add;
use isosheet_mesh::VertexId;
use nalgebra::Matrix3;
use std::sync::Arc;

/// The second derivatives of the positions of a plate by its material coordinates.
#[derive(Debug, Clone)]
pub(crate) struct SecondDerivatives {
    stencils: Arc<Stencils>,
    /// Of each face, the inverse of the root of its law over `sqrt(D A)`.
    inverses: Vec<Matrix3<f64>>,
}

impl SecondDerivatives {
    /// Of a plate with rigidity.
    pub(super) fn new(stencils: &Arc<Stencils>, roots: &Roots, areas: &[f64]) -> Self {
        let inverse = |(face, area): (usize, &f64)| {
            // The mean of the points, each with its part of the area.
            let scale = 1.0 / (roots.rigidity(face) * area * POINTS as f64).sqrt();
            roots.inverse(face) * scale
        };
        Self {
            stencils: Arc::clone(stencils),
            inverses: areas.iter().enumerate().map(inverse).collect(),
        }
    }

    /// Whether others are those of as many faces, and neither has clamps along lines.
    pub(crate) fn are_comparable(&self, other: &Self) -> bool {
        self.stencils.are_comparable(&other.stencils)
    }

    /// Whether those of a face are the same as others at all positions, where they are comparable.
    pub(crate) fn is_same(&self, other: &Self, face: usize) -> bool {
        let mut points = POINTS * face..POINTS * (face + 1);
        self.inverses[face] == other.inverses[face]
            && points.all(|point| self.stencils.is_same(&other.stencils, point))
    }

    /// Of a face at a time and positions, as [`SecondDerivatives::at`].
    pub(crate) fn of_face(&self, face: usize, at: At<'_>) -> Matrix3<f64> {
        let points = POINTS * face..POINTS * (face + 1);
        let sum: Matrix3<f64> = points.map(|point| self.stencils.of(point).apply(at)).sum();
        sum * self.inverses[face]
    }

    /// Of each face at a time and positions: a row for each component of the positions, with the components
    /// `(11, sqrt(2) 12, 22)`, the first axis along the first edge of the face; 1/m.
    pub(crate) fn at<'a>(&'a self, at: At<'a>) -> impl Iterator<Item = Matrix3<f64>> + 'a {
        let mut points = self.stencils.iter();
        self.inverses.iter().map(move |inverse| {
            let of_face = points.by_ref().take(POINTS);
            let sum: Matrix3<f64> = of_face.map(|stencil| stencil.apply(at)).sum();
            sum * inverse
        })
    }

    /// Adds the derivatives of a number by positions (`3V`) with those by the second derivatives of each
    /// face.
    pub(crate) fn add_transposed(&self, of: &[Matrix3<f64>], of_x: &mut [f64]) {
        let mut points = self.stencils.iter();
        for (of, inverse) in of.iter().zip(&self.inverses) {
            let of_sum = of * inverse.transpose();
            for stencil in points.by_ref().take(POINTS) {
                for (v, weights) in stencil {
                    add(of_x, VertexId::from_index(v), &(of_sum * weights));
                }
            }
        }
    }
}
