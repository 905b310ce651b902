//! The models of isometry that the report compares.

use crate::draw::{Colour, palette};
use anyhow::Result;
use isosheet_dynamics::{CreaseSprings, Membrane, PlateBending, Potential, SheetModel};
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
    /// A membrane of the stiffness [`soft_stiffness`]; the bending stiffness of a plate.
    Soft,
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

impl Isometry {
    /// The models that every table has rows for.
    pub(super) const ALL: [Self; 3] = [Self::Rods, Self::Paper, Self::Soft];

    /// A sheet of a material, without weight and support.
    pub(super) fn model(self, sheet: &Sheet, material: Material<'_>) -> Result<SheetModel> {
        match self {
            Self::Rods => rods(sheet, material),
            Self::Paper => elastic(sheet, material, PAPER),
            Self::Soft => {
                let rigidity = material.rigidity.unwrap_or(PAPER_RIGIDITY);
                elastic(sheet, material, (soft_stiffness(sheet, rigidity), PAPER.1))
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
        }
    }
}

impl fmt::Display for Isometry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rods => "rods",
            Self::Paper => "elastic (paper)",
            Self::Soft => "elastic (soft)",
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
    Ok(match material.rigidity {
        None => model,
        Some(rigidity) => {
            model.with_potential(PlateBending::clamped(sheet, rigidity, material.clamped)?)
        }
    })
}

/// Membrane stiffness `100 D / h^2` that leaves bends free (see [`Membrane`]), newtons per metre, with `h^2`
/// twice the mean area of a triangle: the square of the side of a cell in a mesh of squares cut in two.
pub(super) fn soft_stiffness(sheet: &Sheet, rigidity: f64) -> f64 {
    let mean = sheet.area() / sheet.topology().faces().len() as f64;
    100.0 * rigidity / (2.0 * mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;

    #[test]
    fn the_soft_stiffness_is_that_of_the_side_of_a_cell() {
        let sheet = generate::isotropic_square(2, 1.0).unwrap();
        let stiffness = soft_stiffness(&sheet, 2.0);
        assert!(
            (stiffness / (200.0 * 64.0) - 1.0).abs() < 1e-12,
            "{stiffness}"
        );
    }

    /// A uniform stretch by 1 % along x stores `A K E^2 / 2` with Green's strain `E` and
    /// `K = E h / (1 - nu^2)` in every elastic model, and no bending energy.
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
        let material = Material {
            mass: 0.1,
            rigidity: Some(PAPER_RIGIDITY),
            clamped: &[],
        };
        let strain = 0.5 * (1.01 * 1.01 - 1.0);
        for (isometry, stiffness) in [
            (Isometry::Paper, 3e5),
            (Isometry::Soft, 100.0 * PAPER_RIGIDITY * 16.0),
        ] {
            let model = isometry.model(&sheet, material).unwrap();
            let known = 0.5 * stiffness / (1.0 - 0.09) * strain * strain;
            let energy = model.potential_energy(0.0, &x);
            assert!((energy / known - 1.0).abs() < 1e-9, "{energy} {known}");
            let bending = isometry.bending_energy(&sheet, (PAPER_RIGIDITY, &[]), &x);
            assert!(bending.unwrap().abs() < 1e-15);
        }
    }
}
