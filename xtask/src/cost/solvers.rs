//! The linear solvers: time and backward error against size.

mod body;
mod elimination;
mod files;
mod report;
mod row;

pub(super) use body::{Body, Sparse};
pub(super) use files::write as write_matrices;

use super::Record;
use crate::interrupt;
use crate::progress::Progress;
use crate::report::{Effort, list, plot};
use crate::store::Files;
use crate::threads;
use anyhow::Result;
use body::STIFFNESS;
use cpu_time::ThreadTime;
use elimination::elimination;
use isosheet_coords::linalg::{LinalgError, SparseLdlt, SparseLlt, SparseLu, norm_inf};
use isosheet_coords::{CartesianChart, Chart, Choice, Linearised, mass_matrix};
use isosheet_io::MatrixSymmetry;
use maud::html;
use nalgebra::{DMatrix, DVector};
use rayon::ThreadPool;
use row::{CRAMER, DENSE_LU, LDLT, MINORS, SCHUR, SOLVERS, SPARSE_LU, SolverRow};
use std::time::Instant;

/// What is measured, in words.
const ABOUT: &str = "\
    Free, bent sheets: two triangles (n = 7), then the squares M^0, M^1, ... The task is that of a step: \
    velocities from momenta, C q' = p, in a Cartesian chart. The dense solvers need C, whose forming is \
    timed by itself; the sparse ones solve [M G^T; G 0] [v; μ] = [S^T p; 0] for the same velocities. \
    First: symbolic analysis and numeric factorisation; again: numeric factorisation of new values; \
    solve: one right-hand side. Backward error: |b − A x| / (|A| |x| + |b|) in the largest-entry norm, \
    for the sparse solvers of the whole saddle-point system, for the dense ones of C; velocity error: \
    against the refined sparse LU. The primal matrix M + r G^T G is that of the damped methods, which \
    correct its solution as they iterate: it solves the saddle-point system only in the limit, and its \
    errors show what four steps of the method of multipliers leave. Each time is the minimum over \
    repetitions.";

/// Makes the part of the linear solvers.
pub(super) fn make(name: &str, effort: Effort, files: &mut Files<'_>) -> Result<Record> {
    let rows = measured(effort)?;
    let table = report::table(&rows).named(name);
    table.write(files)?;
    let alt =
        "Time and backward error of the linear solvers against the number of degrees of freedom";
    let figure = plot(files, name, &report::plot(&rows), alt)?;
    let inside = html! {
        h2 { "Linear solvers" }
        p { (ABOUT) }
        (figure)
        (list(&report::conclusions(&rows)))
        (table)
    };
    Ok(Record::new(name, inside))
}

/// Finest mesh of the study.
fn finest(effort: Effort) -> u32 {
    effort.pick(2, 6, 7)
}

/// Runs all solvers on all sizes.
fn measured(effort: Effort) -> Result<Vec<SolverRow>> {
    let bar = Progress::start("linear solvers", finest(effort) as usize + 2);
    // Longest measurement of one solver on one matrix, all repetitions together, seconds.
    let limit = effort.pick(0.02, 2.0, 20.0);
    let mut rows: Vec<SolverRow> = Vec::new();
    for body in Body::all(finest(effort)) {
        let body = body?;
        let task = Task::new(&body)?;
        // Forming C takes as many solves as there are coordinates; past the limit nothing dense is tried.
        let slow = |name: &str, rows: &[SolverRow]| {
            rows.iter()
                .rfind(|r| r.solver == name)
                .is_some_and(|r| r.form + r.first > 0.15 * limit)
        };
        let dense: Vec<&str> = SOLVERS[..4]
            .iter()
            .copied()
            .filter(|s| !slow(s, &rows))
            .collect();
        if !dense.is_empty() {
            rows.extend(task.dense(&dense, limit)?);
        }
        for name in &SOLVERS[4..] {
            interrupt::check()?;
            if !slow(name, &rows) {
                rows.push(task.sparse(name, limit));
            }
        }
        bar.step();
    }
    bar.finish(&format!("{} measurements", rows.len()));
    Ok(rows)
}

/// What is to be solved on one body.
struct Task<'a> {
    body: &'a Body,
    chart: Option<CartesianChart>,
    /// `S^T p` over zeros: the right-hand side of the saddle-point system, and p.
    rhs: Vec<f64>,
    p: Vec<f64>,
    whole: Sparse,
    /// Velocities by the refined sparse LU.
    exact: Vec<f64>,
    /// What times of factorisations are measured on.
    one: ThreadPool,
}

impl<'a> Task<'a> {
    fn new(body: &'a Body) -> Result<Self> {
        let n = body.system.dof();
        // Any numbers of the size of one.
        let p: Vec<f64> = (0..n).map(|k| (1.7 * k as f64 + 0.3).sin()).collect();
        let whole = body.saddle(MatrixSymmetry::General);
        let mut rhs = vec![0.0; whole.pattern.cols()];
        // Without a chart any force will do.
        let chart = (n <= LARGEST_CHART)
            .then(|| CartesianChart::new(body.system.clone(), Choice::Auto, body.sheet.positions()))
            .transpose()?;
        match &chart {
            Some(chart) => {
                let mut linear = Linearised::new(&body.system, chart.pattern())?;
                chart.linearise(&body.system, &mut linear, body.sheet.positions())?;
                let top = &mut rhs[..body.system.unknowns()];
                chart.pattern().add_transpose(linear.rows(), &p, top);
            }
            None => {
                let stride = body.system.unknowns() / n;
                for (k, p) in p.iter().enumerate() {
                    rhs[k * stride] = *p;
                }
            }
        }
        let mut lu = SparseLu::new(whole.pattern.clone())?;
        lu.values_mut().copy_from_slice(&whole.values);
        lu.factorize()?;
        let mut exact = rhs.clone();
        lu.solve_refined(&mut exact)?;
        Ok(Self {
            body,
            chart,
            rhs,
            p,
            whole,
            exact,
            one: threads::pool(1)?,
        })
    }

    fn row(&self, solver: &str, order: usize) -> SolverRow {
        SolverRow {
            order,
            ..SolverRow::new(solver, &self.body.name, self.body.system.dof())
        }
    }

    fn velocity_error(&self, v: &[f64]) -> f64 {
        let unknowns = self.body.system.unknowns();
        let exact = &self.exact[..unknowns];
        let gap: Vec<f64> = v.iter().zip(exact).map(|(a, b)| a - b).collect();
        norm_inf(&gap) / norm_inf(exact)
    }

    /// The solvers of `C q' = p`.
    fn dense(&self, names: &[&str], limit: f64) -> Result<Vec<SolverRow>> {
        let Some(chart) = &self.chart else {
            return Ok(Vec::new());
        };
        let x = self.body.sheet.positions();
        let system = &self.body.system;
        let mut linear = Linearised::new(system, chart.pattern())?;
        let mut formed: Result<(DMatrix<f64>, DMatrix<f64>), isosheet_coords::ChartError> =
            Ok(Default::default());
        let form = shortest(limit, || {
            formed = chart
                .linearise(system, &mut linear, x)
                .and_then(|()| chart.jacobian(system, &mut linear, x))
                .map(|j| (mass_matrix(system, &self.body.mass, &j), j));
        });
        let (c, j) = formed?;
        // Masses over their mean, as in the sparse matrices.
        let c = c * (self.body.mass.vertex.len() as f64 / self.body.mass.total());
        let p = DVector::from_column_slice(&self.p);
        let norm = |m: &DMatrix<f64>| m.row_iter().map(|r| r.abs().sum()).fold(0.0, f64::max);
        let mut rows = Vec::new();
        for name in names {
            interrupt::check()?;
            let mut row = self.row(name, c.nrows());
            row.form = form;
            let mut q = None;
            match *name {
                MINORS => {
                    let d = c.determinant();
                    row.first = shortest(limit, || q = Some(minors(&c, d, &self.p)));
                }
                CRAMER => {
                    let d = c.determinant();
                    row.first = shortest(limit, || q = Some(cramer(&c, d, &self.p)));
                }
                DENSE_LU => {
                    let mut factor = c.clone().lu();
                    row.first = shortest(limit, || factor = c.clone().lu());
                    row.solve = shortest(limit, || q = factor.solve(&p));
                }
                _ => {
                    let mut factor = None;
                    row.first = shortest(limit, || factor = c.clone().cholesky());
                    row.solve = shortest(limit, || q = factor.as_ref().map(|f| f.solve(&p)));
                }
            }
            row.again = row.first;
            match q.filter(|q: &DVector<f64>| q.iter().all(|v| v.is_finite())) {
                Some(q) => {
                    let r = &p - &c * &q;
                    row.backward = Some(r.amax() / (norm(&c) * q.amax() + p.amax()));
                    row.velocity = Some(self.velocity_error((&j * q).as_slice()));
                }
                None => row.failure = Some("singular to working precision".into()),
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// The solvers of the saddle-point system.
    fn sparse(&self, name: &str, limit: f64) -> SolverRow {
        let row = self.row(name, 0);
        let failed = row.clone();
        self.measure(name, row, limit)
            .unwrap_or_else(|error| SolverRow {
                failure: Some(error.to_string()),
                ..failed
            })
    }

    fn measure(
        &self,
        name: &str,
        mut row: SolverRow,
        limit: f64,
    ) -> Result<SolverRow, LinalgError> {
        let matrix = match name {
            SPARSE_LU => self.body.saddle(MatrixSymmetry::General),
            LDLT => self.body.saddle(MatrixSymmetry::Symmetric),
            SCHUR => self.body.schur(),
            _ => self.body.primal(),
        };
        row.order = matrix.pattern.cols();
        let order = (name == LDLT).then(|| elimination(self.body));
        let fresh = || Factor::new(name, &matrix, order.as_deref());
        let mut factor = fresh()?;
        let mut outcome = Ok(());
        let mut begin = || {
            outcome = fresh().and_then(|f| {
                factor = f;
                factor.factorize()
            });
        };
        row.first = self.one.install(|| shortest(limit, &mut begin));
        outcome?;
        let mut outcome = Ok(());
        row.again = self
            .one
            .install(|| shortest(limit, || outcome = factor.factorize()));
        outcome?;
        let mut solution = Vec::new();
        row.solve = self
            .one
            .install(|| shortest(limit, || solution = self.solve(&mut factor)));
        row.backward = Some(self.whole.backward_error(&solution, &self.rhs));
        row.velocity = (name != SPARSE_LU)
            .then(|| self.velocity_error(&solution[..self.body.system.unknowns()]));
        Ok(row)
    }

    /// Solves the saddle-point system with a factor of any of the matrices.
    fn solve(&self, factor: &mut Factor) -> Vec<f64> {
        let unknowns = self.body.system.unknowns();
        let mut x = self.rhs.clone();
        match factor {
            Factor::Lu(lu) => lu.solve(&mut x),
            Factor::Ldlt(ldlt) => ldlt.solve(&mut x),
            Factor::Schur(llt) => {
                // S mu = G M^-1 f, v = M^-1 (f - G^T mu).
                let (masses, rods) = (self.body.masses(), self.body.rods());
                let (v, mu) = x.split_at_mut(unknowns);
                mu.fill(0.0);
                for &(e, u, g) in &rods {
                    mu[e as usize] += g * v[u as usize] / masses[u as usize];
                }
                llt.solve(mu);
                for &(e, u, g) in &rods {
                    v[u as usize] -= g * mu[e as usize];
                }
                v.iter_mut().zip(&masses).for_each(|(v, m)| *v /= m);
            }
            Factor::Primal(llt) => {
                // The method of multipliers: (M + r G^T G) v = f - G^T mu, mu += r G v.
                let rods = self.body.rods();
                let (v, mu) = x.split_at_mut(unknowns);
                mu.fill(0.0);
                for _ in 0..MULTIPLIER_STEPS {
                    v.copy_from_slice(&self.rhs[..unknowns]);
                    for &(e, u, g) in &rods {
                        v[u as usize] -= g * mu[e as usize];
                    }
                    llt.solve(v);
                    for &(e, u, g) in &rods {
                        mu[e as usize] += STIFFNESS * g * v[u as usize];
                    }
                }
            }
        }
        x
    }
}

/// Steps of the method of multipliers that make up one solve with the primal matrix.
const MULTIPLIER_STEPS: usize = 4;

/// Most degrees of freedom for which a chart is chosen and the dense matrix formed: choosing coordinates is
/// dense work too.
const LARGEST_CHART: usize = 300;

/// A factorised sparse matrix.
enum Factor {
    Lu(Box<SparseLu>),
    Ldlt(Box<SparseLdlt>),
    Schur(Box<SparseLlt>),
    Primal(Box<SparseLlt>),
}

impl Factor {
    fn new(name: &str, matrix: &Sparse, order: Option<&[usize]>) -> Result<Self, LinalgError> {
        let pattern = matrix.pattern.clone();
        let mut factor = match (name, order) {
            (SPARSE_LU, _) => Self::Lu(Box::new(SparseLu::new(pattern)?)),
            (_, Some(order)) => Self::Ldlt(Box::new(SparseLdlt::new(pattern, order)?)),
            (SCHUR, _) => Self::Schur(Box::new(SparseLlt::new(pattern)?)),
            _ => Self::Primal(Box::new(SparseLlt::new(pattern)?)),
        };
        let values = match &mut factor {
            Self::Lu(f) => f.values_mut(),
            Self::Ldlt(f) => f.values_mut(),
            Self::Schur(f) | Self::Primal(f) => f.values_mut(),
        };
        values.copy_from_slice(&matrix.values);
        Ok(factor)
    }

    fn factorize(&mut self) -> Result<(), LinalgError> {
        match self {
            Self::Lu(f) => f.factorize(),
            Self::Ldlt(f) => f.factorize(),
            Self::Schur(f) | Self::Primal(f) => f.factorize(),
        }
    }
}

/// `q_i = det(C with column i replaced by p) / det C`.
fn cramer(c: &DMatrix<f64>, determinant: f64, p: &[f64]) -> DVector<f64> {
    DVector::from_fn(p.len(), |i, _| {
        let mut replaced = c.clone();
        replaced.column_mut(i).copy_from_slice(p);
        replaced.determinant() / determinant
    })
}

/// `q_j = sum_i p_i (-1)^(i+j) M_ji / det C` with the minors of C (Liu, Tang and Joneja 2007, Sec. 4.1).
fn minors(c: &DMatrix<f64>, determinant: f64, p: &[f64]) -> DVector<f64> {
    DVector::from_fn(p.len(), |j, _| {
        p.iter()
            .enumerate()
            .map(|(i, p)| {
                let sign = if (i + j) % 2 == 0 { 1.0 } else { -1.0 };
                let minor = c.clone().remove_row(i).remove_column(j).determinant();
                p * sign * minor / determinant
            })
            .sum()
    })
}

/// The shortest time of repeated runs, CPU seconds of this thread: at most 20 of them, and no more once a tenth of the limit is
/// used up.
fn shortest(limit: f64, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    let clock = Instant::now();
    for _ in 0..20 {
        let started = ThreadTime::now();
        work();
        best = best.min(started.elapsed().as_secs_f64());
        if clock.elapsed().as_secs_f64() > 0.1 * limit {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::row::PRIMAL;
    use super::*;
    use crate::draw::Vector;

    /// All solvers give the same velocities, whatever system they solve.
    #[test]
    fn the_solvers_agree() {
        let rows = measured(Effort::Quick).unwrap();
        for solver in SOLVERS {
            let here: Vec<&SolverRow> = rows.iter().filter(|r| r.solver == solver).collect();
            // On how many sizes depends on how fast the machine is.
            assert!(!here.is_empty(), "{solver}");
            for r in here {
                assert_eq!(r.failure, None);
                let (backward, velocity) = (r.backward.unwrap(), r.velocity.unwrap_or(0.0));
                // Four steps of the method of multipliers are exact on the smallest sheet only.
                let exact = solver != PRIMAL || r.n == 7;
                assert!(!exact || backward < 1e-12 && velocity < 1e-9, "{r:?}");
            }
        }
        assert_eq!(rows[0].n, 7);
        assert!(report::conclusions(&rows).len() >= 4);
        assert!(report::plot(&rows).to_svg("t").contains("dense Cholesky"));
        let csv = String::from_utf8(report::table(&rows).csv().unwrap()).unwrap();
        assert!(!csv.contains("inf"));
    }
}
