//! The models of a sheet that are compared, and what sheets are made of.

use anyhow::Result;
use isosheet_dynamics::{At, CreaseSprings, ElasticSheet, PlateBending, Potential, SheetModel};
use isosheet_mesh::{EdgeId, MassKind, Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::fmt;

/// How a sheet is kept from stretching.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Model {
    /// Every edge is a rigid rod; springs at the edges, see [`CreaseSprings::bending`].
    #[serde(rename = "rods")]
    Rods,
    /// The elastic sheet with the stiffness of the material on every face, and a plate.
    #[serde(rename = "real stiffness")]
    Material,
    /// The elastic sheet with the stiffness of the material, whose faces have slack where they bend, and a
    /// plate: see [`ElasticSheet::beside`].
    #[serde(rename = "elastic")]
    Elastic,
}

/// What a sheet is made of, which vertices clamps fix, and where creases are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plate<'a> {
    /// Mass per area, kg/m2.
    pub(super) density: f64,
    /// Flexural rigidity, N m.
    pub(super) rigidity: f64,
    /// The force that pulls the slack of faces out, in parts of that of the library.
    pub(super) force: f64,
    pub(super) clamped: &'a [VertexId],
    /// Edges where springs replace the stiffness of the sheet.
    pub(super) creases: &'a [EdgeId],
}

/// Office paper without clamps and creases.
pub(super) const PAPER: Plate<'static> = Plate {
    density: 0.08,
    rigidity: 5e-4,
    force: 1.0,
    clamped: &[],
    creases: &[],
};

/// Membrane stiffness `E h` of office paper, newtons per metre, and its Poisson's ratio.
const MEMBRANE: [f64; 2] = [3e5, 0.3];

impl Model {
    /// The models that the tables have rows for.
    pub(super) const ALL: [Self; 3] = [Self::Rods, Self::Material, Self::Elastic];

    /// A sheet without weight and supports.
    pub(super) fn sheet(self, sheet: &Sheet, plate: Plate<'_>) -> Result<SheetModel> {
        let model = SheetModel::new(sheet, plate.density * sheet.area(), MassKind::Lumped)?;
        let real = ElasticSheet::new(sheet, MEMBRANE[0], MEMBRANE[1])?;
        let elastic = match self {
            Self::Rods => return Ok(model.with_potential(plate.springs(sheet)?)),
            Self::Material => real,
            Self::Elastic => {
                let rigidity = plate.rigidity * plate.force;
                let bends = Plate { rigidity, ..plate }.bending(sheet)?;
                real.beside(sheet, &bends)
            }
        };
        let model = model.with_potential(plate.bending(sheet)?);
        Ok(model.with_elastic_sheet(elastic)?)
    }

    /// The energy of bending of positions `x` (3V, metres), without that of creases, joules.
    pub(super) fn bending_energy(self, sheet: &Sheet, plate: Plate<'_>, x: &[f64]) -> Result<f64> {
        Ok(match self {
            Self::Rods => plate.springs(sheet)?.energy(At::new(0.0, x)),
            _ => plate.bending(sheet)?.energy(At::new(0.0, x)),
        })
    }

    /// The elastic energy in the plane and of bending, without that of creases, joules.
    pub(super) fn energy(self, sheet: &Sheet, plate: Plate<'_>, x: &[f64]) -> Result<f64> {
        Ok(self.sheet(sheet, plate)?.potential_energy(0.0, x))
    }
}

impl Plate<'_> {
    /// With a Poisson's ratio of zero: otherwise the sides of strips curl, and a strip of paper is softer
    /// than the elastica by one or two per cent.
    fn bending(&self, sheet: &Sheet) -> Result<PlateBending> {
        let (clamped, creases) = (self.clamped, self.creases);
        Ok(PlateBending::creased(
            sheet,
            self.rigidity,
            clamped,
            creases,
        )?)
    }

    fn springs(&self, sheet: &Sheet) -> Result<CreaseSprings> {
        Ok(CreaseSprings::bending_beside(
            sheet,
            self.rigidity,
            self.creases,
        )?)
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rods => "rods",
            Self::Material => "real stiffness",
            Self::Elastic => "elastic",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;

    /// A uniform stretch by 0.4 % along x stores `A K E^2 / 2` with Green's strain `E` and `K = E h / (1 -
    /// nu^2)` in elastic sheets, and no bending energy.
    #[test]
    fn the_energies_of_a_stretched_square_are_known() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let stretched = sheet.map_positions(|[x, y, z]| [1.004 * x, y, z]).unwrap();
        let x = stretched.positions();
        let strain = 0.5 * (1.004 * 1.004 - 1.0);
        let known = 0.5 * MEMBRANE[0] / (1.0 - MEMBRANE[1] * MEMBRANE[1]) * strain * strain;
        for model in [Model::Material, Model::Elastic] {
            let energy = model.energy(&sheet, PAPER, x).unwrap();
            assert!((energy / known - 1.0).abs() < 1e-9, "{energy} {known}");
            let bending = model.bending_energy(&sheet, PAPER, x).unwrap();
            assert!(bending.abs() < 1e-15);
        }
    }
}
