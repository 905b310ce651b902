//! How stiff a sheet is in its plane.

use super::error::ElasticSheetError;
use super::law::Law;
use crate::OrthotropicPlate;
use crate::direction::MaterialDirection;
use crate::orthotropy::{PrincipalLaw, first_unusable, turn};
use isosheet_mesh::{FaceId, Sheet};

/// The stiffness of a sheet in its plane whose material has two perpendicular directions, in plane stress:
/// the strains `e_1` along a direction of the material, `e_2` across it and the shear `2 e_12` follow from
/// the forces per width by
///
/// ```text
/// e_1 = (s_1 - nu12 s_2) / (E1 h),   e_2 = s_2 / (E2 h) - nu12 s_1 / (E1 h),   2 e_12 = s_12 / (G12 h)
/// ```
///
/// (S. G. Lekhnitskii, *Anisotropic Plates*, 1968, sections 2 and 9). A strip that is cut at an angle `t` to
/// the direction and pulled has Young's modulus
///
/// ```text
/// 1 / E(t) = cos^4 t / E1 + (1 / G12 - 2 nu12 / E1) sin^2 t cos^2 t + sin^4 t / E2.
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct OrthotropicMembrane {
    /// Young's modulus along the direction times thickness, `E1 h`, N/m.
    pub along: f64,
    /// Young's modulus across it times thickness, `E2 h`, N/m.
    pub across: f64,
    /// Shear modulus times thickness, `G12 h`, N/m.
    pub shear: f64,
    /// Poisson's ratio `nu12`: how much the sheet contracts across the direction where it is pulled along it.
    /// Its square has to be less than `E1 / E2`.
    pub poisson: f64,
    /// The direction of the material.
    pub direction: MaterialDirection,
}

/// How stiff a sheet is in its plane.
#[derive(Debug, Clone, PartialEq)]
pub enum MembraneLaw {
    /// An isotropic law.
    Isotropic {
        /// Young's modulus times thickness, N/m.
        stiffness: f64,
        /// Poisson's ratio, from 0 to 0.5.
        poisson: f64,
    },
    /// With two perpendicular directions.
    Orthotropic(OrthotropicMembrane),
}

impl From<OrthotropicMembrane> for MembraneLaw {
    fn from(membrane: OrthotropicMembrane) -> Self {
        Self::Orthotropic(membrane)
    }
}

impl OrthotropicMembrane {
    /// The plate of the same material, which is homogeneous over its thickness (metres); [`OrthotropicPlate`]
    /// has its rigidities by moduli.
    #[must_use]
    pub fn plate(&self, thickness: f64) -> OrthotropicPlate {
        let PrincipalLaw {
            along,
            across,
            coupling,
            shear,
        } = self.law();
        let bends = |stiffness: f64| stiffness * thickness * thickness / 12.0;
        OrthotropicPlate {
            along: bends(along),
            across: bends(across),
            coupling: bends(coupling),
            twist: bends(shear),
            direction: self.direction.clone(),
        }
    }

    /// Forces by strains.
    fn law(&self) -> PrincipalLaw {
        let free = 1.0 - self.poisson * self.poisson * self.across / self.along;
        let across = self.across / free;
        PrincipalLaw {
            along: self.along / free,
            across,
            coupling: self.poisson * across,
            shear: self.shear,
        }
    }

    fn check(&self) -> Result<(), ElasticSheetError> {
        if let Some(stiffness) = first_unusable([self.along, self.across, self.shear]) {
            return Err(ElasticSheetError::Stiffness { stiffness });
        }
        match self.law().is_definite() {
            true => Ok(()),
            false => Err(ElasticSheetError::Coupling {
                ratio: self.poisson,
                bound: (self.along / self.across).sqrt(),
            }),
        }
    }
}

impl MembraneLaw {
    /// The largest Young's modulus times thickness, N/m.
    pub fn stiffness(&self) -> f64 {
        match self {
            Self::Isotropic { stiffness, .. } => *stiffness,
            Self::Orthotropic(membrane) => membrane.along.max(membrane.across),
        }
    }

    pub(super) fn check(&self) -> Result<(), ElasticSheetError> {
        match self {
            Self::Isotropic { stiffness, poisson } => {
                let (stiffness, ratio) = (*stiffness, *poisson);
                if !(stiffness.is_finite() && stiffness > 0.0) {
                    return Err(ElasticSheetError::Stiffness { stiffness });
                }
                if !(0.0..=0.5).contains(&ratio) {
                    return Err(ElasticSheetError::Poisson { ratio });
                }
                Ok(())
            }
            Self::Orthotropic(membrane) => membrane.check(),
        }
    }

    /// The law of a face by the components of its strain, the first axis along its first edge.
    pub(super) fn of_face(&self, sheet: &Sheet, face: FaceId) -> Result<Law, ElasticSheetError> {
        match self {
            Self::Isotropic { stiffness, poisson } => Ok(Law::isotropic(*stiffness, *poisson)),
            Self::Orthotropic(membrane) => {
                let angle = membrane.direction.angle(sheet, face);
                let angle = angle.map_err(|source| ElasticSheetError::Direction { source })?;
                Ok(Law::orthotropic(membrane.law(), &turn(angle)))
            }
        }
    }
}
