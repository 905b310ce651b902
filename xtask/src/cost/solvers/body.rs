//! The matrices of steps: saddle-point matrix, Schur complement, primal matrix.

use anyhow::Result;
use isosheet_coords::linalg::Pattern;
use isosheet_coords::{BentState, RodSystem, bent_square};
use isosheet_io::MatrixSymmetry;
use isosheet_mesh::generate::isotropic_square;
use isosheet_mesh::{MassKind, MassMatrix, Sheet};

/// A free, bent sheet, whose mass matrix and rods give the matrices.
pub(crate) struct Body {
    pub(crate) name: String,
    pub(crate) sheet: Sheet,
    pub(crate) mass: MassMatrix,
    pub(crate) system: RodSystem,
}

/// A sparse matrix: its pattern and values; of symmetric ones the lower triangle.
pub(crate) struct Sparse {
    pub(crate) pattern: Pattern,
    pub(crate) values: Vec<f64>,
    pub(crate) symmetry: MatrixSymmetry,
}

impl Sparse {
    /// Entries in one place are added up.
    pub(crate) fn new(order: usize, symmetry: MatrixSymmetry, entries: &[(u32, u32, f64)]) -> Self {
        let places: Vec<(u32, u32)> = entries.iter().map(|(r, c, _)| (*r, *c)).collect();
        let (pattern, slots) = Pattern::from_entries(order, order, &places);
        let mut values = vec![0.0; pattern.len()];
        for (slot, (.., v)) in slots.iter().zip(entries) {
            values[*slot as usize] += v;
        }
        Self {
            pattern,
            values,
            symmetry,
        }
    }

    /// `b - A x`.
    pub(crate) fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut r = b.to_vec();
        match self.symmetry {
            MatrixSymmetry::General => self.pattern.sub_product(&self.values, x, &mut r),
            MatrixSymmetry::Symmetric => {
                self.pattern.sub_symmetric_product(&self.values, x, &mut r);
            }
        }
        r
    }

    /// Largest sum of absolute values in a row.
    pub(crate) fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.pattern.cols()];
        for (r, c, v) in self.entries() {
            sums[r] += v.abs();
            if self.symmetry == MatrixSymmetry::Symmetric && r != c {
                sums[c] += v.abs();
            }
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// Normwise backward error `|b - A x| / (|A| |x| + |b|)` in the largest-entry norm.
    pub(crate) fn backward_error(&self, x: &[f64], b: &[f64]) -> f64 {
        let size = |v: &[f64]| v.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        size(&self.residual(x, b)) / (self.norm() * size(x) + size(b))
    }

    /// Row, column and value of every stored entry.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let p = &self.pattern;
        (0..p.cols()).flat_map(move |c| {
            (p.col_ptr()[c]..p.col_ptr()[c + 1]).map(move |k| (p.row_idx()[k], c, self.values[k]))
        })
    }
}

/// Stiffness of the rods in the primal matrix, relative to the masses: that of the damped methods.
pub(crate) const STIFFNESS: f64 = 1e4;

impl Body {
    /// Two triangles with a fold between them, the smallest sheet that bends: 7 degrees of freedom.
    fn pair() -> Result<Self> {
        let x = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.4, 0.9, 0.1, 0.5, -0.8, 0.4];
        Self::new("pair".into(), Sheet::new(x, &[[0, 1, 2], [1, 0, 3]])?)
    }

    /// The square M^level with noise out of its plane.
    fn square(level: u32) -> Result<Self> {
        let flat = isotropic_square(level, 1.0)?;
        let x = bent_square(&flat, level, BentState::Noise);
        Self::new(format!("M{level}"), Sheet::new(x, &flat.face_indices())?)
    }

    /// A sheet as it is.
    pub(crate) fn new(name: String, sheet: Sheet) -> Result<Self> {
        Ok(Self {
            name,
            mass: MassMatrix::from_total(&sheet, 0.1, MassKind::Lumped)?,
            system: RodSystem::new(&sheet, &[])?,
            sheet,
        })
    }

    /// The pair and the squares up to a level, smallest first, each made when asked for.
    pub(crate) fn all(level: u32) -> impl Iterator<Item = Result<Self>> {
        std::iter::once_with(Self::pair).chain((0..=level).map(Self::square))
    }

    /// Masses on the unknowns, of the size of one.
    pub(crate) fn masses(&self) -> Vec<f64> {
        let mean = self.mass.total() / self.mass.vertex.len() as f64;
        self.mass
            .vertex
            .iter()
            .flat_map(|m| [m / mean; 3])
            .collect()
    }

    /// Rows of G on the unknowns, of the size of one: `(equation, unknown, value)`.
    pub(crate) fn rods(&self) -> Vec<(u32, u32, f64)> {
        let scale = self.sheet.mean_length();
        let places = self.system.jacobian_entries();
        places
            .zip(self.system.jacobian_values(self.sheet.positions()))
            .map(|((e, u), v)| (e, u, v / scale))
            .collect()
    }

    /// `[M G^T; G 0]`, in whole or its lower triangle.
    pub(crate) fn saddle(&self, symmetry: MatrixSymmetry) -> Sparse {
        let unknowns = self.system.unknowns() as u32;
        let order = self.system.unknowns() + self.system.equations();
        let mut entries: Vec<(u32, u32, f64)> =
            (0..).zip(self.masses()).map(|(i, m)| (i, i, m)).collect();
        for (e, u, v) in self.rods() {
            entries.push((unknowns + e, u, v));
            if symmetry == MatrixSymmetry::General {
                entries.push((u, unknowns + e, v));
            }
        }
        if symmetry == MatrixSymmetry::Symmetric {
            // The place of every pivot has to exist.
            entries.extend((unknowns..order as u32).map(|i| (i, i, 0.0)));
        }
        Sparse::new(order, symmetry, &entries)
    }

    /// The Schur complement `G M^-1 G^T`, lower triangle.
    pub(crate) fn schur(&self) -> Sparse {
        let masses = self.masses();
        let mut columns = vec![Vec::new(); masses.len()];
        for (e, u, v) in self.rods() {
            columns[u as usize].push((e, v));
        }
        let mut entries = Vec::new();
        for (column, m) in columns.iter().zip(&masses) {
            for &(a, va) in column {
                for &(b, vb) in column.iter().filter(|(b, _)| *b <= a) {
                    entries.push((a, b, va * vb / m));
                }
            }
        }
        Sparse::new(self.system.equations(), MatrixSymmetry::Symmetric, &entries)
    }

    /// The primal matrix `M + r G^T G` of the damped methods, lower triangle.
    pub(crate) fn primal(&self) -> Sparse {
        let mut entries: Vec<(u32, u32, f64)> =
            (0..).zip(self.masses()).map(|(i, m)| (i, i, m)).collect();
        let mut rows = vec![Vec::new(); self.system.equations()];
        for (e, u, v) in self.rods() {
            rows[e as usize].push((u, v));
        }
        for row in &rows {
            for &(a, va) in row {
                for &(b, vb) in row.iter().filter(|(b, _)| *b <= a) {
                    entries.push((a, b, STIFFNESS * va * vb));
                }
            }
        }
        Sparse::new(self.system.unknowns(), MatrixSymmetry::Symmetric, &entries)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    fn dense(a: &Sparse) -> DMatrix<f64> {
        let n = a.pattern.cols();
        let mut d = DMatrix::zeros(n, n);
        for (r, c, v) in a.entries() {
            d[(r, c)] = v;
            if a.symmetry == MatrixSymmetry::Symmetric {
                d[(c, r)] = v;
            }
        }
        d
    }

    #[test]
    fn the_matrices_belong_together() {
        let body = Body::square(0).unwrap();
        assert_eq!(body.system.dof(), 11);
        let whole = dense(&body.saddle(MatrixSymmetry::General));
        let lower = dense(&body.saddle(MatrixSymmetry::Symmetric));
        assert_eq!(whole, lower);
        let (u, e) = (body.system.unknowns(), body.system.equations());
        let m = whole.view((0, 0), (u, u)).into_owned();
        let g = whole.view((u, 0), (e, u)).into_owned();
        let schur = &g * m.clone().try_inverse().unwrap() * g.transpose();
        assert!((dense(&body.schur()) - schur).amax() < 1e-12);
        let primal = &m + STIFFNESS * g.transpose() * &g;
        assert!((dense(&body.primal()) - primal).amax() < 1e-9);
        let total: f64 = (0..u).map(|i| m[(i, i)]).sum();
        assert!((total - u as f64).abs() < 1e-9);
    }

    #[test]
    fn norms_and_residuals() {
        let a = Sparse::new(2, MatrixSymmetry::Symmetric, &[(0, 0, 2.0), (1, 0, -3.0)]);
        assert_eq!(a.norm(), 5.0);
        assert_eq!(a.residual(&[1.0, 2.0], &[0.0, 0.0]), [4.0, 3.0]);
        assert_eq!(a.backward_error(&[1.0, 2.0], &[-4.0, -3.0]), 0.0);
    }
}
