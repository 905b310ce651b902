//! The second derivatives of energies: who receives them, and which part of them.

use crate::vectors::{add, point};
use isosheet_mesh::{EdgeId, VertexId};
use nalgebra::{Matrix3, Vector3};

/// Receives the 3 x 3 blocks of a potential's Hessian.
///
/// Blocks exist where the rods have them, at every vertex and along every edge, and for the pairs that
/// [`Potential::couplings`](crate::Potential::couplings) names. Other couplings have to be left out, which
/// costs iterations, not accuracy.
pub trait HessianSink {
    /// Adds `d2V / dx_v dx_v`, symmetric.
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>);

    /// Adds `d2V / dx_a dx_b` for the edge `a -> b`; the transposed block is implied.
    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>);

    /// Adds `d2V / dx_a dx_b` for a pair named by [`Potential::couplings`](crate::Potential::couplings), rows
    /// at `a`; the transposed block is implied.
    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>);

    /// Adds `factor g g^T` with a `factor` of at least zero and a vector `g` of some vertices, which may be
    /// all of them: the part of the Hessian of an energy of one quantity that is made of the quantity's
    /// gradient. Damped steps take it exactly, for one more solve. The default leaves it out, as conservative
    /// methods do.
    fn add_square(&mut self, _factor: f64, _gradient: &[(VertexId, Vector3<f64>)]) {}
}

/// Receives 3x3 blocks of a symmetric Hessian.
pub trait CouplingSink {
    /// Adds `block` to `d2/dx_a dx_b`, rows at `a`; for `a != b` its transpose belongs to `ba` and is not
    /// given again. For `a = b` the block is symmetric.
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>);
}

/// Receives blocks of both kinds: of edges and named pairs, and of any pair.
pub trait BlockSink: HessianSink + CouplingSink {}

impl<S: HessianSink + CouplingSink + ?Sized> BlockSink for S {}

/// Which part of second derivatives enters a Hessian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HessianPart {
    /// All of them.
    Full,
    /// A positive semidefinite part, where there is one.
    PositiveSemidefinite,
    /// A part that is certain to be positive semidefinite: that of potentials is not.
    Certain,
}

/// A sink that adds `scale` times the product of a Hessian and a vector to another vector.
#[derive(Debug)]
pub struct HessianProduct<'a> {
    /// The edges of the sheet.
    pub edges: &'a [[usize; 2]],
    /// The factor.
    pub scale: f64,
    /// The vector, `3V`.
    pub vector: &'a [f64],
    /// What the product is added to, `3V`.
    pub product: &'a mut [f64],
}

impl HessianProduct<'_> {
    fn add_row(&mut self, row: usize, column: usize, block: &Matrix3<f64>) {
        let v = Vector3::from_column_slice(&self.vector[3 * column..3 * column + 3]);
        if v == Vector3::zeros() {
            return;
        }
        let product = self.scale * block * v;
        for k in 0..3 {
            self.product[3 * row + k] += product[k];
        }
    }

    fn add_both(&mut self, a: usize, b: usize, block: &Matrix3<f64>) {
        self.add_row(a, b, block);
        self.add_row(b, a, &block.transpose());
    }
}

impl HessianSink for HessianProduct<'_> {
    fn add_vertex(&mut self, v: VertexId, block: &Matrix3<f64>) {
        self.add_row(v.index(), v.index(), block);
    }

    fn add_edge(&mut self, e: EdgeId, block: &Matrix3<f64>) {
        let [a, b] = self.edges[e.index()];
        self.add_both(a, b, block);
    }

    fn add_pair(&mut self, a: VertexId, b: VertexId, block: &Matrix3<f64>) {
        self.add_both(a.index(), b.index(), block);
    }

    fn add_square(&mut self, factor: f64, gradient: &[(VertexId, Vector3<f64>)]) {
        let slopes = gradient.iter().map(|(v, g)| g.dot(&point(self.vector, *v)));
        let slope = self.scale * factor * slopes.sum::<f64>();
        for (v, g) in gradient {
            add(self.product, *v, &(slope * g));
        }
    }
}

impl CouplingSink for HessianProduct<'_> {
    fn add(&mut self, a: u32, b: u32, block: &Matrix3<f64>) {
        match a == b {
            true => self.add_row(a as usize, a as usize, block),
            false => self.add_both(a as usize, b as usize, block),
        }
    }
}
