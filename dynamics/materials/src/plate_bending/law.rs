//! The law of a plate: moments by curvatures.

use super::error::PlateBendingError;
use super::stiffness::PlateStiffness;
use crate::direction::{DirectionError, MaterialDirection};
use crate::orthotropy::{PrincipalLaw, first_unusable, root, turn};
use crate::patched::Patched;
use isosheet_mesh::{FaceId, Sheet};
use nalgebra::Matrix3;

/// The stiffness of an orthotropic plate: a curvature with the components `k_1` along a direction of the
/// material, `k_2` across it and the twist `k_12` stores
///
/// ```text
/// 1/2 [ D11 k_1^2 + 2 D12 k_1 k_2 + D22 k_2^2 + 4 D66 k_12^2 ]
/// ```
///
/// per area (S. G. Lekhnitskii, *Anisotropic Plates*, 1968, sections 61 and 62; there `D66` is `D_k`). With
/// the Young's moduli `E1` and `E2`, the shear modulus `G12` and the Poisson's ratios `nu12 / E1 = nu21 / E2`
/// of a homogeneous plate of thickness `h` it is `D11 = E1 h^3 / (12 (1 - nu12 nu21))`, `D22 = D11 E2 / E1`,
/// `D12 = nu12 D22` and `D66 = G12 h^3 / 12`.
#[derive(Debug, Clone, PartialEq)]
pub struct OrthotropicPlate {
    /// `D11`: resists curvature along the direction, newton metres.
    pub along: f64,
    /// `D22`: resists curvature across it, newton metres.
    pub across: f64,
    /// `D12`: couples the two, newton metres.
    pub coupling: f64,
    /// `D66`: resists twist, newton metres.
    pub twist: f64,
    /// The direction of the material.
    pub direction: MaterialDirection,
}

impl OrthotropicPlate {
    fn law(&self) -> PrincipalLaw {
        PrincipalLaw {
            along: self.along,
            across: self.across,
            coupling: self.coupling,
            shear: self.twist,
        }
    }
}

/// Which law a plate has.
#[derive(Debug, Clone, PartialEq)]
pub enum PlateLaw {
    /// An isotropic plate.
    Isotropic(PlateStiffness),
    /// With two perpendicular directions.
    Orthotropic(OrthotropicPlate),
}

impl From<f64> for PlateLaw {
    fn from(rigidity: f64) -> Self {
        Self::Isotropic(rigidity.into())
    }
}

impl From<PlateStiffness> for PlateLaw {
    fn from(stiffness: PlateStiffness) -> Self {
        Self::Isotropic(stiffness)
    }
}

impl From<OrthotropicPlate> for PlateLaw {
    fn from(plate: OrthotropicPlate) -> Self {
        Self::Orthotropic(plate)
    }
}

impl PlateLaw {
    /// The flexural rigidity to which curvatures are related: that of an isotropic plate, the geometric mean
    /// of both directions of an orthotropic one; newton metres.
    pub fn rigidity(&self) -> f64 {
        match self {
            Self::Isotropic(stiffness) => stiffness.rigidity,
            Self::Orthotropic(plate) => plate.law().mean(),
        }
    }

    fn check(&self) -> Result<(), PlateBendingError> {
        match self {
            Self::Isotropic(PlateStiffness { rigidity, poisson }) => {
                let (rigidity, ratio) = (*rigidity, *poisson);
                if !(rigidity.is_finite() && rigidity >= 0.0) {
                    return Err(PlateBendingError::Rigidity { rigidity });
                }
                if !(0.0..=0.5).contains(&ratio) {
                    return Err(PlateBendingError::Poisson { ratio });
                }
            }
            Self::Orthotropic(plate) => {
                let law = plate.law();
                if let Some(rigidity) = first_unusable([law.along, law.across, law.shear]) {
                    return Err(PlateBendingError::Rigidity { rigidity });
                }
                if !law.is_definite() {
                    let coupling = law.coupling;
                    return Err(PlateBendingError::Coupling { coupling });
                }
            }
        }
        Ok(())
    }

    /// The law over the [rigidity](Self::rigidity) by the components `(11, sqrt(2) 12, 22)` of a curvature,
    /// the first axis along the direction of the material.
    fn matrix(&self) -> Matrix3<f64> {
        match self {
            Self::Isotropic(stiffness) => PrincipalLaw::isotropic(stiffness.poisson).over(1.0),
            Self::Orthotropic(plate) => plate.law().over(self.rigidity()),
        }
    }

    /// The root of the law of a face of a sheet.
    fn of_face(&self, sheet: &Sheet, face: FaceId) -> Result<Root, DirectionError> {
        let of_material = root(&self.matrix());
        Ok(Root {
            rigidity: self.rigidity(),
            root: match self {
                Self::Isotropic(_) => of_material,
                Self::Orthotropic(plate) => {
                    let turn = turn(plate.direction.angle(sheet, face)?);
                    turn.transpose() * of_material * turn
                }
            },
        })
    }
}

/// The laws of the faces: with the components `k = (11, sqrt(2) 12, 22)` of a curvature, the first axis along
/// the first edge of a face, `D |R k|^2 / 2` is the energy per area.
#[derive(Debug, Clone)]
pub(super) struct Roots {
    /// Of each face, or of all.
    of_faces: Vec<Root>,
}

/// The law of a face.
#[derive(Debug, Clone)]
struct Root {
    /// `D`, newton metres.
    rigidity: f64,
    /// `R`.
    root: Matrix3<f64>,
}

impl Roots {
    /// Of the faces of a sheet. A plate that resists bending does so everywhere.
    ///
    /// # Errors
    /// [`PlateBendingError`] if a law makes no sense, or a direction is none.
    pub(super) fn new(sheet: &Sheet, laws: &Patched<PlateLaw>) -> Result<Self, PlateBendingError> {
        for law in laws.all() {
            law.check()?;
            let rigidity = law.rigidity();
            if !laws.is_uniform() && rigidity == 0.0 {
                return Err(PlateBendingError::Rigidity { rigidity });
            }
        }
        let of_face = |(face, law): (FaceId, &PlateLaw)| law.of_face(sheet, face);
        let topology = sheet.topology();
        let is_same = laws.is_uniform() && matches!(laws.ground(), PlateLaw::Isotropic(_));
        let count = match is_same {
            true => topology.face_count().min(1),
            false => topology.face_count(),
        };
        let own = laws.of_faces(topology.face_count())?;
        let own = topology.face_ids().zip(own).take(count).map(of_face);
        let of_faces = own.collect::<Result<_, DirectionError>>();
        let of_faces = of_faces.map_err(|source| PlateBendingError::Direction { source })?;
        Ok(Self { of_faces })
    }

    /// The inverse of `R` of a face.
    pub(super) fn inverse(&self, face: usize) -> Matrix3<f64> {
        let inverse = self.of(face).try_inverse();
        inverse.expect("the root of a positive definite law")
    }

    /// `R` of a face.
    pub(super) fn of(&self, face: usize) -> &Matrix3<f64> {
        &self.own(face).root
    }

    /// `D` of a face, newton metres.
    pub(super) fn rigidity(&self, face: usize) -> f64 {
        self.own(face).rigidity
    }

    /// Whether the plate resists bending.
    pub(super) fn are_stiff(&self) -> bool {
        self.of_faces.iter().all(|own| own.rigidity > 0.0)
    }

    fn own(&self, face: usize) -> &Root {
        &self.of_faces[face.min(self.of_faces.len() - 1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isosheet_mesh::generate;
    use nalgebra::Vector3;
    use std::f64::consts::SQRT_2;

    fn components(k: [f64; 3]) -> Vector3<f64> {
        Vector3::new(k[0], SQRT_2 * k[1], k[2])
    }

    #[test]
    fn the_root_of_an_isotropic_law_gives_its_energy() {
        let sheet = generate::isotropic_square(0, 1.0).unwrap();
        let [k11, k12, k22] = [0.7, -1.3, 0.4];
        let (norm, trace) = (k11 * k11 + 2.0 * k12 * k12 + k22 * k22, k11 + k22);
        for poisson in [0.0, 0.3, 0.5] {
            let law = PlateLaw::from(PlateStiffness {
                rigidity: 2.0,
                poisson,
            });
            let roots = Roots::new(&sheet, &Patched::everywhere(law)).unwrap();
            let energy = (roots.of(1) * components([k11, k12, k22])).norm_squared();
            let expected = (1.0 - poisson) * norm + poisson * trace * trace;
            assert!((energy - expected).abs() < 1e-14, "{poisson}");
        }
    }

    /// Of a face whose first edge is turned against the direction of the material.
    #[test]
    fn the_root_of_an_orthotropic_law_turns_with_the_direction() {
        let direction = [0.8_f64, 0.6, 0.0];
        let plate = OrthotropicPlate {
            along: 4.0,
            across: 1.0,
            coupling: 0.5,
            twist: 0.7,
            direction: MaterialDirection::Uniform(direction),
        };
        let law = PlateLaw::from(plate);
        let sheet = generate::isotropic_square(1, 1.0).unwrap();
        let roots = Roots::new(&sheet, &Patched::everywhere(law)).unwrap();
        // A curvature in space, and its components along the direction and along the first edge.
        let matrix = Matrix3::new(0.7, -0.3, 0.0, -0.3, 0.2, 0.0, 0.0, 0.0, 0.0);
        let by = |first: Vector3<f64>| {
            let second = Vector3::z().cross(&first);
            let entry = |u: &Vector3<f64>, v: &Vector3<f64>| u.dot(&(matrix * v));
            [
                entry(&first, &first),
                entry(&first, &second),
                entry(&second, &second),
            ]
        };
        let [k1, k12, k2] = by(Vector3::from(direction));
        let expected = 4.0 * k1 * k1 + 2.0 * 0.5 * k1 * k2 + k2 * k2 + 4.0 * 0.7 * k12 * k12;
        for (f, corners) in sheet.topology().faces().iter().enumerate() {
            let [a, b, _] = corners.map(|v| crate::vectors::point(sheet.positions(), v));
            let own = components(by((b - a).normalize()));
            let energy = roots.rigidity(f) * (roots.of(f) * own).norm_squared();
            assert!((energy - expected).abs() < 1e-13, "{energy} {expected}");
        }
    }

    #[test]
    fn laws_that_make_no_sense_are_refused() {
        let sheet = generate::isotropic_square(0, 1.0).unwrap();
        let plate = |coupling: f64, direction| {
            let plate = OrthotropicPlate {
                along: 4.0,
                across: 1.0,
                coupling,
                twist: 1.0,
                direction,
            };
            let law = PlateLaw::from(plate);
            Roots::new(&sheet, &Patched::everywhere(law)).unwrap_err()
        };
        let x = MaterialDirection::Uniform([1.0, 0.0, 0.0]);
        assert_eq!(plate(2.5, x), PlateBendingError::Coupling { coupling: 2.5 });
        let z = MaterialDirection::Uniform([0.0, 0.0, 1.0]);
        assert!(matches!(plate(0.0, z), PlateBendingError::Direction { .. }));
        let few = MaterialDirection::Faces(vec![[1.0, 0.0, 0.0]]);
        let source = DirectionError::Count {
            found: 1,
            expected: 8,
        };
        assert_eq!(plate(0.0, few), PlateBendingError::Direction { source });
        let nan = MaterialDirection::Uniform([f64::NAN; 3]);
        assert!(matches!(
            plate(0.0, nan),
            PlateBendingError::Direction { .. }
        ));
    }
}
