//! The models of isometry that the report compares.

use crate::draw::{Colour, palette};
use anyhow::Result;
use isosheet_dynamics::{CreaseSprings, ElasticSheet, PlateBending, Potential, SheetModel};
use isosheet_mesh::{MassKind, Sheet, VertexId};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Membrane stiffness `E h` of office paper, newtons per metre, and its Poisson's ratio.
pub(super) const PAPER: (f64, f64) = (3e5, 0.3);

/// Flexural rigidity of office paper, N m.
pub(super) const PAPER_RIGIDITY: f64 = 5e-4;

/// How a sheet is kept from stretching, and what resists its bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) enum Isometry {
    /// Every edge is a rigid rod; springs at the edges, see [`CreaseSprings::bending`].
    Rods,
    /// An elastic sheet with the stiffness of office paper on every face, and the bending stiffness of a plate, see
    /// [`PlateBending`].
    Paper,
    /// Office paper that is softened as far as the mesh needs, with a limit of the strain, see
    /// [`ElasticSheet`]; the bending stiffness of a plate.
    Elastic,
}

/// Mass and bending stiffness of a sheet, and which vertices clamps fix.
#[derive(Clone, Copy, Debug)]
pub(super) struct Material<'a> {
    /// Total mass, kilograms, lumped.
    pub(super) mass: f64,
    /// Flexural rigidity, N m; nothing for a sheet without bending stiffness.
    pub(super) rigidity: Option<f64>,
    pub(super) clamped: &'a [VertexId],
}

impl<'a> Material<'a> {
    /// A sheet with mass per area (kg/m2) and flexural rigidity (N m).
    pub(super) fn plate(
        sheet: &Sheet,
        density: f64,
        rigidity: f64,
        clamped: &'a [VertexId],
    ) -> Self {
        Self {
            mass: density * sheet.area(),
            rigidity: Some(rigidity),
            clamped,
        }
    }

    /// A sheet of a mass (kilograms) without bending stiffness and clamps.
    pub(super) fn limp(mass: f64) -> Self {
        Self {
            mass,
            rigidity: None,
            clamped: &[],
        }
    }
}

impl Isometry {
    /// The models that every table has rows for.
    pub(super) const ALL: [Self; 3] = [Self::Rods, Self::Paper, Self::Elastic];

    /// A sheet of a material, without weight and support. The membranes whose stiffness follows from the
    /// flexural rigidity have that of [`PAPER_RIGIDITY`] where there is none.
    pub(super) fn model(self, sheet: &Sheet, material: Material<'_>) -> Result<SheetModel> {
        let rigidity = material.rigidity.unwrap_or(PAPER_RIGIDITY);
        match self {
            Self::Rods => rods(sheet, material),
            Self::Paper => elastic(sheet, material, PAPER),
            Self::Elastic => {
                let elastic = ElasticSheet::new(sheet, PAPER.0, PAPER.1)?.softened(rigidity)?;
                let model = SheetModel::new(sheet, material.mass, MassKind::Lumped)?;
                with_plate(model.with_elastic_sheet(elastic)?, sheet, material)
            }
        }
    }

    /// The energy of bending of positions `x` (3V, metres) against the flat state, joules.
    pub(super) fn bending_energy(
        self,
        sheet: &Sheet,
        (rigidity, clamped): (f64, &[VertexId]),
        x: &[f64],
    ) -> Result<f64> {
        Ok(if self == Self::Rods {
            CreaseSprings::bending(sheet, rigidity)?.energy(0.0, x)
        } else {
            PlateBending::clamped(sheet, rigidity, clamped)?.energy(0.0, x)
        })
    }

    /// The colour in figures.
    pub(super) fn colour(self) -> Colour {
        match self {
            Self::Rods => palette::VERMILION,
            Self::Paper => palette::BLUE,
            Self::Elastic => palette::GREEN,
        }
    }

    /// The place among the models that are drawn beside one another, in whole steps from the middle.
    pub(super) fn aside(self) -> f64 {
        f64::from(self as u8) - 0.5 * (Self::ALL.len() as f64 - 1.0)
    }

    /// Whether a step keeps equations of isometry to a tolerance.
    pub(super) fn has_equations(self) -> bool {
        self == Self::Rods
    }
}

impl fmt::Display for Isometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rods => "rods",
            Self::Paper => "real stiffness",
            Self::Elastic => "elastic",
        })
    }
}

/// A sheet of rigid rods.
pub(super) fn rods(sheet: &Sheet, material: Material<'_>) -> Result<SheetModel> {
    let model = SheetModel::new(sheet, material.mass, MassKind::Lumped)?;
    Ok(match material.rigidity {
        None => model,
        Some(rigidity) => model.with_potential(CreaseSprings::bending(sheet, rigidity)?),
    })
}

/// An elastic sheet with a membrane stiffness `E h` (newtons per metre) and Poisson's ratio.
pub(super) fn elastic(
    sheet: &Sheet,
    material: Material<'_>,
    (stiffness, poisson): (f64, f64),
) -> Result<SheetModel> {
    let elasticity = ElasticSheet::new(sheet, stiffness, poisson)?;
    let model = SheetModel::new(sheet, material.mass, MassKind::Lumped)?;
    with_plate(model.with_elastic_sheet(elasticity)?, sheet, material)
}

/// Adds the bending stiffness of a plate.
fn with_plate(model: SheetModel, sheet: &Sheet, material: Material<'_>) -> Result<SheetModel> {
    Ok(match material.rigidity {
        None => model,
        Some(rigidity) => {
            model.with_potential(PlateBending::clamped(sheet, rigidity, material.clamped)?)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;

    /// A uniform stretch by 0.4 % along x stores `A K E^2 / 2` with Green's strain `E` and `K = E h / (1 -
    /// nu^2)` in elastic sheets, and no bending energy. The softened stiffness is 2000 `D` over the mean square of
    /// the edges of a face, four thirds of that of the side of a cell, 0.25 m.
    #[test]
    fn the_energies_of_a_stretched_square_are_known() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let x: Vec<f64> = sheet
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| [1.004 * p[0], p[1], p[2]])
            .collect();
        let material = Material::plate(&sheet, 0.1, PAPER_RIGIDITY, &[]);
        let strain = 0.5 * (1.004 * 1.004 - 1.0);
        let soft = 2000.0 * PAPER_RIGIDITY * 16.0 * 0.75;
        for (isometry, stiffness, poisson) in
            [(Isometry::Paper, 3e5, 0.3), (Isometry::Elastic, soft, 0.3)]
        {
            let model = isometry.model(&sheet, material).unwrap();
            let known = 0.5 * stiffness / (1.0 - poisson * poisson) * strain * strain;
            let energy = model.potential_energy(0.0, &x);
            assert!((energy / known - 1.0).abs() < 1e-9, "{energy} {known}");
            let bending = isometry.bending_energy(&sheet, (PAPER_RIGIDITY, &[]), &x);
            assert!(bending.unwrap().abs() < 1e-15);
        }
    }
}
