//! A free sheet that flies and tumbles.

use isosheet_dynamics::{SheetModel, State};
use isosheet_mesh::{MassKind, Sheet};
use nalgebra::{DMatrix, DVector};

/// A sheet of 0.1 kg about the square `[0, 1]^2` (metres) without gravity and supports, and a start in its
/// rest positions at which it flies, turns and bends: smooth velocities, made compatible with the lengths.
pub fn tumbling(sheet: &Sheet) -> (SheetModel, State) {
    tumbling_from(sheet, sheet.positions().to_vec())
}

/// A sheet of 0.1 kg about the square `[0, 1]^2` (metres) without gravity and supports, and a start in other
/// positions (3V, metres) that keep the lengths, at which it flies, turns and bends: smooth velocities, made
/// compatible with the lengths.
pub fn tumbling_from(sheet: &Sheet, x: Vec<f64>) -> (SheetModel, State) {
    let model = SheetModel::new(sheet, 0.1, MassKind::Lumped).expect("valid");
    let v = x.chunks(3).flat_map(|p| {
        [
            0.3 - 2.0 * p[1] + p[2],
            0.1 + 2.0 * p[0],
            1.0 - p[0] + 0.8 * (p[0] - 0.5) * (p[1] - 0.3),
        ]
    });
    let v = compatible(&model, &x, DVector::from_iterator(x.len(), v));
    (model, State::moving(x, v))
}

/// The velocities nearest to the given ones, in the sense of lumped masses, that keep the lengths at
/// positions `x`.
fn compatible(model: &SheetModel, x: &[f64], v: DVector<f64>) -> Vec<f64> {
    let rods = model.rods();
    // A column for each rod: the momentum of a unit of its impulse, and the velocity.
    let mut momenta = DMatrix::zeros(x.len(), rods.len());
    for e in 0..rods.len() {
        let mut unit = vec![0.0; rods.len()];
        unit[e] = 1.0;
        rods.apply_transpose_add(x, &unit, momenta.column_mut(e).as_mut_slice());
    }
    let masses = model.mass().vertex.iter().flat_map(|m| [1.0 / m; 3]);
    let masses = DVector::from_iterator(x.len(), masses);
    let velocities = DMatrix::from_diagonal(&masses) * &momenta;
    let rates = momenta.tr_mul(&v);
    let inverse_masses = momenta.tr_mul(&velocities).svd(true, true);
    let impulses = inverse_masses.solve(&rates, 1e-12).expect("both factors");
    (v - velocities * impulses).data.into()
}
