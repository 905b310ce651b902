//! The linearised chart `A = [G; S]`, factorised: `J = A^-1 [0; I]` and its transpose, applied or formed.

use crate::chart::{Chart, ChartError};
use crate::linalg::{Pattern, SparseLu, norm_inf};
use crate::realise::check;
use crate::system::RodSystem;
use nalgebra::DMatrix;

/// Relative change of the unknowns below which Newton's method for positions stops. Convergence is
/// quadratic, so that the last step taken leaves rounding only.
const NEWTON_TOLERANCE: f64 = 1e-13;

/// Most Newton steps for positions; from a step of ordinary size four or five are needed.
const NEWTON_STEPS: usize = 30;

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
    /// Symbolic analysis for a chart on a rod system.
    ///
    /// # Errors
    /// [`ChartError::Linalg`] when memory runs out.
    ///
    /// # Panics
    /// When the chart's dimension is not the system's number of degrees of freedom.
    pub fn new(system: &RodSystem, chart: &dyn Chart) -> Result<Self, ChartError> {
        assert_eq!(
            chart.dimension(),
            system.dof(),
            "a chart has as many coordinates as degrees of freedom"
        );
        let equations = system.equations();
        let entries: Vec<(u32, u32)> = system
            .jacobian_entries()
            .chain(
                chart
                    .pattern()
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
            rows: vec![0.0; chart.pattern().len()],
            work: vec![0.0; n],
        })
    }

    /// Numeric factorisation at the state x.
    ///
    /// # Errors
    /// [`ChartError::Row`], [`ChartError::Linalg`].
    pub fn factorize(
        &mut self,
        system: &RodSystem,
        chart: &dyn Chart,
        x: &[f64],
    ) -> Result<(), ChartError> {
        chart.rows(x, &mut self.rows)?;
        let values = self.lu.values_mut();
        values.fill(0.0);
        let entries = system.jacobian_values(x).chain(self.rows.iter().copied());
        for (slot, value) in self.slots.iter().zip(entries) {
            values[*slot as usize] += value;
        }
        Ok(self.lu.factorize()?)
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

    /// `v = J qdot` on the unknowns.
    ///
    /// # Errors
    /// [`ChartError::Linalg`] when A is singular at the state of the last factorisation.
    pub fn push(&mut self, qdot: &[f64], v: &mut [f64]) -> Result<(), ChartError> {
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
    pub fn pull(&mut self, w: &[f64], mu: &mut [f64], p: &mut [f64]) -> Result<(), ChartError> {
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
    pub fn jacobian(&mut self) -> Result<DMatrix<f64>, ChartError> {
        let n = self.unknowns() - self.equations;
        let mut jacobian = DMatrix::zeros(self.unknowns(), n);
        for (k, mut column) in jacobian.column_iter_mut().enumerate() {
            let column = column.as_mut_slice();
            column[self.equations + k] = 1.0;
            self.lu.solve_refined(column)?;
        }
        Ok(jacobian)
    }

    /// Newton's method for positions: solve `[c(x); q(x) - q] = 0` from the state in `x`.
    ///
    /// The step is halved while the residual does not decrease. Leaves A factorised near the result.
    ///
    /// # Errors
    /// [`ChartError::NotConverged`], or an error of the factorisation on the way; `x` is the last
    /// iterate then.
    pub fn newton(
        &mut self,
        system: &RodSystem,
        chart: &dyn Chart,
        q: &[f64],
        x: &mut [f64],
    ) -> Result<usize, ChartError> {
        check("q", q, chart.dimension())?;
        check("x", x, 3 * system.vertex_count())?;
        let size = norm_inf(x).max(f64::MIN_POSITIVE);
        let mut residual = vec![0.0; self.unknowns()];
        let mut now = vec![0.0; q.len()];
        let mut trial = x.to_vec();
        let mut evaluate = |x: &[f64], residual: &mut [f64]| -> Result<f64, ChartError> {
            let (c, s) = residual.split_at_mut(system.equations());
            system.residual(x, c);
            chart.coordinates(x, &mut now)?;
            chart.difference(&now, q, s);
            Ok(residual.iter().map(|r| r * r).sum::<f64>().sqrt())
        };
        let mut old = evaluate(x, &mut residual)?;
        let mut change = f64::INFINITY;
        for iteration in 0..NEWTON_STEPS {
            self.factorize(system, chart, x)?;
            let mut step = residual.clone();
            self.lu.solve_refined(&mut step)?;
            change = norm_inf(&step) / size;
            let mut fraction = 1.0;
            loop {
                trial.copy_from_slice(x);
                system.add_scaled(-fraction, &step, &mut trial);
                match evaluate(&trial, &mut residual) {
                    // At rounding level the residual need not decrease any more.
                    Ok(new) if new < old || change < 1e-9 => {
                        old = new;
                        break;
                    }
                    _ if fraction > 1e-3 => fraction *= 0.5,
                    _ => {
                        return Err(ChartError::NotConverged {
                            iterations: iteration,
                            residual: change,
                            tolerance: NEWTON_TOLERANCE,
                        });
                    }
                }
            }
            x.copy_from_slice(&trial);
            if change < 1e-9 && fraction == 1.0 {
                // Quadratic: the step just taken leaves about its square, if the Jacobian is regular;
                // one more pass only when that is still above the tolerance.
                if change * change < NEWTON_TOLERANCE {
                    return Ok(iteration + 1);
                }
            }
        }
        Err(ChartError::NotConverged {
            iterations: NEWTON_STEPS,
            residual: change,
            tolerance: NEWTON_TOLERANCE,
        })
    }
}
