//! Matrices of the potentials of a model, for tests.

use super::PrimalMatrix;
use crate::SheetModel;
use isosheet_materials::hessian::HessianPart;
use isosheet_materials::potential::Memories;

/// Adds `scale` times the second derivatives of the potentials, where nothing has happened yet that they
/// remember.
pub(crate) fn add_potentials(
    matrix: &mut PrimalMatrix,
    model: &SheetModel,
    t: f64,
    x: &[f64],
    scale: f64,
) {
    let at = (t, x, &model.memories());
    add_potentials_with(matrix, model, at, HessianPart::Full, scale);
}

/// Adds `scale` times a part of the second derivatives of the potentials with memories.
pub(crate) fn add_potentials_with(
    matrix: &mut PrimalMatrix,
    model: &SheetModel,
    (t, x, memories): (f64, &[f64], &Memories),
    part: HessianPart,
    scale: f64,
) {
    let sink = &mut matrix.scaled_sink(model, scale);
    for (p, at) in model.potentials_at(t, x, memories) {
        match part {
            HessianPart::Full => p.add_hessian(at, sink),
            HessianPart::PositiveSemidefinite => p.add_semidefinite_hessian(at, sink),
            HessianPart::Certain => {}
        }
    }
}
