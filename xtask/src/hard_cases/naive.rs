//! Methods as textbooks and games have them, to show where they break. Dense and short on purpose.

use super::Findings;
use super::scenes::FRAME;
use crate::interrupt;
use crate::report::Bound;
use isosheet_dynamics::SheetModel;
use nalgebra::{DMatrix, DVector};

/// A condition number beyond which a solve in double precision leaves less than a digit: 2.2e-16 times this
/// is 0.2.
pub(super) const NO_DIGITS: f64 = 1e15;

/// Lagrange multipliers from the second derivative of the constraints: `G M^-1 G^T lambda = -(G M^-1 f +
/// gamma)` with `gamma_e = |v_a - v_b|^2`, solved by dense Cholesky, and symplectic Euler steps (as in
/// Witkin and Baraff's course notes, without their feedback terms). Lumped masses only.
pub(super) const TEXTBOOK: &str =
    "Lagrange multipliers at acceleration level, dense Cholesky, symplectic Euler";

/// Gauss-Seidel projection of one rod after the other, with velocities from the change of position
/// (position-based dynamics).
pub(super) const GAUSS_SEIDEL: &str =
    "Gauss-Seidel projection of the rods (position-based dynamics), 50 sweeps a step";

/// How the sweeps of a step of [`GAUSS_SEIDEL`] end.
pub(super) const SWEEPS: (usize, f64) = (50, 0.0);

fn inverse_masses(model: &SheetModel) -> Vec<f64> {
    model
        .topology()
        .vertex_ids()
        .map(|v| {
            if model.is_pinned(v) {
                0.0
            } else {
                1.0 / model.mass().vertex[v.index()]
            }
        })
        .collect()
}

/// One step of the textbook method.
///
/// # Errors
/// The reason in words, when the matrix is not positive definite or the result not finite.
fn textbook_step(model: &SheetModel, x: &mut [f64], v: &mut [f64], h: f64) -> Result<(), String> {
    let a = textbook_acceleration(model, x, v)?;
    for i in 0..x.len() {
        v[i] += h * a[i];
        x[i] += h * v[i];
    }
    if x.iter().all(|x| x.is_finite()) && model.rods().max_strain(x) < 1e3 {
        Ok(())
    } else {
        Err("the positions have run off".into())
    }
}

fn textbook_acceleration(model: &SheetModel, x: &[f64], v: &[f64]) -> Result<Vec<f64>, String> {
    let w = inverse_masses(model);
    let rods: Vec<[usize; 2]> = model
        .rods()
        .edges()
        .iter()
        .copied()
        .filter(|e| e.iter().any(|&k| w[k] > 0.0))
        .collect();
    let m = rods.len();
    let mut g = DMatrix::zeros(m, x.len());
    let mut gamma = DVector::zeros(m);
    for (row, &[a, b]) in rods.iter().enumerate() {
        for k in 0..3 {
            let (i, j) = (3 * a + k, 3 * b + k);
            g[(row, i)] = x[i] - x[j];
            g[(row, j)] = x[j] - x[i];
            gamma[row] += (v[i] - v[j]).powi(2);
        }
    }
    let mut f = vec![0.0; x.len()];
    model.potential_force(0.0, x, &mut f);
    let free = DVector::from_iterator(x.len(), (0..x.len()).map(|i| w[i / 3] * f[i]));
    let mut weighted = g.clone();
    for (i, mut column) in weighted.column_iter_mut().enumerate() {
        column *= w[i / 3];
    }
    let schur = &weighted * g.transpose();
    let factor = schur.cholesky().ok_or_else(|| {
        format!("Cholesky: the {m} x {m} matrix G M^-1 G^T is not positive definite")
    })?;
    let lambda = factor.solve(&-(&g * &free + gamma));
    Ok((free + weighted.transpose() * lambda).as_slice().to_vec())
}

/// One step of Gauss-Seidel projection: at most so many sweeps, or until every edge is right to a length,
/// metres.
pub(super) fn gauss_seidel_step(
    model: &SheetModel,
    (x, v): (&mut [f64], &mut [f64]),
    h: f64,
    (sweeps, tolerance): (usize, f64),
) {
    let w = inverse_masses(model);
    let old = x.to_vec();
    let mut f = vec![0.0; x.len()];
    model.potential_force(0.0, x, &mut f);
    for i in 0..x.len() {
        x[i] += h * (v[i] + h * w[i / 3] * f[i]);
    }
    for _ in 0..sweeps {
        let mut off = 0.0_f64;
        for (&[a, b], &rest) in model.rods().edges().iter().zip(model.rods().lengths()) {
            let d: [f64; 3] = std::array::from_fn(|k| x[3 * a + k] - x[3 * b + k]);
            let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
            off = off.max((length - rest).abs());
            let sum = w[a] + w[b];
            if sum > 0.0 && length > 0.0 {
                for k in 0..3 {
                    let push = (length - rest) / (length * sum) * d[k];
                    x[3 * a + k] -= w[a] * push;
                    x[3 * b + k] += w[b] * push;
                }
            }
        }
        if off < tolerance {
            break;
        }
    }
    for i in 0..x.len() {
        v[i] = (x[i] - old[i]) / h;
    }
}

/// Takes steps of the textbook method; `watch` sees the number of each, from 1, and may change the
/// velocities.
///
/// # Errors
/// The step that failed, and why.
pub(super) fn textbook_steps(
    model: &SheetModel,
    (x, v): (&mut [f64], &mut [f64]),
    h: f64,
    steps: usize,
    mut watch: impl FnMut(usize, &[f64], &mut [f64]),
) -> Result<(), String> {
    for k in 1..=steps {
        interrupt::check().map_err(|e| e.to_string())?;
        textbook_step(model, x, v, h).map_err(|e| format!("step {k}: {e}"))?;
        watch(k, x, v);
    }
    Ok(())
}

/// Runs the textbook method from rest. Returns the largest strain, or when and why the run broke down.
pub(super) fn textbook(model: &SheetModel, x: &[f64], h: f64, steps: usize) -> Result<f64, String> {
    let (mut x, mut v) = (x.to_vec(), vec![0.0; x.len()]);
    let mut strain = 0.0_f64;
    let mut watch = |_: usize, x: &[f64], _: &mut [f64]| {
        strain = strain.max(model.rods().max_strain(x));
    };
    let outcome = textbook_steps(model, (&mut x, &mut v), h, steps, &mut watch);
    let count = format!("{steps}:");
    outcome.map_err(|e| e.replacen(':', &format!(" of {count}"), 1))?;
    Ok(strain)
}

/// Runs Gauss-Seidel projection from rest; returns the largest strain and the positions.
pub(super) fn gauss_seidel(
    model: &SheetModel,
    x: &[f64],
    h: f64,
    steps: usize,
    ending: (usize, f64),
) -> (f64, Vec<f64>) {
    let (mut x, mut v) = (x.to_vec(), vec![0.0; x.len()]);
    let mut strain = 0.0_f64;
    for _ in 0..steps {
        gauss_seidel_step(model, (&mut x, &mut v), h, ending);
        strain = strain.max(model.rods().max_strain(&x));
    }
    (strain, x)
}

impl Findings {
    /// How far Gauss-Seidel projection strains the edges of a sheet in some steps of [`FRAME`], which is a
    /// failure from a hundredth on.
    pub(super) fn swept(&mut self, what: &str, model: &SheetModel, x: &[f64], steps: usize) {
        let (strain, _) = gauss_seidel(model, x, FRAME, steps, SWEEPS);
        let what = format!("{what}, {steps} steps of 1/60 s: largest edge strain");
        self.naive(GAUSS_SEIDEL, what, strain, Bound::AtMost(1e-2));
    }
}
