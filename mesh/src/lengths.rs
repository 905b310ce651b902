//! The edge-length constraints and their Jacobian.

use crate::{EdgeId, Sheet};
use std::ops::Range;

/// The length constraints of a sheet (Liu, Tang and Joneja 2007, Eq. 3), one for each edge or for some of
/// them,
///
/// `c_e(x) = (|x_a - x_b|^2 - l_e^2) / 2,`
///
/// and the products with the rigidity matrix G = dc/dx (E x 3V). Row e of G holds `x_a - x_b` at the three
/// columns of a and `-(x_a - x_b)` at the columns of b.
///
/// Because c is quadratic, `c(y) - c(x) = G((x + y)/2) (y - x)` holds exactly.
///
/// Units: x in metres, c and G v (for a displacement v) in square metres.
#[derive(Clone, Debug, PartialEq)]
pub struct LengthConstraints {
    edges: Vec<[usize; 2]>,
    lengths: Vec<f64>,
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
        Self {
            edges,
            lengths: sheet.lengths().to_vec(),
            vertex_count: sheet.topology().vertex_count(),
        }
    }

    /// The constraints of some of the edges, in this order.
    ///
    /// # Panics
    /// If an edge does not exist.
    #[must_use]
    pub fn of_edges(&self, edges: &[EdgeId]) -> Self {
        Self {
            edges: edges.iter().map(|e| self.edges[e.index()]).collect(),
            lengths: edges.iter().map(|e| self.lengths[e.index()]).collect(),
            vertex_count: self.vertex_count,
        }
    }

    /// The number of constraints E.
    #[inline]
    pub fn len(&self) -> usize {
        self.edges.len()
    }

    /// Whether there is no constraint; never so for all edges of a sheet.
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
        self.max_strain_among(0..self.len(), x)
    }

    /// The largest relative change of length over some of the edges, `max | |x_a - x_b| / l - 1 |`; NaN if a
    /// position of their ends is.
    ///
    /// # Panics
    /// If `x` is not of length 3V, or an edge does not exist.
    pub fn max_strain_among(&self, edges: Range<usize>, x: &[f64]) -> f64 {
        self.check(x);
        let mut worst = 0.0f64;
        let lengths = &self.lengths[edges.clone()];
        for (&[a, b], &l) in self.edges[edges].iter().zip(lengths) {
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
        assert_eq!(g.len(), 208);
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
    fn products_agree_with_differences() {
        let sheet = isotropic_square(1, 1.0).unwrap();
        let g = LengthConstraints::new(&sheet);
        let x = bent(&sheet, 0.4);
        let lambda: Vec<f64> = (0..g.len()).map(|e| (e as f64).cos()).collect();
        let mut force = vec![0.0; x.len()];
        g.apply_transpose_add(&x, &lambda, &mut force);
        let h = 1e-6;
        for c in 0..x.len() {
            let mut unit = vec![0.0; x.len()];
            unit[c] = 1.0;
            let mut column = vec![0.0; g.len()];
            g.apply(&x, &unit, &mut column);
            let sum: f64 = column.iter().zip(&lambda).map(|(g, l)| g * l).sum();
            assert!((sum - force[c]).abs() < 1e-14);
            let (mut xp, mut xm) = (x.clone(), x.clone());
            xp[c] += h;
            xm[c] -= h;
            let ends = g.residual(&xp).into_iter().zip(g.residual(&xm));
            for (e, ((up, down), exact)) in ends.zip(&column).enumerate() {
                let fd = (up - down) / (2.0 * h);
                let worst = (fd - exact).abs();
                assert!(worst < 1e-8, "edge {e}, column {c}: {fd} against {exact}");
            }
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
