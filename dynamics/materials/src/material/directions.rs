//! Materials with two directions.

use super::Material;
use crate::direction::MaterialDirection;
use crate::options::OptionsError;
use crate::plasticity::Yield;
use crate::{MembraneLaw, OrthotropicMembrane, OrthotropicPlate, PlateLaw, PlateStiffness};
use serde::{Deserialize, Serialize};

/// How stiff a material is along a direction and across it: along and across the direction in which paper was
/// made, the warp and the weft of cloth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Directions {
    /// Young's modulus along the direction times thickness, `E1 h`, N/m.
    pub along: f64,
    /// Young's modulus across it times thickness, `E2 h`, N/m.
    pub across: f64,
    /// Shear modulus times thickness, `G12 h`, N/m.
    pub shear: f64,
    /// Poisson's ratio `nu12`: contraction across the direction by a pull along it.
    pub poisson: f64,
    /// Rigidity `D11` of bends along the direction, N m.
    pub bend_along: f64,
    /// Rigidity `D22` of bends across it, N m.
    pub bend_across: f64,
    /// Rigidity `D66` against twist, N m.
    pub twist: f64,
    /// Coupling `D12` of bends in both directions, N m.
    pub coupling: f64,
    /// The largest strain, in place of that of [`Material`]: woven cloth shears visibly in use.
    pub strain_limit: f64,
}

/// A sheet of one material with two directions, homogeneous over its thickness, for
/// [`Material::orthotropic`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orthotropic {
    /// Young's modulus along the direction, Pa.
    pub youngs: f64,
    /// Young's modulus across it, Pa.
    pub youngs_across: f64,
    /// Shear modulus, Pa.
    pub shear: f64,
    /// Poisson's ratio `nu12`: contraction across the direction by a pull along it.
    pub poisson: f64,
    /// Thickness, m.
    pub thickness: f64,
    /// Mass of a cubic metre, kg/m3.
    pub density: f64,
}

/// Geometric mean of the Poisson's ratios of paper, and its shear modulus in parts of the geometric mean of
/// Young's moduli (G. A. Baum, D. C. Brennan and C. C. Habeger, "Orthotropic elastic constants of paper",
/// Tappi 64(8), 97-101, 1981).
const PAPER_POISSON: f64 = 0.293;
const PAPER_SHEAR: f64 = 0.387;

impl Directions {
    /// The elastic constants of paper, from the geometric means `stiffness` of the `E h` (newtons per metre)
    /// and `rigidity` of the `D` (newton metres) of both directions: along the machine so many times the
    /// mean, across it the mean over as much.
    pub(super) const fn of_paper(stiffness: f64, rigidity: f64, times: f64) -> Self {
        Self {
            along: stiffness * times,
            across: stiffness / times,
            shear: PAPER_SHEAR * stiffness,
            poisson: PAPER_POISSON * times,
            bend_along: rigidity * times,
            bend_across: rigidity / times,
            twist: PAPER_SHEAR * (1.0 - PAPER_POISSON * PAPER_POISSON) * rigidity,
            coupling: PAPER_POISSON * rigidity,
            strain_limit: Material::STRAIN_LIMIT,
        }
    }

    /// The elastic constants of woven cloth, from `E h` of warp and weft and the shear modulus (newtons per
    /// metre), and the rigidities of warp and weft (newton metres), whose geometric mean is given, too. Twist
    /// is resisted so much that a strip that is cut at 45 degrees is about as stiff as the mean of the
    /// others.
    pub(super) const fn of_cloth(
        [along, across, shear]: [f64; 3],
        poisson: f64,
        [bend_along, bend_across, mean]: [f64; 3],
    ) -> Self {
        Self {
            along,
            across,
            shear,
            poisson,
            bend_along,
            bend_across,
            twist: 0.5 * mean,
            coupling: 0.0,
            strain_limit: Self::CLOTH_LIMIT,
        }
    }

    /// The limit of the strain of woven cloth: of a shear of 16 degrees. Cloth that hangs shears by some
    /// degrees.
    const CLOTH_LIMIT: f64 = 0.2;

    fn membrane(&self, direction: MaterialDirection) -> OrthotropicMembrane {
        OrthotropicMembrane {
            along: self.along,
            across: self.across,
            shear: self.shear,
            poisson: self.poisson,
            direction,
        }
    }

    fn plate(&self, direction: MaterialDirection) -> OrthotropicPlate {
        OrthotropicPlate {
            along: self.bend_along,
            across: self.bend_across,
            coupling: self.coupling,
            twist: self.twist,
            direction,
        }
    }

    /// Geometric means of both directions: of `E h`, of `D`, and of Poisson's ratios.
    fn means(&self) -> [f64; 3] {
        [
            (self.along * self.across).sqrt(),
            (self.bend_along * self.bend_across).sqrt(),
            self.poisson * (self.across / self.along).sqrt(),
        ]
    }

    pub(super) fn validate(&self) -> Result<(), OptionsError> {
        for (name, stiffness) in [
            ("along", self.along),
            ("across", self.across),
            ("shear", self.shear),
        ] {
            OptionsError::check_range(name, stiffness, 1e-9, 1e18)?;
        }
        for (name, rigidity) in [
            ("bend_along", self.bend_along),
            ("bend_across", self.bend_across),
            ("twist", self.twist),
        ] {
            OptionsError::check_range(name, rigidity, 1e-18, 1e18)?;
        }
        OptionsError::check_range("strain_limit", self.strain_limit, 1e-6, 0.49)?;
        let most = (self.along / self.across).sqrt();
        OptionsError::check_range("poisson", self.poisson, -most, most)?;
        let most = (self.bend_along * self.bend_across).sqrt();
        OptionsError::check_range("coupling", self.coupling, -most, most)
    }
}

impl Material {
    /// The sheet of a material with two directions, of constant thickness: laminates, wood. Where no
    /// direction is named it has the geometric means of both.
    ///
    /// # Errors
    /// [`OptionsError`] naming the number that makes no sense.
    pub fn orthotropic(material: Orthotropic) -> Result<Self, OptionsError> {
        let Orthotropic {
            youngs,
            youngs_across,
            shear,
            poisson,
            thickness,
            density,
        } = material;
        for (name, modulus) in [
            ("youngs", youngs),
            ("youngs_across", youngs_across),
            ("shear", shear),
        ] {
            OptionsError::check_range(name, modulus, 1.0, 1e15)?;
        }
        OptionsError::check_range("thickness", thickness, 1e-12, 1e12)?;
        OptionsError::check_range("density", density, 1e-3, 1e6)?;
        let most = (youngs / youngs_across).sqrt();
        OptionsError::check_range("poisson", poisson, -most, most)?;
        let membrane = OrthotropicMembrane {
            along: youngs * thickness,
            across: youngs_across * thickness,
            shear: shear * thickness,
            poisson,
            direction: MaterialDirection::Uniform([1.0, 0.0, 0.0]),
        };
        let plate = membrane.plate(thickness);
        let directions = Directions {
            along: membrane.along,
            across: membrane.across,
            shear: membrane.shear,
            poisson,
            bend_along: plate.along,
            bend_across: plate.across,
            twist: plate.twist,
            coupling: plate.coupling,
            strain_limit: Self::STRAIN_LIMIT,
        };
        let [stiffness, rigidity, mean] = directions.means();
        let sheet = Self {
            density: density * thickness,
            stiffness,
            rigidity,
            poisson: mean.clamp(0.0, 0.5),
            strain_limit: Self::STRAIN_LIMIT,
            yields: None,
            directions: Some(directions),
        };
        sheet.validate()?;
        Ok(sheet)
    }

    /// This material as an orthotropic one, where its direction is named: stiffness, rigidity and Poisson's
    /// ratio are the geometric means of both directions, the limit of the strain is that of [`Directions`],
    /// and the sheet yields at the same curvature of the mean rigidity. A material without directions is
    /// returned as it is.
    #[must_use]
    pub fn directed(self) -> Self {
        let Some(directions) = self.directions else {
            return self;
        };
        let [stiffness, rigidity, poisson] = directions.means();
        let part = rigidity / self.rigidity;
        let yields = self.yields.map(|yields| Yield {
            moment: part * yields.moment,
            hardening: part * yields.hardening,
            ..yields
        });
        Self {
            stiffness,
            rigidity,
            poisson: poisson.clamp(0.0, 0.5),
            strain_limit: directions.strain_limit,
            yields,
            ..self
        }
    }

    /// How stiff it is in its plane, with a direction if the sheet has one and the material, too.
    pub fn membrane(&self, direction: Option<&MaterialDirection>) -> MembraneLaw {
        match (self.directions, direction) {
            (Some(own), Some(direction)) => own.membrane(direction.clone()).into(),
            _ => MembraneLaw::Isotropic {
                stiffness: self.stiffness,
                poisson: self.poisson,
            },
        }
    }

    /// How stiff it is in bending, with a direction if the sheet has one and the material, too.
    pub fn plate(&self, direction: Option<&MaterialDirection>) -> PlateLaw {
        match (self.directions, direction) {
            (Some(own), Some(direction)) => own.plate(direction.clone()).into(),
            _ => PlateStiffness::from(self).into(),
        }
    }
}
