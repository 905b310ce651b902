//! The model of a sheet that is of one material.

use crate::{Isometry, ModelError, SheetModel};
use isosheet_materials::Material;
use isosheet_materials::MaterialDirection;
use isosheet_materials::OptionsError;
use isosheet_materials::Yield;
use isosheet_materials::{Curl, PlateBending, PlateBendingError, PlateEdges};
use isosheet_materials::{ElasticSheet, ElasticSheetError};
use isosheet_materials::{NoFace, Patched};
use isosheet_mesh::{Advice, EdgeId, FaceId, MassKind, MassMatrix, Sheet, VertexId};
use isosheet_motion::Profile;

/// Why the model of a sheet of a material cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SheetOfMaterialError {
    /// A number of the material makes no sense.
    #[error("the material cannot be used: {0}")]
    Material(#[source] OptionsError),
    /// The mass or the clamps do not fit the sheet.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The bending stiffness cannot be made.
    #[error(transparent)]
    Bending(#[from] PlateBendingError),
    /// The elasticity in the plane cannot be made.
    #[error(transparent)]
    Elasticity(#[from] ElasticSheetError),
    /// A patch has a face that the sheet has not.
    #[error(transparent)]
    Patch(#[from] NoFace),
    /// The sheet has a direction, and its material has none.
    #[error("the sheet has a direction, and its material is the same in all directions")]
    NoDirections,
    /// The sheet swells, and is of rigid rods.
    #[error("the sheet swells or shrinks, and it is of rigid rods, which keep their lengths")]
    RodsSwell,
}

impl Advice for SheetOfMaterialError {
    fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Material(error) => error.advice(),
            Self::Model(error) => error.advice(),
            Self::Bending(error) => error.advice(),
            Self::Elasticity(error) => error.advice(),
            Self::Patch(error) => error.advice(),
            Self::NoDirections => {
                Some("leave out the direction, or give a material with `directions`")
            }
            Self::RodsSwell => Some("leave out the rods, or the swelling"),
        }
    }
}

/// The choices of [`SheetModel::of_material`]; [`SheetOfMaterial::build`] makes the model.
#[derive(Debug, Clone)]
#[must_use = "the model is made by `build`"]
pub struct SheetOfMaterial<'a> {
    sheet: &'a Sheet,
    materials: Patched<Material>,
    direction: Option<MaterialDirection>,
    isometry: Isometry,
    clamps: Vec<VertexId>,
    creases: Vec<EdgeId>,
    yields: Option<Yield>,
    curvature: WithoutStress,
    swelling: Option<Profile>,
}

/// The shape that bending moments are measured from.
#[derive(Debug, Clone)]
enum WithoutStress {
    Flat,
    /// The shape of the sheet as it is given.
    AsGiven,
    Curled(Curl),
}

impl SheetModel {
    /// The model of a sheet of one material, which gives it its mass, the bending stiffness of a plate, and
    /// the elasticity in its plane with a limit of the strain. What else acts on it is added after
    /// [`SheetOfMaterial::build`].
    ///
    /// ```
    /// use isosheet_materials::Material;
    /// use isosheet_mesh::generate;
    /// use isosheet_model::SheetModel;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let sheet = generate::anisotropic_grid(12, 8, 0.3, 0.2)?;
    /// let clamp = sheet.vertices_where(|[x, _, _]| x < 0.03); // two columns of vertices
    /// let paper = Material::office_paper();
    /// let model = SheetModel::of_material(&sheet, &paper).clamped(&clamp).build()?.with_gravity();
    /// assert!(model.elastic_sheet().is_some());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// A sheet whose mass is known otherwise is built of the same parts by hand: [`SheetModel::with_mass`],
    /// [`PlateBending`], [`Material::elastic_sheet`], and [`PotentialOfPart`](crate::PotentialOfPart) for one
    /// of several sheets.
    pub fn of_material<'a>(sheet: &'a Sheet, material: &Material) -> SheetOfMaterial<'a> {
        SheetOfMaterial {
            sheet,
            materials: Patched::everywhere(*material),
            direction: None,
            isometry: Isometry::Elastic,
            clamps: Vec::new(),
            creases: Vec::new(),
            yields: None,
            curvature: WithoutStress::Flat,
            swelling: None,
        }
    }
}

impl SheetOfMaterial<'_> {
    /// Pins vertices where they are, in addition to earlier calls. Where all corners of a face are among them
    /// the sheet is clamped: it leaves the clamp with the slope of that face ([`PlateBending::clamped`]).
    /// Single vertices and single lines of vertices are hinges.
    pub fn clamped(mut self, vertices: &[VertexId]) -> Self {
        self.clamps.extend(vertices);
        self
    }

    /// Lays the material along a direction: the one in which paper was made, the warp of cloth. Without, the
    /// sheet is the same in all directions.
    pub fn along(mut self, direction: MaterialDirection) -> Self {
        self.direction = Some(direction);
        self
    }

    /// Makes some faces of another material: a label, a reinforcement. The limit of the strain is the largest
    /// of all materials.
    pub fn with_patch(mut self, faces: Vec<FaceId>, material: &Material) -> Self {
        self.materials = self.materials.with_patch(faces, *material);
        self
    }

    /// Interrupts the bending stiffness at edges, in addition to earlier calls, where the springs of creases
    /// take its place ([`PlateBending::creased`]).
    pub fn creased(mut self, edges: &[EdgeId]) -> Self {
        self.creases.extend(edges);
        self
    }

    /// Makes the sheet yield in bending, for instance as its [material](Material::yields) does. By default it
    /// is elastic.
    pub fn yielding(mut self, yields: Yield) -> Self {
        self.yields = Some(yields);
        self
    }

    /// Leaves the sheet curved as its positions are, without stress, in place of flat
    /// ([`PlateBending::curved`]).
    pub fn curved(mut self) -> Self {
        self.curvature = WithoutStress::AsGiven;
        self
    }

    /// Gives the sheet a curvature that it has by itself ([`PlateBending::with_curl`]).
    pub fn curled(mut self, curl: Curl) -> Self {
        self.curvature = WithoutStress::Curled(curl);
        self
    }

    /// Lets all lengths grow by a part that is a function of time ([`ElasticSheet::with_swelling`]).
    pub fn swelling(mut self, part: impl Into<Profile>) -> Self {
        self.swelling = Some(part.into());
        self
    }

    /// What keeps the lengths: the elasticity of the material, which is the default, or rigid rods along the
    /// edges, of which the material gives mass and bending stiffness alone.
    pub fn with_isometry(mut self, isometry: Isometry) -> Self {
        self.isometry = isometry;
        self
    }

    /// The model, without gravity.
    ///
    /// # Errors
    /// [`SheetOfMaterialError`] naming the number, the vertex or the edge that cannot be used.
    pub fn build(self) -> Result<SheetModel, SheetOfMaterialError> {
        let Self {
            sheet,
            materials,
            direction,
            isometry,
            clamps,
            creases,
            yields,
            curvature,
            swelling,
        } = self;
        for material in materials.all() {
            let checked = material.validate();
            checked.map_err(SheetOfMaterialError::Material)?;
        }
        let direction = direction.as_ref();
        let has_directions = |material: &Material| material.directions.is_some();
        if direction.is_some() && !materials.all().any(has_directions) {
            return Err(SheetOfMaterialError::NoDirections);
        }
        let materials = materials.map(|material| match direction {
            Some(_) => material.directed(),
            None => *material,
        });
        let of_faces = materials.of_faces(sheet.topology().face_count())?;
        let density = |face: FaceId| of_faces[face.index()].density;
        let mass = MassMatrix::from_densities(sheet, density, MassKind::Lumped);
        let mass = mass.map_err(ModelError::from)?;
        let model = SheetModel::with_mass(sheet, mass)?.with_pins(&clamps)?;
        let laws = materials.map(|material| material.plate(direction));
        let edges = PlateEdges {
            pinned: &clamps,
            creases: &creases,
            clamps: &[],
        };
        let mut plate = PlateBending::patched(sheet, &laws, &edges)?;
        plate = match curvature {
            WithoutStress::Flat => plate,
            WithoutStress::AsGiven => plate.curved(sheet),
            WithoutStress::Curled(curl) => plate.with_curl(sheet, curl)?,
        };
        if let Some(yields) = yields {
            plate = plate.with_yield(sheet, yields)?;
        }
        let model = match isometry {
            Isometry::Rods if swelling.is_some() => return Err(SheetOfMaterialError::RodsSwell),
            Isometry::Rods => model,
            Isometry::Elastic => {
                let laws = materials.map(|material| material.membrane(direction));
                let limits = materials.all().map(|material| material.strain_limit);
                let mut elastic = ElasticSheet::patched(sheet, &laws)?.beside(sheet, &plate);
                if let Some(part) = swelling {
                    elastic = elastic.with_swelling(part)?;
                }
                model.with_elastic_sheet(elastic.with_limit(limits.fold(0.0, f64::max))?)?
            }
        };
        Ok(model.with_potential(plate))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;

    fn strip() -> Sheet {
        generate::anisotropic_grid(8, 2, 0.2, 0.05).unwrap()
    }

    #[test]
    fn the_same_material_stiffens_rods() {
        let sheet = strip();
        let paper = Material::office_paper();
        let builder = SheetModel::of_material(&sheet, &paper).with_isometry(Isometry::Rods);
        let model = builder.build().unwrap();
        assert!(model.elastic_sheet().is_none());
        // A strip of 0.2 m by 0.05 m that is bent to a cylinder of the radius 1 m has the energy D A / 2.
        let bent = sheet.positions().as_chunks::<3>().0.iter();
        let bent: Vec<f64> = bent
            .flat_map(|[x, y, _]| [x.sin(), *y, 1.0 - x.cos()])
            .collect();
        let expected = 0.5 * paper.rigidity * sheet.area();
        let energy = model.potential_energy(0.0, &bent);
        // Faces at free edges, which no moment bends, are less bent than the others.
        assert!(
            energy > 0.5 * expected && energy < 1.05 * expected,
            "{energy} {expected}"
        );
    }

    #[test]
    fn what_cannot_be_used_is_refused() {
        let sheet = strip();
        let mut material = Material::office_paper();
        let nobody = VertexId(1000);
        let refused = SheetModel::of_material(&sheet, &material)
            .clamped(&[nobody])
            .build();
        let vertex_count = sheet.topology().vertex_count();
        let expected = ModelError::NoSuchVertex {
            vertex: nobody,
            vertex_count,
        };
        assert_eq!(refused.unwrap_err(), expected.into());
        let refused = SheetModel::of_material(&sheet, &material)
            .creased(&[EdgeId(1000)])
            .build();
        assert!(matches!(refused, Err(SheetOfMaterialError::Bending(_))));
        let refused = SheetModel::of_material(&sheet, &material)
            .swelling(0.01)
            .with_isometry(Isometry::Rods)
            .build();
        assert_eq!(refused.unwrap_err(), SheetOfMaterialError::RodsSwell);
        let swollen = SheetModel::of_material(&sheet, &material).swelling(0.001);
        let swollen = swollen.build().unwrap();
        let strains = swollen.elastic_sheet().unwrap();
        let mut strains = strains.strains(isosheet_materials::At::new(0.0, sheet.positions()));
        let expected = 0.5_f64.sqrt() * (1.001_f64.powi(-2) - 1.0).abs();
        assert!(strains.all(|s| (s - expected).abs() < 1e-12));
        material.rigidity = f64::NAN;
        let refused = SheetModel::of_material(&sheet, &material)
            .build()
            .unwrap_err();
        assert!(matches!(refused, SheetOfMaterialError::Material(_)));
        assert!(refused.to_string().contains("rigidity"), "{refused}");
        assert!(refused.advice().is_some());
    }
}
