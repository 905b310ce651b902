//! The curvature that a plate has without moments.

use super::error::CurlError;
use super::law::Roots;
use super::stencil::POINTS;
use crate::direction::{DirectionError, MaterialDirection};
use crate::orthotropy::turn;
use isosheet_mesh::{FaceId, Sheet};
use isosheet_motion::Profile;
use nalgebra::Vector3;
use std::f64::consts::SQRT_2;

/// The curvature that a sheet has by itself, without moments: that of paper which curls along one direction,
/// of a poster off a roll, of a bilayer or a bimetal.
///
/// With the curvature `k_1` along a direction of the material, `k_2` across it and the twist `k_12`, times a
/// profile of time, `V` is the energy of what a face is bent beyond, `k_T - k_0`. Curvatures are positive
/// towards the front of the faces, from which their corners run counter-clockwise: the sheet rolls up with
/// its front inside.
///
/// A strip whose two layers want strains that differ by `e` has the curvature
///
/// ```text
/// 6 e (1 + m)^2 / (h [3 (1 + m)^2 + (1 + m n) (m^2 + 1 / (m n))])
/// ```
///
/// with the thickness `h` of both together, the ratio `m` of their thicknesses and `n` of their moduli: `1.5
/// e / h` for equal layers (S. Timoshenko, "Analysis of bi-metal thermostats", J. Opt. Soc. Am. 11, 1925). A
/// wide plate with `k_0` in both directions rolls up along one, to the curvature `(1 + nu) k_0`.
#[derive(Debug, Clone, PartialEq)]
pub struct Curl {
    /// The direction along which the sheet is curved.
    pub direction: MaterialDirection,
    /// How much.
    pub curvature: NaturalTensor,
    /// A factor of time, in seconds: a constant 1 for a curl that is always there.
    pub profile: Profile,
}

/// The components of a curvature by a direction of the material, 1/m.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Curvature {
    /// `k_1`, along the direction.
    pub along: f64,
    /// `k_2`, across it.
    pub across: f64,
    /// `k_12`, the angle by which a line across the direction turns about it in a metre: a narrow strip with
    /// this alone is a helicoid.
    pub twist: f64,
}

impl Curvature {
    /// The larger of its principal curvatures, without its sign.
    fn sharpest(&self) -> f64 {
        let half = 0.5 * (self.along - self.across);
        (0.5 * (self.along + self.across)).abs() + half.hypot(self.twist)
    }
}

/// A natural curvature of all faces, or of each.
#[derive(Debug, Clone, PartialEq)]
pub enum NaturalTensor {
    /// A uniform curvature.
    Uniform(Curvature),
    /// One for each face.
    Faces(Vec<Curvature>),
}

impl From<Curvature> for NaturalTensor {
    fn from(curvature: Curvature) -> Self {
        Self::Uniform(curvature)
    }
}

/// Natural curvatures of the points of a plate.
#[derive(Debug)]
pub(super) struct NaturalCurvature {
    /// `R k_0` of each point, 1/m.
    points: Vec<Vector3<f64>>,
    /// Its factor, unless that is always one.
    profile: Option<Profile>,
}

impl NaturalCurvature {
    /// Of curvatures `R k` of the points, 1/m.
    pub(super) fn of_points(points: Vec<Vector3<f64>>) -> Self {
        let profile = None;
        Self { points, profile }
    }

    /// The factor of time, unless that is always one.
    pub(super) fn profile(&self) -> Option<&Profile> {
        self.profile.as_ref()
    }

    /// `R k_0` of a point, 1/m.
    pub(super) fn own(&self, point: usize) -> &Vector3<f64> {
        &self.points[point]
    }

    /// Of curvatures `R k` of the points at a time when the profile is one, 1/m.
    ///
    /// # Errors
    /// [`CurlError`].
    pub(super) fn of_shape(points: Vec<Vector3<f64>>, profile: Profile) -> Result<Self, CurlError> {
        profile.validate()?;
        let mut numbers = points.iter().flat_map(|k| k.iter());
        if let Some(value) = numbers.find(|k| !k.is_finite()) {
            return Err(CurlError::Curvature { value: *value });
        }
        let profile = Some(profile);
        Ok(Self { points, profile })
    }

    /// # Errors
    /// [`CurlError`].
    pub(super) fn of_curl(sheet: &Sheet, roots: &Roots, curl: Curl) -> Result<Self, CurlError> {
        curl.profile.validate()?;
        let all = match &curl.curvature {
            NaturalTensor::Uniform(own) => std::slice::from_ref(own),
            NaturalTensor::Faces(all) => all,
        };
        let (found, expected) = (all.len(), sheet.topology().face_count());
        if matches!(&curl.curvature, NaturalTensor::Faces(_)) && found != expected {
            return Err(CurlError::Count { found, expected });
        }
        let numbers = all.iter().flat_map(|k| [k.along, k.across, k.twist]);
        if let Some(value) = numbers.into_iter().find(|k| !k.is_finite()) {
            return Err(CurlError::Curvature { value });
        }
        for face in sheet.topology().face_ids() {
            let sharpest = all[face.index().min(found - 1)].sharpest();
            let edges = sheet.topology().face_edges(face);
            let lengths = edges.map(|e| sheet.lengths()[e.index()]);
            let length = lengths.into_iter().fold(0.0, f64::max);
            // A chord of a circle is not longer than its diameter.
            if sharpest * length > 2.0 {
                let radius = 1.0 / sharpest;
                return Err(CurlError::Sharp {
                    face,
                    radius,
                    length,
                });
            }
        }
        let of_face = |face: FaceId| {
            let k = all[face.index().min(found - 1)];
            let own = Vector3::new(k.along, SQRT_2 * k.twist, k.across);
            let angle = curl.direction.angle(sheet, face)?;
            Ok::<_, DirectionError>(roots.of(face.index()) * turn(angle).tr_mul(&own))
        };
        let mut points = Vec::with_capacity(POINTS * sheet.topology().face_count());
        for face in sheet.topology().face_ids() {
            points.extend([of_face(face)?; POINTS]);
        }
        Ok(Self {
            points,
            profile: Some(curl.profile),
        })
    }

    pub(super) fn is_driven(&self) -> bool {
        let profile = self.profile.as_ref();
        profile.is_some_and(|profile| !profile.is_constant())
    }

    /// `R k_0` of a point at a time, 1/m.
    pub(super) fn at(&self, point: usize, t: f64) -> Vector3<f64> {
        let factor = self.profile.as_ref().map_or(1.0, |p| p.value(t));
        factor * self.points[point]
    }
}
