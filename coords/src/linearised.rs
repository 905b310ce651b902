//! The linearised chart `A = [G; S]`, factorised: `J = A^-1 [0; I]` and its transpose, applied or formed.

use crate::row_pattern::RowPattern;
use crate::system::RodSystem;
use isosheet_linalg::{LinalgError, Pattern, SparseLu};
use nalgebra::DMatrix;

/// Sparse LU of `A = [G; S]` at a state (symbolic analysis once, numeric refactorisation per state).
///
/// With M the mass matrix, `J = dx/dq` and `C = J^T M J` are the quantities of Liu, Tang and Joneja
/// 2007, Sec. 4.1; [`Linearised::push`] and [`Linearised::pull`] apply J and its transpose without
/// forming it.
pub struct Linearised {
    lu: SparseLu,
    slots: Vec<u32>,
    equations: usize,
    rows: Vec<f64>,
    work: Vec<f64>,
}

impl Linearised {
    /// Symbolic analysis for a rod system and the pattern of the coordinate rows S.
    ///
    /// # Errors
    /// [`LinalgError::Symbolic`] when memory runs out.
    ///
    /// # Panics
    /// When there are not as many coordinate rows as the system has degrees of freedom.
    pub fn new(system: &RodSystem, coordinates: &RowPattern) -> Result<Self, LinalgError> {
        assert_eq!(
            coordinates.rows(),
            system.dof(),
            "a chart has as many coordinates as degrees of freedom"
        );
        let equations = system.equations();
        let entries: Vec<(u32, u32)> = system
            .jacobian_entries()
            .chain(
                coordinates
                    .entries()
                    .map(|(k, u)| (k + equations as u32, u)),
            )
            .collect();
        let n = system.unknowns();
        let (pattern, slots) = Pattern::from_entries(n, n, &entries);
        Ok(Self {
            lu: SparseLu::new(pattern)?,
            slots,
            equations,
            rows: vec![0.0; coordinates.len()],
            work: vec![0.0; n],
        })
    }

    /// The values of S, to be filled before [`Linearised::factorize`]; [`crate::Chart::linearise`] does both.
    pub(crate) fn rows_mut(&mut self) -> &mut [f64] {
        &mut self.rows
    }

    /// Numeric factorisation at the state x, with the values of S in [`Linearised::rows_mut`].
    ///
    /// # Errors
    /// [`LinalgError::Singular`] when the pattern of A is structurally singular.
    pub(crate) fn factorize(&mut self, system: &RodSystem, x: &[f64]) -> Result<(), LinalgError> {
        let values = self.lu.values_mut();
        values.fill(0.0);
        let entries = system.jacobian_values(x).chain(self.rows.iter().copied());
        for (slot, value) in self.slots.iter().zip(entries) {
            values[*slot as usize] += value;
        }
        self.lu.factorize()
    }

    /// The values of S at the state of the last factorisation.
    #[must_use]
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Number of unknowns, the order of A.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        self.lu.order()
    }

    /// Solve `A y = r` in place, for r the rods' part above the coordinates' part.
    ///
    /// # Errors
    /// As [`Linearised::push`].
    pub(crate) fn solve(&mut self, r: &mut [f64]) -> Result<(), LinalgError> {
        self.lu.solve_refined(r)?;
        Ok(())
    }

    /// `v = J qdot` on the unknowns: the velocity of the vertices from the rates of the coordinates (Eq. 5).
    ///
    /// # Errors
    /// [`LinalgError::Singular`] when A is singular at the state of the last factorisation.
    pub fn push(&mut self, qdot: &[f64], v: &mut [f64]) -> Result<(), LinalgError> {
        v[..self.equations].fill(0.0);
        v[self.equations..].copy_from_slice(qdot);
        self.lu.solve_refined(v)?;
        Ok(())
    }

    /// Solve `A^T [mu; p] = w` for w on the unknowns: `p = J^T w`, and mu are the multipliers that hold
    /// what is left of w, `w - S^T p = G^T mu`.
    ///
    /// # Errors
    /// As [`Linearised::push`].
    pub fn pull(&mut self, w: &[f64], mu: &mut [f64], p: &mut [f64]) -> Result<(), LinalgError> {
        let mut y = std::mem::take(&mut self.work);
        y.copy_from_slice(w);
        let solved = self.lu.solve_transpose_refined(&mut y);
        mu.copy_from_slice(&y[..self.equations]);
        p.copy_from_slice(&y[self.equations..]);
        self.work = y;
        solved?;
        Ok(())
    }

    /// The dense Jacobian J, unknowns x n.
    ///
    /// # Errors
    /// As [`Linearised::push`].
    pub fn jacobian(&mut self) -> Result<DMatrix<f64>, LinalgError> {
        let n = self.unknowns() - self.equations;
        let mut jacobian = DMatrix::zeros(self.unknowns(), n);
        for (k, mut column) in jacobian.column_iter_mut().enumerate() {
            let column = column.as_mut_slice();
            column[self.equations + k] = 1.0;
            self.lu.solve_refined(column)?;
        }
        Ok(jacobian)
    }
}
