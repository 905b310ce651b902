//! The models of isometry that the report compares.

use crate::draw::{Colour, palette};
use anyhow::Result;
use isosheet_dynamics::{
    CreaseSprings, ElasticSheet, Membrane, PlateBending, Potential, SheetModel,
};
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
    /// The membrane of office paper, see [`Membrane`]; the bending stiffness of a plate, see
    /// [`PlateBending`].
    Paper,
    /// A membrane of the stiffness `100 D / h^2` (`D`: flexural rigidity, `h^2`: twice the mean area of the
    /// faces), which leaves bends free; the bending stiffness of a plate.
    Soft,
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
    pub(super) const ALL: [Self; 4] = [Self::Rods, Self::Paper, Self::Soft, Self::Elastic];

    /// A sheet of a material, without weight and support. The membranes whose stiffness follows from the
    /// flexural rigidity have that of [`PAPER_RIGIDITY`] where there is none.
    pub(super) fn model(self, sheet: &Sheet, material: Material<'_>) -> Result<SheetModel> {
        let rigidity = material.rigidity.unwrap_or(PAPER_RIGIDITY);
        match self {
            Self::Rods => rods(sheet, material),
            Self::Paper => elastic(sheet, material, PAPER),
            Self::Soft => elastic(sheet, material, (soft(sheet, rigidity), PAPER.1)),
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
            Self::Soft => palette::GREEN,
            Self::Elastic => palette::PURPLE,
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
            Self::Paper => "elastic (paper)",
            Self::Soft => "elastic (soft)",
            Self::Elastic => "elastic sheet",
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
    let model = SheetModel::new(sheet, material.mass, MassKind::Lumped)?
        .with_membrane(Membrane::new(sheet, stiffness, poisson)?);
    with_plate(model, sheet, material)
}

/// The stiffness of a soft membrane, see [`Isometry::Soft`].
fn soft(sheet: &Sheet, rigidity: f64) -> f64 {
    let squared = 2.0 * sheet.area() / sheet.topology().face_count() as f64;
    100.0 * rigidity / squared
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

    /// A uniform stretch by 1 % along x stores `A K E^2 / 2` with Green's strain `E` and `K = E h / (1 -
    /// nu^2)` in every model with a membrane, and no bending energy. The stiffness of the soft ones is `100
    /// D` over the square of the side of a cell, 0.25 m.
    #[test]
    fn the_energies_of_a_stretched_square_are_known() {
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let x: Vec<f64> = sheet
            .positions()
            .as_chunks::<3>()
            .0
            .iter()
            .flat_map(|p| [1.01 * p[0], p[1], p[2]])
            .collect();
        let material = Material::plate(&sheet, 0.1, PAPER_RIGIDITY, &[]);
        let strain = 0.5 * (1.01 * 1.01 - 1.0);
        let soft = 100.0 * PAPER_RIGIDITY * 16.0;
        for (isometry, stiffness, poisson) in
            [(Isometry::Paper, 3e5, 0.3), (Isometry::Soft, soft, 0.3)]
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
