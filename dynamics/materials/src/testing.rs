//! Second derivatives of a potential as a matrix, for tests.

use crate::hessian::{HessianPart, HessianProduct};
use crate::potential::{At, Potential};
use isosheet_mesh::Topology;
use nalgebra::DMatrix;

/// The product of a part of the second derivatives and a vector (`3V`).
pub(crate) fn product(
    topology: &Topology,
    potential: &dyn Potential,
    (at, part): (At<'_>, HessianPart),
    vector: &[f64],
) -> Vec<f64> {
    let edges: Vec<[usize; 2]> = topology
        .edges()
        .iter()
        .map(|e| e.map(|v| v.index()))
        .collect();
    let mut product = vec![0.0; vector.len()];
    let mut sink = HessianProduct {
        edges: &edges,
        scale: 1.0,
        vector,
        product: &mut product,
    };
    match part {
        HessianPart::Full => potential.add_hessian(at, &mut sink),
        HessianPart::PositiveSemidefinite => potential.add_semidefinite_hessian(at, &mut sink),
        HessianPart::Certain => {}
    }
    product
}

/// All second derivatives.
pub(crate) fn hessian(topology: &Topology, potential: &dyn Potential, at: At<'_>) -> DMatrix<f64> {
    let n = at.x.len();
    let mut matrix = DMatrix::zeros(n, n);
    for i in 0..n {
        let mut unit = vec![0.0; n];
        unit[i] = 1.0;
        let column = product(topology, potential, (at, HessianPart::Full), &unit);
        matrix.column_mut(i).copy_from_slice(&column);
    }
    matrix
}
