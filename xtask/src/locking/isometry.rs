//! The models of isometry that the report compares.

use anyhow::Result;
use isosheet_dynamics::{CreaseSprings, Membrane, PlateBending, Potential, SheetModel};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use std::fmt;

/// Membrane stiffness `E h` of office paper, newtons per metre, and its Poisson's ratio.
const PAPER: (f64, f64) = (3e5, 0.3);

/// How a sheet is kept from stretching, and what resists its bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Isometry {
    /// Every edge is a rigid rod; springs at the edges, see [`CreaseSprings::bending`].
    Rods,
    /// The membrane of office paper, see [`Membrane`]; the bending stiffness of a plate, see [`PlateBending`].
    Elastic,
}

impl Isometry {
    /// The models that every table has rows for.
    pub(super) const ALL: [Self; 2] = [Self::Rods, Self::Elastic];

    /// A sheet of the given mass (kilograms, lumped), without bending stiffness, weight or support.
    pub(super) fn model(self, sheet: &Sheet, mass: f64) -> Result<SheetModel> {
        let model = SheetModel::new(sheet, mass, MassKind::Lumped)?;
        Ok(match self {
            Self::Rods => model,
            Self::Elastic => model.with_membrane(Membrane::new(sheet, PAPER.0, PAPER.1)?),
        })
    }

    /// The same with bending stiffness; `rigidity` in newton metres, `clamped` the vertices that clamps fix.
    pub(super) fn bending(
        self,
        sheet: &Sheet,
        mass: f64,
        rigidity: f64,
        clamped: &[VertexId],
    ) -> Result<SheetModel> {
        let model = self.model(sheet, mass)?;
        Ok(match self {
            Self::Rods => model.with_potential(CreaseSprings::bending(sheet, rigidity)?),
            Self::Elastic => model.with_potential(PlateBending::clamped(sheet, rigidity, clamped)?),
        })
    }

    /// The energy of bending of positions `x` (3V, metres) against the flat state, joules.
    pub(super) fn bending_energy(self, sheet: &Sheet, rigidity: f64, x: &[f64]) -> Result<f64> {
        match self {
            Self::Rods => bending_energy(sheet, rigidity, x),
            Self::Elastic => Ok(PlateBending::new(sheet, rigidity)?.energy(0.0, x)),
        }
    }
}

impl fmt::Display for Isometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rods => "rods",
            Self::Elastic => "elastic",
        })
    }
}

/// The energy of bending of springs at the edges, joules, at positions `x` (3V, metres).
pub(super) fn bending_energy(sheet: &Sheet, rigidity: f64, x: &[f64]) -> Result<f64> {
    Ok(CreaseSprings::bending(sheet, rigidity)?.energy(0.0, x))
}
