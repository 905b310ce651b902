//! Rank of the rigidity matrix.

use crate::SheetModel;
use isosheet_linalg::{Ordering, Pattern, SparseLdlt, elimination_order};
use isosheet_model::PINNED;
use nalgebra::{DMatrix, Vector3};

/// Rank of the length constraints at a state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
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
    /// there are more rods than unknowns, or none. Above a thousand rods to a factor of two.
    pub smallest: f64,
}

/// Smallest singular value (of the rigidity matrix with unit rods) below which dependence of
/// the rods is named as the reason of a failure: the referee integrations of the smoothest
/// known runs pass values down to 1e-6 only with steps of a microsecond.
const DEPENDENT_RODS: f64 = 1e-5;

/// Largest number of rods for which the dense singular values are computed: a few seconds.
const MAX_DENSE: usize = 1000;

/// Singular values below this count as zero where they are counted with squares, whose round-off is its
/// square.
const ROUND_OFF_OF_SQUARES: f64 = 1e-7;

/// Rank and smallest singular value of the rigidity matrix at positions `x`, rows scaled to
/// unit rods, pinned vertices left out. `None` if a position is not finite, or memory runs out.
///
/// Above a thousand rods singular values below 1e-7 count as zero: with the rigidity matrix `A` the matrix `A
/// A^T - s^2 I` has as many negative eigenvalues as there are singular values below `s`, which a sparse
/// factorisation `L D L^T` counts (Sylvester's law of inertia).
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
    if x.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if edges.len() > MAX_DENSE {
        return rank_by_inertia(model, x, &edges);
    }
    if edges.is_empty() {
        return Some(RodRank {
            rods: 0,
            rank: 0,
            deficiency: 0,
            nearly_dependent: 0,
            smallest: 0.0,
        });
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

/// The rank from counts of singular values.
fn rank_by_inertia(model: &SheetModel, x: &[f64], edges: &[[usize; 2]]) -> Option<RodRank> {
    let mut gram = Gram::new(model, x, edges)?;
    let dependent = gram.below(ROUND_OFF_OF_SQUARES)?;
    let nearly_dependent = gram.below(DEPENDENT_RODS)?;
    let (mut low, mut high) = (ROUND_OFF_OF_SQUARES, DEPENDENT_RODS);
    if dependent > 0 {
        high = 0.0;
    } else if nearly_dependent == 0 {
        // The largest singular value is at most the root of twice the largest number of rods at a vertex.
        (low, high) = (DEPENDENT_RODS, edges.len() as f64);
    }
    while high > 4.0 * low {
        let middle = (low * high).sqrt();
        match gram.below(middle)? {
            0 => low = middle,
            _ => high = middle,
        }
    }
    Some(RodRank {
        rods: edges.len(),
        rank: edges.len() - dependent,
        deficiency: dependent,
        nearly_dependent,
        smallest: (low * high).sqrt(),
    })
}

/// The matrix `A A^T - s^2 I` of the rigidity matrix `A` of unit rods.
struct Gram {
    ldlt: SparseLdlt,
    /// Values without the shift.
    values: Vec<f64>,
    /// Slots of the diagonal.
    diagonal: Vec<u32>,
}

impl Gram {
    fn new(model: &SheetModel, x: &[f64], edges: &[[usize; 2]]) -> Option<Self> {
        let free = model.free_index();
        let mut at_vertex: Vec<Vec<(u32, Vector3<f64>)>> = vec![Vec::new(); free.len()];
        for (row, &[a, b]) in edges.iter().enumerate() {
            let at = |v: usize| Vector3::from_column_slice(&x[3 * v..3 * v + 3]);
            let direction = (at(a) - at(b)).normalize();
            at_vertex[a].push((row as u32, direction));
            at_vertex[b].push((row as u32, -direction));
        }
        let count = edges.len() as u32;
        let mut entries: Vec<(u32, u32)> = (0..count).map(|i| (i, i)).collect();
        let mut products = vec![0.0; edges.len()];
        for (rods, _) in at_vertex.iter().zip(free).filter(|(_, f)| **f != PINNED) {
            for (i, d) in rods {
                for (j, e) in rods.iter().filter(|(j, _)| j <= i) {
                    entries.push((*i, *j));
                    products.push(d.dot(e));
                }
            }
        }
        let (pattern, slots) = Pattern::from_entries(edges.len(), edges.len(), &entries);
        let order = elimination_order(&pattern, 1, Ordering::MinimumDegree);
        let mut values = vec![0.0; pattern.len()];
        for (slot, product) in slots.iter().zip(&products) {
            values[*slot as usize] += product;
        }
        Some(Self {
            ldlt: SparseLdlt::new(pattern, &order).ok()?,
            values,
            diagonal: slots[..edges.len()].to_vec(),
        })
    }

    /// Number of singular values below a bound.
    fn below(&mut self, bound: f64) -> Option<usize> {
        let values = self.ldlt.values_mut();
        values.copy_from_slice(&self.values);
        for slot in &self.diagonal {
            values[*slot as usize] -= bound * bound;
        }
        self.ldlt.factorize().ok()?;
        Some(self.ldlt.negative_eigenvalues())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::{MassKind, Sheet, generate};

    #[test]
    fn flat_sheets_have_as_many_dependent_rods_as_interior_vertices() {
        for (level, interior) in [(0, 1), (1, 9), (2, 49)] {
            let sheet = generate::isotropic_square(level, 0.3).expect("valid");
            let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
            let rank = rod_rank(&model, sheet.positions()).expect("small");
            assert_eq!(rank.deficiency, interior, "M^{level}");
        }
    }

    /// Meshes of more than a thousand rods have an answer as well.
    #[test]
    fn large_flat_sheets_have_as_many_dependent_rods_as_interior_vertices() {
        let sheet = generate::isotropic_square(4, 0.3).expect("valid");
        let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).expect("valid");
        let rank = rod_rank(&model, sheet.positions()).expect("finite");
        assert!(rank.rods > MAX_DENSE);
        let interior = sheet.topology().vertex_ids();
        let interior = interior.filter(|v| !sheet.topology().is_boundary_vertex(*v));
        assert_eq!((rank.deficiency, rank.smallest), (interior.count(), 0.0));
    }

    /// Counts and bisection agree with the dense singular values.
    #[test]
    fn inertia_counts_singular_values() {
        for fold in [1e-6, 1e-4, 0.2] {
            let flat = generate::isotropic_square(1, 1.0).unwrap();
            let mut x = flat.positions().to_vec();
            for p in x.chunks_mut(3) {
                p[2] = fold * (3.0 * p[0]).sin() * (1.0 + p[1]);
            }
            let sheet = Sheet::new(x.clone(), &flat.face_indices()).unwrap();
            let model = SheetModel::new(&sheet, 0.1, MassKind::Lumped).unwrap();
            let dense = rod_rank(&model, &x).unwrap();
            let counted = rank_by_inertia(&model, &x, model.rods().edges()).unwrap();
            assert_eq!(counted.nearly_dependent, dense.nearly_dependent, "{fold}");
            let ratio = counted.smallest / dense.smallest;
            let is_zero = counted.smallest == 0.0 && dense.smallest < ROUND_OFF_OF_SQUARES;
            assert!(is_zero || (0.5..=2.0).contains(&ratio), "{fold}: {ratio}");
        }
    }
}
