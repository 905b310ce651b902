//! Rank of the rigidity matrix.

use crate::SheetModel;
use crate::model::PINNED;
use nalgebra::DMatrix;

/// Rank of the length constraints at a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RodRank {
    /// Rods with at least one free end.
    pub rods: usize,
    /// Rank of their rigidity matrix.
    pub rank: usize,
    /// Number of dependent rods, `rods - rank`.
    pub deficiency: usize,
    /// Number of rods that are dependent but for singular values below 1e-5, those included.
    pub nearly_dependent: usize,
    /// Smallest singular value of the rigidity matrix with rows scaled to unit rods; zero if
    /// there are more rods than unknowns.
    pub smallest: f64,
}

/// Smallest singular value (of the rigidity matrix with unit rods) below which dependence of
/// the rods is named as the reason of a failure: the referee integrations of the smoothest
/// known runs pass values down to 1e-6 only with steps of a microsecond.
const DEPENDENT_RODS: f64 = 1e-5;

/// Largest order for which the dense singular values are computed: a few seconds.
const MAX_ORDER: usize = 1000;

/// Rank and smallest singular value of the rigidity matrix at positions `x`, rows scaled to
/// unit rods, pinned vertices left out. `None` if the mesh has more than a thousand rods.
pub fn rod_rank(model: &SheetModel, x: &[f64]) -> Option<RodRank> {
    let free = model.free_index();
    let columns = 3 * model.free_count();
    let edges: Vec<[usize; 2]> = model
        .rods()
        .edges()
        .iter()
        .copied()
        .filter(|e| e.iter().any(|&v| free[v] != PINNED))
        .collect();
    if edges.len() > MAX_ORDER {
        return None;
    }
    let mut matrix = DMatrix::zeros(edges.len(), columns);
    for (row, &[a, b]) in edges.iter().enumerate() {
        let d: [f64; 3] = std::array::from_fn(|k| x[3 * a + k] - x[3 * b + k]);
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        for (v, sign) in [(a, 1.0), (b, -1.0)] {
            if free[v] != PINNED {
                for k in 0..3 {
                    matrix[(row, 3 * free[v] as usize + k)] = sign * d[k] / length;
                }
            }
        }
    }
    let values = matrix.singular_values();
    let largest = values.max();
    let tolerance = largest * f64::EPSILON * edges.len().max(columns) as f64;
    let rank = values.iter().filter(|s| **s > tolerance).count();
    let nearly_independent = values.iter().filter(|s| **s >= DEPENDENT_RODS).count();
    let smallest = if edges.len() > columns {
        0.0
    } else {
        values.min()
    };
    Some(RodRank {
        rods: edges.len(),
        rank,
        deficiency: edges.len() - rank,
        nearly_dependent: edges.len() - nearly_independent,
        smallest,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, generate};

    #[test]
    fn flat_sheets_have_as_many_dependent_rods_as_interior_vertices() {
        for (level, interior) in [(0, 1), (1, 9), (2, 49)] {
            let sheet = generate::isotropic_square(level, 0.3).expect("valid");
            let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
            let rank = rod_rank(&model, sheet.positions()).expect("small");
            assert_eq!(rank.deficiency, interior, "M^{level}");
        }
    }
}
