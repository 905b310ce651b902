//! Small motions out of the plane of a flat sheet: stiffness matrices and eigenvalues.

use anyhow::Result;
use isosheet_dynamics::nalgebra::{DMatrix, DVector, Matrix3};
use isosheet_dynamics::{At, HessianSink, SheetModel};
use isosheet_linalg::{Pattern, SparseLlt};
use isosheet_mesh::{EdgeId, Topology, VertexId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A symmetric matrix by its entries on and below the diagonal; entries at the same place are added.
#[derive(Clone, Default)]
pub(super) struct Symmetric {
    order: usize,
    entries: Vec<(u32, u32, f64)>,
}

impl Symmetric {
    pub(super) fn diagonal(values: &[f64]) -> Self {
        let entry = |(k, value): (usize, &f64)| (k as u32, k as u32, *value);
        Self {
            order: values.len(),
            entries: values.iter().enumerate().map(entry).collect(),
        }
    }

    /// The difference of two matrices, times a factor.
    pub(super) fn minus(&self, other: &Self, factor: f64) -> Self {
        let own = self.entries.iter().map(|(r, c, v)| (*r, *c, factor * v));
        let others = other.entries.iter().map(|(r, c, v)| (*r, *c, -factor * v));
        Self {
            order: self.order,
            entries: own.chain(others).collect(),
        }
    }

    fn product(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let mut y = DMatrix::zeros(x.nrows(), x.ncols());
        for &(r, c, value) in &self.entries {
            let (r, c) = (r as usize, c as usize);
            for k in 0..x.ncols() {
                y[(r, k)] += value * x[(c, k)];
                if r != c {
                    y[(c, k)] += value * x[(r, k)];
                }
            }
        }
        y
    }

    fn factorised(&self) -> Result<SparseLlt> {
        let places: Vec<(u32, u32)> = self.entries.iter().map(|(r, c, _)| (*r, *c)).collect();
        let (pattern, slots) = Pattern::from_entries(self.order, self.order, &places);
        let mut factor = SparseLlt::new(pattern)?;
        for (slot, (.., value)) in slots.iter().zip(&self.entries) {
            factor.values_mut()[*slot as usize] += value;
        }
        factor.factorize()?;
        Ok(factor)
    }
}

/// What is added to the rows of the free vertices.
struct Upwards<'a> {
    topology: &'a Topology,
    /// Rows of the vertices; pinned ones have none.
    rows: Vec<Option<u32>>,
    entries: Vec<(u32, u32, f64)>,
}

impl HessianSink for Upwards<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.add_pair(v, v, block);
    }

    fn add_edge(&mut self, edge: EdgeId, block: &Matrix3<f64>) {
        let [a, b] = self.topology.edges()[edge.index()];
        self.add_pair(a, b, block);
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        if let [Some(a), Some(b)] = [a, b].map(|v| self.rows[v.index()]) {
            self.entries.push((a.max(b), a.min(b), block[(2, 2)]));
        }
    }
}

/// The vertices of a model that are not pinned.
pub(super) fn free(model: &SheetModel) -> Vec<VertexId> {
    let all = model.topology().vertex_ids();
    all.filter(|v| !model.is_pinned(*v)).collect()
}

/// The second derivatives of the energy of a model at positions `x` by the heights of the free vertices.
pub(super) fn stiffness(model: &SheetModel, x: &[f64]) -> Symmetric {
    let mut rows = vec![None; model.topology().vertex_count()];
    let free = free(model);
    for (row, v) in free.iter().enumerate() {
        rows[v.index()] = Some(row as u32);
    }
    let mut upwards = Upwards {
        topology: model.topology(),
        rows,
        entries: Vec::new(),
    };
    for potential in model.potentials() {
        let memory = potential
            .remembering()
            .map_or_else(Vec::new, |p| p.memory());
        potential.add_hessian(At::new(0.0, x).with_memory(&memory), &mut upwards);
    }
    Symmetric {
        order: free.len(),
        entries: upwards.entries,
    }
}

/// Vectors of the subspace, and its iterations.
const VECTORS: usize = 10;
const ITERATIONS: usize = 60;

/// The smallest positive `lambda` with `a z = lambda b z`, in rising order; `a` is positive definite.
/// (Subspace iteration: K.-J. Bathe, *Finite Element Procedures*, section 11.6.)
pub(super) fn eigenvalues(a: &Symmetric, b: &Symmetric) -> Result<Vec<f64>> {
    let mut factor = a.factorised()?;
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut vectors = DMatrix::from_fn(a.order, VECTORS, |_, _| rng.random_range(-1.0..1.0));
    let mut values = DVector::zeros(VECTORS);
    for _ in 0..ITERATIONS {
        // `a w = b v`, so that `w^T a w = w^T b v`.
        let loads = b.product(&vectors);
        let mut moved = loads.clone();
        for mut column in moved.column_iter_mut() {
            factor.solve(column.as_mut_slice());
        }
        let of_a = moved.transpose() * a.product(&moved);
        let of_b = moved.transpose() * b.product(&moved);
        let Some(root) = of_a.clone().cholesky() else {
            anyhow::bail!("the subspace has collapsed")
        };
        let inverse = root
            .l()
            .try_inverse()
            .unwrap_or_else(|| DMatrix::identity(VECTORS, VECTORS));
        let reduced = &inverse * of_b * inverse.transpose();
        let eigen = (0.5 * (&reduced + reduced.transpose())).symmetric_eigen();
        vectors = moved * inverse.transpose() * eigen.eigenvectors;
        values = eigen.eigenvalues;
    }
    let mut found: Vec<f64> = values
        .iter()
        .map(|v| 1.0 / v)
        .filter(|v| *v > 0.0)
        .collect();
    found.sort_by(f64::total_cmp);
    Ok(found)
}
