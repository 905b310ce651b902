//! Free coordinates, and the penalties of rods between them.

use crate::SheetModel;
use isosheet_model::PINNED;

/// Copies the free entries of `full` (`3V`) into `packed`.
pub(crate) fn gather(model: &SheetModel, full: &[f64], packed: &mut [f64]) {
    for (v, &i) in model.free_index().iter().enumerate() {
        if i != PINNED {
            let i = 3 * i as usize;
            packed[i..i + 3].copy_from_slice(&full[3 * v..3 * v + 3]);
        }
    }
}

/// Copies `packed` to the free entries of `full` (`3V`) and zeroes the others.
pub(crate) fn scatter(model: &SheetModel, packed: &[f64], full: &mut [f64]) {
    for (v, &i) in model.free_index().iter().enumerate() {
        let row = &mut full[3 * v..3 * v + 3];
        if i == PINNED {
            row.fill(0.0);
        } else {
            let i = 3 * i as usize;
            row.copy_from_slice(&packed[i..i + 3]);
        }
    }
}

/// Penalty of each rod, `kappa` times the inverse of `G M^-1 G^T` at rest: `kappa m_e / l_e^2` with `m_e` the
/// reduced mass of its free ends, kilograms per square metre. It is scale free, so that slivers and heavy
/// vertices are treated alike.
pub(crate) fn penalties(model: &SheetModel, kappa: f64) -> Vec<f64> {
    let rods = model.rods();
    let inverse = |v: usize| {
        if model.free_index()[v] == PINNED {
            0.0
        } else {
            1.0 / model.mass().vertex[v]
        }
    };
    rods.edges()
        .iter()
        .zip(rods.lengths())
        .map(|(&[a, b], l)| {
            let sum = inverse(a) + inverse(b);
            if sum == 0.0 {
                0.0
            } else {
                kappa / (sum * l * l)
            }
        })
        .collect()
}
