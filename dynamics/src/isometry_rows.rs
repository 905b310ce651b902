//! The equations that keep the lengths of a sheet.

use crate::weak_isometry::WeakRows;
use isosheet_mesh::LengthConstraints;

/// The equations `W d(x) = 0` of a model, with the length errors `d_e = (|x_a - x_b|^2 - l_e^2) / 2` of the
/// edges: `W` is the identity for rods, and the matrix of [`WeakIsometry`](crate::WeakIsometry) in weak form.
/// Their Jacobian is `J = W G` with the rigidity matrix `G = dd/dx`. (An elastic sheet has the equations of
/// rods with penalties of zero.)
#[derive(Debug, Clone, Copy)]
pub(crate) enum IsometryRows<'a> {
    /// One equation for each edge, square metres.
    Rods(&'a LengthConstraints),
    /// Two equations for each vertex, strains.
    Weak(&'a LengthConstraints, &'a WeakRows),
}

/// Sizes of an equation, for tolerances and round-off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RowScale {
    /// Its value at a strain of one: `l^2` for a rod, 1 in weak form.
    pub(crate) unit: f64,
    /// The sum of `|W| l^2` over the edges.
    pub(crate) size: f64,
    /// The sum of `|W| l` over the edges: by how much it grows with a displacement of one metre.
    pub(crate) slope: f64,
}

impl IsometryRows<'_> {
    /// Number of equations.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Rods(rods) => rods.len(),
            Self::Weak(_, weak) => weak.len(),
        }
    }

    /// `W d(x)`.
    pub(crate) fn residual_into(&self, x: &[f64], out: &mut [f64]) {
        match self {
            Self::Rods(rods) => rods.residual_into(x, out),
            Self::Weak(_, weak) => weak.residual_into(x, out),
        }
    }

    /// `J(x) v`.
    pub(crate) fn apply(&self, x: &[f64], v: &[f64], out: &mut [f64]) {
        match self {
            Self::Rods(rods) => rods.apply(x, v, out),
            Self::Weak(_, weak) => weak.apply(x, v, out),
        }
    }

    /// Force densities of the edges `W^T m`: the Hessian of `m . W d` is that of springs with these
    /// densities.
    pub(crate) fn densities_into(&self, multipliers: &[f64], densities: &mut [f64]) {
        match self {
            Self::Rods(_) => densities.copy_from_slice(multipliers),
            Self::Weak(_, weak) => weak.densities_into(multipliers, densities),
        }
    }

    /// Adds `J(x)^T m = G(x)^T W^T m`; `densities` becomes `W^T m`.
    pub(crate) fn apply_transpose_add(
        &self,
        x: &[f64],
        multipliers: &[f64],
        densities: &mut [f64],
        out: &mut [f64],
    ) {
        self.densities_into(multipliers, densities);
        let (Self::Rods(rods) | Self::Weak(rods, _)) = self;
        rods.apply_transpose_add(x, densities, out);
    }

    /// Sizes of the equations.
    pub(crate) fn scales(&self) -> Vec<RowScale> {
        match self {
            Self::Rods(rods) => {
                let scale = |l: &f64| RowScale {
                    unit: l * l,
                    size: l * l,
                    slope: *l,
                };
                rods.lengths().iter().map(scale).collect()
            }
            Self::Weak(_, weak) => {
                let scale = |[size, slope]: [f64; 2]| RowScale {
                    unit: 1.0,
                    size,
                    slope,
                };
                weak.scales().into_iter().map(scale).collect()
            }
        }
    }
}
