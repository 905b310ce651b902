//! The four vertices of a rigid body, and how impulses move them.

use crate::{SheetModel, State};
use isosheet_mesh::VertexId;
use nalgebra::{DMatrix, DVector, Matrix4, Vector3};

/// The four vertices of a rigid body.
pub(super) struct ImpactBody {
    pub(super) first: usize,
    mass: Matrix4<f64>,
    /// Velocities of the vertices (12) in the motions that guides leave to the body, by columns.
    motions: DMatrix<f64>,
}

impl ImpactBody {
    pub(super) fn new(model: &SheetModel, state: &State, first: usize) -> Self {
        let place = |k: usize| {
            let v = 3 * (first + k);
            Vector3::from_column_slice(&state.x[v..v + 3])
        };
        let vertex = |k: usize| VertexId::from_index(first + k);
        let centre = (0..4).map(place).sum::<Vector3<f64>>() / 4.0;
        let size = (0..4)
            .map(|k| (place(k) - centre).norm())
            .fold(0.0, f64::max);
        let mut fields = DMatrix::zeros(12, 6);
        for k in 0..4 {
            for axis in 0..3 {
                let unit = Vector3::ith(axis, 1.0);
                let turned = unit.cross(&(place(k) - centre)) / size;
                fields.fixed_view_mut::<3, 1>(3 * k, axis).copy_from(&unit);
                fields
                    .fixed_view_mut::<3, 1>(3 * k, 3 + axis)
                    .copy_from(&turned);
            }
        }
        let mut fixed: Vec<[f64; 6]> = Vec::new();
        let mut fix = |k: usize, direction: &Vector3<f64>| {
            let row = fields.rows(3 * k, 3).tr_mul(direction);
            fixed.push(std::array::from_fn(|i| row[i]));
        };
        for k in (0..4).filter(|k| model.is_pinned(vertex(*k))) {
            for axis in 0..3 {
                fix(k, &Vector3::ith(axis, 1.0));
            }
        }
        for constraint in model.constraints() {
            let v = constraint.vertex().index();
            if (first..first + 4).contains(&v) {
                let equations = constraint.at(state.t, &place(v - first));
                let rows = equations.independent() * equations.jacobian;
                for row in rows.row_iter() {
                    fix(v - first, &row.transpose());
                }
            }
        }
        Self {
            first,
            mass: mass_matrix(model, first),
            motions: &fields * allowed(&fixed),
        }
    }

    /// `A J`: the velocities that impulses (12, newton seconds) give the body as it is guided.
    fn response_velocities(&self, impulses: &DVector<f64>) -> DVector<f64> {
        let weighted = DMatrix::from_fn(12, self.motions.ncols(), |row, column| {
            let (k, axis) = (row / 3, row % 3);
            (0..4)
                .map(|j| self.mass[(k, j)] * self.motions[(3 * j + axis, column)])
                .sum()
        });
        let inertia = self.motions.tr_mul(&weighted);
        let driving = self.motions.tr_mul(impulses);
        match inertia.cholesky() {
            Some(inertia) => &self.motions * inertia.solve(&driving),
            None => DVector::zeros(12),
        }
    }

    /// `J . A J`, joules.
    pub(super) fn response(&self, impulses: &DVector<f64>) -> f64 {
        impulses.dot(&self.response_velocities(impulses))
    }

    /// `A J` at each vertex.
    pub(super) fn velocities(&self, impulses: &DVector<f64>) -> [Vector3<f64>; 4] {
        let all = self.response_velocities(impulses);
        std::array::from_fn(|k| all.fixed_rows::<3>(3 * k).into_owned())
    }
}

/// The mass matrix of the four vertices of a body, kilograms.
pub(in crate::damped) fn mass_matrix(model: &SheetModel, first: usize) -> Matrix4<f64> {
    let vertex = |k: usize| VertexId::from_index(first + k);
    Matrix4::from_fn(|i, j| match (i == j, &model.mass().edge) {
        (true, _) => model.mass().vertex[first + i],
        (false, None) => 0.0,
        (false, Some(edges)) => {
            let edge = model.topology().find_edge(vertex(i), vertex(j));
            edge.map_or(0.0, |e| edges[e.index()])
        }
    })
}

/// The combinations of six motions, by columns, in which nothing moves along these rows.
fn allowed(rows: &[[f64; 6]]) -> DMatrix<f64> {
    let square = DMatrix::from_fn(6, 6, |i, j| rows.iter().map(|row| row[i] * row[j]).sum());
    let eigen = nalgebra::SymmetricEigen::new(square);
    let largest = eigen.eigenvalues.max();
    let free = (0..6).filter(|i| eigen.eigenvalues[*i] <= f64::EPSILON.sqrt() * largest);
    let columns: Vec<_> = free
        .map(|i| eigen.eigenvectors.column(i).into_owned())
        .collect();
    match columns.is_empty() {
        true => DMatrix::zeros(6, 0),
        false => DMatrix::from_columns(&columns),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_guides_forbid_is_no_motion() {
        assert_eq!(allowed(&[]).ncols(), 6);
        let left = allowed(&[
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        ]);
        assert_eq!(left.ncols(), 4);
        for column in left.column_iter() {
            assert!((column[0] + column[5]).abs() < 1e-14 && column[1].abs() < 1e-14);
        }
    }
}
