//! The models of a sheet with bending stiffness that yardsticks with answers in closed form compare.

use super::isometry::PAPER;
use crate::draw::{Colour, palette};
use crate::report::{Bound, Finding};
use crate::runs::Course;
use anyhow::Result;
use isosheet_dynamics::{CreaseSprings, ElasticSheet, PlateBending, Potential, SheetModel};
use isosheet_mesh::{EdgeId, MassKind, Sheet, VertexId, fold_angle};
use serde::{Deserialize, Serialize};
use std::fmt;

/// How a sheet is kept from stretching.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Model {
    /// The elastic sheet with faces as stiff as the mesh can bear, see [`ElasticSheet::softened`]; a plate.
    Elastic,
    /// The same with another bound `C` of the stiffness.
    Bound(f64),
    /// The elastic sheet with the stiffness of the material on every face, and a plate.
    Material,
    /// Every edge is a rigid rod; springs at the edges, see [`CreaseSprings::bending`].
    Rods,
}

/// What a sheet is made of, which vertices clamps fix, and where creases are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plate<'a> {
    /// Mass per area, kg/m2.
    pub(super) density: f64,
    /// Flexural rigidity, N m.
    pub(super) rigidity: f64,
    pub(super) clamped: &'a [VertexId],
    /// Edges where springs replace the stiffness of the sheet.
    pub(super) creases: &'a [EdgeId],
}

impl Model {
    /// The models that the tables have rows for.
    pub(super) const ALL: [Self; 3] = [Self::Elastic, Self::Material, Self::Rods];

    /// A sheet without weight and supports.
    pub(super) fn sheet(self, sheet: &Sheet, plate: Plate<'_>) -> Result<SheetModel> {
        let Plate {
            density, rigidity, ..
        } = plate;
        let model = SheetModel::new(sheet, density * sheet.area(), MassKind::Lumped)?;
        let real = || ElasticSheet::new(sheet, PAPER.0, PAPER.1);
        let elastic = match self {
            Self::Rods => {
                let springs = CreaseSprings::bending_beside(sheet, rigidity, plate.creases)?;
                return Ok(model.with_potential(springs));
            }
            Self::Elastic => real()?.softened(rigidity)?,
            Self::Bound(c) => real()?.softened(rigidity * c / ElasticSheet::SOFTENING)?,
            Self::Material => real()?,
        };
        let bending = plate.bending(sheet)?;
        Ok(model.with_potential(bending).with_elastic_sheet(elastic)?)
    }

    /// The energy of bending of positions `x` (3V, metres), without that of creases, joules.
    pub(super) fn bending_energy(self, sheet: &Sheet, plate: Plate<'_>, x: &[f64]) -> Result<f64> {
        Ok(match self {
            Self::Rods => {
                CreaseSprings::bending_beside(sheet, plate.rigidity, plate.creases)?.energy(0.0, x)
            }
            _ => plate.bending(sheet)?.energy(0.0, x),
        })
    }

    /// The elastic energy in the plane and of bending, without that of creases, joules.
    pub(super) fn energy(self, sheet: &Sheet, plate: Plate<'_>, x: &[f64]) -> Result<f64> {
        Ok(self.sheet(sheet, plate)?.potential_energy(0.0, x))
    }

    /// The elastic energy of each face, joules; that of a spring belongs to both faces of its edge in equal parts.
    pub(super) fn face_energies(
        self,
        sheet: &Sheet,
        plate: Plate<'_>,
        x: &[f64],
    ) -> Result<Vec<f64>> {
        if let Some(faces) = self.sheet(sheet, plate)?.elastic_deformation(x) {
            let sums = faces.stretching.iter().zip(&faces.bending);
            return Ok(sums.map(|(s, b)| s + b).collect());
        }
        let t = sheet.topology();
        let mut energies = vec![0.0; t.face_count()];
        for edge in t.edge_ids().filter(|e| !plate.creases.contains(e)) {
            let ([Some(left), Some(right)], Some(angle)) =
                (t.edge_faces(edge), fold_angle(t, x, edge))
            else {
                continue;
            };
            let faces = [left, right].map(|f| f.index());
            let area: f64 = faces.iter().map(|f| sheet.face_areas()[*f]).sum();
            // See [`CreaseSprings::bending`].
            let stiffness = plate.rigidity * sheet.lengths()[edge.index()].powi(2) / area;
            for face in faces {
                energies[face] += 0.25 * stiffness * angle * angle;
            }
        }
        Ok(energies)
    }

    /// The colour in figures.
    pub(super) fn colour(self) -> Colour {
        match self {
            Self::Elastic | Self::Bound(_) => palette::GREEN,
            Self::Material => palette::BLUE,
            Self::Rods => palette::VERMILION,
        }
    }
}

impl Plate<'_> {
    fn bending(&self, sheet: &Sheet) -> Result<PlateBending> {
        Ok(PlateBending::creased(
            sheet,
            self.rigidity,
            self.clamped,
            self.creases,
        )?)
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Elastic => f.write_str("elastic"),
            Self::Bound(c) => write!(f, "elastic, C = {c}"),
            Self::Material => f.write_str("real stiffness"),
            Self::Rods => f.write_str("rods"),
        }
    }
}

/// A run with one model, and what was measured of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Tried<J, M> {
    pub(super) model: Model,
    pub(super) job: J,
    /// Number of vertices of the mesh.
    pub(super) vertices: usize,
    pub(super) course: Course,
    pub(super) measured: M,
}

impl<J, M> Tried<J, M> {
    /// A value of a run that reached its end.
    pub(super) fn if_good(&self, value: impl Fn(&M) -> f64) -> Option<f64> {
        self.course.is_good().then(|| value(&self.measured))
    }
}

/// A requirement on the largest of some values of a model.
pub(super) fn at_most(model: Model, quantity: &str, bound: f64, values: &[Option<f64>]) -> Finding {
    Finding::worst(model.to_string(), quantity, Bound::AtMost(bound), values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;

    #[test]
    fn the_energies_of_the_faces_are_that_of_the_sheet() {
        let sheet = generate::isotropic_square(2, 0.1).unwrap();
        let plate = Plate {
            density: 0.08,
            rigidity: 5e-4,
            clamped: &[],
            creases: &[EdgeId(3)],
        };
        let bent = sheet
            .map_positions(|[x, y, _]| [x, y, 0.1 * x * x + 0.05 * x * y])
            .unwrap();
        for model in Model::ALL {
            let x = bent.positions();
            let faces = model.face_energies(&sheet, plate, x).unwrap();
            let whole = model.energy(&sheet, plate, x).unwrap();
            let part = faces.iter().sum::<f64>() / whole;
            assert!((part - 1.0).abs() < 1e-12, "{model}: {part}");
        }
    }
}
