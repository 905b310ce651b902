//! Materials of sheets: what a square metre weighs, and how it resists stretching and bending.

mod catalogue;
mod directions;
#[cfg(test)]
mod tests;

pub use catalogue::{NamedMaterial, UnknownMaterial};
pub use directions::{Directions, Orthotropic};

use crate::options::OptionsError;
use crate::plasticity::Yield;
use crate::{ElasticSheet, ElasticSheetError, PlateBending, PlateLaw, PlateStiffness};
use isosheet_mesh::Sheet;
use serde::{Deserialize, Serialize};

/// A material in the form of a sheet.
///
/// [`Material::named`] looks one up, and each has a constructor of its own, whose documentation says where
/// the numbers are from. [`Material::isotropic`] makes one of Young's modulus and thickness. The numbers can
/// be changed after that:
///
/// ```
/// use isosheet_materials::Material;
///
/// let mut paper = Material::named("office paper")?;
/// paper.rigidity = 3.2e-4; // the mean of both directions
/// paper.validate()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Paper is about twice as stiff in the direction in which it was made as across, and woven cloth is many
/// times softer in shear than along its yarns. A sheet has these [directions](Material::directions) where it
/// names one (`SheetOfMaterial::along`); otherwise it is isotropic.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Material {
    /// Mass of a square metre, kg/m2.
    pub density: f64,
    /// Membrane stiffness, Young's modulus times thickness `E h`, N/m.
    pub stiffness: f64,
    /// Flexural rigidity `D`, N m. That of a plate is `E h^3 / (12 (1 - nu^2))`; paper and cloth, whose
    /// fibres move against one another, are softer than this.
    pub rigidity: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// The largest principal strain that a sheet of this material may have: [`Material::STRAIN_LIMIT`], or
    /// more for materials that stretch visibly in use.
    pub strain_limit: f64,
    /// When a sheet of this material yields in bending, per metre of its width; nothing where it is not
    /// known.
    #[serde(default)]
    pub yields: Option<Yield>,
    /// How stiff it is along a direction and across it; nothing of a material that is the same in all.
    #[serde(default)]
    pub directions: Option<Directions>,
}

/// A sheet of one isotropic material, for [`Material::isotropic`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Isotropic {
    /// Young's modulus, Pa.
    pub youngs: f64,
    /// Thickness, m.
    pub thickness: f64,
    /// Mass of a cubic metre, kg/m3.
    pub density: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl Isotropic {
    /// Membrane stiffness `E h`, flexural rigidity `E h^3 / (12 (1 - nu^2))` and mass `rho h`.
    pub(crate) const fn sheet(self) -> Material {
        let Self {
            youngs,
            thickness,
            density,
            poisson,
        } = self;
        Material {
            density: density * thickness,
            stiffness: youngs * thickness,
            rigidity: youngs * thickness * thickness * thickness
                / (12.0 * (1.0 - poisson * poisson)),
            poisson,
            strain_limit: Material::STRAIN_LIMIT,
            yields: None,
            directions: None,
        }
    }
}

impl Material {
    /// The strain limit of materials unless they stretch more: 5 %. This is no yield point. Metals yield, and
    /// paper tears, at 0.1 to 3 %; a sheet that is bent without folds has strains far below that. The faces
    /// of a mesh that is too coarse for its bends have larger ones, as chords are shorter than arcs: by 4 %
    /// where a face bends by a radian.
    pub const STRAIN_LIMIT: f64 = ElasticSheet::LIMIT;

    /// The sheet of an isotropic material of constant thickness: metals, films, rubber.
    ///
    /// # Errors
    /// [`OptionsError`] naming the number that makes no sense, of the material or of the sheet
    /// ([`Material::validate`]). The ranges are far wider than for any material.
    pub fn isotropic(material: Isotropic) -> Result<Self, OptionsError> {
        OptionsError::check_range("youngs", material.youngs, 1.0, 1e15)?;
        OptionsError::check_range("thickness", material.thickness, 1e-12, 1e12)?;
        OptionsError::check_range("density", material.density, 1e-3, 1e6)?;
        OptionsError::check_range("poisson", material.poisson, 0.0, 0.5)?;
        let sheet = material.sheet();
        sheet.validate()?;
        Ok(sheet)
    }

    /// The hardening of metals, in parts of the rigidity: after the yield a moment grows with a hundredth of
    /// the slope before, `D H / (D + H) = D / 100`, as EN 1993-1-5 (Eurocode 3), C.6, has it for finite
    /// elements.
    const METAL_HARDENING: f64 = 1.0 / 99.0;

    /// Makes it yield at a stress (Pa), as a metal of this thickness (metres) does: at the moment `stress
    /// thickness^2 / 4` of a section that has yielded in the whole of its thickness, with the hardening of
    /// Eurocode 3, in [`Yield::LAYERS`] layers: it begins at two thirds of this moment.
    #[must_use]
    pub const fn with_yield_stress(self, thickness: f64, stress: f64) -> Self {
        let yields = Yield {
            moment: stress * thickness * thickness / 4.0,
            hardening: self.rigidity * Self::METAL_HARDENING,
            layers: Yield::LAYERS,
        };
        Self {
            yields: Some(yields),
            ..self
        }
    }

    /// Checks the numbers. The ranges are far wider than for any sheet; a strain limit has to be below 0.5,
    /// the compression of an edge to nothing.
    ///
    /// # Errors
    /// [`OptionsError`] naming the number that makes no sense.
    pub fn validate(&self) -> Result<(), OptionsError> {
        OptionsError::check_range("density", self.density, 1e-9, 1e9)?;
        OptionsError::check_range("stiffness", self.stiffness, 1e-9, 1e18)?;
        OptionsError::check_range("rigidity", self.rigidity, 0.0, 1e18)?;
        OptionsError::check_range("poisson", self.poisson, 0.0, 0.5)?;
        OptionsError::check_range("strain_limit", self.strain_limit, 1e-6, 0.49)?;
        self.yields.map_or(Ok(()), |yields| yields.validate())?;
        self.directions.map_or(Ok(()), |own| own.validate())
    }

    /// The elasticity in the plane of a sheet of this material, with the limit of the strain. The flexural
    /// rigidity is not part of it: `plate` resists bending, and is one more potential of the model
    /// ([`ElasticSheet::beside`]). It is the same in all directions; [`Material::membrane`] is with a
    /// direction.
    ///
    /// # Errors
    /// [`ElasticSheetError`].
    pub fn elastic_sheet(
        &self,
        sheet: &Sheet,
        plate: &PlateBending,
    ) -> Result<ElasticSheet, ElasticSheetError> {
        let elastic = ElasticSheet::of_law(sheet, self.membrane(None))?;
        elastic.beside(sheet, plate).with_limit(self.strain_limit)
    }
}

impl From<&Material> for PlateLaw {
    fn from(material: &Material) -> Self {
        PlateStiffness::from(material).into()
    }
}

impl From<&Material> for PlateStiffness {
    fn from(material: &Material) -> Self {
        Self {
            rigidity: material.rigidity,
            poisson: material.poisson,
        }
    }
}
