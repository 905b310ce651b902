//! The saddle-point matrix `[M G^T; G 0]`, factorised.

use crate::system::RodSystem;
use isosheet_linalg::{LinalgError, Pattern, SparseLu};
use isosheet_mesh::MassMatrix;

/// Sparse LU of the saddle-point matrix of a rod system.
///
/// The mass-matrix solve of any chart is one solve with it: eliminating the multipliers gives
///
/// ```text
/// C qdot = p   <=>   [ M  G^T ] [ v ]   [ S^T p ]
///                    [ G   0  ] [ mu] = [   0   ] ,   qdot = S v.
/// ```
///
/// Neither J nor C is formed, and the accuracy does not depend on the chart. The matrix is scaled by
/// the mean mass and the mean rod length, so that both kinds of blocks have entries of order one.
pub struct SaddlePoint {
    lu: SparseLu,
    mass_slots: Vec<(u32, f64)>,
    rod_slots: Vec<u32>,
    unknowns: usize,
    mass_scale: f64,
    length_scale: f64,
    work: Vec<f64>,
}

impl SaddlePoint {
    /// Symbolic analysis for a system and its mass matrix.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] when memory runs out.
    pub fn new(system: &RodSystem, mass: &MassMatrix) -> Result<Self, LinalgError> {
        let unknowns = system.unknowns();
        let order = unknowns + system.equations();
        let mut entries = Vec::new();
        let mut masses = Vec::new();
        mass_entries(system, mass, |i, j, m| {
            entries.push((i, j));
            masses.push(m);
        });
        for (e, u) in system.jacobian_entries() {
            entries.push((unknowns as u32 + e, u));
            entries.push((u, unknowns as u32 + e));
        }
        let (pattern, slots) = Pattern::from_entries(order, order, &entries);
        let mass_scale = system
            .free_vertices()
            .iter()
            .map(|v| mass.vertex[v.index()])
            .sum::<f64>()
            / system.free_vertices().len() as f64;
        let length_scale =
            system.rods().iter().map(|r| r.length).sum::<f64>() / system.equations() as f64;
        let count = masses.len();
        Ok(Self {
            lu: SparseLu::new(pattern)?,
            mass_slots: slots[..count].iter().copied().zip(masses).collect(),
            rod_slots: slots[count..].to_vec(),
            unknowns,
            mass_scale,
            length_scale,
            work: vec![0.0; order],
        })
    }

    /// Numeric factorisation at the state x.
    ///
    /// # Errors
    /// [`LinalgError::Singular`]. A flat state may pass here and fail in [`SaddlePoint::solve`].
    pub fn factorize(&mut self, system: &RodSystem, x: &[f64]) -> Result<(), LinalgError> {
        let values = self.lu.values_mut();
        values.fill(0.0);
        for (slot, m) in &self.mass_slots {
            values[*slot as usize] += m / self.mass_scale;
        }
        for (pair, value) in self
            .rod_slots
            .chunks_exact(2)
            .zip(system.jacobian_values(x))
        {
            values[pair[0] as usize] += value / self.length_scale;
            values[pair[1] as usize] += value / self.length_scale;
        }
        self.lu.factorize()
    }

    /// Solve `M v + G^T mu = force, G v = rate`, with iterative refinement. Returns the backward error.
    ///
    /// # Errors
    /// [`LinalgError::Singular`] where the length equations are dependent.
    pub fn solve(
        &mut self,
        force: &[f64],
        rate: &[f64],
        v: &mut [f64],
        mu: &mut [f64],
    ) -> Result<f64, LinalgError> {
        let (top, bottom) = self.work.split_at_mut(self.unknowns);
        for (t, f) in top.iter_mut().zip(force) {
            *t = f / self.mass_scale;
        }
        for (b, r) in bottom.iter_mut().zip(rate) {
            *b = r / self.length_scale;
        }
        let error = self.lu.solve_refined(&mut self.work)?;
        let (top, bottom) = self.work.split_at(self.unknowns);
        v.copy_from_slice(top);
        for (m, b) in mu.iter_mut().zip(bottom) {
            *m = b * self.mass_scale / self.length_scale;
        }
        Ok(error)
    }
}

/// Every entry `(i, j, m)` of the mass matrix on the unknowns, both triangles.
pub(crate) fn mass_entries(
    system: &RodSystem,
    mass: &MassMatrix,
    mut emit: impl FnMut(u32, u32, f64),
) {
    for (k, v) in system.free_vertices().iter().enumerate() {
        for i in 0..3 {
            let u = (3 * k + i) as u32;
            emit(u, u, mass.vertex[v.index()]);
        }
    }
    let Some(edge_mass) = &mass.edge else {
        return;
    };
    for rod in system.rods() {
        if let [Some(a), Some(b)] = rod.unknown {
            for i in 0..3 {
                emit(a + i, b + i, edge_mass[rod.edge.index()]);
                emit(b + i, a + i, edge_mass[rod.edge.index()]);
            }
        }
    }
}

/// `out = M v` on the unknowns.
pub fn apply_mass(system: &RodSystem, mass: &MassMatrix, v: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    mass_entries(system, mass, |i, j, m| {
        out[i as usize] += m * v[j as usize];
    });
}
