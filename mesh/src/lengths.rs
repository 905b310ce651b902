//! The edge-length constraints and their Jacobian.

use crate::Sheet;

/// The length constraints of a sheet (Liu, Tang and Joneja 2007, Eq. 3), one per edge,
///
/// `c_e(x) = (|x_a - x_b|^2 - l_e^2) / 2,`
///
/// and the rigidity matrix G = dc/dx (E x 3V). Row e of G holds `x_a - x_b` at the three columns of a and
/// `-(x_a - x_b)` at those of b, six numbers in all, so that its sparsity pattern never changes.
///
/// Because c is quadratic, `c(y) - c(x) = G((x + y)/2) (y - x)` holds exactly.
///
/// Units: x in metres, c and G v (for a displacement v) in square metres.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthConstraints {
    edges: Vec<[usize; 2]>,
    lengths: Vec<f64>,
    row_ptr: Vec<usize>,
    col_idx: Vec<usize>,
    vertex_count: usize,
}

impl LengthConstraints {
    /// The constraints that keep every edge of `sheet` at its rest length.
    pub fn new(sheet: &Sheet) -> Self {
        let edges: Vec<[usize; 2]> = sheet
            .topology()
            .edges()
            .iter()
            .map(|e| e.map(|v| v.index()))
            .collect();
        let row_ptr = (0..=edges.len()).map(|e| 6 * e).collect();
        let mut col_idx = Vec::with_capacity(6 * edges.len());
        for &[a, b] in &edges {
            let (low, high) = (a.min(b), a.max(b));
            col_idx.extend([
                3 * low,
                3 * low + 1,
                3 * low + 2,
                3 * high,
                3 * high + 1,
                3 * high + 2,
            ]);
        }
        Self {
            edges,
            lengths: sheet.lengths().to_vec(),
            row_ptr,
            col_idx,
            vertex_count: sheet.topology().vertex_count(),
        }
    }

    /// The number of constraints E.
    #[inline]
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Whether there is no constraint; never so for a sheet.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The number of vertices V; positions have length 3V.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The ends (a, b) of every edge.
    #[inline]
    pub fn edges(&self) -> &[[usize; 2]] {
        &self.edges
    }

    /// The lengths `l_e` to be kept, in metres.
    #[inline]
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// Row pointers of G in compressed-row form: row e has the entries `6 e .. 6 e + 6`.
    #[inline]
    pub fn row_ptr(&self) -> &[usize] {
        &self.row_ptr
    }

    /// Column indices of G in compressed-row form, ascending within each row.
    #[inline]
    pub fn col_idx(&self) -> &[usize] {
        &self.col_idx
    }

    /// The number of stored entries of G, 6 E.
    #[inline]
    pub fn nnz(&self) -> usize {
        6 * self.edges.len()
    }

    /// The values of G(x) in the order of [`Self::col_idx`]: with it and [`Self::row_ptr`] the matrix for the
    /// sparse solvers of other libraries.
    ///
    /// ```
    /// # use isosheet_mesh::{LengthConstraints, generate};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::isotropic_square(0, 1.0)?;
    /// let (g, x) = (LengthConstraints::new(&sheet), sheet.positions());
    /// let mut values = vec![0.0; g.nnz()];
    /// g.values_into(x, &mut values);
    /// // In a flat sheet all rods keep their lengths while the corner moves out of the plane.
    /// let row = g.row_ptr()[0]..g.row_ptr()[1];
    /// let rates = row.filter(|&k| g.col_idx()[k] % 3 == 2).map(|k| values[k]);
    /// assert!(rates.into_iter().all(|rate| rate == 0.0));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Panics
    /// If `x` is not of length 3V or `values` not of length 6E.
    pub fn values_into(&self, x: &[f64], values: &mut [f64]) {
        self.check(x);
        assert_eq!(values.len(), self.nnz(), "one value per stored entry");
        for (&[a, b], row) in self.edges.iter().zip(values.chunks_exact_mut(6)) {
            let (low, high) = (a.min(b), a.max(b));
            for k in 0..3 {
                let d = x[3 * low + k] - x[3 * high + k];
                row[k] = d;
                row[3 + k] = -d;
            }
        }
    }

    /// c(x), in square metres.
    ///
    /// # Panics
    /// If `x` is not of length 3V.
    pub fn residual(&self, x: &[f64]) -> Vec<f64> {
        let mut c = vec![0.0; self.len()];
        self.residual_into(x, &mut c);
        c
    }

    /// Writes c(x), in square metres, into `c`.
    ///
    /// # Panics
    /// If `x` is not of length 3V or `c` not of length E.
    pub fn residual_into(&self, x: &[f64], c: &mut [f64]) {
        self.check(x);
        assert_eq!(c.len(), self.len(), "one residual per edge");
        for (e, &[a, b]) in self.edges.iter().enumerate() {
            let l = self.lengths[e];
            // The product form loses nothing when the two squares are nearly equal.
            let d = distance(x, a, b);
            c[e] = 0.5 * (d - l) * (d + l);
        }
    }

    /// Writes G(x) v into `out` (length E).
    ///
    /// # Panics
    /// If `x` or `v` is not of length 3V or `out` not of length E.
    pub fn apply(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        self.check(x);
        self.check(v);
        assert_eq!(out.len(), self.len(), "one entry per edge");
        for (e, &[a, b]) in self.edges.iter().enumerate() {
            out[e] = (0..3)
                .map(|k| (x[3 * a + k] - x[3 * b + k]) * (v[3 * a + k] - v[3 * b + k]))
                .sum();
        }
    }

    /// Adds G(x)^T lambda to `out` (length 3V): `lambda_e (x_a - x_b)` at a, its opposite at b.
    ///
    /// # Panics
    /// If `x` or `out` is not of length 3V or `lambda` not of length E.
    pub fn apply_transpose_add(&self, x: &[f64], lambda: &[f64], out: &mut [f64]) {
        self.check(x);
        self.check(out);
        assert_eq!(lambda.len(), self.len(), "one multiplier per edge");
        for (&[a, b], &l) in self.edges.iter().zip(lambda) {
            for k in 0..3 {
                let f = l * (x[3 * a + k] - x[3 * b + k]);
                out[3 * a + k] += f;
                out[3 * b + k] -= f;
            }
        }
    }

    /// The largest relative change of length over all edges, `max | |x_a - x_b| / l - 1 |`; NaN if any
    /// position is.
    ///
    /// # Panics
    /// If `x` is not of length 3V.
    pub fn max_strain(&self, x: &[f64]) -> f64 {
        self.check(x);
        let mut worst = 0.0f64;
        for (&[a, b], &l) in self.edges.iter().zip(&self.lengths) {
            let s = ((distance(x, a, b) - l) / l).abs();
            if s.is_nan() {
                return f64::NAN;
            }
            worst = worst.max(s);
        }
        worst
    }

    fn check(&self, x: &[f64]) {
        assert_eq!(x.len(), 3 * self.vertex_count, "three numbers per vertex");
    }
}

#[inline]
fn distance(x: &[f64], a: usize, b: usize) -> f64 {
    (0..3)
        .map(|k| (x[3 * a + k] - x[3 * b + k]).powi(2))
        .sum::<f64>()
        .sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::isotropic_square;

    /// A state well away from rest, by a formula without symmetry.
    fn bent(sheet: &Sheet, phase: f64) -> Vec<f64> {
        sheet
            .positions()
            .iter()
            .enumerate()
            .map(|(k, c)| 1.3 * c + 0.1 * (1.7 * k as f64 + phase).sin())
            .collect()
    }

    #[test]
    fn rest_satisfies_the_constraints() {
        let sheet = isotropic_square(2, 0.3).unwrap();
        let g = LengthConstraints::new(&sheet);
        assert!(g.max_strain(sheet.positions()) < 1e-15);
        assert!(
            g.residual(sheet.positions())
                .iter()
                .all(|c| c.abs() < 1e-17)
        );
        assert_eq!((g.len(), g.nnz(), g.row_ptr().len()), (208, 1248, 209));
        assert!(!g.is_empty());
    }

    #[test]
    fn jacobian_is_the_exact_discrete_gradient() {
        let sheet = isotropic_square(1, 1.0).unwrap();
        let g = LengthConstraints::new(&sheet);
        let (x, y) = (bent(&sheet, 0.0), bent(&sheet, 2.0));
        let mid: Vec<f64> = x.iter().zip(&y).map(|(a, b)| 0.5 * (a + b)).collect();
        let step: Vec<f64> = x.iter().zip(&y).map(|(a, b)| b - a).collect();
        let mut gv = vec![0.0; g.len()];
        g.apply(&mid, &step, &mut gv);
        for ((cy, cx), d) in g.residual(&y).iter().zip(g.residual(&x)).zip(&gv) {
            assert!((cy - cx - d).abs() < 1e-14);
        }
    }

    #[test]
    fn stored_values_agree_with_products_and_differences() {
        let sheet = isotropic_square(1, 1.0).unwrap();
        let g = LengthConstraints::new(&sheet);
        let x = bent(&sheet, 0.4);
        let v = bent(&sheet, 5.0);
        let mut values = vec![0.0; g.nnz()];
        g.values_into(&x, &mut values);
        let mut gv = vec![0.0; g.len()];
        g.apply(&x, &v, &mut gv);
        let lambda: Vec<f64> = (0..g.len()).map(|e| (e as f64).cos()).collect();
        let mut force = vec![0.0; x.len()];
        g.apply_transpose_add(&x, &lambda, &mut force);
        let mut force_csr = vec![0.0; x.len()];
        let h = 1e-6;
        for e in 0..g.len() {
            let row = g.row_ptr()[e]..g.row_ptr()[e + 1];
            assert!(g.col_idx()[row.clone()].is_sorted());
            let sum: f64 = row.clone().map(|k| values[k] * v[g.col_idx()[k]]).sum();
            assert!((sum - gv[e]).abs() < 1e-14);
            for k in row {
                let c = g.col_idx()[k];
                force_csr[c] += values[k] * lambda[e];
                let (mut xp, mut xm) = (x.clone(), x.clone());
                xp[c] += h;
                xm[c] -= h;
                let fd = (g.residual(&xp)[e] - g.residual(&xm)[e]) / (2.0 * h);
                assert!(
                    (fd - values[k]).abs() < 1e-8,
                    "edge {e}, column {c}: {fd} against {}",
                    values[k]
                );
            }
        }
        for (a, b) in force.iter().zip(&force_csr) {
            assert!((a - b).abs() < 1e-14);
        }
    }

    #[test]
    fn strain_reports_nan_and_scale() {
        let sheet = isotropic_square(0, 1.0).unwrap();
        let g = LengthConstraints::new(&sheet);
        let twice: Vec<f64> = sheet.positions().iter().map(|c| 2.0 * c).collect();
        assert!((g.max_strain(&twice) - 1.0).abs() < 1e-15);
        let mut broken = twice;
        broken[0] = f64::NAN;
        assert!(g.max_strain(&broken).is_nan());
    }
}
