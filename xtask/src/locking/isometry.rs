//! The models of isometry that the report compares.

use anyhow::Result;
use isosheet_dynamics::{CreaseSprings, Potential, SheetModel};
use isosheet_mesh::{MassKind, Sheet};
use std::fmt;

/// How a sheet is kept from stretching.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Isometry {
    /// Every edge is a rigid rod.
    Rods,
}

impl Isometry {
    /// The models that every table has rows for.
    pub(super) const ALL: [Self; 1] = [Self::Rods];

    /// A sheet of the given mass (kilograms, lumped) that does not stretch, without weight or support.
    pub(super) fn model(self, sheet: &Sheet, mass: f64) -> Result<SheetModel> {
        Ok(match self {
            Self::Rods => SheetModel::new(sheet, mass, MassKind::Lumped)?,
        })
    }

    /// The same with springs that resist bending, see [`CreaseSprings::bending`]; `rigidity` in newton
    /// metres.
    pub(super) fn bending(self, sheet: &Sheet, mass: f64, rigidity: f64) -> Result<SheetModel> {
        let springs = CreaseSprings::bending(sheet, rigidity)?;
        Ok(self.model(sheet, mass)?.with_potential(springs))
    }
}

impl fmt::Display for Isometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rods => "rods",
        })
    }
}

/// The energy of bending of positions `x` (3V, metres) against the flat state, joules.
pub(super) fn bending_energy(sheet: &Sheet, rigidity: f64, x: &[f64]) -> Result<f64> {
    Ok(CreaseSprings::bending(sheet, rigidity)?.energy(0.0, x))
}
